//! How many times as long as described the train is, by the slopes that it reaches over.
//!
//! ```text
//! a = q u - k g(s; λ L) - b0 - b1 v - b2 v²          λ: 1 of a train as long as described
//! ```
//!
//! A train that is longer than described feels a slope earlier and more smoothly. What that leaves follows the changes
//! of the slopes, in all runs alike, so no number of runs averages it out.

use super::mixture::MixtureFit;
use super::steepness::{LEAST_COASTED, MOST_SD_N_PER_KG, first_over, first_over_places};
use super::stretch::Stretch;
use crate::effort::driven::Driven;
use crate::effort::least_squares;
use crate::figure::Figure;
use nalgebra::{SMatrix, SVector};
use rundown::model::{track::Track, train::Train};
use rundown_files::statistics::rms;

/// Lengths that are tried, times as long as described; between them the fit is a straight line.
const TRIED: [f64; 15] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.1, 1.25, 1.45, 1.7, 2.0, 2.4, 3.0];
/// Half of the difference that makes a straight line, share of the length.
const STEP: f64 = 0.05;
/// It is another number than 1 by so many standard deviations, and by so much.
const SURELY_NOT: f64 = 3.0;
const LEAST_OFF: f64 = 0.1;
/// Fewer runs do not show how much they differ.
const LEAST_RUNS: usize = 6;
/// A change of the length by all of it that changes the climbs by less cannot be seen, N/kg.
const LEAST_SEEN_N_PER_KG: f64 = 1e-4;

/// Another length than the described one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OtherLength {
    /// Times as long as described, λ.
    pub(super) times: Figure,
    /// What that changes in the climbs, root mean square, N/kg.
    pub(super) off_n_per_kg: f64,
}

/// λ where a length leads to it, and how badly that one explains what trains do.
struct Tried {
    times: Figure,
    left: f64,
}

/// By the accelerations beside one of the two efforts of the windows.
pub(super) fn by_efforts(which: usize, windows: &[Driven], train: &Train, track: &Track) -> Option<OtherLength> {
    let climbs = |times: f64| {
        let of = |window: &Driven| window.climb_of(times * train.length_m(), train, track);
        windows.iter().map(of).collect()
    };
    let fit = |climbs: &[f64], changes: &[f64]| {
        let row = |((window, climb), change): ((&Driven, &f64), &f64)| {
            let (u, v) = (window.efforts_n_per_kg[which], window.speed_mps);
            (SVector::from([-change, -climb, u, 1.0, v, v * v]), window.acceleration_mps2)
        };
        let rows: Vec<(SVector<f64, 6>, f64)> = windows.iter().zip(climbs).zip(changes).map(row).collect();
        let (beta, inverse, left) = least_squares(&rows)?;
        let places = windows.iter().map(|window| window.fronts_m);
        Some(Tried { times: surely(&rows, places, windows.iter().map(|window| window.run), (&beta, &inverse))?, left })
    };
    other_length(climbs, fit)
}

/// By the stretches that are coasted, each as surely as it is.
pub(super) fn by_coasts(stretches: &[Stretch], train: &Train, track: &Track) -> Option<OtherLength> {
    let climbs = |times: f64| {
        let of = |stretch: &Stretch| stretch.climb_n_per_kg(times * train.length_m(), train, track);
        stretches.iter().map(of).collect()
    };
    let fit = |climbs: &[f64], changes: &[f64]| {
        let mixture = MixtureFit::of(stretches, climbs, MOST_SD_N_PER_KG)?;
        if mixture.coasted() < LEAST_COASTED {
            return None;
        }
        let row = |(((stretch, climb), change), share): (((&Stretch, &f64), &f64), &f64)| {
            let (weight, r) = (share.sqrt(), stretch.resistance_n_per_kg);
            (SVector::from([-change, -climb, 1.0, r]) * weight, weight * (stretch.gain_n_per_kg + r))
        };
        let rows = stretches.iter().zip(climbs).zip(changes).zip(&mixture.shares).map(row);
        let rows: Vec<(SVector<f64, 4>, f64)> = rows.collect();
        let (beta, inverse, _) = least_squares(&rows)?;
        let places = stretches.iter().map(|stretch| stretch.fronts_m);
        let times = surely(&rows, places, stretches.iter().map(|stretch| stretch.run), (&beta, &inverse))?;
        Some(Tried { times, left: -mixture.log_likelihood() })
    };
    other_length(climbs, fit)
}

/// The first coefficient as surely as both places and runs agree on it: locations that are off from run to run make
/// each run's slopes earlier or later, which looks like a length of its own.
fn surely<const N: usize>(
    rows: &[(SVector<f64, N>, f64)],
    fronts_m: impl Iterator<Item = [f64; 2]>,
    runs: impl Iterator<Item = usize>,
    fit: (&SVector<f64, N>, &SMatrix<f64, N, N>),
) -> Option<Figure> {
    let [places, runs] = [first_over_places(rows, fronts_m, fit)?, first_over(rows, runs, fit, LEAST_RUNS)?];
    Some(Figure { sd: places.sd.max(runs.sd), ..places })
}

/// λ where it surely is another number than 1. `climbs`: force of the climbs with so many times the length, N/kg;
/// `fit`: explains with these climbs, and what longer trains change of them, how far the length is from there.
fn other_length(
    climbs: impl Fn(f64) -> Vec<f64>,
    fit: impl Fn(&[f64], &[f64]) -> Option<Tried>,
) -> Option<OtherLength> {
    let tried = |times: f64| {
        let [less, more] = [times - STEP, times + STEP].map(&climbs);
        let changes: Vec<f64> = less.iter().zip(&more).map(|(less, more)| (more - less) / (2.0 * STEP)).collect();
        let Tried { times: off, left } =
            fit(&climbs(times), &changes).filter(|_| rms(&changes) > LEAST_SEEN_N_PER_KG)?;
        Some(Tried { times: Figure { value: times + off.value, ..off }, left })
    };
    let is_off = |found: &Tried| {
        let off = (found.times.value - 1.0).abs();
        off > LEAST_OFF && off > SURELY_NOT * found.times.sd
    };
    // A straight line from the described length says whether there is anything to be sought.
    let described = tried(1.0).filter(is_off)?;
    let others = TRIED.into_iter().filter_map(tried);
    let best = others.chain([described]).min_by(|a, b| a.left.total_cmp(&b.left)).filter(is_off)?;
    let times = best.times;
    // Beyond, it is something else.
    if !(TRIED[0]..=TRIED[TRIED.len() - 1]).contains(&times.value) {
        return None;
    }
    let off = climbs(1.0).into_iter().zip(climbs(times.value)).map(|(described, better)| described - better);
    Some(OtherLength { times, off_n_per_kg: rms(off) })
}
