//! Gradient error: the line has another gradient here than its description.
//!
//! ```text
//! extra = σ g / γ x delta / 1000 x share of the train inside          σ = +1 up, -1 down
//! ```
//!
//! `delta` is true minus described, uphill in the `up` direction positive: what it adds in one direction it takes away
//! in the other, which separates it from a resistance.

use super::{GradientError, Law, Situation};
use crate::Real;

impl GradientError {
    /// Extra resistance in N/kg. `gravity_n_per_kg` is g / γ, `direction_sign` +1 for up.
    ///
    /// ```
    /// use rundown::model::effects::GradientError;
    ///
    /// let dip = GradientError { from_m: 0.0, to_m: 500.0, delta_permille: -2.0 };
    /// assert!((dip.resistance_n_per_kg(9.25, 1.0, 1.0) + 0.0185).abs() < 1e-15);
    /// assert!((dip.resistance_n_per_kg(9.25, 1.0, -1.0) - 0.0185).abs() < 1e-15);
    /// ```
    pub fn resistance_n_per_kg(&self, gravity_n_per_kg: Real, share_inside: Real, direction_sign: Real) -> Real {
        direction_sign * gravity_n_per_kg * (self.delta_permille / 1000.0) * share_inside
    }
}

impl Law for GradientError {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        let share_inside = at.share_inside(self.from_m, self.to_m);
        self.resistance_n_per_kg(at.gravity_n_per_kg(), share_inside, at.direction_sign())
    }
}
