//! Speeds that are means over some seconds around their time, beside momentary efforts.
//!
//! In: rows of all runs of a unit, put right. Out: over how long the speeds are means; the efforts averaged over as
//! long, so that both are of the same moments.
//!
//! ```text
//! ∫ v_read dt - x = (L²/24 - τ²/2) a - τ v_read + offset t + scale x + noise          in each window of 40 s, less its mean
//! ```
//!
//! A mean over L s is the true speed plus L²/24 of its second derivative, whatever its shape: L²/12 is the variance of
//! its weights. A speed that is read momentarily has none of it, but for the trapezia of the integral, which add Δt²/12
//! between rows Δt apart, and this is taken off. Means of speed, resistance and effort over the same time belong
//! together; a momentary effort beside a mean speed makes a start look like a resistance.

use crate::effort;
use crate::figure::Figure;
use crate::rows::times::usual_step_s;
use nalgebra::SVector;
use rundown_files::sample::Sample;
use rundown_files::statistics::mean;
use std::ops::Range;

/// Speeds in larger steps show what is none: eight metros in whole km/h had means over 15 s, by seven standard
/// deviations. km/h.
pub(crate) const MOST_STEP_KMH: f64 = 0.5;
/// Rows farther apart do not show it, s: a window has too few of them.
const MOST_STEP_S: f64 = 6.0;
/// Windows, and the time on both sides of a row over which its acceleration is taken, or a row, s.
const WINDOW_S: f64 = 40.0;
const BESIDE_S: f64 = 4.0;
/// A slower train reads what its recorder makes of a stop, m/s.
const LEAST_MPS: f64 = 3.0;
/// So many rows in a run, so much of its time, s, and so many runs, whose scatter says how sure the figure is.
const LEAST_ROWS: usize = 60;
const LEAST_S: f64 = 200.0;
const LEAST_RUNS: usize = 4;
/// Shorter means do not matter, s.
const SHORTEST_S: f64 = 5.0;
/// So many standard deviations.
const SURE: f64 = 6.0;
/// Averaged efforts leave less than this share of the squares unexplained: above 0.99 where they had been averaged with
/// the speeds, 0.03 to 0.95 where they had not.
const BETTER: f64 = 0.95;
/// Beside longer means the efforts are left out, s: on slopes of 14 permille those of 15 s put r(60 km/h) 19 % off, for
/// gradients are no means.
pub(crate) const MOST_S: f64 = 12.0;
/// The acceleration is itself taken over some seconds, of speeds that are means: where a train powers and brakes for
/// less than a minute L comes out a fifth too large.
const SHAPE_SD: f64 = 0.15;

/// What explains the difference of both ways, and that, m.
pub(crate) type WayDifference = (SVector<f64, 4>, f64);

/// Over how long speeds are means, s; none where they are momentary, or too little shows it. A receiver whose locations
/// trail in a filter shows the same: only the efforts decide, see [`averaged_efforts`].
pub(crate) fn of(runs: &[&[Sample]]) -> Option<Figure> {
    let of_run = |rows: &&[Sample]| {
        let step_s = usual_step_s(rows);
        second_order(&compared(rows, step_s), step_s)
    };
    let found: Vec<Figure> = runs.iter().filter_map(of_run).collect();
    if found.len() < LEAST_RUNS {
        return None;
    }
    // The noise of neighbouring rows is one: what runs differ by says how sure they are.
    let Figure { value: mean, sd } = Figure::mean_of(&found)?;
    let long_s = (24.0 * mean).max(0.0).sqrt();
    let figure = Figure { value: long_s, sd: (12.0 * sd / long_s).hypot(SHAPE_SD * long_s) };
    (long_s > SHORTEST_S && mean > SURE * sd).then_some(figure)
}

/// Efforts of each run as means over `long_s`; none where they explain the accelerations less well than the efforts as
/// they are, which were averaged with the speeds, or it is the locations that trail.
pub(crate) fn averaged_efforts(runs: &[&[Sample]], long_s: f64) -> Option<Vec<Vec<Option<f64>>>> {
    let averaged: Vec<Vec<Option<f64>>> = runs.iter().map(|rows| averaged(rows, long_s)).collect();
    let (mut as_read, mut as_means) = (0.0, 0.0);
    for (rows, efforts) in runs.iter().zip(&averaged) {
        let means = rows.iter().zip(efforts).map(|(row, effort)| Sample { effort_n_per_kg: *effort, ..*row });
        if let (Some(read), Some(means)) = (unexplained(rows), unexplained(&means.collect::<Vec<_>>())) {
            as_read += read;
            as_means += means;
        }
    }
    (as_means < BETTER * as_read).then_some(averaged)
}

