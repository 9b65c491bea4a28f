//! Speed scale: worn wheels or a wrong diameter; the odometer's speed is off by a factor.
//!
//! ```text
//! true speed = measured / measured_over_true
//! ```
//!
//! Locations are taken to come from elsewhere (balises, satellites): only so does it show.

use super::{Law, SpeedScale};
use crate::Real;

impl SpeedScale {
    /// The speed as it is, m/s.
    ///
    /// ```
    /// use rundown::model::effects::SpeedScale;
    ///
    /// assert_eq!(SpeedScale { measured_over_true: 1.25 }.true_speed_mps(25.0), 20.0);
    /// ```
    pub fn true_speed_mps(&self, measured_mps: Real) -> Real {
        measured_mps / self.measured_over_true
    }
}

impl Law for SpeedScale {
    fn corrected(&self, _direction_sign: Real, location_m: Real, speed_mps: Real) -> (Real, Real) {
        (location_m, self.true_speed_mps(speed_mps))
    }
}
