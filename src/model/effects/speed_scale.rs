//! Speed scale: worn wheels or a wrong diameter; the odometer's speed is off by a factor.
//!
//! ```text
//! true speed = measured / measured_over_true
//! ```
//!
//! Locations are taken to come from elsewhere (balises, satellites): only so does it show.

use super::EffectError;
use super::error::within;
use crate::Real;
use serde::{Deserialize, Serialize};

/// The odometer reads too much or too little.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedScale {
    /// Measured over true speed; above 1 with worn wheels.
    pub measured_over_true: Real,
}

impl SpeedScale {
    /// Its name.
    pub const NAME: &'static str = "speed_scale";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        within(Self::NAME, "measured_over_true", self.measured_over_true, 0.8, 1.25)
    }

    /// The speed as it is, m/s.
    ///
    /// ```
    /// use rundown::model::effects::SpeedScale;
    ///
    /// assert_eq!(SpeedScale { measured_over_true: 1.25 }.true_speed_mps(25.0), 20.0);
    /// ```
    pub fn true_speed_mps(&self, measured_mps: Real) -> Real {
        measured_mps / self.measured_over_true
    }
}
