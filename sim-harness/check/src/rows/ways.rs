//! Which way the locations of a run grow, how far a train goes between its rows, and how far it may go.

use crate::rows::reach::reach_m;
use rundown_files::sample::Sample;
use rundown_files::statistics::spread;
use std::ops::RangeInclusive;

/// What a train does in a longer gap is not asked, s.
pub(crate) const LONGEST_S: f64 = 3600.0;

/// +1 where locations grow more often than they fall.
pub fn heading(rows: &[Sample]) -> f64 {
    if ahead_m(rows) < 0.0 { -1.0 } else { 1.0 }
}

/// How far locations grow in all, m; a leap is no way.
pub(crate) fn ahead_m(rows: &[Sample]) -> f64 {
    let located: Vec<f64> = rows.iter().filter_map(|row| row.location_m).collect();
    located.windows(2).map(|pair| step_ahead_m(pair[0], pair[1])).sum()
}

/// How far one location is ahead of another, as far as a single step says, m.
pub fn step_ahead_m(from_m: f64, to_m: f64) -> f64 {
    (to_m - from_m).clamp(-100.0, 100.0)
}

/// Distance by speed between two rows, m.
pub(crate) fn between(a: &Sample, b: &Sample) -> f64 {
    let speeds = [a.speed_mps, b.speed_mps].into_iter().flatten();
    let count = speeds.clone().count().max(1) as f64;
    speeds.sum::<f64>() / count * (b.time_s - a.time_s).clamp(0.0, LONGEST_S)
}

/// Distance by speed from the first row to each of them, m; of each row its time, s, and its speed, m/s.
pub(crate) fn run_until_m(rows: &[[f64; 2]]) -> Vec<f64> {
    let mut ways_m = vec![0.0];
    for pair in rows.windows(2) {
        let [[a_s, a_mps], [b_s, b_mps]] = [pair[0], pair[1]];
        ways_m.push(ways_m[ways_m.len() - 1] + 0.5 * (a_mps + b_mps) * (b_s - a_s).max(0.0));
    }
    ways_m
}

/// How far the step of the location from row to row usually is from that by speed, m.
pub(crate) fn noise_m(rows: &[Sample], sign: f64) -> f64 {
    let off = rows.windows(2).filter_map(|pair| {
        let step_m = pair[1].location_m? - pair[0].location_m?;
        Some(step_m - sign * between(&pair[0], &pair[1]))
    });
    spread(off)
}

/// The largest speed that was read, m/s.
pub(crate) fn fastest_mps(rows: &[Sample]) -> f64 {
    rows.iter().filter_map(|row| row.speed_mps).fold(0.0, f64::max)
}

/// The ways that a train may go from one row to the other, whatever it does between them, m.
pub(crate) fn reaches(a: &Sample, b: &Sample, fastest_mps: f64) -> Option<RangeInclusive<f64>> {
    Some(reach_m([a.speed_mps?, b.speed_mps?], b.time_s - a.time_s, fastest_mps))
}
