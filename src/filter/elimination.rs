//! Square-root-free Cholesky factor of a covariance, its first columns: P = L D Lᵀ.
//!
//! In: a symmetric matrix. Out: the first K columns of L D with their pivots D, and the first K rows of the same
//! columns of L (unit diagonal). With K = N it is the whole factor. A pivot that is not above zero stops it with its
//! row.

use crate::Real;
use nalgebra::{ArrayStorage, SMatrix, SVector};
use rundown_wire::errors;

errors! {
    /// A matrix is not positive definite: its pivot is not above zero, or not a number. Rows are counted from 0.
    pub struct NotPositiveDefinite { row: usize, pivot: Real } =>
        "covariance: expected pivot {row} above 0, found {pivot}";
}

/// A column of the factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FactorColumn<const N: usize, const K: usize> {
    /// Pivot D, above zero.
    pub d: Real,
    /// First K rows of the column of L: 0 above the diagonal, 1 on it.
    pub l: SVector<Real, K>,
    /// The whole column of L, times D.
    pub dl: SVector<Real, N>,
}

impl<const N: usize, const K: usize> FactorColumn<N, K> {
    /// Before it is found.
    pub(crate) const ZERO: Self = Self {
        d: 0.0,
        l: SVector::from_array_storage(ArrayStorage([[0.0; K]])),
        dl: SVector::from_array_storage(ArrayStorage([[0.0; N]])),
    };
}

/// The first K columns of the factor of a covariance.
///
/// # Errors
/// [`NotPositiveDefinite`] with the row and value of the first pivot that is not above zero.
///
/// ```
/// use nalgebra::matrix;
/// use rundown::filter::elimination::eliminate;
///
/// let [first, second] = eliminate::<2, 2>(&matrix![4.0, 2.0; 2.0, 3.0]).unwrap();
/// assert_eq!((first.d, second.d), (4.0, 2.0));
/// assert_eq!(first.l[1], 0.5);
/// assert_eq!(first.dl[1], 2.0);
/// ```
#[inline]
pub fn eliminate<const N: usize, const K: usize>(
    covariance: &SMatrix<Real, N, N>,
) -> Result<[FactorColumn<N, K>; K], NotPositiveDefinite> {
    let mut columns = [FactorColumn::ZERO; K];
    eliminate_into(covariance, &mut columns)?;
    Ok(columns)
}

/// [`eliminate`] in place: a result would be copied on the board's stack.
///
/// # Errors
/// As there; the columns are then of no use.
#[inline]
pub(crate) fn eliminate_into<const N: usize, const K: usize>(
    covariance: &SMatrix<Real, N, N>,
    columns: &mut [FactorColumn<N, K>; K],
) -> Result<(), NotPositiveDefinite> {
    for j in 0..K {
        for i in j..N {
            // Not by an index, which may panic for all that the compiler knows.
            let mut dl = covariance.get((i, j)).copied().unwrap_or(Real::NAN);
            for before in &columns[..j] {
                dl -= before.dl[i] * before.l[j];
            }
            columns[j].dl[i] = dl;
        }
        let column = &mut columns[j];
        column.d = above_zero(column.dl[j], j)?;
        column.l[j] = 1.0;
        for i in j + 1..K {
            column.l[i] = column.dl[i] / column.d;
        }
    }
    Ok(())
}

/// Passes a pivot that is above zero.
#[inline]
pub(crate) fn above_zero(pivot: Real, row: usize) -> Result<Real, NotPositiveDefinite> {
    // Also refuses NaN.
    if pivot > 0.0 { Ok(pivot) } else { Err(NotPositiveDefinite { row, pivot }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::matrix;

    #[test]
    fn factor_gives_back_the_matrix() {
        let p = matrix![4.0, 2.0, -1.0; 2.0, 3.0, 0.5; -1.0, 0.5, 2.0];
        let columns = eliminate::<3, 3>(&p).unwrap();
        let sum = columns.iter().map(|column| column.dl * column.l.transpose()).sum::<SMatrix<Real, 3, 3>>();
        assert!((sum - p).amax() < 1e-15);
        for column in &columns {
            assert!((column.l * column.d - column.dl).amax() < 1e-15);
        }
    }

    #[test]
    fn a_part_is_the_beginning_of_the_whole() {
        let p = matrix![4.0, 2.0, -1.0; 2.0, 3.0, 0.5; -1.0, 0.5, 2.0];
        let whole = eliminate::<3, 3>(&p).unwrap();
        for (part, whole) in eliminate::<3, 2>(&p).unwrap().iter().zip(&whole) {
            assert_eq!((part.d, part.dl), (whole.d, whole.dl));
            assert_eq!(part.l, whole.l.fixed_rows::<2>(0));
        }
    }

    #[test]
    fn the_failing_pivot_is_named() {
        let indefinite = matrix![1.0, 2.0; 2.0, 1.0];
        let expected = NotPositiveDefinite { row: 1, pivot: -3.0 };
        assert_eq!(eliminate::<2, 2>(&indefinite), Err(expected));
        let not_a_number = matrix![Real::NAN, 0.0; 0.0, 1.0];
        assert_eq!(eliminate::<2, 2>(&not_a_number).unwrap_err().row, 0);
    }
}
