//! Davis error: the described coefficients are simply wrong, everywhere and in every run.
//!
//! ```text
//! extra = dr0 + dr1 v + dr2 v²
//! ```

use super::EffectError;
use super::error::within;
use crate::Real;
use serde::{Deserialize, Serialize};

/// The described Davis coefficients are wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DavisError {
    /// True minus described r0, N/kg.
    pub dr0: Real,
    /// True minus described r1, N/(kg m/s).
    pub dr1: Real,
    /// True minus described r2, N/(kg (m/s)²).
    pub dr2: Real,
}

impl DavisError {
    /// Its name.
    pub const NAME: &'static str = "davis_error";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        within(Self::NAME, "dr0", self.dr0, -0.1, 0.1)?;
        within(Self::NAME, "dr1", self.dr1, -0.01, 0.01)?;
        within(Self::NAME, "dr2", self.dr2, -1e-3, 1e-3)
    }

    /// Extra resistance in N/kg at a speed.
    ///
    /// ```
    /// use rundown::model::effects::DavisError;
    ///
    /// let wrong = DavisError { dr0: 1e-3, dr1: 1e-5, dr2: 1e-6 };
    /// assert!((wrong.resistance_n_per_kg(20.0) - 1.6e-3).abs() < 1e-15);
    /// ```
    pub fn resistance_n_per_kg(&self, speed_mps: Real) -> Real {
        self.dr0 + speed_mps * (self.dr1 + speed_mps * self.dr2)
    }
}
