//! Square-root-free Cholesky factor of a covariance, for its first columns: P = L D Lᵀ.
//!
//! In: a symmetric matrix. Out: the first K columns of L (unit diagonal) with their pivots D, and what is left of P when they are eliminated,
//! which is the covariance of the other components once the first K are known. With K = N it is the whole factor.
//! A pivot that is not above zero stops it with its row.

use crate::Real;
use core::fmt;
use nalgebra::{SMatrix, SVector};

/// A matrix is not positive definite: pivot `row` was `pivot`, not above zero (or not a number).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotPositiveDefinite {
    /// Row of the pivot, counted from 0.
    pub row: usize,
    /// Its value.
    pub pivot: Real,
}

impl fmt::Display for NotPositiveDefinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "covariance is not positive definite: pivot {} is {}",
            self.row, self.pivot
        )
    }
}

impl core::error::Error for NotPositiveDefinite {}

/// The first K columns of the factor and the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor<const N: usize, const K: usize> {
    /// Columns of L; 0 above the diagonal, 1 on it.
    pub columns: [SVector<Real, N>; K],
    /// Pivots D, all above zero.
    pub pivots: [Real; K],
    /// Rows and columns from K on: covariance of these components given the first K. Elsewhere without meaning.
    pub rest: SMatrix<Real, N, N>,
}

/// Eliminates the first K components of a covariance; only its lower triangle is read.
///
/// # Errors
/// [`NotPositiveDefinite`] with the row and value of the first pivot that is not above zero; the diagonal of the rest is checked too.
///
/// ```
/// use nalgebra::matrix;
/// use rundown::elimination::eliminate;
///
/// let factor = eliminate::<2, 1>(&matrix![4.0, 2.0; 2.0, 3.0]).unwrap();
/// assert_eq!(factor.pivots, [4.0]);
/// assert_eq!(factor.columns[0][1], 0.5);
/// assert_eq!(factor.rest[(1, 1)], 2.0);
/// ```
#[inline]
pub fn eliminate<const N: usize, const K: usize>(
    covariance: &SMatrix<Real, N, N>,
) -> Result<Factor<N, K>, NotPositiveDefinite> {
    let mut rest = *covariance;
    let mut columns = [SVector::zeros(); K];
    let mut pivots = [0.0; K];
    for j in 0..K {
        let pivot = above_zero(rest[(j, j)], j)?;
        pivots[j] = pivot;
        let inverse = 1.0 / pivot;
        columns[j][j] = 1.0;
        for i in j + 1..N {
            columns[j][i] = rest[(i, j)] * inverse;
        }
        for k in j + 1..N {
            for i in k..N {
                rest[(i, k)] -= columns[j][i] * rest[(k, j)];
            }
        }
    }
    for k in K..N {
        above_zero(rest[(k, k)], k)?;
        for i in k + 1..N {
            rest[(k, i)] = rest[(i, k)];
        }
    }
    Ok(Factor {
        columns,
        pivots,
        rest,
    })
}

/// Passes a pivot that is above zero.
#[inline]
pub(crate) fn above_zero(pivot: Real, row: usize) -> Result<Real, NotPositiveDefinite> {
    // Also refuses NaN.
    if pivot > 0.0 {
        Ok(pivot)
    } else {
        Err(NotPositiveDefinite { row, pivot })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::matrix;

    #[test]
    fn factor_gives_back_the_matrix() {
        let p = matrix![4.0, 2.0, -1.0; 2.0, 3.0, 0.5; -1.0, 0.5, 2.0];
        let factor = eliminate::<3, 3>(&p).unwrap();
        let sum = (0..3)
            .map(|j| factor.columns[j] * factor.columns[j].transpose() * factor.pivots[j])
            .sum::<SMatrix<Real, 3, 3>>();
        assert!((sum - p).amax() < 1e-15);
        let partial = eliminate::<3, 1>(&p).unwrap();
        let column = partial.columns[0];
        let sum = column * column.transpose() * partial.pivots[0] + partial.rest;
        assert!((sum - p).view((1, 1), (2, 2)).amax() < 1e-15);
    }

    #[test]
    fn the_failing_pivot_is_named() {
        let indefinite = matrix![1.0, 2.0; 2.0, 1.0];
        let expected = NotPositiveDefinite {
            row: 1,
            pivot: -3.0,
        };
        assert_eq!(eliminate::<2, 2>(&indefinite), Err(expected));
        assert_eq!(eliminate::<2, 1>(&indefinite), Err(expected));
        let not_a_number = matrix![Real::NAN, 0.0; 0.0, 1.0];
        assert_eq!(eliminate::<2, 2>(&not_a_number).unwrap_err().row, 0);
    }
}
