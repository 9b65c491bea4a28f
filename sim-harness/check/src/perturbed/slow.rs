//! Stretches where a run is far slower than the others.
//!
//! ```text
//! v < min(3/4 q25, q25 - 3/2 (q75 - q25))      q: quantiles over the others of the lowest speed near the place
//! ```
//!
//! The others are those that call at the stations around as this run does. A stretch counts where it cost time.

use super::{Cause, LEAST_OTHERS, Perturbation};
use crate::rows::profile::{CELL_M, Medians, Profile, get};
use rundown_files::statistics::mean_of;

/// A stretch that costs less is a driver's style, s.
const LEAST_LOST_S: f64 = 15.0;
/// Slow is below this share of what three quarters of the others exceed.
const SLOW_SHARE: f32 = 0.75;
/// And so many of the others' interquartile ranges below it.
const SLOW_RANGES: f32 = 1.5;
/// Where the others are slower, m/s, all stop there, and the noise of a speed decides who is slow.
const OTHERS_PASS_MPS: f32 = 2.0;
/// A stop within this way shapes the speed, m.
const AROUND_M: f64 = 3_000.0;
/// No train is counted as slower than this while time is added up, m/s: standing is a stop's matter.
const CREEP_MPS: f64 = 0.5;
/// Slow cells with at most so many others between them are one stretch.
const BRIDGED: i64 = 4;

/// A cell in which a run is slow.
#[derive(Clone, Copy)]
struct Slow {
    cell: i64,
    mps: f32,
    /// What three quarters of the others exceed.
    lower_mps: f32,
    others: usize,
}

/// The stretches where a run was held back. `typical`: of all runs, to ask the others only where a run may be slow.
pub fn held_back(
    profiles: &[Profile],
    lows: &[Vec<f32>],
    typical: &Medians,
    run: usize,
    near_m: f64,
) -> Vec<Perturbation> {
    let profile = &profiles[run];
    let cells = profile.first_cell..profile.first_cell + profile.speeds_mps.len() as i64;
    let slow = |cell: i64| {
        let mps = profile.speed_mps(cell)?;
        (mps < SLOW_SHARE * typical.mps(cell)?).then_some(())?;
        let mut others = like_others(profiles, lows, run, cell, near_m);
        if others.len() < LEAST_OTHERS {
            return None;
        }
        others.sort_unstable_by(f32::total_cmp);
        let [lower_mps, upper_mps] = [0.25, 0.75].map(|share| others[(share * (others.len() - 1) as f64) as usize]);
        let limit_mps = (SLOW_SHARE * lower_mps).min(lower_mps - SLOW_RANGES * (upper_mps - lower_mps));
        (mps < limit_mps && lower_mps > OTHERS_PASS_MPS).then_some(Slow { cell, mps, lower_mps, others: others.len() })
    };
    let slow: Vec<Slow> = cells.filter_map(slow).collect();
    slow.chunk_by(|a, b| b.cell - a.cell <= BRIDGED + 1).filter_map(stretch).collect()
}

/// Low speeds of the others at a cell that call as this run does at the stations around.
fn like_others(profiles: &[Profile], lows: &[Vec<f32>], run: usize, cell: i64, near_m: f64) -> Vec<f32> {
    let at_m = (cell as f64 + 0.5) * CELL_M;
    let profile = &profiles[run];
    let calls_m: Vec<f64> = profile
        .stands
        .iter()
        .map(|stand| stand.at_m)
        .chain(profile.ends_m)
        .filter(|m| (m - at_m).abs() < AROUND_M)
        .collect();
    let is_like = |i: &usize| *i != run && calls_m.iter().all(|call_m| profiles[*i].calls_at(*call_m, near_m));
    (0..profiles.len()).filter(is_like).filter_map(|i| get(&lows[i], cell - profiles[i].first_cell)).collect()
}

fn stretch(slow: &[Slow]) -> Option<Perturbation> {
    let (first, last) = (slow.first()?, slow.last()?);
    let lost_s: f64 = slow
        .iter()
        .map(|one| CELL_M / f64::from(one.mps).max(CREEP_MPS) - CELL_M / f64::from(one.lower_mps).max(CREEP_MPS))
        .sum();
    (lost_s >= LEAST_LOST_S).then(|| Perturbation {
        cause: Cause::HeldBack,
        from_m: first.cell as f64 * CELL_M,
        to_m: (last.cell + 1) as f64 * CELL_M,
        duration_s: lost_s,
        speed_kmh: 3.6 * slow.iter().map(|one| f64::from(one.mps)).fold(f64::INFINITY, f64::min),
        others_kmh: Some(3.6 * mean_of(slow.iter().map(|one| f64::from(one.lower_mps)))),
        others_stopping: 0,
        others: slow.iter().map(|one| one.others).min().unwrap_or(0),
    })
}
