//! A normal distribution: what is believed of a state.

use crate::Real;
use crate::extremes::Extremes;
use crate::plain::{Bytes, Plain};
use nalgebra::{ArrayStorage, SMatrix, SVector};
use serde::{Deserialize, Serialize};

/// A normal distribution: what is believed of a state, or of the Davis coefficients alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gaussian<const N: usize> {
    /// Mean.
    pub mean: SVector<Real, N>,
    /// Covariance, symmetric to the last bit.
    pub covariance: SMatrix<Real, N, N>,
}

impl<const N: usize> Plain for Gaussian<N> {
    const START: Self = Self::ZEROED;

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        self.mean.pass(bytes);
        self.covariance.pass(bytes);
    }
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
    /// use rundown::filter::gaussian::Gaussian;
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
        crate::roots::square_root(variance.at_least(0.0))
    }

    /// Every number is finite.
    pub fn is_finite(&self) -> bool {
        self.mean.iter().chain(self.covariance.iter()).all(|value| value.is_finite())
    }
}
