//! Energy per rotating mass, by effect.
//!
//! In: two ticks in a row. Out: their part of [`Energy`].
//!
//! ```text
//! E = ∫ f ds = ∫ f v dt ≈ (f1 v1 + f2 v2) dt / 2        trapezoid, resistance terms and gradient
//! E = u (v1 + v2) dt / 2                                 effort, which is already a mean over the interval
//! ```
//!
//! The calculated effort is noise about 0 while the train coasts; there it is not counted.

use super::interval::Interval;
use super::{Energy, Observation};
use crate::tick::regime::Regime;

impl Energy {
    /// Adds one interval. The coefficients are those of the later tick at both ends.
    pub(super) fn add(&mut self, before: &Observation, after: &Observation, interval: &Interval) {
        let work = interval.work_j_per_kg;
        let under_effort = matches!(after.regime, Regime::Traction | Regime::Cruise | Regime::Brake);
        if work > 0.0 && under_effort {
            self.traction_j_per_kg += work;
        }
        // The tick at which the train stands ends an interval of braking.
        if work < 0.0 && (under_effort || after.regime == Regime::Standstill) {
            self.brake_j_per_kg -= work;
        }
        let [r0, r1, r2] = after.davis.terms_n_per_kg(before.speed_mps);
        let [s0, s1, s2] = after.davis.terms_n_per_kg(after.speed_mps);
        let half_dt_s = 0.5 * after.dt_s;
        let (before_m, after_m) = (half_dt_s * before.speed_mps, half_dt_s * after.speed_mps);
        self.r0_j_per_kg += r0 * before_m + s0 * after_m;
        self.r1_j_per_kg += r1 * before_m + s1 * after_m;
        self.r2_j_per_kg += r2 * before_m + s2 * after_m;
        self.gradient_j_per_kg += before.gradient_n_per_kg * before_m + after.gradient_n_per_kg * after_m;
    }
}
