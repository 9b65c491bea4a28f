//! Whole steps of the speed that come only once it has changed by as much since the last one, as event recorders write
//! them.
//!
//! In: rows of all runs of a unit, as read. Out: by how much the speed that is shown stays behind.
//!
//! ```text
//! v     62.4  62.9  63.3  63.5  63.9  64.4        true
//!       62    62    62    63    63    64          rounded
//!       62    62    62    62    63    63          written again once it has changed by 1
//! ```
//!
//! Rounded speeds are too high as often as too low. These are too low while the train gains speed and too high while it
//! slows, so that each change from power to coasting hides some of the speed that was gained, and the measured mode
//! learns a resistance that is up to a tenth too small. The column itself does not show it, as finer ones do
//! (`stairs`); the locations do: in windows of 10 s
//!
//! ```text
//! way by location less way by speed = behind × (time rising less time falling) + offset t + scale x + skew Δv + noise
//! ```
//!
//! where rising and falling are the rows that repeat a speed after it has risen or fallen.

use crate::agreement::compared::{Row, SLOWEST_MPS, held_shares};
use crate::agreement::parts::parts;
use crate::effort::least_squares;
use crate::figure::Figure;
use crate::rows::times::usual_step_s;
use crate::speed::smoothed::WayDifference;
use nalgebra::SVector;
use rundown_files::sample::Sample;
use rundown_files::statistics::spread;

/// Smaller steps are asked by `stairs`, km/h.
const LEAST_STEP_KMH: f64 = 0.4;
/// With rows farther apart a speed hardly repeats but where it is held, s.
const MOST_STEP_S: f64 = 2.5;
/// Windows, s, and so many of a run.
const WINDOW_S: f64 = 10.0;
const LEAST_WINDOWS: usize = 20;
/// Share of the time of a reading in which the train did not pass it.
const MOST_HELD: f64 = 0.5;
/// Windows farther from the fit, in standard deviations, are leaps of the location.
const OUTLIER: f64 = 4.0;
/// So many runs agree, whose scatter says how sure the figure is, and by so many standard deviations.
const LEAST_RUNS: usize = 3;
const SURE: f64 = 6.0;
/// Half a step is what such speeds stay behind in the mean, less where the train passes several steps between two rows;
/// others have other causes.
const OF_STEP: core::ops::Range<f64> = 0.25..0.75;

/// By how much the speeds of these runs stay behind, km/h; none where they are rounded, or too little shows it.
pub(crate) fn behind_kmh<'a>(runs: impl Iterator<Item = &'a [Sample]>, step_kmh: f64) -> Option<Figure> {
    if step_kmh < LEAST_STEP_KMH {
        return None;
    }
    let of_runs: Vec<Figure> = runs.filter_map(of_run).collect();
    if of_runs.len() < LEAST_RUNS {
        return None;
    }
    let Figure { value, sd } = Figure::mean_of(&of_runs)?;
    let behind = Figure { value: 3.6 * value, sd: 3.6 * sd };
    let is_behind = OF_STEP.contains(&(behind.value / step_kmh)) && behind.value > SURE * behind.sd;
    is_behind.then_some(behind)
}

/// Leaves out speeds that repeat the one before, and counts them.
pub(crate) fn leave_out_repeats(rows: &mut [Sample]) -> usize {
    let (mut last, mut count) = (None, 0);
    for speed in rows.iter_mut().map(|row| &mut row.speed_mps) {
        let is_repeat = *speed == last && speed.is_some_and(|mps| mps > 0.0);
        last = *speed;
        if is_repeat {
            *speed = None;
            count += 1;
        }
    }
    count
}

/// By how much those of one run stay behind, m/s.
fn of_run(rows: &[Sample]) -> Option<Figure> {
    let step_s = usual_step_s(rows);
    if step_s > MOST_STEP_S {
        return None;
    }
    let mut windows: Vec<WayDifference> = parts(rows, step_s).iter().flat_map(|part| windows(part)).collect();
    for _ in 0..2 {
        let fit = fitted(&windows)?;
        let off = |(x, y): &WayDifference| (y - fit.0.dot(x)) / fit.1;
        windows.retain(|window| off(window).abs() < OUTLIER);
    }
    let (coefficients, noise_m, variance) = fitted(&windows)?;
    (variance > 0.0).then_some(Figure { value: coefficients[0], sd: noise_m * variance.sqrt() })
}

