//! Where a log without an effort column coasted: the probability of coasting of each interval, forward and backward
//! over its run.
//!
//! The train's effort is calculated from the change of speed and the current model; each regime expects its own,
//!
//! | regime | effort expected, N/kg |
//! |---|---|
//! | coast | 0 |
//! | hold | what keeps the speed: r + g |
//! | power | 0.15 to 1.1 of the largest, or beyond |
//! | brake | -0.8 to -0.1, or below |
//! | change | -0.5 to 1.05 of the largest |
//!
//! Coasting and a held speed weigh more than their share, 2.5 times as much as a density of the same width: without
//! that short coasts would hardly be seen. An interval counts as coasted only if the one beside it did, too, or if the
//! change clearly lies in the one beside it: its effort is a part of the one before. How often regimes change is found
//! from the runs.

use crate::config::CoastingConfig;
use crate::data::{believed::believed_load, interval::Interval};
use crate::noise::calibrate::Own;
use rundown::model::line::Line;

const REGIMES: usize = 5;
/// The place of coasting among the regimes.
const COAST: usize = 0;

/// How sure a calculated effort is in which coasting is to be recognised.
#[derive(Clone, Copy, Debug)]
pub struct Recognised<'a> {
    /// Standard deviation of the calculated effort, N/kg.
    pub noise_n_per_kg: f64,
    /// The same of the resistance, as a share.
    pub uncertain: f64,
    /// What differs from run to run.
    pub own: Own,
    /// Thresholds.
    pub config: &'a CoastingConfig,
}

/// What the model has beyond the believed description in each interval of a run, N/kg.
#[derive(Clone, Debug)]
pub struct Extra {
    pub all: Vec<f64>,
    /// Without what acts by place.
    pub beyond_places: Vec<f64>,
}

/// The intervals of one run, each weighed.
pub struct Driven<'a> {
    weighed: Vec<Weighed>,
    noise_n_per_kg: f64,
    config: &'a CoastingConfig,
}

/// One interval under each regime.
struct Weighed {
    effort_n_per_kg: f64,
    /// Weight of its effort under each regime.
    weights: [f64; REGIMES],
    /// Log of how much better coasting fits than a held speed, each beside its own best.
    over_held: f64,
}

impl Weighed {
    fn new(line: &Line<'_>, interval: &Interval, extra: [f64; 2], recognised: &Recognised<'_>) -> Self {
        let config = recognised.config;
        // Beyond that it would be power that drivers apply at the same place, taken for a gradient, and found there
        // ever more.
        let [extra, beyond_places] = extra.map(|e| e.clamp(-config.most_extra_n_per_kg, config.most_extra_n_per_kg));
        let load = believed_load(line, interval) + extra;
        let effort = interval.acceleration_mps2() + load;
        let speed = interval.mean_speed_mps();
        let davis = line.train.davis();
        let noise = recognised.noise_n_per_kg;
        let sd = [
            recognised.uncertain * davis.resistance_n_per_kg(speed),
            recognised.own.constant_n_per_kg,
            2.0 * davis.r2 * speed * recognised.own.wind_mps,
        ];
        let sd = sd.into_iter().fold(noise, f64::hypot);
        let student = |x: f64, sd: f64| {
            let z = x / sd;
            (1.0 + z * z / 5.0).powi(-3) / sd
        };
        // Not heavier tails: one interval of power between two of coasting must cost more than to change twice.
        let coast = |effort: f64| (-0.5 * (effort / sd).powi(2)).exp() + config.tail;
        let hold = |change: f64| {
            (1.0 - config.held_wide_share) * student(change, config.held_narrow * noise)
                + config.held_wide_share * student(change, config.held_wide * noise)
        };
        // A broad plateau with soft edges.
        let even = |low: f64, high: f64| {
            let outside = (low - effort).max(effort - high).max(0.0);
            student(outside, noise) * noise / (high - low)
        };
        let held = hold(effort - load);
        let most = line.train.max_effort_n_per_kg(speed.max(1.0));
        let weights = [
            coast(effort) / sd,
            held,
            // What is harder than usual is power or a brake all the same: else the tail of coasting would have it.
            even(config.power_from * most, effort.max(config.power_to * most)),
            even(effort.min(config.brake_from_n_per_kg), config.brake_to_n_per_kg),
            // Changing: anywhere between.
            even(config.change_from_n_per_kg, config.change_to * most) * config.change_weight,
        ];
        // What was found at this place must not make coasting of a speed that was held; where neither fits, both are as
        // far off as they are, with the same tails.
        let by_the_rest = student(effort - extra + beyond_places, sd) * sd;
        let moves = interval.speed_mps.iter().all(|speed| *speed >= config.slowest_mps);
        Self {
            effort_n_per_kg: effort,
            weights: if moves { weights } else { [1e-9, 1.0, 1.0, 1.0, 1.0] },
            over_held: (by_the_rest * hold(0.0) / held).ln(),
        }
    }
}

