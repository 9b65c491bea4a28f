//! Unscented Kalman Filter, section 3.1.
//!
//! In: a belief (mean, covariance), a motion, a measurement. Out: the belief one step later, and the innovation.
//!
//! The method is the paper's: van der Merwe's points x and x ± √c l, c = α² (N + κ), with l the columns of the Cholesky
//! factor (Eq. 7-9), sent through the motion (Eq. 8), and their weighted sums (Eq. 10-18). The form is another, because
//! λ = c - N makes weights of 1.7e6 when α = 0.001, and twelve digits are lost. Three observations make it exact and
//! short; each is an identity, not an approximation.
//!
//! **One number is not linear.** The motion is x' = T x + b a(x) with a scalar a, for a train its acceleration (Eq. 4,
//! 5). Weighted sums pass through what is linear, so only a needs points: its mean ā, its variance V and its covariance
//! C with x. Then x' has the mean T x + b ā, and its covariance follows from P, C and V in the same way.
//!
//! **Seen from the central point, a pair of points has an odd and an even part.** With P = L D Lᵀ (no square root), ε =
//! c D_j, l = column j of L and any vector g, for us the slope of a at x,
//!
//! ```text
//! a(x ± √ε l) - a(x) = ± √ε (g·l + odd_j) + c even_j
//! ```
//!
//! and with the weights of Eq. (9) put in, λ and all large terms cancel:
//!
//! ```text
//! ā = a(x) + m                                                m = Σ even_j
//! C = Σ D_j l_j (g·l_j + odd_j) = P ĝ                         ĝ = g + L⁻ᵀ odd
//! V = ĝᵀ P ĝ + c Σ even_j² + (β - α²) m²
//! ```
//!
//! ĝ is the slope as the points see it: for them the motion is a straight line of slope ĝ and a scatter about it.
//!
//! **Most pairs see a straight line.** The last N - K components of our states are constants of the train that enter a
//! linearly. Along their columns odd and even are zero, so the factor ends after K columns.
//!
//! Readings are components of the state (Eq. 6: location and speed) and independent, so Eq. (12)-(18) take them in one
//! after another; a missing one is left out. The paper's own arithmetic stands in the tests as the reference
//! implementation of all this (`host-tests/tests/textbook.rs`).
//!
//! Printed as it is, Eq. (11)-(15) leave Q out of the gain; [`Ukf::reuse_points`] keeps that.

use crate::Real;
use crate::filter::elimination::{FactorColumn, NotPositiveDefinite, above_zero, eliminate_into};
use crate::filter::gaussian::Gaussian;
use crate::plain::{Bytes, Plain};
use nalgebra::{SMatrix, SVector};
use rundown_wire::errors;
use serde::{Deserialize, Serialize};

/// A motion x' = T x + b (a(x) + noise) of N components, driven by one number a. The first K components move;
/// the last N - K are constants, and enter a linearly.
pub trait Process<const N: usize, const K: usize> {
    /// a(x).
    fn drive(&self, x: &SVector<Real, N>) -> Real;

    /// Slope g of a at x, exact for the constants. For the moving part it may be anything, if [`Process::pair`] knows
    /// it.
    fn slope(&self, x: &SVector<Real, N>) -> SVector<Real, N>;

    /// What a pair of points sees of a beyond a(x) and the slope: a(x ± √(c D) l) - a(x) = ± √(c D) (g·l + odd) + c
    /// even.
    fn pair(&self, x: &SVector<Real, N>, column: &FactorColumn<N, K>, c: Real) -> Pair;

    /// The moving part of T x + b a: linear in both.
    fn carry(&self, x: &SVector<Real, N>, a: Real) -> SVector<Real, K>;

    /// Variance q of the noise in a, which makes Q = q b bᵀ of Eq. (11). Zero, as in the paper, when not given.
    fn noise_variance(&self) -> Real {
        0.0
    }