pub(crate) fn averaged(rows: &[Sample], long_s: f64) -> Vec<Option<f64>> {
    let mut from = 0;
    let mean = |row: &Sample| {
        row.effort_n_per_kg?;
        from += rows[from..].iter().take_while(|other| other.time_s < row.time_s - 0.5 * long_s).count();
        let near = rows[from..].iter().take_while(|other| other.time_s <= row.time_s + 0.5 * long_s);
        mean(near.filter_map(|other| other.effort_n_per_kg))
    };
    rows.iter().map(mean).collect()
}

/// What efforts, a constant and squared speeds leave unexplained of the accelerations, (m/s²)².
fn unexplained(rows: &[Sample]) -> Option<f64> {
    let explained = |rows: &[Sample]| {
        let mps = rows.first()?.speed_mps?;
        let (acceleration, effort) = effort::window(rows).filter(|_| mps > LEAST_MPS)?;
        Some((SVector::from([effort, 1.0, mps * mps]), acceleration))
    };
    let rows: Vec<_> = effort::stretches(rows, BESIDE_S).into_iter().filter_map(explained).collect();
    effort::least_squares(&rows).map(|(.., left)| left)
}

/// The rows of the windows in which the train runs and each row has both readings.
fn compared(rows: &[Sample], step_s: f64) -> Vec<WayDifference> {
    let (mut found, mut begin) = (Vec::new(), 0);
    while begin < rows.len() && step_s <= MOST_STEP_S {
        let end = begin + rows[begin..].iter().take_while(|row| row.time_s < rows[begin].time_s + WINDOW_S).count();
        found.extend(window(rows, begin..end, BESIDE_S.max(step_s)).into_iter().flatten());
        begin = end;
    }
    found
}

fn window(rows: &[Sample], range: Range<usize>, beside_s: f64) -> Option<Vec<WayDifference>> {
    let (first, last) = (&rows[range.start], &rows[range.end - 1]);
    let begin_m = first.location_m?;
    let grows = last.location_m? >= begin_m;
    if last.time_s - first.time_s < 0.7 * WINDOW_S {
        return None;
    }
    let (mut integral_m, mut before) = (0.0, first);
    let mut found = Vec::new();
    for (at, row) in range.clone().zip(&rows[range.clone()]) {
        let mps = row.speed_mps.filter(|mps| *mps > LEAST_MPS)?;
        integral_m += 0.5 * (before.speed_mps? + mps) * (row.time_s - before.time_s);
        before = row;
        let way_m = if grows { row.location_m? - begin_m } else { begin_m - row.location_m? };
        let x = SVector::from([acceleration(rows, at, beside_s)?, mps, row.time_s - first.time_s, way_m]);
        found.push((x, integral_m - way_m));
    }
    let n = found.len() as f64;
    let (x, apart_m) = found.iter().fold((SVector::zeros(), 0.0), |(x, y), row| (x + row.0, y + row.1));
    found.iter_mut().for_each(|row| *row = (row.0 - x / n, row.1 - apart_m / n));
    Some(found)
}

/// Slope of the speed around a row, m/s².
fn acceleration(rows: &[Sample], at: usize, beside_s: f64) -> Option<f64> {
    let time_s = rows[at].time_s;
    let before = rows[..at].iter().rev().take_while(|row| row.time_s >= time_s - beside_s).last()?;
    let after = rows[at + 1..].iter().take_while(|row| row.time_s <= time_s + beside_s).last()?;
    let long_s = after.time_s - before.time_s;
    (long_s >= 1.5 * beside_s).then_some((after.speed_mps? - before.speed_mps?) / long_s)
}

