//! Least squares in whitened rows, with runs as the unit.

use core::ops::Range;
use nalgebra::{DMatrix, DVector};
use rundown_files::statistics::sorted;

/// Log-likelihood that a value at the end of its 95 % interval loses: half the square of
/// [`HALF_95`](rundown_check::figure::HALF_95).
pub const LOSS_AT_LIMIT: f64 = 1.92;

/// Log of the number of ways to choose `chosen` of `all` runs, about.
pub fn choices(chosen: usize, all: usize) -> f64 {
    let p = (chosen as f64 / all as f64).clamp(1e-9, 1.0 - 1e-9);
    -(all as f64) * (p * p.ln() + (1.0 - p) * (1.0 - p).ln()) + 0.5 * (all as f64).ln()
}

/// Share of the runs that are of a second kind, by expectation and maximisation. `expected`: how many of them are,
/// under a share.
pub fn mixed_share(runs: usize, rounds: usize, most: f64, mut expected: impl FnMut(f64) -> f64) -> f64 {
    let runs = runs as f64;
    (0..rounds).fold(0.2, |share, _| (expected(share) / runs).clamp(0.5 / runs, most))
}

/// Odds that a run is of the second kind, whose gain of log-likelihood that is.
pub fn mixed_odds(share: f64, gain: f64) -> f64 {
    share * gain.clamp(-500.0, 500.0).exp() / (1.0 - share)
}

/// What runs of two kinds gain together, log-likelihood: of which kind each is, is integrated out.
pub fn mixed_gain(share: f64, gains: impl Iterator<Item = f64>) -> f64 {
    gains.map(|gain| (1.0 - share).ln() + mixed_odds(share, gain).ln_1p()).sum()
}

/// Of normal equations: log of the root of the determinant, and what of the squares their solution explains.
pub fn explained(gram: DMatrix<f64>, with: &DVector<f64>) -> Option<(f64, f64)> {
    let cholesky = gram.cholesky()?;
    Some((cholesky.l_dirty().diagonal().iter().map(|d| d.ln()).sum(), with.dot(&cholesky.solve(with))))
}

/// A coordinate search: each coordinate is moved by its step to either side as long as that gains, then the steps are
/// made smaller.
pub struct Climb<const N: usize> {
    pub steps: [f64; N],
    /// Factor on the steps.
    pub shrink: f64,
    /// Rounds; the steps are made smaller after each. 0: only after a round without a move, as long as the first step
    /// is above `least`.
    pub rounds: usize,
    /// The least first step.
    pub least: f64,
    /// A gain by less is none.
    pub better: f64,
    /// Which side first: 1 or -1.
    pub first: f64,
    /// Both sides are looked at from where the coordinate stood; else the second from where the first led.
    pub both: bool,
    /// No coordinate goes beyond.
    pub range: (f64, f64),
}

pub const ANYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

impl<const N: usize> Climb<N> {
    /// From a point on; `gain` is `None` where the search may not go. Where it ends, with its gain.
    pub fn from(&self, mut at: [f64; N], gain: impl Fn([f64; N]) -> Option<f64>) -> ([f64; N], f64) {
        let mut most = gain(at).unwrap_or(f64::NEG_INFINITY);
        let (mut steps, mut round) = (self.steps, 0);
        while if self.rounds > 0 { round < self.rounds } else { steps[0] > self.least } {
            let mut moved = false;
            for which in 0..N {
                let stood = at[which];
                for by in [self.first * steps[which], -self.first * steps[which]] {
                    let mut other = at;
                    let from = if self.both { stood } else { at[which] };
                    other[which] = (from + by).clamp(self.range.0, self.range.1);
                    if let Some(now) = gain(other).filter(|now| *now > most + self.better) {
                        (at, most, moved) = (other, now, true);
                    }
                }
            }
            round += 1;
            if self.rounds > 0 || !moved {
                steps.iter_mut().for_each(|step| *step *= self.shrink);
            }
        }
        (at, most)
    }
}

/// Neighbours that are more alike make no finite variance of a mean.
const MOST_ALIKE: f64 = 0.9;

/// A design in whitened rows, reduced to what fits need.
#[derive(Clone, Debug)]
pub struct Base {
    /// Whitened columns of the current model.
    x: DMatrix<f64>,
    /// (XᵀX)⁻¹.
    inverse: DMatrix<f64>,
    pub beta: DVector<f64>,
    pub residual: DVector<f64>,
    runs: Vec<Range<usize>>,
}

#[derive(Clone, Debug)]
pub struct Gain {
    /// Coefficients of the further columns.
    pub beta: DVector<f64>,
    /// Their covariance as the noise model has it.
    pub naive: DMatrix<f64>,
    /// Their covariance from the spread between runs.
    pub robust: DMatrix<f64>,
    /// Gain of log-likelihood under the noise model.
    pub naive_gain: f64,
    /// The same, but no more than the spread between runs allows.
    pub gain: f64,
    /// The gain without the tenth of the runs that gain most, scaled up to all runs.
    pub without_best: f64,
}

fn inverse(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    // Columns of very different size: scaled to ones on the diagonal first.
    let scale = matrix.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
    let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
        matrix[(i, j)] * scale[i] * scale[j] + if i == j { 1e-10 } else { 0.0 }
    });
    let inverse = scaled.cholesky()?.inverse();
    Some(DMatrix::from_fn(inverse.nrows(), inverse.ncols(), |i, j| inverse[(i, j)] * scale[i] * scale[j]))
}