    /// The moving part of f(x), Eq. (3).
    fn advance(&self, x: &SVector<Real, N>) -> SVector<Real, K> {
        self.carry(x, self.drive(x))
    }
}

/// What a pair of sigma points sees beyond a straight line, [`Process::pair`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pair {
    /// Slope along l beyond g·l.
    pub odd: Real,
    /// Half the sum of the two, over c.
    pub even: Real,
}

/// Readings z = (components of x) + noise, M of them, independent of each other, Eq. (6).
pub trait MeasurementModel<const M: usize> {
    /// Which component of the state each reading reads.
    const COMPONENTS: [usize; M];

    /// Variance of reading `i`, above zero.
    fn variance(&self, i: usize) -> Real;

    /// Variance by which the gate judges it; below [`variance`](Self::variance) where that is inflated for errors that
    /// readings share.
    #[inline]
    fn gate_variance(&self, i: usize) -> Real {
        self.variance(i)
    }
}

/// Spread of the sigma points of a state of N components, Table 1. Made by [`Spread::try_new`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "SpreadTable", into = "SpreadTable")]
pub struct Spread<const N: usize> {
    alpha: Real,
    beta: Real,
    kappa: Real,
}

/// As a configuration file holds it; unchecked.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SpreadTable {
    alpha: Real,
    beta: Real,
    kappa: Real,
}

impl<const N: usize> Plain for Spread<N> {
    const START: Self = Self { alpha: 0.0, beta: 0.0, kappa: 0.0 };

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        let mut parameters = self.parameters();
        bytes.numbers(&mut parameters);
        let [alpha, beta, kappa] = parameters;
        match Self::try_new(alpha, beta, kappa) {
            Ok(spread) => *self = spread,
            Err(_) => bytes.refuse(),
        }
    }
}

impl<const N: usize> TryFrom<SpreadTable> for Spread<N> {
    type Error = SpreadError;

    fn try_from(table: SpreadTable) -> Result<Self, SpreadError> {
        Self::try_new(table.alpha, table.beta, table.kappa)
    }
}

impl<const N: usize> From<Spread<N>> for SpreadTable {
    fn from(spread: Spread<N>) -> Self {
        Self { alpha: spread.alpha, beta: spread.beta, kappa: spread.kappa }
    }
}

errors! {
    /// α and N + κ must be above zero, and all three finite; N is the number of components of the state.
    #[derive(Eq)]
    pub struct SpreadError { components: usize } =>
        "spread: expected alpha above 0, kappa above -{components} and all finite";
}

impl<const N: usize> Spread<N> {
    /// Table 1.
    pub const PAPER: Self = Self::new(1e-3, 2.0, -2.0);
    /// The same points at α = 1: the spread of a normal distribution in three dimensions.
    pub const WIDE: Self = Self::new(1.0, 2.0, -2.0);

    /// As [`Spread::try_new`], for constants.
    ///
    /// # Panics
    /// While compiling, when the values are refused.
    pub const fn new(alpha: Real, beta: Real, kappa: Real) -> Self {
        match Self::try_new(alpha, beta, kappa) {
            Ok(spread) => spread,
            Err(_) => panic!("alpha and N + kappa must be above zero"),
        }
    }

    /// Checks α, β, κ for a state of N components.
    ///
    /// # Errors
    /// [`SpreadError`] when α or N + κ is not above zero, or one of them is not finite.
    pub const fn try_new(alpha: Real, beta: Real, kappa: Real) -> Result<Self, SpreadError> {
        let reaches = alpha > 0.0 && kappa + N as Real > 0.0;
        if reaches && alpha.is_finite() && beta.is_finite() && kappa.is_finite() {
            Ok(Self { alpha, beta, kappa })
        } else {
            Err(SpreadError { components: N })
        }
    }

    /// α, β, κ.
    pub const fn parameters(&self) -> [Real; 3] {
        [self.alpha, self.beta, self.kappa]
    }

    /// c = N + λ = α² (N + κ): squared reach of the points in standard deviations.
    pub fn reach(&self) -> Real {
        self.alpha * self.alpha * (N as Real + self.kappa)
    }

