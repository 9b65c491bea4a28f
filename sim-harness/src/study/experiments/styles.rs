//! Section 5: "individual driving styles statistics could be computed and the differences between them could be
//! studied".
//!
//! Runs with a column `driver`: of five drivers who take turns, each with a style of its own, and of as many labels
//! that say nothing. Each feature is tested between the drivers, as it was found and as it was.

use super::answer::{Answer, Arm, VariantAxis};
use super::groups::p_value;
use super::plan::Plan;
use super::sweep::{Estimated, over_sets};
use super::variant::Variant;
use crate::study::Refused;
use crate::study::view::{Seen, ViewOutcome};
use rundown_files::recording::Recording;

const DRIVERS: usize = 5;

type Feature = fn(&ViewOutcome) -> Option<f64>;

/// Columns with what is tested.
const FEATURES: [(&str, &str, Feature); 4] = [
    ("cruise_speed_p", "p-value of the cruise speed", |outcome| outcome.cruise_kmh),
    ("final_coast_p", "p-value of the final coast", |outcome| outcome.coast_s),
    ("final_brake_p", "p-value of the final brake", |outcome| outcome.brake_s),
    ("power_p", "p-value of the mean power", |outcome| outcome.power_kw),
];

pub fn answer(plan: &Plan<'_>) -> Result<Answer, Refused> {
    let variants = [
        Variant::parse("labels that say nothing", 0.0, "")?,
        Variant::parse("drivers with a style", 1.0, &format!("[driver]\ndrivers = {DRIVERS}"))?,
    ];
    let rows = over_sets(plan, &variants, |variant, driven| {
        let labels: Vec<usize> = (0..driven.cases.len()).map(|run| label(&driven.cases[run].recording, run)).collect();
        let tested = |seen: &[Seen]| FEATURES.map(|(.., of)| test(seen, of, &labels, plan.seed)).to_vec();
        let mut rows = Vec::new();
        for Estimated { arm, config } in [Estimated::PAPER, Estimated::GATED] {
            rows.push((arm, tested(&driven.look(variant, config(variant.config))?.seen)));
        }
        rows.push((Arm::TRUTH, tested(&driven.truth)));
        Ok(rows)
    })?;
    Ok(Answer::new(plan, VariantAxis::Kinds("what a driver's label says"), measured().to_vec(), rows))
}

/// What is measured: name, and label.
pub fn measured() -> [(&'static str, &'static str); 4] {
    FEATURES.map(|(name, label, _)| (name, label))
}

/// The driver of a run; without one a label in turns.
fn label(recording: &Recording, run: usize) -> usize {
    let number = recording.driver.trim_start_matches("driver").parse::<usize>();
    number.map_or(run % DRIVERS, |number| number - 1)
}

/// Of the runs that have the feature.
fn test(seen: &[Seen], of: Feature, labels: &[usize], seed: u64) -> Option<f64> {
    let known = seen.iter().zip(labels).filter_map(|(seen, label)| Some((of(&seen.outcome)?, *label)));
    let (values, labels): (Vec<f64>, Vec<usize>) = known.unzip();
    p_value(&values, &labels, seed)
}

#[cfg(test)]
mod tests {
    use super::super::look::Driven;
    use super::*;

    #[test]
    fn runs_have_the_driver_of_their_plan() {
        let variant = Variant::parse("a", 0.0, "[driver]\ndrivers = 5").unwrap();
        let driven = Driven::new(&variant, 6, 3, 0).unwrap();
        let labels: Vec<usize> = driven.cases.iter().enumerate().map(|(i, c)| label(&c.recording, i)).collect();
        assert!(driven.cases.iter().all(|case| case.recording.driver.starts_with("driver0")));
        assert!(labels.iter().all(|label| *label < DRIVERS));
        assert!(labels.windows(2).any(|pair| pair[0] != pair[1]));
    }
}
