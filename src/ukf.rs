//! Unscented Kalman Filter, section 3.1.
//!
//! In: a belief (mean, covariance), a motion, a measurement. Out: the belief one step later, and the innovation.
//!
//! The method is the paper's: van der Merwe's points x and x ± √c l_j, c = α² (N + κ), with l_j the columns of the Cholesky factor (Eq. 7-9),
//! sent through the motion f (Eq. 8), and their weighted sums (Eq. 10-18). The form is another, because λ = c - N makes weights of 1.7e6 when
//! α = 0.001, and twelve digits are lost. Seen from the central point, a pair of points has an odd and an even part,
//!
//! ```text
//! f(x ± √ε l) - f(x) = ± √ε odd + ε even              ε = c D_j, P = L D Lᵀ, l = column j of L
//! ```
//!
//! and with the weights of Eq. (9) put in, Eq. (10) and (11) become, without any rounding,
//!
//! ```text
//! x̄  = f(x) + m                                       m = Σ D_j even_j
//! Px = Σ D_j odd_j odd_jᵀ + c Σ D_j² even_j even_jᵀ + (β - α²) m mᵀ + Q
//! ```
//!
//! No term is large, λ is never formed, and no square root is taken. One thing more saves half of the work: the last N - K
//! components of our states are constants of the train that enter f linearly and do not change. The points along their columns
//! only carry their covariance (given the moving part) through a linear map, so that is what is done. The paper's own
//! arithmetic stands in the tests as the witness of both steps (`host-tests/tests/textbook.rs`).
//!
//! Measurements are linear, z = H x (Eq. 6: location and speed are read), so Eq. (12)-(15) are products with P, and with independent
//! readings the components are taken in one after another; a missing one is left out.
//!
//! Printed as it is, Eq. (11)-(15) leave Q out of the gain; [`Ukf::reuse_points`] keeps that.

use crate::Real;
use crate::elimination::{NotPositiveDefinite, above_zero, eliminate};
use crate::state::Gaussian;
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

/// A motion f of N components of which the first K move. The last N - K are constants that enter f linearly.
/// With K = N it is any motion at all.
pub trait Process<const N: usize, const K: usize> {
    /// The moving part of f(x), Eq. (3).
    fn advance(&self, x: &SVector<Real, N>) -> SVector<Real, K>;

    /// What the pair x ± √ε l sees beyond f(x). Not called with ε = 0.
    fn pair(&self, x: &SVector<Real, N>, l: &SVector<Real, N>, epsilon: Real) -> Pair<K>;

    /// Change of the moving part for a change of the constants alone: linear in `change`, whose first K components are ignored.
    fn constants(&self, x: &SVector<Real, N>, change: &SVector<Real, N>) -> SVector<Real, K>;

    /// Process noise Q of Eq. (11). None, as in the paper, means zero.
    fn noise(&self) -> Option<SMatrix<Real, N, N>> {
        None
    }
}

/// Odd and even part of a pair of sigma points, moving rows only: f(x ± √ε l) - f(x) = ± √ε odd + ε even.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<const K: usize> {
    /// Half the difference of the two, over √ε: the slope along l.
    pub odd: SVector<Real, K>,
    /// Half the sum of the two, over ε: the curvature along l.
    pub even: SVector<Real, K>,
}

/// A linear measurement z = H x + noise of M independent readings, Eq. (6).
pub trait Observation<const N: usize, const M: usize> {
    /// Row `i` of H times `x`.
    fn read(&self, i: usize, x: &SVector<Real, N>) -> Real;

    /// Variance of reading `i`, above zero.
    fn variance(&self, i: usize) -> Real;
}

/// Spread of the sigma points, Table 1. Made by [`Spread::try_new`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "SpreadTable", into = "SpreadTable")]
pub struct Spread {
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

impl TryFrom<SpreadTable> for Spread {
    type Error = SpreadError;

    fn try_from(table: SpreadTable) -> Result<Self, SpreadError> {
        Self::try_new(table.alpha, table.beta, table.kappa)
    }
}

impl From<Spread> for SpreadTable {
    fn from(spread: Spread) -> Self {
        Self {
            alpha: spread.alpha,
            beta: spread.beta,
            kappa: spread.kappa,
        }
    }
}

/// α and N + κ must be above zero, and all three finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpreadError;

impl core::fmt::Display for SpreadError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("spread: alpha and 5 + kappa must be above zero, beta finite")
    }
}

impl core::error::Error for SpreadError {}

