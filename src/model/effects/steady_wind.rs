//! Steady wind: the mean wind of an open line, the same in every run.
//!
//! ```text
//! extra = r2 (w |w| - v²)          w = v + σ wind, speed relative to the air; σ = +1 up, -1 down
//! ```
//!
//! A wind that overtakes the train pushes it: hence w |w| and not w². Acts on the quadratic term alone; gusts and
//! crosswind (yaw) are left out. In one direction only it is confounded with the Davis coefficients.

use super::{Law, Situation, SteadyWind};
use crate::Real;

impl SteadyWind {
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

impl Law for SteadyWind {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.davis.r2, at.moment.speed_mps, at.direction_sign())
    }
}