/// L²/24 of a run, s², by least squares.
fn second_order(rows: &[WayDifference], step_s: f64) -> Option<Figure> {
    if rows.len() < LEAST_ROWS || rows.len() as f64 * step_s < LEAST_S {
        return None;
    }
    let (beta, inverse, left) = effort::least_squares(rows)?;
    let sd = (left / (rows.len() as f64 - 4.0) * inverse[(0, 0)]).sqrt();
    // Even without any noise no surer than the integral of rows a second apart.
    Some(Figure { value: beta[0] + 0.5 * beta[1] * beta[1] - step_s * step_s / 12.0, sd: sd.max(0.05) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Runs of a train that starts, coasts and brakes; speeds are means over `long_s`, and `lag_s` old.
    fn runs(seed: u64, long_s: usize, lag_s: usize, noise_m: f64) -> Vec<Vec<Sample>> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let run = |_| {
            let (mut mps, mut x_m, mut v, mut x) = (5.0_f64, 0.0, Vec::new(), Vec::new());
            let hop_s = rng.random_range(180..260);
            for second in 0..1500 {
                let a = match second % hop_s {
                    0..50 => 0.45,
                    50..150 => -0.03,
                    _ if mps > 5.0 => -0.6,
                    _ => 0.0,
                };
                (x_m, mps) = (x_m + mps + 0.5 * a, mps + a);
                v.push(mps);
                x.push(x_m);
            }
            let mean = |at: usize| {
                let of = &v[at - lag_s - long_s / 2..=at - lag_s + long_s / 2];
                of.iter().sum::<f64>() / of.len() as f64
            };
            let rows = (40..1400).map(|at| Sample {
                time_s: at as f64,
                location_m: Some(x[at - 1] + rng.random_range(-noise_m..noise_m)),
                speed_mps: Some(0.99 * mean(at - 1) + rng.random_range(-0.1..0.1)),
                ..Sample::default()
            });
            rows.collect()
        };
        (0..6).map(run).collect()
    }

    /// Every fifth row.
    fn coarse(runs: Vec<Vec<Sample>>) -> Vec<Vec<Sample>> {
        runs.into_iter().map(|rows| rows.into_iter().step_by(5).collect()).collect()
    }

    fn found(runs: &[Vec<Sample>]) -> Option<Figure> {
        of(&runs.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    #[test]
    fn the_time_of_means_is_found_beside_a_lag_and_a_wheel() {
        let mut held = 0;
        for seed in 0..10 {
            for (long_s, lag_s) in [(9, 0), (9, 3), (15, 0), (21, 2)] {
                let found = found(&runs(seed, long_s, lag_s, 3.0)).unwrap();
                assert!((found.value - long_s as f64).abs() < 0.12 * long_s as f64, "{long_s} {found:?}");
                held += usize::from((found.value - long_s as f64).abs() < 2.5 * found.sd);
            }
        }
        assert!(held >= 30, "{held} of 40");
    }

    #[test]
    fn momentary_speeds_are_no_means_whatever_their_lag() {
        for seed in 0..20 {
            for (lag_s, noise_m) in [(0, 1.0), (4, 5.0)] {
                assert_eq!(found(&runs(seed, 1, lag_s, noise_m)), None, "{seed}");
            }
        }
    }

    #[test]
    fn rows_five_seconds_apart_show_the_time_of_means_and_are_none_themselves() {
        for seed in 0..10 {
            for (long_s, lag_s) in [(9, 0), (15, 3), (25, 0)] {
                let found = found(&coarse(runs(seed, long_s, lag_s, 3.0))).unwrap();
                assert!((found.value - long_s as f64).abs() < 0.2 * long_s as f64, "{seed} {long_s} {found:?}");
            }
            assert_eq!(found(&coarse(runs(seed, 1, 4, 3.0))), None, "{seed}");
        }
    }

    #[test]
    fn efforts_become_means_over_as_long() {
        let row =
            |second: usize, effort| Sample { time_s: second as f64, effort_n_per_kg: effort, ..Sample::default() };
        let rows: Vec<Sample> = (0..9).map(|i| row(i, (i != 6).then_some(if i < 4 { 0.0 } else { 1.0 }))).collect();
        let efforts = averaged(&rows, 4.0);
        let expected = [0.0, 0.0, 0.2, 0.4, 0.5, 0.75, -1.0, 1.0, 1.0].map(|one| (one >= 0.0).then_some(one));
        assert_eq!(efforts, expected);
    }
}
