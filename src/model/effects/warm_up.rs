//! Warm-up: bearings and gears run stiff after standing, and loosen in the first minutes.
//!
//! ```text
//! extra = amplitude exp(-t / tau)                  t since the departure of the run
//! ```

use super::{Law, Situation, WarmUp};
use crate::Real;
use crate::extremes::Extremes;

impl WarmUp {
    /// Extra resistance in N/kg at a time after the departure.
    ///
    /// ```
    /// use rundown::model::effects::WarmUp;
    ///
    /// let cold = WarmUp { amplitude: 4e-3, tau_s: 300.0 };
    /// assert!((cold.resistance_n_per_kg(300.0) - 1.4715e-3).abs() < 1e-7);
    /// ```
    pub fn resistance_n_per_kg(&self, since_departure_s: Real) -> Real {
        self.amplitude * libm::exp(-since_departure_s.at_least(0.0) / self.tau_s)
    }
}

impl Law for WarmUp {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.moment.since_departure_s)
    }
}