    /// Weights of Eq. (9), w0 of the mean, w0 of the covariance and w_i. The filter never needs them.
    ///
    /// ```
    /// use rundown::filter::ukf::Spread;
    ///
    /// let (w0_mean, w0_covariance, w) = Spread::<5>::PAPER.weights();
    /// assert!((w - 1.0 / 6e-6).abs() < 1e-3);
    /// assert!((w0_mean + 10.0 * w - 1.0).abs() < 1e-6);
    /// assert!((w0_covariance - w0_mean - 2.999999).abs() < 1e-6);
    /// ```
    pub fn weights(&self) -> (Real, Real, Real) {
        let reach = self.reach();
        let mean = 1.0 - N as Real / reach;
        let covariance = mean + 1.0 - self.alpha * self.alpha + self.beta;
        (mean, covariance, 0.5 / reach)
    }
}

/// The filter's settings. What changes is a [`Gaussian`], held by the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ukf<const N: usize, const M: usize> {
    /// Spread of the sigma points.
    pub spread: Spread<N>,
    /// Largest accepted |innovation| in standard deviations, for each reading; none: every reading is taken.
    pub gate: [Option<Real>; M],
    /// Form the gain from the propagated points, which do not know Q, as Eq. (12)-(15) are printed. Makes a difference
    /// only with a Q.
    pub reuse_points: bool,
}

/// What became of one reading in an update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// It was not there.
    #[default]
    Missing,
    /// It moved the belief.
    Used,
    /// It lay outside the gate and was left out.
    Gated,
}

/// Difference between a measurement and what was expected of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation<const M: usize> {
    /// z - H x̄; 0 where the reading is missing.
    pub value: SVector<Real, M>,
    /// P_z of Eq. (14), of all readings whether missing or not.
    pub covariance: SMatrix<Real, M, M>,
    /// What became of each reading.
    pub readings: [Reading; M],
    /// Each used reading's innovation, given those before it, and its variance.
    pub(crate) sequential: [(Real, Real); M],
}

impl<const M: usize> Innovation<M> {
    /// Logarithm of the density of the used readings under what was expected of them (the tuning criterion of section
    /// 4.2).
    pub fn log_likelihood(&self) -> Real {
        self.used()
            .map(|(value, variance)| {
                -0.5 * (value * value / variance + libm::log(2.0 * core::f64::consts::PI * variance))
            })
            .sum()
    }

    /// Squared Mahalanobis distance of the used readings: its mean is their number when the filter is consistent.
    pub fn distance_squared(&self) -> Real {
        self.used().map(|(value, variance)| value * value / variance).sum()
    }

    fn used(&self) -> impl Iterator<Item = (Real, Real)> + '_ {
        let is_used = |(reading, _): &(&Reading, _)| **reading == Reading::Used;
        self.readings.iter().zip(self.sequential).filter(is_used).map(|(_, pair)| pair)
    }
}

impl<const N: usize, const M: usize> Ukf<N, M> {
    /// One step: predict, then update with what there is of a measurement.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]; `belief` is then of no use. It is worked on in place, so a caller who needs the old one
    /// keeps a copy.
    #[inline]
    pub fn step<const K: usize>(
        &self,
        belief: &mut Gaussian<N>,
        process: &impl Process<N, K>,
        observation: &impl MeasurementModel<M>,
        z: &[Option<Real>; M],
    ) -> Result<Innovation<M>, NotPositiveDefinite> {
        let noise = process.noise_variance();
        let in_gain = if self.reuse_points { 0.0 } else { noise };
        self.propagate(belief, process, in_gain)?;
        let innovation = self.update(belief, observation, z)?;
        if self.reuse_points && noise != 0.0 {
            let b = process.carry(&SVector::zeros(), 1.0);
            for j in 0..K {
                for i in j..K {
                    let element = belief.covariance[(i, j)] + noise * b[i] * b[j];
                    belief.covariance[(i, j)] = element;
                    belief.covariance[(j, i)] = element;
                }
            }
        }
        Ok(innovation)
    }

