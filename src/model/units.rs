//! Quantities of descriptions and settings in another unit than SI: each a newtype with one exit.

use crate::Real;

/// Standard gravity in m/s².
pub const GRAVITY_MPS2: Real = 9.80665;

/// Speed in km/h, the unit of recorders, limits and the paper's thresholds.
///
/// ```
/// use rundown::model::units::KmPerHour;
///
/// assert!((KmPerHour(36.0).to_mps() - 10.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct KmPerHour(pub Real);

impl KmPerHour {
    /// The same speed in m/s.
    pub const fn to_mps(self) -> Real {
        self.0 / 3.6
    }
}
