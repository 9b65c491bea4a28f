//! Logs in which a train goes there and back: refused, since a run has one direction.

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use rundown_files::sample::Sample;

/// Both directions, if each has at least this, m.
const LEAST_WAY_M: f64 = 500.0;
/// A step is a leap from so much on, m, beyond twice what the speeds allow; without speeds trains may be so fast, m/s.
const LEAP_M: f64 = 100.0;
const FASTEST_MPS: f64 = 100.0;
const LONGEST_STEP_S: f64 = 20.0;
/// Rows at each end whose median is the end: one wild row is none.
const AT_END: usize = 5;

/// There and back in one log.
pub(crate) fn refuse(rows: &[Sample], findings: &mut Vec<Finding>) {
    let mut latest_s = f64::NEG_INFINITY;
    // A row that comes late is no way back.
    let on_time = rows.iter().filter(|row| {
        let later = row.time_s > latest_s;
        latest_s = latest_s.max(row.time_s);
        later
    });
    let located = without_leaps(on_time);
    let smooth: Vec<(u64, f64)> = located.windows(AT_END).map(middle).collect();
    let (Some((_, first_m)), Some((_, last_m))) = (smooth.first(), smooth.last()) else {
        return;
    };
    // The far end, and how far the train comes back from it.
    let turns = [1.0, -1.0].into_iter().filter_map(|sign| {
        let (line, end_m) = smooth.iter().max_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1)))?;
        let [there, back] = [sign * (end_m - first_m), sign * (end_m - last_m)];
        (there.min(back) > LEAST_WAY_M).then_some((*line, there.min(back)))
    });
    if let Some((line, metres)) = turns.max_by(|a, b| a.1.total_cmp(&b.1)) {
        let (kind, figure) = (Kind::TwoDirections, Figure { value: metres, sd: 0.0 });
        findings.push(Finding { kind, figure, unit: "m", count: 1, line, done: Done::Refused });
    }
}

/// Lines and locations, but for what a location leaps by from one row to the next that its train cannot go: an odometer
/// that is set right at a stop goes nowhere.
fn without_leaps<'a>(rows: impl Iterator<Item = &'a Sample>) -> Vec<(u64, f64)> {
    let (mut leaps_m, mut fastest_mps, mut before) = (0.0, 0.0_f64, None);
    let located = rows.filter_map(|row| {
        fastest_mps = fastest_mps.max(row.speed_mps.map_or(FASTEST_MPS, f64::abs));
        let location_m = row.location_m?;
        if let Some((last_s, last_m)) = before.replace((row.time_s, location_m)) {
            let (step_m, step_s) = (location_m - last_m, row.time_s - last_s);
            // Within a longer one a train may have gone and stopped again.
            let is_leap = step_s < LONGEST_STEP_S && f64::abs(step_m) > LEAP_M + 2.0 * fastest_mps * step_s;
            leaps_m += if is_leap { step_m } else { 0.0 };
        }
        fastest_mps = row.speed_mps.map_or(FASTEST_MPS, f64::abs);
        Some((row.line, location_m - leaps_m))
    });
    located.collect()
}

/// The row in the middle of some, by their locations.
fn middle(rows: &[(u64, f64)]) -> (u64, f64) {
    let mut sorted = rows.to_vec();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    sorted[sorted.len() / 2]
}
