//! Running resistance of the train per mass, Davis equation.
//!
//! In: speed. Out: resistance in N/kg (per rotating mass, γ m), positive against the direction of travel.
//!
//! ```text
//! r(v) = r0 + r1 v + r2 v²                     Eq. (2)
//! ```

use crate::Real;
use crate::plain::plain;
use serde::{Deserialize, Serialize};

/// Coefficients of the Davis equation, per rotating mass γ m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Davis {
    /// Constant term in N/kg.
    pub r0: Real,
    /// Linear term in N/(kg m/s).
    pub r1: Real,
    /// Quadratic (aerodynamic) term in N/(kg (m/s)²).
    pub r2: Real,
}

plain! {
    struct Davis { r0, r1, r2 }
}

impl Davis {
    /// Running resistance per mass at a speed, Eq. (2).
    ///
    /// `speed_mps` in m/s, not negative. Result in N/kg, positive against the direction of travel.
    ///
    /// ```
    /// use rundown::model::resistance::Davis;
    ///
    /// let davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };
    /// let r = davis.resistance_n_per_kg(140.0 / 3.6);
    /// assert!((r - 0.0559).abs() < 1e-4);
    /// ```
    pub fn resistance_n_per_kg(&self, speed_mps: Real) -> Real {
        self.r0 + speed_mps * (self.r1 + speed_mps * self.r2)
    }

    /// The three terms r0, r1 v, r2 v² in N/kg; they add up to [`Davis::resistance_n_per_kg`].
    pub fn terms_n_per_kg(&self, speed_mps: Real) -> [Real; 3] {
        [self.r0, self.r1 * speed_mps, self.r2 * speed_mps * speed_mps]
    }
}
