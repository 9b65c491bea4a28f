//! A run whose effort column is unlike that of the other runs: it stands still, reads half, is cut off, or is another
//! train's.
//!
//! In: rows of all runs of a unit, put right. Out: the acceleration that a run has for its effort, beside that of the
//! usual run.
//!
//! ```text
//! Δv/Δt = k e - r0 - r2 v² + noise
//! ```
//!
//! `k` is 1 of a column in N/kg of the moving mass, and the same in all runs of a unit but for its load. Gradients are
//! noise here.

use crate::effort::{least_squares, stretches, window};
use crate::figure::Figure;
use nalgebra::Vector3;
use rundown_files::sample::Sample;
use rundown_files::statistics::{mean_of, median_of, spread, squares_about};

/// Windows are at least so long, s: the effort of a second earlier or later does not matter.
const WINDOW_S: f64 = 10.0;
/// So many windows, and accelerations that differ by so much, m/s² (standard deviation), show how a train answers to
/// its effort.
const LEAST_WINDOWS: usize = 20;
const LEAST_CHANGE_MPS2: f64 = 0.08;
/// The usual run is known from so many.
const LEAST_RUNS: usize = 6;
/// Loads make less than this, as a share.
const LEAST_OFF: f64 = 0.25;
/// So many standard deviations, its own and those between runs.
const SURE: f64 = 5.0;
/// Neighbours have gradients in common: so much wider is the scatter of a fit than that of rows that know nothing of
/// each other.
const WIDER: f64 = 1.5;

/// What explains the answer of the train in a window, and that, m/s².
type Answered = (Vector3<f64>, f64);

/// None where the train stands at one of the ends.
fn answered(rows: &[Sample]) -> Option<Answered> {
    let (acceleration_mps2, effort) = window(rows)?;
    let [first, last] = [rows.first()?.speed_mps?, rows.last()?.speed_mps?];
    let mean = 0.5 * (first + last);
    (first.min(last) > 0.0).then(|| (Vector3::new(effort, 1.0, mean * mean), acceleration_mps2))
}

/// The acceleration that a run has for its effort: 0 where the column stands still. None where too little of it powers
/// and brakes.
pub(crate) fn of_run(rows: &[Sample]) -> Option<Figure> {
    let windows: Vec<Answered> = stretches(rows, WINDOW_S).into_iter().filter_map(answered).collect();
    let n = windows.len() as f64;
    let changes: Vec<f64> = windows.iter().map(|(_, change)| *change).collect();
    let scatter = (squares_about(mean_of(&changes), &changes) / n).sqrt();
    if windows.len() < LEAST_WINDOWS || scatter < LEAST_CHANGE_MPS2 {
        return None;
    }
    let effort = windows[0].0[0];
    if windows.iter().all(|(x, _)| (x[0] - effort).abs() < 1e-9) {
        return Some(Figure { value: 0.0, sd: 0.0 });
    }
    let (beta, inverse, left) = least_squares(&windows)?;
    Some(Figure { value: beta[0], sd: WIDER * (left / (n - 3.0) * inverse[(0, 0)]).sqrt() })
}

/// Of these runs the ones that are unlike the usual one, by their places: what they have for their effort, over what
/// the usual run has.
pub(crate) fn unlike(runs: &[Option<Figure>]) -> Vec<(usize, Figure)> {
    let values: Vec<f64> = runs.iter().flatten().map(|one| one.value).collect();
    if values.len() < LEAST_RUNS {
        return Vec::new();
    }
    let usual = median_of(&values);
    if usual <= 0.0 {
        return Vec::new();
    }
    let between = spread(values.iter().map(|value| value - usual));
    let is_unlike = |one: &Figure| {
        let off = (one.value - usual).abs();
        off > LEAST_OFF * usual && off > SURE * one.sd.hypot(between)
    };
    let found = runs.iter().enumerate().filter_map(|(place, one)| Some((place, one.filter(is_unlike)?)));
    found.map(|(place, one)| (place, Figure { value: one.value / usual, sd: one.sd.hypot(between) / usual })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// A train that starts, coasts and brakes on slopes; its column holds what `reads` makes of the effort.
    fn run(seed: u64, reads: impl Fn(f64) -> f64) -> Vec<Sample> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (mut rows, mut mps, mut slope) = (Vec::new(), 0.0_f64, 0.0);
        for second in 0..1500 {
            if second % 40 == 0 {
                slope = rng.random_range(-0.05..0.05);
            }
            let effort = match second % 300 {
                0..80 => 0.4,
                80..220 => 0.0,
                _ => -0.5,
            };
            mps = (mps + effort - 0.02 - 2e-5 * mps * mps - slope).max(0.0);
            rows.push(Sample {
                time_s: f64::from(second),
                speed_mps: Some(mps + rng.random_range(-0.05..0.05)),
                effort_n_per_kg: Some(reads(effort + rng.random_range(-0.005..0.005))),
                ..Sample::default()
            });
        }
        rows
    }

    fn found(odd: impl Fn(f64) -> f64, seed: u64) -> Vec<usize> {
        let runs = (0..10).map(|i| if i == 3 { of_run(&run(seed, &odd)) } else { of_run(&run(seed + 1 + i, |e| e)) });
        unlike(&runs.collect::<Vec<_>>()).into_iter().map(|(place, _)| place).collect()
    }

    #[test]
    fn a_run_that_answers_otherwise_to_its_effort_is_found() {
        for seed in [10, 30, 50] {
            assert_eq!(found(|effort| 0.5 * effort, seed), [3], "half");
            assert_eq!(found(|_| 0.1, seed), [3], "stands still");
            assert_eq!(found(|effort| -effort, seed), [3], "turned");
            assert_eq!(found(|effort| effort, seed), [0; 0], "like the others");
            assert_eq!(found(|effort| 1.08 * effort, seed), [0; 0], "another load");
        }
    }

    #[test]
    fn a_column_that_stands_still_in_one_run_answers_by_nothing() {
        let mut rows = run(7, |effort| effort);
        rows.iter_mut().for_each(|row| row.effort_n_per_kg = Some(0.2));
        assert_eq!(of_run(&rows), Some(Figure { value: 0.0, sd: 0.0 }));
        assert_eq!(of_run(&rows[80..200]), None, "a coast alone says nothing");
    }
}
