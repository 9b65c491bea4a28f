//! The noise of interval residuals, and its removal.
//!
//! Neighbouring intervals share a reading of the speed, so their errors are anticorrelated:
//!
//! ```text
//! var(y_i) = q² 2/dt² + a² + (c |Δu_i|)²        cov(y_i, y_i+1) = -q²/(dt_i dt_i+1)
//! ```
//!
//! with q the error of a reading (rounding included), a a disturbance of the acceleration, c the share of a change of
//! the effort by which its mean is uncertain. On top, each run has its own wind, load and effort gain: columns Z with
//! variances D. A whitened column is S L⁻¹ x with L Lᵀ = V and S = (I + Z̃ D Z̃ᵀ)^(-1/2); in whitened rows ordinary
//! least squares is right. What all runs have alike with a prior (the gain of the effort column) comes on top in the
//! same way.

use crate::data::interval::{Interval, SAME_TIME_S};
use core::ops::Range;
use nalgebra::{DMatrix, DVector};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Of a reading of the speed, q, m/s.
    pub reading_mps: f64,
    /// Of the acceleration over an interval, a, m/s².
    pub acceleration_mps2: f64,
    /// Share of a change of the effort, c.
    pub change_share: f64,
}

impl Noise {
    /// Variance of the acceleration over an interval, without the error of its readings, (m/s²)².
    pub fn disturbance(&self, interval: &Interval) -> f64 {
        let change = self.change_share * interval.effort_change_n_per_kg;
        self.acceleration_mps2 * self.acceleration_mps2 + change * change
    }
}

/// Cholesky factor of the tridiagonal covariance, row by row, and per-run random effects.
#[derive(Clone, Debug)]
pub struct Whitening {
    runs: Vec<Range<usize>>,
    diagonal: Vec<f64>,
    below: Vec<f64>,
    /// For each run an orthonormal basis U of its own columns and 1 - 1/√(1 + d²) for each.
    own: Vec<(DMatrix<f64>, DVector<f64>)>,
    /// The same of what all runs have alike.
    common: Option<(DMatrix<f64>, DVector<f64>)>,
    log_determinant: f64,
}

impl Whitening {
    /// `spread` is a factor on the standard deviation of each row, 1 unless it is an outlier.
    pub fn new(intervals: &[&Interval], noise: &Noise, spread: &[f64]) -> Self {
        let count = intervals.len();
        let mut runs: Vec<Range<usize>> = Vec::new();
        let (mut diagonal, mut below) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut log_determinant = 0.0;
        let q2 = noise.reading_mps * noise.reading_mps;
        for (i, interval) in intervals.iter().enumerate() {
            let before = i.checked_sub(1).map(|j| intervals[j]);
            match runs.last_mut() {
                Some(range) if before.is_some_and(|b| b.run == interval.run) => range.end = i + 1,
                _ => runs.push(i..i + 1),
            }
            let beyond = 2.0 * q2 / (interval.dt_s * interval.dt_s) + noise.disturbance(interval);
            let variance = beyond * spread[i] * spread[i];
            let neighbours = before.is_some_and(|b| adjacent(b, interval));
            let off = match before {
                Some(b) if neighbours => -q2 / (b.dt_s * interval.dt_s) / diagonal[i - 1],
                _ => 0.0,
            };
            // The inflated variance of an outlier only adds to the diagonal, so the rest stays positive.
            let rest = (variance - off * off).max(1e-12);
            diagonal.push(rest.sqrt());
            below.push(off);
            log_determinant += 0.5 * rest.ln();
        }
        Self { own: Vec::new(), common: None, runs, diagonal, below, log_determinant }
    }

