//! What section 4 claims in numbers, and whether these runs say the same.
//!
//! Each claim has the criterion by which it counts as reproduced, set before looking: a shape where the paper describes one, else a margin about
//! the paper's number that 67 runs justify. The verdict is that on the paper's mode; the gated mode and the truth stand beside it.

mod driving;
mod resistance;
mod trials;

use super::{gather::Gathered, moments::Moments, tallies::Tallies, trials::Trials};
use rundown::model::train::Train;
use rundown_files::table::{Cell, Record};
use rundown_pages::numbers::{NOTHING, number};

#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Figure or section of the paper: `2` to `9`, or `3.2`, `4.1`, `4.2`.
    pub place: &'static str,
    pub statement: &'static str,
    pub paper: String,
    pub gated: String,
    pub truth: String,
    pub verdict: Verdict,
    pub why: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Reproduced,
    Not,
    /// These runs have no data on it.
    NoData,
}

impl Verdict {
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::Not => "not reproduced",
            Self::NoData => "no data",
        }
    }
}

pub fn claims(gathered: &Gathered, train: &Train, trials: &Trials) -> Vec<Claim> {
    let mut claims = Vec::from(driving::setting(train));
    claims.push(driving::runs(gathered));
    claims.extend(driving::profiles(gathered));
    claims.extend(resistance::one_run(gathered, train));
    claims.extend(resistance::all_runs(gathered, train));
    claims.extend(resistance::terms(gathered, train));
    claims.push(resistance::initial(&trials.sensitivity));
    claims.extend(trials::trials(trials));
    claims.extend(driving::regimes(gathered));
    claims.extend(driving::style(gathered));
    claims.extend(driving::brake(gathered));
    claims.extend(driving::power(gathered, train));
    claims
}

pub fn records(claims: &[Claim]) -> Vec<Record> {
    let row = |claim: &Claim| {
        [
            ("place", claim.place),
            ("statement", claim.statement),
            ("paper_mode", &claim.paper),
            ("gated_mode", &claim.gated),
            ("truth", &claim.truth),
            ("verdict", claim.verdict.as_str()),
            ("why", &claim.why),
        ]
        .map(|(name, text)| (name.to_owned(), Cell::from(text)))
        .to_vec()
    };
    claims.iter().map(row).collect()
}

/// What the paper's mode says of a claim, the gated mode, and the truth; a dash where there is nothing.
type Columns = [Option<String>; 3];

/// A claim of which nothing is known yet.
fn claim(place: &'static str, statement: &'static str) -> Claim {
    let nothing = || NOTHING.to_owned();
    let [paper, gated, truth] = [nothing(), nothing(), nothing()];
    Claim { place, statement, paper, gated, truth, verdict: Verdict::NoData, why: String::new() }
}

impl Claim {
    fn columns(self, columns: Columns) -> Self {
        let [paper, gated, truth] = columns.map(|text| text.unwrap_or_else(|| NOTHING.to_owned()));
        Self { paper, gated, truth, ..self }
    }

    /// Whether the criterion is met; none where there are no data.
    fn holds(self, holds: Option<bool>) -> Self {
        let verdict = match holds {
            Some(true) => Verdict::Reproduced,
            Some(false) => Verdict::Not,
            None => Verdict::NoData,
        };
        Self { verdict, ..self }
    }

    /// By which criterion.
    fn by(self, why: impl Into<String>) -> Self {
        Self { why: why.into(), ..self }
    }
}

/// The columns of a claim on the description, or on the paper's mode alone.
fn alone(text: Option<String>) -> Columns {
    [text, None, None]
}

/// The columns of one quantity.
fn three(gathered: &Gathered, of: impl Fn(&Tallies) -> Option<String>) -> Columns {
    let truth = (gathered.truth.runs > 0).then(|| of(&gathered.truth));
    [of(&gathered.paper), of(&gathered.gated), truth.flatten()]
}

fn near(found: Option<f64>, wanted: f64, margin: f64) -> Option<bool> {
    found.map(|found| (found - wanted).abs() <= margin)
}

fn percent(share: Option<f64>) -> Option<String> {
    share.map(|share| format!("{}\u{a0}%", number(100.0 * share, 1)))
}

fn mean(moments: &Moments, decimals: usize) -> Option<String> {
    moments.mean().map(|mean| number(mean, decimals))
}

