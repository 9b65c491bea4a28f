//! Logs in which a train goes there and back: refused, since a run has one direction.

use crate::agreement::Figure;
use crate::finding::{Done, Finding, Kind};
use rundown_files::sample::Sample;

/// Both directions, if each has at least this, m.
const LEAST_WAY_M: f64 = 500.0;
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
    let located: Vec<(u64, f64)> = on_time.filter_map(|row| Some((row.line, row.location_m?))).collect();
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

/// The row in the middle of some, by their locations.
fn middle(rows: &[(u64, f64)]) -> (u64, f64) {
    let mut sorted = rows.to_vec();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    sorted[sorted.len() / 2]
}
