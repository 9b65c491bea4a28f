//! Location lag: the location reading is older than the speed beside it.
//!
//! ```text
//! true location = reading + σ v lag                      σ = +1 up, -1 down
//! ```
//!
//! The speed is taken to have been the same meanwhile: with 0.5 m/s² and 2 s that is wrong by 1 m.

use super::EffectError;
use super::error::within;
use crate::Real;
use serde::{Deserialize, Serialize};

/// The location comes late.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LocationLag {
    /// Age of the location reading, s.
    pub lag_s: Real,
}

impl LocationLag {
    /// Its name.
    pub const NAME: &'static str = "location_lag";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        within(Self::NAME, "lag_s", self.lag_s, -60.0, 60.0)
    }

    /// The location as it is, m; `direction_sign` is +1 for up.
    ///
    /// ```
    /// use rundown::model::effects::LocationLag;
    ///
    /// let late = LocationLag { lag_s: 2.0 };
    /// assert_eq!(late.true_location_m(1.0, 1000.0, 30.0), 1060.0);
    /// assert_eq!(late.true_location_m(-1.0, 1000.0, 30.0), 940.0);
    /// ```
    pub fn true_location_m(&self, direction_sign: Real, reading_m: Real, speed_mps: Real) -> Real {
        reading_m + direction_sign * speed_mps * self.lag_s
    }
}