fn from_to(moments: &Moments, per_unit: f64, decimals: usize) -> Option<String> {
    (moments.count > 0).then(|| {
        let end = |value: f64| number(value / per_unit, decimals);
        format!("{} to {}", end(moments.least), end(moments.largest))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::trials::{Misses, Pace, Sensitivity};
    use crate::{study::case::case_study, study::description};

    fn train() -> Train {
        description::of(&case_study().unwrap()).unwrap().train
    }

    fn verdict(claims: &[Claim], needle: &str) -> Verdict {
        let claim = claims.iter().find(|c| c.statement.contains(needle));
        claim.unwrap_or_else(|| panic!("no claim on {needle}")).verdict
    }

    #[test]
    fn without_runs_nothing_is_reproduced_but_what_the_description_says() {
        let claims = claims(&Gathered::default(), &train(), &Trials::default());
        assert!(claims.len() > 20, "{}", claims.len());
        let of_description = ["38 km/h", "0.025 N/kg", "0.06 m/s"];
        for claim in &claims {
            let is_one = of_description.iter().any(|n| claim.statement.contains(n));
            let is_reproduced = claim.verdict == Verdict::Reproduced;
            assert_eq!(is_reproduced, is_one, "{}", claim.statement);
        }
        assert_eq!(verdict(&claims, "38 km/h"), Verdict::Reproduced);
    }

    #[test]
    fn a_coefficient_of_variation_is_judged_by_its_margin() {
        let of = |coasts_s: [f64; 3]| {
            let mut gathered = Gathered::default();
            gathered.paper.runs = 3;
            for coast_s in coasts_s {
                gathered.paper.coast_s.add(coast_s);
            }
            verdict(&claims(&gathered, &train(), &Trials::default()), "lengths of the final coast vary by 30")
        };
        assert_eq!(of([210.0, 300.0, 390.0]), Verdict::Reproduced);
        assert_eq!(of([290.0, 300.0, 310.0]), Verdict::Not);
    }

    #[test]
    fn brake_rates_must_rise_towards_low_speeds() {
        let of = |rates: [f64; 5]| {
            let mut gathered = Gathered::default();
            for (moments, rate) in gathered.paper.brake_steps.iter_mut().zip(rates) {
                for _ in 0..10 {
                    moments.add(rate);
                }
            }
            verdict(&claims(&gathered, &train(), &Trials::default()), "lower the speed")
        };
        assert_eq!(of([0.20, 0.25, 0.30, 0.32, 0.36]), Verdict::Reproduced);
        assert_eq!(of([0.36, 0.32, 0.30, 0.25, 0.20]), Verdict::Not);
    }

    #[test]
    fn negative_coefficients_are_those_of_the_changed_filter() {
        let of = |negative_runs| {
            let found = |factor| Sensitivity {
                which: "r0",
                factor,
                negative_runs: if factor > 1.0 { negative_runs } else { 0 },
                runs: 5,
                least_share: [0.5; 3],
            };
            let trials = Trials { sensitivity: vec![found(1.0), found(10.0), found(100.0)], ..Trials::default() };
            verdict(&claims(&Gathered::default(), &train(), &trials), "give negative coefficients")
        };
        assert_eq!(of(3), Verdict::Reproduced);
        assert_eq!(of(0), Verdict::Not);
    }

    #[test]
    fn a_slow_filter_and_samples_that_do_no_harm_are_no_reproduction() {
        let of = |step_ms, thinned_s| {
            let misses = |s: f64| {
                let mut moments = Moments::default();
                moments.add(s);
                Misses { paper: [moments; 2], gated: [moments; 2] }
            };
            let pace = Pace { step_ms, run_s: 1 };
            let trials =
                Trials { pace: Some([pace; 2]), thinned: Some([misses(5.0), misses(thinned_s)]), ..Trials::default() };
            let claims = claims(&Gathered::default(), &train(), &trials);
            ["computation time", "every second sample"].map(|n| verdict(&claims, n))
        };
        assert_eq!(of(1, 8.0), [Verdict::Reproduced; 2]);
        assert_eq!(of(2_000, 4.0), [Verdict::Not; 2]);
    }

    #[test]
    fn two_clouds_are_counted_by_run() {
        let of = |inside| {
            let mut gathered = Gathered::default();
            gathered.paper.in_both_clouds = [inside, 67];
            verdict(&claims(&gathered, &train(), &Trials::default()), "all trajectories")
        };
        assert_eq!(of(66), Verdict::Reproduced);
        assert_eq!(of(40), Verdict::Not);
    }
}