impl<'a> Driven<'a> {
    /// Each interval of a run.
    pub fn new(line: &Line<'_>, intervals: &[Interval], extra: &Extra, recognised: Recognised<'a>) -> Self {
        let extra = extra.all.iter().zip(&extra.beyond_places);
        let weighed = |(interval, (all, beyond)): (&Interval, (&f64, &f64))| {
            Weighed::new(line, interval, [*all, *beyond], &recognised)
        };
        Self {
            weighed: intervals.iter().zip(extra).map(weighed).collect(),
            noise_n_per_kg: recognised.noise_n_per_kg,
            config: recognised.config,
        }
    }

    /// Probabilities of the regimes at each interval from what was before, and the log-likelihood of the run.
    fn forward(&self, change: f64) -> (Vec<[f64; REGIMES]>, f64) {
        let mut now = [1.0 / REGIMES as f64; REGIMES];
        let mut likelihood = 0.0;
        let forward = self.weighed.iter().map(|weighed| {
            let foreseen = step(&now, change);
            let joint = core::array::from_fn(|i| foreseen[i] * weighed.weights[i]);
            likelihood += joint.iter().sum::<f64>().max(1e-300).ln();
            now = scaled(joint);
            now
        });
        (forward.collect(), likelihood)
    }

    /// Probabilities of the regimes at each interval from the whole run.
    fn regimes(&self, change: f64) -> Vec<[f64; REGIMES]> {
        let (mut regimes, _) = self.forward(change);
        let mut backward = [1.0; REGIMES];
        for (regimes, weighed) in regimes.iter_mut().zip(&self.weighed).rev() {
            *regimes = scaled(core::array::from_fn(|i| regimes[i] * backward[i]));
            let weighted = core::array::from_fn(|i| weighed.weights[i] * backward[i]);
            backward = scaled(step(&weighted, change));
        }
        regimes
    }

    /// Which intervals coasted.
    fn coasted(&self, change: f64) -> Vec<bool> {
        let regimes = self.regimes(change);
        let at = |i: isize| usize::try_from(i).ok().filter(|i| *i < regimes.len());
        // No part of the effort before or after lies in the interval: its neighbour coasted too, or the change lies
        // well within the neighbour.
        let pure = |i: isize, outward: isize| {
            let Some(beside) = at(i + outward) else {
                return true;
            };
            let changed = |beyond: usize| {
                let [part, all] = [beside, beyond].map(|i| self.weighed[i].effort_n_per_kg);
                all.abs() > self.config.clear * self.noise_n_per_kg
                    && (self.config.part_from..self.config.part_to).contains(&(part / all))
            };
            regimes[beside][COAST] > 0.5 || at(i + 2 * outward).is_some_and(changed)
        };
        let mut coasted: Vec<bool> = (0..regimes.len())
            .map(|i| regimes[i][COAST] > self.config.enough && pure(i as isize, -1) && pure(i as isize, 1))
            .collect();
        // Down a gradient that balances the resistance a held speed looks like coasting, interval by interval; and
        // power between two coasts must not hide in them.
        let mut at = 0;
        for stretch in coasted.chunk_by_mut(|a, b| a == b) {
            let weighed = &self.weighed[at..at + stretch.len()];
            at += stretch.len();
            let over_held = |weighed: &[Weighed]| weighed.iter().map(|weighed| weighed.over_held).sum::<f64>();
            let all = over_held(weighed);
            for (i, coasted) in stretch.iter_mut().enumerate() {
                let around = self.config.around;
                let around = &weighed[i.saturating_sub(around)..(i + around + 1).min(weighed.len())];
                *coasted &= all > self.config.over_held && over_held(around) > -self.config.held_around;
            }
        }
        coasted
    }
}

