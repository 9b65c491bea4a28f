//! The paper's filter exactly as it is printed: the reference implementation that `rundown::filter::ukf` is compared
//! with, in result and cost.
//!
//! In: a belief, any function f, a measurement of some of the components. Out: the belief one step later, and what lay
//! between.
//!
//! Written from Eq. (7)-(18) alone, with nalgebra's matrices and its own Cholesky loop. From `rundown` it takes only
//! the containers ([`Gaussian`], `Spread`) and, in [`Motion`], the descriptions of track and train: weights, points,
//! sums, gain and update are its own.
//!
//! ```text
//! X0 = x, X_i = x ± sqrt(L + λ) l_i         Eq. (7), (8)     Y_i = f(X_i)
//! x̄ = Σ W_m Y_i                             Eq. (10)         Px = Σ W_c (Y_i - x̄)(Y_i - x̄)ᵀ + Q    Eq. (11)
//! Z_i = H Y_i                               Eq. (12)         z̄, Pz, Pxz                            Eq. (13)-(15)
//! K = Pxz Pz⁻¹, x = x̄ + K (z - z̄), P = Px - K Pz Kᵀ                                                Eq. (16)-(18)
//! ```

use crate::prelude::*;
use nalgebra::{SMatrix, SVector};
use rundown::model::line::Line;

/// α, β, κ as plain numbers.
#[derive(Clone, Copy, Debug)]
pub struct PlainSpread {
    /// α.
    pub alpha: f64,
    /// β.
    pub beta: f64,
    /// κ.
    pub kappa: f64,
}

/// Weights of Eq. (9): λ, w0 of the mean, w0 of the covariance, w_i.
pub fn weights(shape: PlainSpread, n: usize) -> (f64, f64, f64, f64) {
    let l = n as f64;
    let lambda = shape.alpha * shape.alpha * (l + shape.kappa) - l;
    let mean = lambda / (l + lambda);
    let covariance = mean + 1.0 - shape.alpha * shape.alpha + shape.beta;
    (lambda, mean, covariance, 1.0 / (2.0 * (l + lambda)))
}

