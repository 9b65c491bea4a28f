//! Davis error: the described coefficients are simply wrong, everywhere and in every run.
//!
//! ```text
//! extra = dr0 + dr1 v + dr2 v²
//! ```

use super::{DavisError, Law, Situation};
use crate::Real;

impl DavisError {
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

impl Law for DavisError {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.moment.speed_mps)
    }
}
