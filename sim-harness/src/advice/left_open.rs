//! What the diagnosis of logs has found and left as it is: the interval of what is published holds both.
//!
//! - A zero of the efforts that may be one that acts. Where only trains that coast show that the zero is off, motors
//!   that drag or feed the auxiliaries while they coast look the same, and where only trains that stand do, a light
//!   brake; then the efforts are as recorded, and r differs by all of the constant.
//! - Speeds with an offset beside a scale: what was learned is r of other speeds.
//! - A resistance at places, as of curves and tunnels: r of the line has its mean in it.
//!
//! ```text
//! v = v_read + Δ, Δ = o + κ v        r(v) - r(v_read) = r' Δ = r1 o + (r1 κ + 2 r2 o) v + 2 r2 κ v²
//! a_read = a/(1 + κ)                 of coasts r is off by κ r besides
//! ```

use super::before_brakes::withhold_if_unknown;
use nalgebra::Vector3;
use rundown::estimator::Estimator;
use rundown::estimator::config::Mode;
use rundown::filter::gaussian::Gaussian;
use rundown_check::figure::HALF_95;
use rundown_check::{Correction, RecorderCheck};
use rundown_files::replay::ReplayedRun;
use std::collections::BTreeMap;

/// What is open of a recorder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct OfRecorder {
    /// By how much the zero of its efforts may be wrong, N/kg.
    zero_n_per_kg: f64,
    speeds: Correction,
}

/// What is open of the recorders, by unit, and of the line.
#[derive(Clone, Debug, Default)]
pub struct LeftOpen {
    recorders: BTreeMap<String, OfRecorder>,
    /// What acts at places in both directions, standard deviation over the line, N/kg.
    pub at_places_n_per_kg: f64,
}

impl LeftOpen {
    /// Adds what is open of a recorder; of its efforts where the mode learns from them.
    pub fn add(&mut self, recorder: &RecorderCheck, mode: Mode) {
        let (zero_n_per_kg, speeds) = (recorder.effort_doubt_n_per_kg, recorder.left_open);
        // What runs read before have left open stays.
        let open = self.recorders.entry(recorder.unit.clone()).or_default();
        if mode == Mode::Measured && zero_n_per_kg > 0.0 {
            open.zero_n_per_kg = zero_n_per_kg;
        }
        if speeds != Correction::NONE {
            open.speeds = speeds;
        }
    }

    /// Widens what runs taught by it.
    pub fn doubt(&self, estimator: &Estimator, runs: &mut [ReplayedRun]) {
        if estimator.config().mode == Mode::Paper {
            return;
        }
        for run in runs {
            let open = self.recorders.get(&run.unit).copied().unwrap_or_default();
            // Where a share f of the line has all of it, its mean is √(f/(1 - f)) standard deviations: one of half.
            let zero_n_per_kg = (open.zero_n_per_kg / HALF_95).hypot(self.at_places_n_per_kg / HALF_95);
            if zero_n_per_kg == 0.0 && open.speeds == Correction::NONE {
                continue;
            }
            for davis in [&mut run.vehicle_before, &mut run.vehicle_after, &mut run.summary.run_davis] {
                davis.covariance[(0, 0)] += zero_n_per_kg.powi(2);
                let scaled = davis.mean * (1.0 / open.speeds.scale - 1.0);
                for off in [of_other_speeds(davis, &open.speeds), scaled] {
                    davis.covariance += off * off.transpose();
                }
            }
            withhold_if_unknown(estimator, run);
        }
    }
}

/// What coefficients are off by that were learned at speeds that are off.
fn of_other_speeds(davis: &Gaussian<3>, speeds: &Correction) -> Vector3<f64> {
    let ([_, r1, r2], o, k) = (<[f64; 3]>::from(davis.mean), speeds.offset_mps, 1.0 / speeds.scale - 1.0);
    Vector3::new(r1 * o, r1 * k + 2.0 * r2 * o, 2.0 * r2 * k)
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
        let doubted = |effort_doubt_n_per_kg: f64, at_places_n_per_kg: f64| {
            let mut runs = runs.clone();
            runs[0].learned = Learned::Learned;
            let mut recorder = RecorderCheck::default();
            (recorder.unit, recorder.effort_doubt_n_per_kg) = (runs[0].unit.clone(), effort_doubt_n_per_kg);
            let mut open = LeftOpen { at_places_n_per_kg, ..LeftOpen::default() };
            open.add(&recorder, Mode::Measured);
            // Further runs that leave nothing open.
            recorder.effort_doubt_n_per_kg = 0.0;
            open.add(&recorder, Mode::Measured);
            open.doubt(&estimator, &mut runs);
            (runs[0].vehicle_after.covariance[(0, 0)], runs[0].learned)
        };
        let (known, small, large) = (doubted(0.0, 0.0), doubted(1e-4, 0.0), doubted(0.1, 0.0));
        assert!((small.0 - known.0 - (1e-4 / HALF_95).powi(2)).abs() < 1e-15);
        assert!((doubted(0.0, 1e-4).0 - small.0).abs() < 1e-15);
        assert_eq!((known.1, large.1), (Learned::Learned, Learned::NotYet));
    }

    #[test]
    fn a_resistance_that_was_learned_at_speeds_that_are_off_is_doubted_by_what_that_makes() {
        let (estimator, runs) = (estimator(Config::default()), replayed().runs);
        let speeds = Correction { offset_mps: -1.0 / 3.6, scale: 1.012 };
        let mut doubted = runs.clone();
        let mut open = LeftOpen::default();
        let mut recorder = RecorderCheck::default();
        (recorder.unit, recorder.left_open) = (runs[0].unit.clone(), speeds);
        open.add(&recorder, Mode::Gated);
        open.doubt(&estimator, &mut doubted);
        let read_mps = 40.0;
        let at = |v: f64| Vector3::new(1.0, v, v * v);
        let r = |v: f64| at(v).dot(&runs[0].vehicle_after.mean);
        let variance = |run: &ReplayedRun| at(read_mps).dot(&(run.vehicle_after.covariance * at(read_mps)));
        let added = (variance(&doubted[0]) - variance(&runs[0])).sqrt();
        let off = (r(read_mps) - r(read_mps / 1.012 - 1.0 / 3.6)).hypot(0.012 * r(read_mps));
        assert!((added / off - 1.0).abs() < 0.02, "{added} {off}");
    }
}