    /// Prediction alone, Eq. (7)-(11).
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]; `belief` is then as it was.
    #[inline]
    pub fn predict<const K: usize>(
        &self,
        belief: &mut Gaussian<N>,
        process: &impl Process<N, K>,
    ) -> Result<(), NotPositiveDefinite> {
        self.propagate(belief, process, process.noise_variance())?;
        mirror(&mut belief.covariance);
        Ok(())
    }

    /// Eq. (7)-(11) in the form that the module's header derives. Leaves only the lower triangle of the covariance
    /// good.
    #[inline]
    fn propagate<const K: usize>(
        &self,
        belief: &mut Gaussian<N>,
        process: &impl Process<N, K>,
        noise_variance: Real,
    ) -> Result<(), NotPositiveDefinite> {
        let (x, p) = (&belief.mean, &belief.covariance);
        let c = self.spread.reach();
        let mut columns = [FactorColumn::<N, K>::ZERO; K];
        eliminate_into(p, &mut columns)?;

        // What the pairs see, one after another: each gives its stack back. Then ĝ by back substitution.
        let mut pairs = [Pair::default(); K];
        for (pair, column) in pairs.iter_mut().zip(&columns) {
            *pair = process.pair(x, column, c);
        }
        let mut slope = process.slope(x);
        let mut beyond = SVector::<Real, K>::zeros();
        for j in (0..K).rev() {
            beyond[j] = pairs[j].odd;
            for i in j + 1..K {
                beyond[j] -= columns[j].l[i] * beyond[i];
            }
            slope[j] += beyond[j];
        }

        // Mean of a, covariance with x, variance.
        let m: Real = pairs.iter().map(|pair| pair.even).sum();
        let scatter: Real = pairs.iter().map(|pair| pair.even * pair.even).sum();
        let curvature = self.spread.beta - self.spread.alpha * self.spread.alpha;
        let mean = process.drive(x) + m;
        // P ĝ, written out: a product of nalgebra takes more of the board's stack.
        let with_x = SVector::<Real, N>::from_fn(|i, _| {
            let mut sum = p[(i, 0)] * slope[0];
            for j in 1..N {
                sum += p[(i, j)] * slope[j];
            }
            sum
        });
        let straight: Real = slope.iter().zip(&with_x).map(|(g, c)| g * c).sum();
        let variance = straight + c * scatter + curvature * m * m + noise_variance;

        carry_on(belief, process, mean, &with_x, variance);
        Ok(())
    }

    /// Update, Eq. (12)-(18), one reading after another; a missing or gated reading is left out.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] with the row of the variance that is no longer above zero; `belief` is then of no use.
    #[inline]
    pub fn update<O: MeasurementModel<M>>(
        &self,
        belief: &mut Gaussian<N>,
        observation: &O,
        z: &[Option<Real>; M],
    ) -> Result<Innovation<M>, NotPositiveDefinite> {
        let Gaussian { mean, covariance } = belief;
        let mut innovation = Innovation {
            value: SVector::zeros(),
            covariance: SMatrix::from_fn(|i, j| lower(covariance, O::COMPONENTS[i], O::COMPONENTS[j])),
            readings: [Reading::Missing; M],
            sequential: [(0.0, 0.0); M],
        };
        for i in 0..M {
            innovation.covariance[(i, i)] += observation.variance(i);
            if let Some(z) = z[i] {
                innovation.value[i] = z - mean[O::COMPONENTS[i]];
            }
        }
        for i in 0..M {
            let Some(z) = z[i] else { continue };
            let read = O::COMPONENTS[i];
            let column = SVector::<Real, N>::from_fn(|j, _| lower(covariance, j, read));
            let noise = observation.variance(i);
            let value = z - mean[read];
            let variance = column[read] + noise;
            innovation.sequential[i] = (value, variance);
            if let Some(gate) = self.gate[i]
                && value * value > gate * gate * (column[read] + observation.gate_variance(i))
            {
                innovation.readings[i] = Reading::Gated;
                continue;
            }
            innovation.readings[i] = Reading::Used;
            let gain = column * (1.0 / variance); // Eq. (16)
            for j in 0..N {
                mean[j] += gain[j] * value; // Eq. (17)
            }
            for k in 0..N {
                for j in k..N {
                    // Eq. (18); where the row is the reading's own, column - gain column = gain noise without a
                    // difference.
                    if j == read {
                        covariance[(j, k)] = gain[k] * noise;
                    } else if k == read {
                        covariance[(j, k)] = gain[j] * noise;
                    } else {
                        covariance[(j, k)] -= gain[j] * column[k];
                    }
                }
            }
        }
        // The check comes last: else the compiler stores what is below the diagonal twice.
        mirror(covariance);
        for row in 0..N {
            above_zero(covariance[(row, row)], row)?;
        }
        Ok(innovation)
    }
}