impl Base {
    /// How many times wider than the noise says differences of the log-likelihood scatter, at least 1: the mean square
    /// of what is left, which should be 1, times what neighbours that are alike add to the variance of a mean.
    /// (Overdispersion; Burnham and Anderson 2002; autocorrelation of first order.)
    pub fn dispersion(&self) -> f64 {
        let free = self.residual.len().saturating_sub(self.x.ncols()).max(1);
        let squares = self.residual.norm_squared();
        let left = &self.residual;
        let of_run = |run: &Range<usize>| (run.start + 1..run.end).map(|i| left[i - 1] * left[i]).sum::<f64>();
        let alike = self.runs.iter().map(of_run).sum::<f64>() / squares.max(f64::MIN_POSITIVE);
        let alike = alike.clamp(0.0, MOST_ALIKE);
        (squares / free as f64 * (1.0 + alike) / (1.0 - alike)).max(1.0)
    }

    /// Fits the current model. `None` if its columns are not independent.
    pub fn new(y: &DVector<f64>, columns: &[DVector<f64>], runs: &[Range<usize>]) -> Option<Self> {
        let x = if columns.is_empty() { DMatrix::zeros(y.len(), 0) } else { DMatrix::from_columns(columns) };
        let inverse = inverse(x.transpose() * &x)?;
        let beta = &inverse * x.tr_mul(y);
        let residual = y - &x * &beta;
        Some(Self { x, inverse, beta, residual, runs: runs.to_vec() })
    }

    /// A column with the current model projected out.
    pub fn beside(&self, column: &DVector<f64>) -> DVector<f64> {
        if self.x.ncols() == 0 {
            return column.clone();
        }
        column - &self.x * (&self.inverse * self.x.tr_mul(column))
    }

    /// A Gram matrix of columns with the current model projected out.
    pub fn project(&self, columns: &DMatrix<f64>, gram: &DMatrix<f64>) -> DMatrix<f64> {
        if self.x.ncols() == 0 {
            return gram.clone();
        }
        let with = self.x.transpose() * columns;
        gram - with.transpose() * &self.inverse * with
    }

    pub fn half_sum(&self) -> f64 {
        0.5 * self.residual.norm_squared()
    }

    /// Covariance of the coefficients as the noise model has it.
    pub fn naive(&self) -> &DMatrix<f64> {
        &self.inverse
    }

    /// Covariance of the coefficients from the spread between runs.
    pub fn robust(&self) -> DMatrix<f64> {
        let scores = self.scores(&self.x, &self.residual);
        let count = self.runs.len() as f64;
        let correction = count / (count - 1.0).max(1.0);
        &self.inverse * (&scores * scores.transpose()) * &self.inverse * correction
    }

    fn scores(&self, x: &DMatrix<f64>, residual: &DVector<f64>) -> DMatrix<f64> {
        let mut scores = DMatrix::zeros(x.ncols(), self.runs.len());
        for (k, range) in self.runs.iter().enumerate() {
            let score = x.rows(range.start, range.len()).tr_mul(&residual.rows(range.start, range.len()));
            scores.set_column(k, &score);
        }
        scores
    }

    /// What these whitened columns bring beside the current model.
    pub fn gain(&self, columns: &[DVector<f64>]) -> Option<Gain> {
        if columns.is_empty() {
            return None;
        }
        let x = DMatrix::from_columns(&columns.iter().map(|c| self.beside(c)).collect::<Vec<_>>());
        let naive = inverse(x.transpose() * &x)?;
        let beta = &naive * x.tr_mul(&self.residual);
        let left = &self.residual - &x * &beta;
        let scores = self.scores(&x, &left);
        let count = self.runs.len() as f64;
        let correction = count / (count - beta.len() as f64).max(1.0);
        let robust = &naive * (&scores * scores.transpose()) * &naive * correction;
        let naive_gain = 0.5 * (self.residual.norm_squared() - left.norm_squared());
        let of_runs = sorted(self.runs.iter().map(|range| {
            let sum = |e: &DVector<f64>| e.rows(range.start, range.len()).norm_squared();
            0.5 * (sum(&self.residual) - sum(&left))
        }));
        let kept = of_runs.len() - (of_runs.len() / 10).max(1).min(of_runs.len());
        let without_best = of_runs[..kept].iter().sum::<f64>() * of_runs.len() as f64 / kept.max(1) as f64;
        // How much wider the spread between runs is than the noise model says, over the directions of these columns.
        let wider = robust.diagonal().iter().zip(naive.diagonal().iter()).map(|(r, n)| r / n).fold(1.0, f64::max);
        Some(Gain { gain: naive_gain / wider, naive_gain, without_best, beta, naive, robust })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Of 40 runs of 50 rows that scatter so many times wider than the noise says, each row with a share of the one
    /// before.
    fn dispersion(wider: f64, carried: f64) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut before = 0.0;
        let y = DVector::from_fn(2000, |_, _| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            before = carried * before + (1.0 - carried * carried).sqrt() * noise;
            wider * before
        });
        let runs: Vec<Range<usize>> = (0..40).map(|run| 50 * run..50 * (run + 1)).collect();
        Base::new(&y, &[DVector::from_element(2000, 1.0)], &runs).unwrap().dispersion()
    }

    #[test]
    fn log_likelihoods_scatter_wider_where_the_noise_is_wider_or_neighbours_are_alike() {
        assert!((1.0..1.15).contains(&dispersion(1.0, 0.0)));
        assert_eq!(dispersion(0.5, 0.0), 1.0, "less noise than was said makes nothing surer");
        assert!((dispersion(2.0, 0.0) / 4.0 - 1.0).abs() < 0.15);
        // (1 + 0.5) / (1 - 0.5)
        assert!((dispersion(1.0, 0.5) / 3.0 - 1.0).abs() < 0.2, "{}", dispersion(1.0, 0.5));
    }
}
