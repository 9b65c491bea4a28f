//! What the filter estimates: the state x = (s, v, r0, r1, r2), and its names.
//!
//! The first [`MOVING`] components move (location, speed); those behind are constants of the train which enter the
//! motion linearly. The `measured` mode appends one more constant, the gain of the measured effort.

use crate::Real;
use crate::extremes::Extremes;
use crate::filter::gaussian::Gaussian;
use crate::model::resistance::Davis;
use nalgebra::{SVector, Vector3};

/// Location of the train's front along the track, m.
pub const LOCATION: usize = 0;
/// Speed in m/s, not negative.
pub const SPEED: usize = 1;
/// Constant Davis term, N/kg.
pub const R0: usize = 2;
/// Linear Davis term, N/(kg m/s).
pub const R1: usize = 3;
/// Quadratic Davis term, N/(kg (m/s)²).
pub const R2: usize = 4;
/// Gain of the measured effort, true over measured; only in the `measured` mode.
pub const GAIN: usize = 5;

/// Number of components of the paper's state.
pub const SIZE: usize = 5;
/// Number of components with the gain of the measured effort.
pub const SIZE_WITH_GAIN: usize = 6;
/// Number of leading components that move.
pub const MOVING: usize = 2;

/// The Davis coefficients in a state of the filter.
pub fn davis<const N: usize>(state: &SVector<Real, N>) -> Davis {
    Davis { r0: state[R0], r1: state[R1], r2: state[R2] }
}

/// Variance of r(v) by a belief of r0, r1, r2, (N/kg)².
// Once in the image.
#[inline(never)]
pub fn resistance_variance(belief: &Gaussian<3>, speed_mps: Real) -> Real {
    let at = Vector3::new(1.0, speed_mps, speed_mps * speed_mps);
    at.dot(&(belief.covariance * at)).at_least(0.0)
}

/// Standard deviation of r(v) by a belief of r0, r1, r2, N/kg.
pub fn resistance_sd(belief: &Gaussian<3>, speed_mps: Real) -> Real {
    crate::roots::square_root(resistance_variance(belief, speed_mps))
}
