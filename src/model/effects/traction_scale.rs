//! Traction scale: the train's maximum effort and power differ from the description everywhere (a motor cut out,
//! another software).
//!
//! ```text
//! maximum effort, maximum power = factor x described
//! ```

use super::{Law, Limits, TractionScale};
use crate::Real;

impl TractionScale {
    /// The limits.
    ///
    /// ```
    /// use rundown::model::effects::{Limits, TractionScale};
    ///
    /// let described = Limits { effort_n_per_kg: 0.5, power_w_per_kg: 5.0, brake_n_per_kg: 0.66 };
    /// let three_of_four = TractionScale { factor: 0.75 };
    /// assert_eq!(three_of_four.limit(&described).traction_n_per_kg(0.0), 0.375);
    /// ```
    pub fn limit(&self, limits: &Limits) -> Limits {
        Limits {
            effort_n_per_kg: self.factor * limits.effort_n_per_kg,
            power_w_per_kg: self.factor * limits.power_w_per_kg,
            ..*limits
        }
    }
}

impl Law for TractionScale {
    fn limits_left(&self, limits: &Limits, _location_m: Real, _speed_mps: Real) -> Limits {
        self.limit(limits)
    }
}
