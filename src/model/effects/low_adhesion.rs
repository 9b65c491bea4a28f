//! Low adhesion: leaves or rain; wheels slip at low speed, where the effort is largest.
//!
//! ```text
//! maximum effort = factor x maximum effort at standstill         below below_kmh
//! ```
//!
//! On which days is the analyst's knowledge (`runs`); on board it is in force until it is taken out. Braking with
//! slipping wheels is left out.

use super::{Law, Limits, LowAdhesion};
use crate::Real;
use crate::model::units::KmPerHour;

impl LowAdhesion {
    /// The limits at a speed.
    ///
    /// ```
    /// use rundown::model::effects::{Limits, LowAdhesion};
    ///
    /// let described = Limits { effort_n_per_kg: 0.5, power_w_per_kg: 5.0, brake_n_per_kg: 0.66 };
    /// let leaves = LowAdhesion { factor: 0.5, below_kmh: 54.0 };
    /// assert_eq!(leaves.limit(&described, 14.9).traction_n_per_kg(14.9), 0.25);
    /// assert_eq!(leaves.limit(&described, 15.1), described);
    /// ```
    pub fn limit(&self, limits: &Limits, speed_mps: Real) -> Limits {
        let slow = speed_mps < KmPerHour(self.below_kmh).to_mps();
        Limits { effort_n_per_kg: limits.effort_n_per_kg * if slow { self.factor } else { 1.0 }, ..*limits }
    }
}

impl Law for LowAdhesion {
    fn limits_left(&self, limits: &Limits, _location_m: Real, speed_mps: Real) -> Limits {
        self.limit(limits, speed_mps)
    }
}