    /// Adds per-run random effects: columns (not whitened) with their standard deviations.
    pub fn with_own(mut self, columns: &[(&[f64], f64)]) -> Self {
        let whitened: Vec<(Vec<f64>, f64)> =
            columns.iter().filter(|(_, sd)| *sd > 0.0).map(|(column, sd)| (self.factor(column), *sd)).collect();
        if whitened.is_empty() {
            return self;
        }
        let mut own = Vec::with_capacity(self.runs.len());
        for range in &self.runs {
            let z =
                DMatrix::from_fn(range.len(), whitened.len(), |i, k| whitened[k].0[range.start + i] * whitened[k].1);
            let svd = z.svd(true, false);
            let d = svd.singular_values;
            self.log_determinant += d.iter().map(|d| 0.5 * (1.0 + d * d).ln()).sum::<f64>();
            let shrink = d.map(|d| 1.0 - 1.0 / (1.0 + d * d).sqrt());
            own.push((svd.u.unwrap_or_else(|| DMatrix::zeros(range.len(), shrink.len())), shrink));
        }
        self.own = own;
        self
    }

    /// Adds what all runs have alike: columns (not whitened) with the standard deviations of their priors around zero.
    pub fn with_common(mut self, columns: &[(Vec<f64>, f64)]) -> Self {
        let acts = |column: &[f64]| column.iter().any(|value| *value != 0.0);
        let acting = columns.iter().filter(|(column, sd)| *sd > 0.0 && acts(column));
        let white: Vec<DVector<f64>> = acting.map(|(column, sd)| self.whiten(column) * *sd).collect();
        if white.is_empty() {
            return self;
        }
        let z = DMatrix::from_columns(&white);
        // Of hundreds of columns far less work than their singular values, and what is lost is rounding beside 1.
        let eigen = z.tr_mul(&z).symmetric_eigen();
        let squares = eigen.eigenvalues.map(|square| square.max(0.0));
        self.log_determinant += squares.iter().map(|square| 0.5 * square.ln_1p()).sum::<f64>();
        let least = f64::EPSILON * squares.max();
        let acting: Vec<usize> = (0..squares.len()).filter(|k| squares[*k] > least).collect();
        let scaled = acting.iter().map(|k| eigen.eigenvectors.column(*k) / squares[*k].sqrt());
        let scaled: Vec<DVector<f64>> = scaled.collect();
        let shrink =
            DVector::from_iterator(acting.len(), acting.iter().map(|k| 1.0 - 1.0 / (1.0 + squares[*k]).sqrt()));
        self.common = (!acting.is_empty()).then(|| (z * DMatrix::from_columns(&scaled), shrink));
        self
    }

    pub fn runs(&self) -> &[Range<usize>] {
        &self.runs
    }

    /// ½ log det of the covariance.
    pub fn log_determinant(&self) -> f64 {
        self.log_determinant
    }

    /// L⁻¹ x.
    fn factor(&self, column: &[f64]) -> Vec<f64> {
        let mut whitened: Vec<f64> = Vec::with_capacity(column.len());
        for (i, value) in column.iter().enumerate() {
            let before = if i == 0 { 0.0 } else { whitened[i - 1] };
            whitened.push((value - self.below[i] * before) / self.diagonal[i]);
        }
        whitened
    }

    /// S L⁻¹ x.
    pub fn whiten(&self, column: &[f64]) -> DVector<f64> {
        let mut whitened = DVector::from_vec(self.factor(column));
        for (range, (u, shrink)) in self.runs.iter().zip(&self.own) {
            let mut rows = whitened.rows_mut(range.start, range.len());
            let along = u.tr_mul(&rows).component_mul(shrink);
            rows -= u * along;
        }
        if let Some((u, shrink)) = &self.common {
            let along = u.tr_mul(&whitened).component_mul(shrink);
            whitened -= u * along;
        }
        whitened
    }
}

/// Whether two intervals share a reading.
fn adjacent(before: &Interval, interval: &Interval) -> bool {
    interval.follows
        && before.run == interval.run
        && (before.begin_s + before.dt_s - interval.begin_s).abs() < SAME_TIME_S
}
