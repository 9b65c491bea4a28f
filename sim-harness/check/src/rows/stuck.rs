//! Sensors that stand still: rows in which a reading stays the same, and what it misses of the distance.

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::times::{longest_step_s, usual_step_s};
use rundown_files::sample::Sample;

/// A sensor that stands still over less is not said to, m.
pub(crate) const LEAST_STUCK_M: f64 = 150.0;
/// ... nor over less than this share of the distance.
pub(crate) const STUCK_SHARE: f64 = 0.2;
/// Rows in a row that say the same.
pub(crate) const LEAST_STUCK: usize = 4;

/// Rows in which a reading stays the same, and the distance that it misses.
pub struct StuckRows {
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// How many of them have the reading.
    pub(crate) count: usize,
    /// The first has an old one already.
    pub(crate) begins_old: bool,
    pub(crate) metres: f64,
    /// The distance in these rows, by speed or by location.
    pub(crate) way_m: f64,
}

/// Stretches of so many rows at least in which a reading stays the same, with the `missing` of distance by speed and by
/// location. Where rows are missing a train may have stopped, and the reading be a new one.
pub(crate) fn stretches(
    rows: &[Sample],
    reading: fn(&Sample) -> Option<f64>,
    missing: fn(f64, f64) -> f64,
    least: usize,
) -> Vec<StuckRows> {
    let mut found = Vec::new();
    let mut from = 0;
    let longest_s = longest_step_s(usual_step_s(rows));
    while from < rows.len() {
        let Some(stays) = reading(&rows[from]) else {
            from += 1;
            continue;
        };
        // A reading that is lost between two equal ones ends nothing.
        let goes_on = |i: &usize| *i == from || rows[*i].time_s - rows[i - 1].time_s <= longest_s;
        let alike = (from..rows.len()).take_while(goes_on).map(|i| (i, reading(&rows[i])));
        let alike = alike.take_while(|(_, read)| read.is_none_or(|read| read == stays));
        let read: Vec<usize> = alike.filter_map(|(i, read)| read.map(|_| i)).collect();
        let (same, to) = (read.len(), read.last().copied().unwrap_or(from));
        if same >= least {
            let located = (from..=to).filter(|i| rows[*i].location_m.is_some());
            let [first, last] = [located.clone().min().unwrap_or(from), located.max().unwrap_or(from)];
            let by_speed = run_m(&rows[from..=to], [first, last].map(|i| rows[i].time_s));
            let by_location = rows[first].location_m.zip(rows[last].location_m).map_or(0.0, |(a, b)| (b - a).abs());
            let metres = missing(by_speed, by_location);
            let (begins_old, way_m) = (false, by_speed.max(by_location));
            found.push(StuckRows { from, to, count: same, begins_old, metres, way_m });
        }
        from = to + 1;
    }
    found
}

/// Distance by speed from one time to another: between two rows with a speed their mean, whatever rows stand between
/// them, before the first and after the last of them that speed.
fn run_m(rows: &[Sample], [from_s, to_s]: [f64; 2]) -> f64 {
    let read: Vec<(f64, f64)> = rows.iter().filter_map(|row| Some((row.time_s, row.speed_mps?))).collect();
    let (Some(first), Some(last)) = (read.first(), read.last()) else { return 0.0 };
    let all = [&[(from_s.min(first.0), first.1)], &read[..], &[(to_s.max(last.0), last.1)]].concat();
    let way = |pair: &[(f64, f64)]| {
        let [(a_s, a_mps), (b_s, b_mps)] = [pair[0], pair[1]];
        let long_s = b_s - a_s;
        // The part of it between the two times.
        let [begins_s, ends_s] = [a_s.max(from_s), b_s.min(to_s)];
        let at = |time_s: f64| if long_s > 0.0 { a_mps + (b_mps - a_mps) * (time_s - a_s) / long_s } else { a_mps };
        0.5 * (at(begins_s) + at(ends_s)) * (ends_s - begins_s).max(0.0)
    };
    all.windows(2).map(way).sum()
}

/// A speed that stands still is one of those between these rows.
pub(crate) fn is_beside(stuck: &[StuckRows], [from, to]: [usize; 2]) -> bool {
    stuck.iter().any(|stuck| stuck.from <= to && from <= stuck.to)
}

pub(crate) fn leave_out(rows: &mut [Sample], stretches: &[StuckRows], kind: Kind, findings: &mut Vec<Finding>) {
    let Some(first) = stretches.first() else {
        return;
    };
    let figure = Figure { value: stretches.iter().map(|stretch| stretch.metres.abs()).sum(), sd: 0.0 };
    let (count, line) = (stretches.len(), rows[first.from].line);
    findings.push(Finding { kind, figure, unit: "m", count, line, done: Done::LeftOut });
    for StuckRows { from, to, begins_old, .. } in stretches {
        if kind == Kind::StuckLocation {
            // The first of them was mostly read while the sensor still worked.
            rows[from + usize::from(!begins_old)..=*to].iter_mut().for_each(|row| row.location_m = None);
        } else {
            rows[*from..=*to].iter_mut().for_each(|row| row.speed_mps = None);
        }
    }
}