/// Which intervals of each run coasted.
pub fn coasted(runs: &[Driven<'_>]) -> Vec<Vec<bool>> {
    let Some(config) = runs.first().map(|run| run.config) else {
        return Vec::new();
    };
    let likelihood = |change: f64| runs.iter().map(|run| run.forward(change).1).sum::<f64>();
    let changes = config.changes.iter().copied();
    let change = changes.max_by(|a, b| likelihood(*a).total_cmp(&likelihood(*b))).unwrap_or(0.1);
    runs.iter().map(|run| run.coasted(change)).collect()
}

/// One interval on: a regime stays, or changes to any other.
fn step(from: &[f64; REGIMES], change: f64) -> [f64; REGIMES] {
    let other = change / (REGIMES as f64 - 1.0);
    let total: f64 = from.iter().sum();
    core::array::from_fn(|i| (1.0 - change) * from[i] + other * (total - from[i]))
}

fn scaled(mut p: [f64; REGIMES]) -> [f64; REGIMES] {
    let total: f64 = p.iter().sum();
    p.iter_mut().for_each(|v| *v /= total.max(1e-300));
    p
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{believed::Believed, rows::Row};
    use rundown::model::direction::Direction;
    use rundown::model::track::{Gradient, Track};
    use rundown::model::train::{Train, TrainDescription};

    const POWER: f64 = 0.2;

    fn level() -> Track {
        let gradient = Gradient { from_m: 0.0, permille: 0.0 };
        Track::try_new(9_000.0, [gradient]).unwrap()
    }

    /// Which intervals of a run on the level with these efforts, in N/kg, count as coasted. The speed stays about 25
    /// m/s: what is given is taken off between.
    fn coasted_of(efforts: &[f64]) -> Vec<bool> {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let track = level();
        let believed = Believed::new(&train, &track);
        let line = believed.line(Direction::Up);
        let interval = |effort: &f64| {
            let mut interval = Row::coasting(Direction::Up, 1000.0, 25.0).interval;
            let half = 5.0 * (effort - train.davis().resistance_n_per_kg(25.0));
            interval.speed_mps = [25.0 - half, 25.0 + half];
            interval
        };
        let intervals: Vec<Interval> = efforts.iter().map(interval).collect();
        let extra = Extra { all: vec![0.0; intervals.len()], beyond_places: vec![0.0; intervals.len()] };
        let config = CoastingConfig::default();
        let recognised = Recognised { noise_n_per_kg: 0.006, uncertain: 0.1, own: Own::default(), config: &config };
        let run = Driven::new(line, &intervals, &extra, recognised);
        coasted(&[run]).swap_remove(0)
    }

    #[test]
    fn a_short_coast_between_phases_counts_where_the_changes_lie_beside_it() {
        let power = [POWER; 3];
        let run = [&power[..], &[0.08, 0.0, 0.0, 0.09], &power, &[0.1, 0.0, 0.0, 0.07], &power].concat();
        let expected: Vec<bool> = run.iter().map(|effort| *effort == 0.0).collect();
        assert_eq!(coasted_of(&run), expected);
    }

    #[test]
    fn an_interval_with_a_rest_of_the_power_does_not() {
        let power = [POWER; 3];
        let coast = [0.0; 4];
        // The power went off a fifth of a second after the interval began.
        let run = [&power[..], &[0.02 * POWER], &coast, &[0.1], &power].concat();
        let found = coasted_of(&run);
        assert!(!found[3]);
        assert!(found[4..8].iter().all(|coasted| *coasted));
    }

    #[test]
    fn a_brake_or_a_power_that_is_harder_than_any_is_no_coasting() {
        for hardest in [-0.7, -1.0, -3.0, 0.3, 0.6] {
            let run = [&[0.0; 5][..], &[hardest; 2], &[0.0; 5]].concat();
            let found = coasted_of(&run);
            assert!(!found[5] && !found[6] && found[1] && found[10], "{hardest}: {found:?}");
        }
    }

    #[test]
    fn neither_a_speed_that_is_held_nor_an_end_beside_it_counts() {
        let held = Train::try_new(TrainDescription::CASE_STUDY).unwrap().davis().resistance_n_per_kg(25.0);
        let run = [&[held; 6][..], &[0.0; 5], &[held; 6]].concat();
        let found = coasted_of(&run);
        let at: Vec<usize> = (0..run.len()).filter(|i| found[*i]).collect();
        assert_eq!(at, [7, 8, 9]);
    }

    #[test]
    fn what_was_found_at_a_place_makes_no_coasting_of_a_held_speed() {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let track = level();
        let believed = Believed::new(&train, &track);
        let held = Row::coasting(Direction::Up, 1000.0, 25.0).interval;
        // A gradient that would take up the whole resistance.
        let resistance = train.davis().resistance_n_per_kg(25.0);
        let config = CoastingConfig::default();
        let over_held = |beyond_places: f64| {
            let recognised = Recognised { noise_n_per_kg: 0.006, uncertain: 0.1, own: Own::default(), config: &config };
            let line = believed.line(Direction::Up);
            Weighed::new(line, &held, [-resistance, beyond_places], &recognised).over_held
        };
        assert!(over_held(-resistance) > -0.5);
        assert!(over_held(0.0) < -config.held_around);
    }

    #[test]
    fn a_coast_that_neither_fits_by_the_rest_nor_is_held_is_as_far_from_both_by_the_same_tails() {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let track = level();
        let believed = Believed::new(&train, &track);
        // 1.5 permille less, readings of every second.
        let (slope, config) = (-0.0147, CoastingConfig::default());
        let mut coast = Row::coasting(Direction::Up, 1000.0, 25.0).interval;
        let half = 5.0 * (slope + train.davis().resistance_n_per_kg(25.0));
        coast.speed_mps = [25.0 + half, 25.0 - half];
        let recognised = Recognised { noise_n_per_kg: 0.003, uncertain: 0.1, own: Own::default(), config: &config };
        let over_held = Weighed::new(believed.line(Direction::Up), &coast, [slope, 0.0], &recognised).over_held;
        assert!(over_held > -1.5, "{over_held}");
    }
}
