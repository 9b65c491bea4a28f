//! What the filter estimates: the state x = (s, v, r0, r1, r2), and its names.
//!
//! The first [`MOVING`] components move (location, speed); those behind are constants of the train which enter the motion linearly.
//! The `measured` mode appends one more constant, the gain of the measured effort.

use crate::Real;
use crate::resistance::Davis;
use nalgebra::{ArrayStorage, SMatrix, SVector};
use serde::{Deserialize, Serialize};

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

/// A normal distribution: what is believed of a state, or of the Davis coefficients alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gaussian<const N: usize> {
    /// Mean.
    pub mean: SVector<Real, N>,
    /// Covariance, symmetric to the last bit.
    pub covariance: SMatrix<Real, N, N>,
}

impl<const N: usize> Gaussian<N> {
    /// Zeros.
    pub const ZEROED: Self = Self {
        mean: SVector::from_array_storage(ArrayStorage([[0.0; N]])),
        covariance: SMatrix::from_array_storage(ArrayStorage([[0.0; N]; N])),
    };

    /// Independent components with these means and standard deviations.
    ///
    /// ```
    /// use rundown::state::Gaussian;
    ///
    /// let belief = Gaussian::independent([10.0, 5.0], [2.0, 0.5]);
    /// assert_eq!(belief.covariance[(0, 0)], 4.0);
    /// assert_eq!(belief.covariance[(0, 1)], 0.0);
    /// ```
    pub fn independent(mean: [Real; N], sd: [Real; N]) -> Self {
        let sd = SVector::from(sd);
        Self { mean: SVector::from(mean), covariance: SMatrix::from_diagonal(&sd.component_mul(&sd)) }
    }

    /// Standard deviation of one component; 0 where the variance is not above 0.
    pub fn sd(&self, component: usize) -> Real {
        let variance = self.covariance.get((component, component)).copied().unwrap_or(0.0);
        libm::sqrt(variance.max(0.0))
    }

    /// Every number is finite.
    pub fn is_finite(&self) -> bool {
        self.mean.iter().chain(self.covariance.iter()).all(|value| value.is_finite())
    }
}

/// The Davis coefficients in a state of the filter.
pub fn davis<const N: usize>(state: &SVector<Real, N>) -> Davis {
    Davis { r0: state[R0], r1: state[R1], r2: state[R2] }
}