impl Spread {
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
            Err(_) => panic!("alpha and 5 + kappa must be above zero"),
        }
    }

    /// Checks α, β, κ for states of five components or more.
    ///
    /// # Errors
    /// [`SpreadError`] when α or 5 + κ is not above zero, or β is not finite.
    pub const fn try_new(alpha: Real, beta: Real, kappa: Real) -> Result<Self, SpreadError> {
        let reaches = alpha > 0.0 && kappa + 5.0 > 0.0;
        if reaches && alpha.is_finite() && beta.is_finite() && kappa.is_finite() {
            Ok(Self { alpha, beta, kappa })
        } else {
            Err(SpreadError)
        }
    }

    /// c = N + λ = α² (N + κ): squared reach of the points in standard deviations.
    pub fn reach(&self, n: usize) -> Real {
        self.alpha * self.alpha * (n as Real + self.kappa)
    }

    /// Weights of Eq. (9), w0 of the mean, w0 of the covariance and w_i. The filter never needs them.
    ///
    /// ```
    /// use rundown::ukf::Spread;
    ///
    /// let (w0_mean, w0_covariance, w) = Spread::PAPER.weights(5);
    /// assert!((w - 1.0 / 6e-6).abs() < 1e-3);
    /// assert!((w0_mean + 10.0 * w - 1.0).abs() < 1e-6);
    /// assert!((w0_covariance - w0_mean - 2.999999).abs() < 1e-6);
    /// ```
    pub fn weights(&self, n: usize) -> (Real, Real, Real) {
        let reach = self.reach(n);
        let mean = 1.0 - n as Real / reach;
        let covariance = mean + 1.0 - self.alpha * self.alpha + self.beta;
        (mean, covariance, 0.5 / reach)
    }
}

/// The filter's settings. What changes is a [`Gaussian`], held by the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ukf<const N: usize, const M: usize> {
    /// Spread of the sigma points.
    pub spread: Spread,
    /// Largest accepted |innovation| in standard deviations, for each reading; none: every reading is taken.
    pub gate: [Option<Real>; M],
    /// Form the gain from the propagated points, which do not know Q, as Eq. (12)-(15) are printed. Makes a difference only with a Q.
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
    sequential: [(Real, Real); M],
}

impl<const M: usize> Innovation<M> {
    /// Logarithm of the density of the used readings under what was expected of them (the tuning criterion of section 4.2).
    pub fn log_likelihood(&self) -> Real {
        self.used()
            .map(|(value, variance)| {
                -0.5 * (value * value / variance
                    + libm::log(2.0 * core::f64::consts::PI * variance))
            })
            .sum()
    }

    /// Squared Mahalanobis distance of the used readings: its mean is their number when the filter is consistent.
    pub fn distance_squared(&self) -> Real {
        self.used()
            .map(|(value, variance)| value * value / variance)
            .sum()
    }

    fn used(&self) -> impl Iterator<Item = (Real, Real)> + '_ {
        let is_used = |(reading, _): &(&Reading, _)| **reading == Reading::Used;
        self.readings
            .iter()
            .zip(self.sequential)
            .filter(is_used)
            .map(|(_, pair)| pair)
    }
}

impl<const N: usize, const M: usize> Ukf<N, M> {
    /// One step: predict, then update with what there is of a measurement.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]; `belief` is then as it was.
    pub fn step<const K: usize>(
        &self,
        belief: &mut Gaussian<N>,
        process: &impl Process<N, K>,
        observation: &impl Observation<N, M>,
        z: &[Option<Real>; M],
    ) -> Result<Innovation<M>, NotPositiveDefinite> {
        let mut next = self.propagate(belief, process)?;
        let noise = process.noise();
        if let (Some(q), false) = (&noise, self.reuse_points) {
            next.covariance += q;
        }
        let innovation = self.take_in(&mut next, observation, z)?;
        if let (Some(q), true) = (&noise, self.reuse_points) {
            next.covariance += q;
        }
        *belief = next;
        Ok(innovation)
    }

    /// Prediction alone, Eq. (7)-(11) with Q.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]; `belief` is then as it was.
    pub fn predict<const K: usize>(
        &self,
        belief: &mut Gaussian<N>,
        process: &impl Process<N, K>,
    ) -> Result<(), NotPositiveDefinite> {
        let mut next = self.propagate(belief, process)?;
        if let Some(q) = process.noise() {
            next.covariance += q;
        }
        *belief = next;
        Ok(())
    }

