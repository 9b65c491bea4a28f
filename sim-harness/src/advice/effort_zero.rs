//! A zero of the efforts that may be one that acts.
//!
//! Where only trains that coast show that the zero is off, motors that drag or feed the auxiliaries while they coast
//! look the same, and where only trains that stand do, a light brake; then the efforts are as recorded, and r differs
//! by all of the constant. Both are inside the interval of what is published.

use super::before_brakes::withhold_if_unknown;
use rundown::estimator::Estimator;
use rundown::filter::gaussian::Gaussian;
use rundown_check::agreement::HALF_95;
use rundown_files::replay::ReplayedRun;
use std::collections::BTreeMap;

/// Widens what efforts taught by what their zero is doubted by. `doubts`: by unit, N/kg.
pub fn doubt(estimator: &Estimator, doubts: &BTreeMap<String, f64>, runs: &mut [ReplayedRun]) {
    for run in runs {
        let Some(doubt) = doubts.get(&run.unit) else { continue };
        let widen = |davis: &mut Gaussian<3>| davis.covariance[(0, 0)] += (doubt / HALF_95).powi(2);
        [&mut run.vehicle_before, &mut run.vehicle_after, &mut run.summary.run_davis].into_iter().for_each(widen);
        withhold_if_unknown(estimator, run);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::advice::tests::{estimator, replayed};
    use rundown::estimator::config::Config;
    use rundown_wire::Learned;

    #[test]
    fn the_interval_holds_both_and_what_is_hardly_known_is_not_published() {
        let (estimator, runs) = (estimator(Config::default()), replayed().runs);
        let doubted = |doubt_n_per_kg: f64| {
            let mut runs = runs.clone();
            runs[0].learned = Learned::Learned;
            doubt(&estimator, &BTreeMap::from([(runs[0].unit.clone(), doubt_n_per_kg)]), &mut runs);
            (runs[0].vehicle_after.covariance[(0, 0)], runs[0].learned)
        };
        let (known, small, large) = (doubted(0.0), doubted(1e-4), doubted(0.1));
        assert!((small.0 - known.0 - (1e-4 / HALF_95).powi(2)).abs() < 1e-15);
        assert_eq!((known.1, large.1), (Learned::Learned, Learned::NotYet));
    }
}
