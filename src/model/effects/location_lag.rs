//! Location lag: the location reading is older than the speed beside it.
//!
//! ```text
//! true location = reading + σ v lag                      σ = +1 up, -1 down
//! ```
//!
//! The speed is taken to have been the same meanwhile: with 0.5 m/s² and 2 s that is wrong by 1 m.

use super::{Law, LocationLag};
use crate::Real;

impl LocationLag {
    /// The location as it is, m; `direction_sign` is +1 for up.
    ///
    /// ```
    /// use rundown::model::effects::LocationLag;
    ///
    /// let late = LocationLag { lag_s: 2.0 };
    /// assert_eq!(late.true_location_m(1.0, 1000.0, 30.0), 1060.0);
    /// assert_eq!(late.true_location_m(-1.0, 1000.0, 30.0), 940.0);
    /// ```
    pub fn true_location_m(&self, direction_sign: Real, reading_m: Real, speed_mps: Real) -> Real {
        reading_m + direction_sign * speed_mps * self.lag_s
    }
}

impl Law for LocationLag {
    fn corrected(&self, direction_sign: Real, location_m: Real, speed_mps: Real) -> (Real, Real) {
        (self.true_location_m(direction_sign, location_m, speed_mps), speed_mps)
    }
}