/// Lower Cholesky factor; `None` when the matrix is not positive definite.
pub fn cholesky<const N: usize>(p: &SMatrix<f64, N, N>) -> Option<SMatrix<f64, N, N>> {
    let mut l = SMatrix::<f64, N, N>::zeros();
    for j in 0..N {
        for i in j..N {
            let sum: f64 = (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum();
            let rest = p[(i, j)] - sum;
            if i > j {
                l[(i, j)] = rest / l[(j, j)];
            } else if rest > 0.0 {
                l[(j, j)] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(l)
}

/// The 2N + 1 points of Eq. (7), or what became of them.
#[derive(Clone, Copy, Debug)]
pub struct Points<const N: usize> {
    centre: SVector<f64, N>,
    plus: [SVector<f64, N>; N],
    minus: [SVector<f64, N>; N],
}

impl<const N: usize> Points<N> {
    /// x, x + √(L + λ) l_i and x - √(L + λ) l_i.
    pub fn new(shape: PlainSpread, belief: &Gaussian<N>) -> Option<Self> {
        let (lambda, ..) = weights(shape, N);
        let reach = (N as f64 + lambda).sqrt();
        let l = cholesky(&belief.covariance)?;
        Some(Self {
            centre: belief.mean,
            plus: std::array::from_fn(|i| belief.mean + reach * l.column(i)),
            minus: std::array::from_fn(|i| belief.mean - reach * l.column(i)),
        })
    }

    /// The same points sent through f.
    pub fn through(&self, f: impl Fn(&SVector<f64, N>) -> SVector<f64, N>) -> Self {
        Self { centre: f(&self.centre), plus: self.plus.each_ref().map(&f), minus: self.minus.each_ref().map(&f) }
    }

    /// The points with weight `w0` for the centre and `w` for the others.
    fn weighted(&self, w0: f64, w: f64) -> impl Iterator<Item = (f64, &SVector<f64, N>)> {
        let others = self.plus.iter().chain(&self.minus);
        std::iter::once((w0, &self.centre)).chain(others.map(move |point| (w, point)))
    }

    /// Eq. (10) and the sum of Eq. (11), without Q.
    pub fn statistics(&self, shape: PlainSpread) -> Gaussian<N> {
        let (_, w0_mean, w0_covariance, w) = weights(shape, N);
        let mut mean = SVector::<f64, N>::zeros();
        for (weight, point) in self.weighted(w0_mean, w) {
            mean += weight * point;
        }
        let mut covariance = SMatrix::<f64, N, N>::zeros();
        for (weight, point) in self.weighted(w0_covariance, w) {
            let from_mean = point - mean;
            covariance += weight * from_mean * from_mean.transpose();
        }
        Gaussian { mean, covariance }
    }
}

/// A reading of one component of the state.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    /// Which component.
    pub component: usize,
    /// Its reading.
    pub value: f64,
    /// Variance of the reading.
    pub variance: f64,
}

/// What a step gives.
#[derive(Clone, Copy, Debug)]
pub struct Step<const N: usize, const M: usize> {
    /// After Eq. (18).
    pub posterior: Gaussian<N>,
    /// z - z̄.
    pub innovation: SVector<f64, M>,
    /// Pz of Eq. (14).
    pub innovation_covariance: SMatrix<f64, M, M>,
}

/// One step as printed, with the M readings that are there. `None`: a matrix was not positive definite.
pub fn step<const N: usize, const M: usize>(
    shape: PlainSpread,
    belief: &Gaussian<N>,
    f: impl Fn(&SVector<f64, N>) -> SVector<f64, N>,
    q: &SMatrix<f64, N, N>,
    reuse_points: bool,
    readings: &[Read; M],
) -> Option<Step<N, M>> {
    let mut points = Points::new(shape, belief)?.through(f);
    let mut prior = points.statistics(shape);
    prior.covariance += q;
    if !reuse_points {
        points = Points::new(shape, &prior)?;
    }

    let (_, w0_mean, w0_covariance, w) = weights(shape, N);
    let read = |x: &SVector<f64, N>| SVector::<f64, M>::from_fn(|i, _| x[readings[i].component]);
    let mut expected = SVector::<f64, M>::zeros();
    for (weight, point) in points.weighted(w0_mean, w) {
        expected += weight * read(point);
    }
    let mut p_z = SMatrix::<f64, M, M>::zeros();
    let mut p_xz = SMatrix::<f64, N, M>::zeros();
    for (weight, point) in points.weighted(w0_covariance, w) {
        let from_expected = read(point) - expected;
        p_z += weight * from_expected * from_expected.transpose();
        p_xz += weight * (point - prior.mean) * from_expected.transpose();
    }
    for (i, reading) in readings.iter().enumerate() {
        p_z[(i, i)] += reading.variance;
    }
    let innovation = SVector::<f64, M>::from_fn(|i, _| readings[i].value) - expected;

    let mut posterior = prior;
    if M > 0 {
        let gain = p_xz * p_z.try_inverse()?;
        posterior.mean += gain * innovation;
        posterior.covariance -= gain * p_z * gain.transpose();
    }
    Some(Step { posterior, innovation, innovation_covariance: p_z })
}

/// Eq. (4), (5) for any state whose first five components are (s, v, r0, r1, r2); `lead_mps` and `lead_m` are what the
/// midway form adds to speed and location before it evaluates resistance and gradient.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    line: Line<'a>,
    effort_n_per_kg: f64,
    dt_s: f64,
    lead_mps: f64,
    lead_m: f64,
    origin_m: f64,
}

impl<'a> Motion<'a> {
    /// A step from the mean `x`.
    pub fn new<const N: usize>(
        line: Line<'a>,
        x: &SVector<f64, N>,
        effort_n_per_kg: f64,
        dt_s: f64,
        evaluate: Evaluate,
    ) -> Self {
        let mut motion = Self { line, effort_n_per_kg, dt_s, lead_mps: 0.0, lead_m: 0.0, origin_m: 0.0 };
        if evaluate == Evaluate::Midway {
            let half_s = 0.5 * dt_s;
            let lead_mps = half_s * motion.acceleration_mps2(x);
            motion.lead_m = line.direction.sign() * half_s * (x[1] + 0.5 * lead_mps);
            motion.lead_mps = lead_mps;
        }
        motion
    }

    /// The same motion for states whose location is counted from here: with weights of 1.7e6 every digit that the
    /// numbers do not carry counts.
    pub fn seen_from(mut self, origin_m: f64) -> Self {
        self.origin_m = origin_m;
        self
    }

    fn acceleration_mps2<const N: usize>(&self, x: &SVector<f64, N>) -> f64 {
        let (s, v) = (self.origin_m + x[0] + self.lead_m, x[1] + self.lead_mps);
        let train = self.line.train;
        let mean_gradient = self.line.track.mean_gradient(s, train.length_m(), self.line.direction);
        let gain = if N > 5 { x[5] } else { 1.0 };
        gain * self.effort_n_per_kg - x[2] - x[3] * v - x[4] * v * v - train.gravity_n_per_kg() * mean_gradient
    }

    /// f(x) of Eq. (3).
    pub fn advance<const N: usize>(&self, x: &SVector<f64, N>) -> SVector<f64, N> {
        let a = self.acceleration_mps2(x);
        let mut next = *x;
        next[0] += self.line.direction.sign() * (self.dt_s * x[1] + 0.5 * self.dt_s * self.dt_s * a);
        next[1] += self.dt_s * a;
        next
    }

    /// Q: white noise in the acceleration, constant over the step.
    pub fn noise<const N: usize>(&self, noise_mps2: f64) -> SMatrix<f64, N, N> {
        let mut moved = SVector::<f64, N>::zeros();
        moved[0] = self.line.direction.sign() * 0.5 * self.dt_s * self.dt_s * noise_mps2;
        moved[1] = self.dt_s * noise_mps2;
        moved * moved.transpose()
    }
}
