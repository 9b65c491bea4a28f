//! Power limit section: a weak feeding section; the train's control lowers the power with the line voltage.
//!
//! ```text
//! maximum power inside = factor x maximum power
//! ```
//!
//! The maximum effort stays, so it shows above the transition speed. The front of the train stands for its pantographs.

use super::{Law, Limits, PowerLimitSection};
use crate::Real;

impl PowerLimitSection {
    /// The limits with the front at a location.
    ///
    /// ```
    /// use rundown::model::effects::{Limits, PowerLimitSection};
    ///
    /// let described = Limits { effort_n_per_kg: 0.5, power_w_per_kg: 5.0, brake_n_per_kg: 0.66 };
    /// let weak = PowerLimitSection { from_m: 4e3, to_m: 9e3, factor: 0.6 };
    /// assert_eq!(weak.limit(&described, 4e3).power_w_per_kg, 3.0);
    /// assert_eq!(weak.limit(&described, 9e3), described);
    /// ```
    pub fn limit(&self, limits: &Limits, location_m: Real) -> Limits {
        let inside = (self.from_m..self.to_m).contains(&location_m);
        Limits { power_w_per_kg: limits.power_w_per_kg * if inside { self.factor } else { 1.0 }, ..*limits }
    }
}

impl Law for PowerLimitSection {
    fn limits_left(&self, limits: &Limits, location_m: Real, _speed_mps: Real) -> Limits {
        self.limit(limits, location_m)
    }
}
