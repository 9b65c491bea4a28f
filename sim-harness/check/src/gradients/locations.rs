//! By how much locations are off from run to run, by the slopes that come early or late beside the efforts.
//!
//! ```text
//! e = x dc/ds         e: what the efforts leave of the acceleration, c: force of the climb, x: read less true location
//! τ² = (Q - n) / (Σ w - Σ w²/Σ w)        Q = Σ w (x - mean)², w = 1/sd²: over the runs in one section and direction, summed over all
//! ```
//!
//! Errors of the gradients, and of how drivers answer them, are the same in all runs; where a run has its zero is not.

use crate::effort::driven::Driven;
use crate::figure::Figure;
use rundown::model::direction::Direction;
use rundown::model::{track::Track, train::Train};
use rundown_files::statistics::Pairs;
use std::collections::BTreeMap;

/// Length of a section that has one x in a run, m: trains are set right at stations.
const SECTION_M: f64 = 10_000.0;
/// Half of the difference that makes dc/ds, m.
const STEP_M: f64 = 25.0;
/// Sections that say x no better are left out, m.
const MOST_SD_M: f64 = 150.0;
/// Fewer runs in a section do not differ.
const LEAST_RUNS: usize = 3;
/// Differences count from so much on, m, where they are so many times what the noise makes, of variances: accelerations
/// beside efforts have more of it at some places.
const LEAST_M: f64 = 15.0;
const LEAST_SCATTER: f64 = 2.0;
const LEAST_FREE: f64 = 20.0;

/// Locations that are not the same in all runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OffFromRunToRun {
    /// Standard deviation, m; how surely it is known.
    pub(super) metres: Figure,
    /// What that makes of the climbs, root mean square, N/kg.
    pub(super) off_n_per_kg: f64,
}

/// dc/ds and e of the windows of each run in a section.
type OfRuns = BTreeMap<usize, Vec<(f64, f64)>>;

/// `left_mps2`: what the efforts leave of the acceleration in each window.
pub(super) fn by_efforts(
    windows: &[Driven],
    left_mps2: &[f64],
    train: &Train,
    track: &Track,
) -> Option<OffFromRunToRun> {
    let mut sections: BTreeMap<(i64, bool), OfRuns> = BTreeMap::new();
    let (mut squares, mut slopes) = (0.0, 0.0);
    for (window, left) in windows.iter().zip(left_mps2) {
        let climb = |by_m: f64| window.moved(by_m).climb_n_per_kg(train, track);
        let slope = (climb(STEP_M) - climb(-STEP_M)) / (2.0 * STEP_M);
        let section = (window.fronts_m[0] / SECTION_M).floor() as i64;
        let of_runs = sections.entry((section, window.direction == Direction::Up)).or_default();
        of_runs.entry(window.run).or_default().push((slope, *left));
        (squares, slopes) = (squares + left * left, slopes + slope * slope);
    }
    let n = windows.len() as f64;
    let variance = squares / n;
    let (mut scatter, mut free, mut weight) = (0.0, 0.0, 0.0);
    for of_runs in sections.values() {
        // About their means: a force that a run has of its own is no x.
        let known = of_runs.values().map(|windows| Pairs::of(windows));
        let known = known.filter(|pairs| pairs.xx * MOST_SD_M * MOST_SD_M > variance);
        // x with its weight.
        let known: Vec<[f64; 2]> = known.map(|pairs| [pairs.slope(), pairs.xx / variance]).collect();
        if known.len() < LEAST_RUNS {
            continue;
        }
        let all: f64 = known.iter().map(|[_, w]| w).sum();
        let mean = known.iter().map(|[x, w]| w * x).sum::<f64>() / all;
        scatter += known.iter().map(|[x, w]| w * (x - mean).powi(2)).sum::<f64>();
        free += known.len() as f64 - 1.0;
        weight += all - known.iter().map(|[_, w]| w * w).sum::<f64>() / all;
    }
    let is_known = free > LEAST_FREE && scatter > LEAST_SCATTER * free;
    let metres = is_known.then(|| ((scatter - free) / weight).sqrt()).filter(|metres| *metres > LEAST_M)?;
    let sd = metres * (0.5 / free).sqrt() * scatter / (scatter - free);
    Some(OffFromRunToRun { metres: Figure { value: metres, sd }, off_n_per_kg: metres * (slopes / n).sqrt() })
}
