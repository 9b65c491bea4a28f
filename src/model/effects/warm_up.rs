//! Warm-up: bearings and gears run stiff after standing, and loosen in the first minutes.
//!
//! ```text
//! extra = amplitude exp(-t / tau)                  t since the departure of the run
//! ```

use super::EffectError;
use super::error::within;
use crate::Real;
use serde::{Deserialize, Serialize};

/// r0 is larger in the first minutes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmUp {
    /// Extra resistance at the departure, N/kg.
    pub amplitude: Real,
    /// Time after which 37 % of it is left, s.
    pub tau_s: Real,
}

impl WarmUp {
    /// Its name.
    pub const NAME: &'static str = "warm_up";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        within(Self::NAME, "amplitude", self.amplitude, -0.5, 0.5)?;
        within(Self::NAME, "tau_s", self.tau_s, 1.0, 36000.0)
    }

    /// Extra resistance in N/kg at a time after the departure.
    ///
    /// ```
    /// use rundown::model::effects::WarmUp;
    ///
    /// let cold = WarmUp { amplitude: 4e-3, tau_s: 300.0 };
    /// assert!((cold.resistance_n_per_kg(300.0) - 1.4715e-3).abs() < 1e-7);
    /// ```
    pub fn resistance_n_per_kg(&self, since_departure_s: Real) -> Real {
        self.amplitude * libm::exp(-since_departure_s.max(0.0) / self.tau_s)
    }
}
