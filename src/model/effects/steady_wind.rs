//! Steady wind: the mean wind of an open line, the same in every run.
//!
//! ```text
//! extra = r2 (w |w| - v²)          w = v + σ wind, speed relative to the air; σ = +1 up, -1 down
//! ```
//!
//! A wind that overtakes the train pushes it: hence w |w| and not w². Acts on the quadratic term alone; gusts and crosswind (yaw) are left out.
//! In one direction only it cannot be told from other Davis coefficients.

use super::EffectError;
use super::error::within;
use crate::Real;
use serde::{Deserialize, Serialize};

/// A wind that blows in every run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SteadyWind {
    /// Headwind in the `up` direction, m/s; it is a tailwind in the other.
    pub wind_mps: Real,
}

impl SteadyWind {
    /// Its name.
    pub const NAME: &'static str = "steady_wind";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        within(Self::NAME, "wind_mps", self.wind_mps, -40.0, 40.0)
    }

    /// Extra resistance in N/kg with the train's `r2` in N/(kg (m/s)²); `direction_sign` is +1 for up.
    ///
    /// ```
    /// use rundown::model::effects::SteadyWind;
    ///
    /// let wind = SteadyWind { wind_mps: 3.0 };
    /// assert!((wind.resistance_n_per_kg(2.8e-5, 30.0, 1.0) - 2.8e-5 * 189.0).abs() < 1e-15);
    /// assert!((wind.resistance_n_per_kg(2.8e-5, 30.0, -1.0) + 2.8e-5 * 171.0).abs() < 1e-15);
    /// // Slower than a wind from behind: it is pushed.
    /// assert!((wind.resistance_n_per_kg(2.8e-5, 1.0, -1.0) + 2.8e-5 * 5.0).abs() < 1e-15);
    /// ```
    pub fn resistance_n_per_kg(&self, r2: Real, speed_mps: Real, direction_sign: Real) -> Real {
        let relative_mps = speed_mps + direction_sign * self.wind_mps;
        r2 * (relative_mps * relative_mps.abs() - speed_mps * speed_mps)
    }
}
