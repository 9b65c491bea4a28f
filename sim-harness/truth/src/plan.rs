//! Which runs a scenario has: seed, direction, departure, and the effects that act in each.
//!
//! In: a scenario, a number of runs and a seed. Out: a [`RunPlan`] for each, in the order of departure.

use crate::conditions::Scenario;
use crate::effects::Together;
use crate::seeds::{run_seed, stream};
pub use crate::timetable::{Dates, Heading, Headings};
use rand::RngExt;

const DAY_S: f64 = 86_400.0;
/// Trains run from 6 to 22 h UTC.
const SERVICE_S: [f64; 2] = [6.0 * 3600.0, 22.0 * 3600.0];

/// One run before it is driven.
#[derive(Clone, Debug, PartialEq)]
pub struct RunPlan {
    /// Counted from 1.
    pub number: usize,
    /// Feeds all draws of the run.
    pub seed: u64,
    /// Direction.
    pub heading: Heading,
    /// Start of the log, in seconds after 1970-01-01 UTC.
    pub departure_s: i64,
    /// Where between the first and the last departure, 0 to 1.
    pub season: f64,
    /// For each effect of the scenario, whether it acts in this run.
    pub acting: Vec<bool>,
    /// Who drives; none where every run has another driver.
    pub driver: Option<Turn>,
}

/// A driver whose turn it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Counted from 1.
    pub number: usize,
    /// Feeds the draws of this driver's style.
    pub seed: u64,
}

impl Turn {
    /// In files.
    pub fn name(self) -> String {
        format!("driver{:02}", self.number)
    }
}

impl RunPlan {
    /// A run on its own: the first of its scenario, with this seed.
    pub fn alone(scenario: &Scenario, seed: u64) -> Self {
        let mut plans = plan(scenario, 1, seed);
        Self { seed, ..plans.swap_remove(0) }
    }
}

/// Plans the runs of a scenario; run `i` has the seed [`run_seed`]`(seed, i)`.
pub fn plan(scenario: &Scenario, runs: usize, seed: u64) -> Vec<RunPlan> {
    let departures: Vec<i64> = (0..runs).map(|i| departure_s(scenario.dates, runs, i, seed)).collect();
    let first_s = departures.first().copied().unwrap_or(0);
    let span_s = (departures.last().copied().unwrap_or(0) - first_s).max(1);
    let days: Vec<i64> = departures.iter().map(|s| s.div_euclid(DAY_S as i64)).collect();
    let each: Vec<i64> = (0..runs as i64).collect();
    let acting: Vec<Vec<bool>> = scenario
        .effects
        .iter()
        .enumerate()
        .map(|(index, effect)| {
            // Each effect draws its runs on its own.
            let seed = seed ^ (index as u64 + 1).wrapping_mul(0xD1B5_4A32_D192_ED03);
            match effect.law().affected() {
                None => vec![true; runs],
                Some((affected, Together::Nothing)) => affected.choose(&each, seed),
                Some((affected, Together::Day)) => affected.choose(&days, seed),
            }
        })
        .collect();
    (0..runs)
        .map(|i| RunPlan {
            number: i + 1,
            seed: run_seed(seed, i),
            heading: match scenario.headings {
                Headings::Down => Heading::Down,
                Headings::Both if i % 2 == 1 => Heading::Down,
                _ => Heading::Up,
            },
            departure_s: departures[i],
            season: (departures[i] - first_s) as f64 / span_s as f64,
            acting: acting.iter().map(|runs| runs[i]).collect(),
            driver: turn(scenario.drivers, run_seed(seed, i), seed),
        })
        .collect()
}

/// Drawn for each run, from a stream of its own.
fn turn(drivers: usize, run: u64, set: u64) -> Option<Turn> {
    (drivers > 0).then(|| {
        let number = stream(run, 12).random_range(1..=drivers);
        Turn { number, seed: run_seed(!set, number) }
    })
}

/// Evenly spread, drawn within its share of the period, moved into the hours of service.
fn departure_s(dates: Dates, runs: usize, run: usize, seed: u64) -> i64 {
    let within: f64 = stream(run_seed(seed, run), 7).random();
    let day = (run as f64 + within) / runs as f64 * dates.days;
    let [from_s, to_s] = SERVICE_S;
    let time_s = day.floor() * DAY_S + from_s + day.fract() * (to_s - from_s);
    dates.start_s + time_s.round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Affected, LowAdhesion};

    #[test]
    fn runs_are_in_order_and_within_their_period() {
        let scenario = Scenario { headings: Headings::Both, ..Scenario::default() };
        let plans = plan(&scenario, 67, 5);
        assert!(plans.is_sorted_by_key(|p| p.departure_s));
        let start_s = scenario.dates.start_s;
        assert!(plans.iter().all(|p| {
            let since_s = p.departure_s - start_s;
            (0..60 * 86_400).contains(&since_s) && (6..22).contains(&(since_s / 3600 % 24))
        }));
        assert_eq!((plans[0].season, plans[66].season), (0.0, 1.0));
        let down = plans.iter().filter(|p| p.heading == Heading::Down).count();
        assert_eq!(down, 33);
    }

    #[test]
    fn a_driver_has_a_style_and_the_next_one_another() {
        let scenario = Scenario { drivers: 3, ..Scenario::default() };
        let turns: Vec<Turn> = plan(&scenario, 60, 5).iter().filter_map(|plan| plan.driver).collect();
        assert_eq!(turns.len(), 60);
        for number in 1..=3 {
            let mut seeds: Vec<u64> = turns.iter().filter(|turn| turn.number == number).map(|turn| turn.seed).collect();
            assert!(seeds.len() > 10);
            seeds.dedup();
            assert_eq!(seeds.len(), 1);
        }
        assert!(plan(&Scenario::default(), 3, 5).iter().all(|plan| plan.driver.is_none()));
    }

    #[test]
    fn runs_of_one_day_slip_together() {
        let scenario = Scenario {
            dates: Dates { days: 10.0, ..Dates::default() },
            effects: vec![LowAdhesion { factor: 0.5, below_kmh: 40.0, runs: Affected::Share(0.3) }.into()],
            ..Scenario::default()
        };
        let plans = plan(&scenario, 60, 2);
        let mut slippery: Vec<i64> = plans.iter().filter(|p| p.acting[0]).map(|p| p.departure_s / 86_400).collect();
        let count = slippery.len();
        slippery.dedup();
        assert_eq!(slippery.len(), 3);
        assert!(count >= 12);
        for p in plans {
            assert_eq!(p.acting[0], slippery.contains(&(p.departure_s / 86_400)));
        }
    }
}
