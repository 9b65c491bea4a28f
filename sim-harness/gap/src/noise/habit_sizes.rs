//! How large what drivers do alike is in these runs: by restricted likelihood, beside a model that takes up any effect.
//!
//! What differs between driven and coasting rows of the same place and speed, and from part to part of the line, is
//! habit; what they have alike is not. The sizes of powering and of braking are the likeliest by
//!
//! ```text
//! -½ log |I + D G D| + ½ b' D (I + D G D)⁻¹ D b        G = Z' M Z, b = Z' M y
//! ```
//!
//! with Z the habits, D their standard deviations and M what a flexible model leaves of whitened rows.

use crate::fit::explained;
use nalgebra::{DMatrix, DVector};

/// Sizes that are tried: from the most that a habit may be, each this factor above the next, and none. The smallest is
/// a hundredth of the most, which is as good as none.
const STEP: f64 = 1.25;
const STEPS: i32 = 21;

/// What is known of the habits.
pub struct Habits {
    /// Of the whitened columns beside the flexible model.
    gram: DMatrix<f64>,
    /// Their products with what the model leaves of the residuals.
    with: DVector<f64>,
    /// Of each column, which of the two sizes is its standard deviation.
    of: Vec<usize>,
}

impl Habits {
    /// `columns`: whitened, beside the flexible model, as `residual` is; each with its size.
    pub fn new(columns: &[(DVector<f64>, usize)], residual: &DVector<f64>) -> Self {
        let of = columns.iter().map(|(_, of)| *of).collect();
        let rows = residual.len();
        let z = DMatrix::from_fn(rows, columns.len(), |i, k| columns[k].0[i]);
        Self { gram: z.tr_mul(&z), with: z.tr_mul(residual), of }
    }

    /// Restricted log-likelihood of two sizes, N/kg.
    fn likelihood(&self, sizes: [f64; 2]) -> f64 {
        let sd: Vec<f64> = self.of.iter().map(|of| sizes[*of]).collect();
        let mut inner = DMatrix::from_fn(sd.len(), sd.len(), |i, j| sd[i] * self.gram[(i, j)] * sd[j]);
        (0..sd.len()).for_each(|i| inner[(i, i)] += 1.0);
        let with = DVector::from_fn(sd.len(), |i, _| sd[i] * self.with[i]);
        explained(inner, &with).map_or(f64::NEG_INFINITY, |(log_root, explained)| 0.5 * explained - log_root)
    }

    /// The likeliest sizes, N/kg, none of them more than `most`: what drivers do cannot scatter more than driven rows
    /// do, and an effect that powered rows show is not to be taken for it.
    pub fn sizes(&self, most: [f64; 2]) -> [f64; 2] {
        let tried = |most: f64| -> Vec<f64> {
            let some = (0..STEPS).map(|step| most * STEP.powi(-step));
            if most > 0.0 { some.chain([0.0]).collect() } else { vec![0.0] }
        };
        let braking = tried(most[1]);
        let pairs =
            tried(most[0]).into_iter().flat_map(|powering| braking.iter().map(move |braking| [powering, *braking]));
        let scored = pairs.map(|pair| (self.likelihood(pair), pair));
        scored.max_by(|a, b| a.0.total_cmp(&b.0)).map_or([0.0; 2], |(_, pair)| pair)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Standard deviation of a force of braking, where 24 parts of the line have 40 rows of noise 1 each.
    fn found(size: f64, seed: u64) -> [f64; 2] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let (parts, rows) = (24, 24 * 40);
        let column = |part: usize| DVector::from_fn(rows, |i, _| f64::from(i % parts == part));
        let columns: Vec<(DVector<f64>, usize)> = (0..parts).map(|part| (column(part), 1)).collect();
        let mut residual = DVector::from_fn(rows, |_, _| normal());
        columns.iter().for_each(|(column, _)| residual += column * (size * normal()));
        Habits::new(&columns, &residual).sizes([1.0, 2.0])
    }

    #[test]
    fn a_habit_is_as_large_as_it_differs_from_part_to_part() {
        let mean = |size: f64| (0..20).map(|seed| found(size, seed)[1]).sum::<f64>() / 20.0;
        assert!(mean(0.0) < 0.06, "{}", mean(0.0));
        assert!((mean(1.0) - 1.0).abs() < 0.15, "{}", mean(1.0));
        assert_eq!(found(5.0, 1)[1], 2.0, "no more than it may be");
    }
}