/// The belief one step later, of which the motion a has this mean, covariance with x, and variance: x' is linear in (x,
/// a), and so are its covariances with x and with a, and with itself. Leaves only the lower triangle good.
// Of its own on the board: nothing of it is on the stack while a pair of points crosses an edge of the gradients.
#[cfg_attr(target_os = "none", inline(never))]
#[cfg_attr(not(target_os = "none"), inline)]
fn carry_on<const N: usize, const K: usize>(
    belief: &mut Gaussian<N>,
    process: &impl Process<N, K>,
    mean: Real,
    with_x: &SVector<Real, N>,
    variance: Real,
) {
    let carried = process.carry(&belief.mean, mean);
    let with_a = process.carry(with_x, variance);
    let p = &mut belief.covariance;
    let mut moving = SMatrix::<Real, K, K>::zeros();
    for i in 0..N {
        let row = process.carry(&p.row(i).transpose(), with_x[i]);
        for k in 0..K {
            let place = if i < K { &mut moving[(k, i)] } else { &mut p[(i, k)] };
            *place = row[k];
        }
    }
    for k in 0..K {
        belief.mean[k] = carried[k];
        let row = SVector::from_fn(|i, _| if i < K { moving[(k, i)] } else { p[(i, k)] });
        let row = process.carry(&row, with_a[k]);
        for i in k..K {
            p[(i, k)] = row[i];
        }
    }
}

/// Element (i, j) of a symmetric matrix of which the lower triangle is good.
#[inline]
fn lower<const N: usize>(matrix: &SMatrix<Real, N, N>, i: usize, j: usize) -> Real {
    // Not by an index, which may panic for all that the compiler knows; every caller stays inside.
    matrix.get((i.max(j), i.min(j))).copied().unwrap_or(Real::NAN)
}

/// Writes the lower triangle into the upper one: symmetric to the last bit.
#[inline]
fn mirror<const N: usize>(matrix: &mut SMatrix<Real, N, N>) {
    for j in 0..N {
        for i in j + 1..N {
            matrix[(j, i)] = matrix[(i, j)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_checked_for_its_own_number_of_components() {
        for (kappa, of_three, of_six) in
            [(-2.0, true, true), (-3.0, false, true), (-5.5, false, true), (-6.0, false, false)]
        {
            assert_eq!(Spread::<3>::try_new(1.0, 2.0, kappa).is_ok(), of_three, "{kappa}");
            assert_eq!(Spread::<6>::try_new(1.0, 2.0, kappa).is_ok(), of_six, "{kappa}");
        }
        for (alpha, beta, kappa) in
            [(0.0, 2.0, 0.0), (Real::NAN, 2.0, 0.0), (1.0, Real::INFINITY, 0.0), (1.0, 2.0, Real::INFINITY)]
        {
            assert_eq!(Spread::<5>::try_new(alpha, beta, kappa), Err(SpreadError { components: 5 }));
        }
    }
}