/// Coefficients, the standard deviation of a window, m, and the variance of the first coefficient in units of its
/// square.
fn fitted(windows: &[WayDifference]) -> Option<(SVector<f64, 4>, f64, f64)> {
    let (coefficients, inverse, _) = least_squares(windows).filter(|_| windows.len() >= LEAST_WINDOWS)?;
    let noise_m = spread(windows.iter().map(|(x, y)| y - coefficients.dot(x)));
    (noise_m > 0.0).then_some((coefficients, noise_m, inverse[(0, 0)]))
}

/// The windows of rows without a gap.
fn windows(part: &[Row]) -> Vec<WayDifference> {
    let mut found = Vec::new();
    let held = held_shares(part);
    let (mut begin, mut stale, mut way_m) = (0, 0.0, 0.0);
    // 1 where a speed is repeated after it has risen, -1 after it has fallen.
    let (mut direction, mut before) = (0.0, 0.0);
    for i in 1..part.len() {
        let [last, now] = [part[i - 1], part[i]];
        let change = now.speed_mps - last.speed_mps;
        let repeated = if change == 0.0 { direction } else { 0.0 };
        if change != 0.0 {
            direction = change.signum();
        }
        // A speed that is held has one rounding error all the time.
        if last.speed_mps.min(now.speed_mps) < SLOWEST_MPS || held[i] > MOST_HELD {
            (begin, stale, way_m, direction, before) = (i, 0.0, 0.0, 0.0, 0.0);
            continue;
        }
        let dt_s = now.time_s - last.time_s;
        stale += 0.5 * dt_s * (before + repeated);
        way_m += 0.5 * dt_s * (last.speed_mps + now.speed_mps);
        before = repeated;
        let from = part[begin];
        let long_s = now.time_s - from.time_s;
        if long_s >= WINDOW_S {
            let x = SVector::from([stale, long_s, way_m, now.speed_mps - from.speed_mps]);
            found.push((x, now.location_m - from.location_m - way_m));
            (begin, stale, way_m) = (i, 0.0, 0.0);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Speeds of a train that powers, coasts and brakes, as `shown` has them, beside locations with a noise of half a
    /// metre.
    fn run(seed: u64, late_s: usize, mut shown: impl FnMut(f64) -> f64) -> Vec<Sample> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (mut kmh, mut location_m, mut speeds, mut rows) = (30.0 + seed as f64, 0.0, Vec::new(), Vec::new());
        for second in 0..1800 {
            let change = match second % 360 {
                0..90 => 0.9 - 0.006 * f64::from(second % 360),
                90..330 => -0.12,
                _ => -0.5,
            };
            kmh += change;
            location_m += (kmh - 0.5 * change) / 3.6;
            speeds.push(kmh);
            let noise: f64 = StandardNormal.sample(&mut rng);
            let read = speeds[speeds.len().saturating_sub(1 + late_s)];
            rows.push(Sample {
                time_s: f64::from(second),
                location_m: Some(location_m + 0.5 * noise),
                speed_mps: Some(shown(read) / 3.6),
                ..Sample::default()
            });
        }
        rows
    }

    fn found(late_s: usize, shown: impl Fn() -> Box<dyn FnMut(f64) -> f64>) -> Option<Figure> {
        let runs: Vec<Vec<Sample>> = (0..8).map(|seed| run(seed, late_s, shown())).collect();
        behind_kmh(runs.iter().map(Vec::as_slice), 1.0)
    }

    #[test]
    fn speeds_that_are_written_once_they_have_changed_by_a_step_stay_behind_by_half_of_it() {
        let written = || -> Box<dyn FnMut(f64) -> f64> {
            let mut last = 0.0_f64;
            Box::new(move |kmh| {
                if (kmh - last).abs() >= 1.0 {
                    last = kmh;
                }
                last.round()
            })
        };
        for late_s in [0, 2] {
            let behind = found(late_s, written).unwrap();
            assert!((0.25..0.6).contains(&behind.value), "{behind:?}");
        }
    }

    #[test]
    fn rounded_truncated_and_scaled_ones_do_not_also_where_they_are_late() {
        let roundings: [fn(f64) -> f64; 4] =
            [f64::round, f64::floor, |kmh| (1.01 * kmh).round(), |kmh| (kmh + 0.4).floor()];
        for (round, late_s) in roundings.into_iter().flat_map(|round| [(round, 0), (round, 2)]) {
            assert_eq!(found(late_s, || Box::new(round)), None);
        }
    }
}
