//! Mass error: the train is heavier or lighter than described (load, water, ballast, a wrong data sheet).
//!
//! ```text
//! a = (u - r2 v²) / (1 + e) - r0 - r1 v - g          e = true mass / believed - 1
//! extra = (u - r2 v²) e / (1 + e)
//! ```
//!
//! u and r2 v² are forces over the believed γ m: the same forces move another mass. r0, r1 v and gravity grow with the
//! mass and keep their value per kg. γ is taken to stay the same. Without a known effort only the air drag shows it,
//! which is confounded with r2.

use super::{Law, MassError, Situation};
use crate::Real;

impl MassError {
    /// Extra resistance in N/kg (of the believed model's accounts) with the train's `r2`, at a speed and an effort per
    /// believed γ m.
    ///
    /// ```
    /// use rundown::model::effects::MassError;
    ///
    /// let heavy = MassError { relative: 0.25 };
    /// // At 0.3 N/kg and without air drag a fifth of the effort is lost on the mass that was not known.
    /// assert!((heavy.resistance_n_per_kg(0.0, 10.0, 0.3) - 0.06).abs() < 1e-15);
    /// ```
    pub fn resistance_n_per_kg(&self, r2: Real, speed_mps: Real, effort_n_per_kg: Real) -> Real {
        (effort_n_per_kg - r2 * speed_mps * speed_mps) * self.effort_share()
    }

    /// e / (1 + e).
    pub fn effort_share(&self) -> Real {
        self.relative / (1.0 + self.relative)
    }
}

impl Law for MassError {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.davis.r2, at.moment.speed_mps, at.moment.effort_n_per_kg)
    }

    fn slope_over_effort(&self) -> Real {
        self.effort_share()
    }
}
