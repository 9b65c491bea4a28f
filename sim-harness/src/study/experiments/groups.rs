//! Do groups of runs differ by more than the runs within them? One-way analysis of variance with a permutation test
//! over the labels.
//!
//! The test needs no distribution: under the hypothesis that the label says nothing every assignment of labels to runs
//! is as probable.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rundown_files::statistics::{mean_of, squares_about};

pub const PERMUTATIONS: usize = 999;

/// Variance between the groups' means over that within them, each by its degrees of freedom; none with fewer than two
/// groups or no spread.
fn f_ratio(values: &[f64], labels: &[usize]) -> Option<f64> {
    let groups = labels.iter().max()? + 1;
    let (mut sums, mut counts) = (vec![0.0; groups], vec![0.0; groups]);
    for (value, label) in values.iter().zip(labels) {
        sums[*label] += value;
        counts[*label] += 1.0;
    }
    let filled = counts.iter().filter(|count| **count > 0.0).count();
    let all = values.len() as f64;
    let mean = mean_of(values);
    let of_groups = sums.iter().zip(&counts).filter(|(_, count)| **count > 0.0);
    let between: f64 = of_groups.map(|(sum, count)| count * (sum / count - mean).powi(2)).sum();
    let total = squares_about(mean, values);
    let within = (total - between) / (all - filled as f64);
    let ratio = between / (filled as f64 - 1.0) / within;
    ratio.is_finite().then_some(ratio)
}

/// Share of the permutations of the labels, the true one included, that set the groups at least as far apart.
pub fn p_value(values: &[f64], labels: &[usize], seed: u64) -> Option<f64> {
    let found = f_ratio(values, labels)?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut drawn = labels.to_vec();
    let mut as_far = 1;
    for _ in 0..PERMUTATIONS {
        drawn.shuffle(&mut rng);
        as_far += usize::from(f_ratio(values, &drawn).is_some_and(|ratio| ratio >= found));
    }
    Some(as_far as f64 / (PERMUTATIONS + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_that_lie_apart_are_found_and_others_are_not() {
        let labels: Vec<usize> = (0..30).map(|i| i % 3).collect();
        let noise = |i: usize| ((i * 7919) % 101) as f64 / 101.0;
        let apart: Vec<f64> = (0..30).map(|i| noise(i) + (i % 3) as f64).collect();
        let alike: Vec<f64> = (0..30).map(noise).collect();
        assert_eq!(p_value(&apart, &labels, 1), Some(0.001));
        assert!(p_value(&alike, &labels, 1).unwrap() > 0.05);
    }

    #[test]
    fn a_textbook_ratio() {
        // Means 2, 3, 7 of three values each: between 42/2, within 6/6.
        let values = [1.0, 2.0, 3.0, 2.0, 3.0, 4.0, 6.0, 7.0, 8.0];
        let ratio = f_ratio(&values, &[0, 0, 0, 1, 1, 1, 2, 2, 2]).unwrap();
        assert!((ratio - 21.0).abs() < 1e-12, "{ratio}");
    }

    #[test]
    fn one_group_or_no_spread_says_nothing() {
        assert_eq!(p_value(&[1.0, 2.0], &[0, 0], 1), None);
        assert_eq!(p_value(&[1.0, 1.0, 1.0], &[0, 1, 1], 1), None);
    }
}