    /// Eq. (7)-(11) without Q, in the form that the module's header derives.
    #[inline]
    fn propagate<const K: usize>(
        &self,
        belief: &Gaussian<N>,
        process: &impl Process<N, K>,
    ) -> Result<Gaussian<N>, NotPositiveDefinite> {
        let x = &belief.mean;
        let c = self.spread.reach(N);
        let factor = eliminate::<N, K>(&belief.covariance)?;

        // Rows 0..K of Px; the rows of the constants among themselves stay.
        let mut rows = SMatrix::<Real, K, N>::zeros();
        let mut m = SVector::<Real, K>::zeros();
        for (l, d) in factor.columns.iter().zip(factor.pivots) {
            let pair = process.pair(x, l, c * d);
            let even = pair.even * d;
            m += even;
            for i in 0..K {
                let weighted = d * pair.odd[i];
                let bent = c * even[i];
                for j in i..K {
                    rows[(i, j)] += weighted * pair.odd[j] + bent * even[j];
                }
                for j in K..N {
                    rows[(i, j)] += weighted * l[j];
                }
            }
        }

        // The constants given the moving part have covariance R: F R, and F R Fᵀ.
        let mut moved = [SVector::<Real, N>::zeros(); K];
        for j in K..N {
            let column = process.constants(x, &factor.rest.column(j).into_owned());
            for i in 0..K {
                moved[i][j] = column[i];
                rows[(i, j)] += column[i];
            }
        }
        let curvature = self.spread.beta - self.spread.alpha * self.spread.alpha;
        for i in 0..K {
            let square = process.constants(x, &moved[i]);
            for j in i..K {
                rows[(i, j)] += square[j] + curvature * m[i] * m[j];
            }
        }

        let mut next = *belief;
        let moved = process.advance(x) + m;
        for i in 0..K {
            next.mean[i] = moved[i];
            for j in i..N {
                next.covariance[(i, j)] = rows[(i, j)];
                next.covariance[(j, i)] = rows[(i, j)];
            }
        }
        Ok(next)
    }

    /// Update, Eq. (12)-(18), one reading after another; a missing or gated reading is left out.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] with the row of the variance that is no longer above zero; `belief` is then as it was.
    #[inline]
    pub fn update(
        &self,
        belief: &mut Gaussian<N>,
        observation: &impl Observation<N, M>,
        z: &[Option<Real>; M],
    ) -> Result<Innovation<M>, NotPositiveDefinite> {
        let mut next = *belief;
        let innovation = self.take_in(&mut next, observation, z)?;
        *belief = next;
        Ok(innovation)
    }

    /// As [`Ukf::update`], on a belief of the caller's own: after an error it is of no use.
    #[inline]
    fn take_in(
        &self,
        next: &mut Gaussian<N>,
        observation: &impl Observation<N, M>,
        z: &[Option<Real>; M],
    ) -> Result<Innovation<M>, NotPositiveDefinite> {
        let mut innovation = Innovation {
            value: SVector::zeros(),
            covariance: SMatrix::zeros(),
            readings: [Reading::Missing; M],
            sequential: [(0.0, 0.0); M],
        };
        for i in 0..M {
            if let Some(z) = z[i] {
                innovation.value[i] = z - observation.read(i, &next.mean);
            }
            let p_h = project(&next.covariance, observation, i);
            for j in i..M {
                innovation.covariance[(i, j)] = observation.read(j, &p_h);
                innovation.covariance[(j, i)] = innovation.covariance[(i, j)];
            }
            innovation.covariance[(i, i)] += observation.variance(i);
        }
        for i in 0..M {
            let Some(z) = z[i] else { continue };
            let p_h = project(&next.covariance, observation, i);
            let value = z - observation.read(i, &next.mean);
            let variance = observation.read(i, &p_h) + observation.variance(i);
            innovation.sequential[i] = (value, variance);
            if let Some(gate) = self.gate[i]
                && value * value > gate * gate * variance
            {
                innovation.readings[i] = Reading::Gated;
                continue;
            }
            innovation.readings[i] = Reading::Used;
            let gain = p_h * (1.0 / variance); // Eq. (16)
            next.mean += gain * value; // Eq. (17)
            for j in 0..N {
                for k in j..N {
                    // Eq. (18); both halves get the same bits, so the covariance stays symmetric.
                    next.covariance[(k, j)] -= gain[j] * p_h[k];
                }
            }
            for j in 0..N {
                for k in j + 1..N {
                    next.covariance[(j, k)] = next.covariance[(k, j)];
                }
            }
        }
        for row in 0..N {
            let pivot = next.covariance[(row, row)];
            above_zero(pivot, row)?;
        }
        Ok(innovation)
    }
}

/// P hᵢ, the column of the covariance that belongs to reading i.
#[inline]
fn project<const N: usize, const M: usize>(
    covariance: &SMatrix<Real, N, N>,
    observation: &impl Observation<N, M>,
    i: usize,
) -> SVector<Real, N> {
    SVector::from_fn(|j, _| observation.read(i, &covariance.column(j).into_owned()))
}
