//! Low adhesion: leaves or rain; wheels slip at low speed, where the effort is largest.
//!
//! ```text
//! maximum effort = factor x maximum effort at standstill         below below_kmh
//! ```
//!
//! On which days is the analyst's knowledge (`runs`); on board it is in force until it is taken out. Braking with slipping wheels is left out.

use super::EffectError;
use super::Limits;
use super::error::within;
use crate::Real;
use crate::model::units::KmPerHour;
use serde::{Deserialize, Serialize};

/// Wheels slip at low speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LowAdhesion {
    /// Largest effort over described effort.
    pub factor: Real,
    /// Speed below which it holds, km/h.
    pub below_kmh: Real,
}

impl LowAdhesion {
    /// Its name.
    pub const NAME: &'static str = "low_adhesion";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        within(Self::NAME, "factor", self.factor, 0.01, 1.0)?;
        within(Self::NAME, "below_kmh", self.below_kmh, 1.0, 400.0)
    }

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
