//! Single readings that are missing, no numbers, or impossible beside their neighbours.

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::times::usual_step_s;
use crate::rows::wild::wild;
use rundown::model::units::KmPerHour;
use rundown_files::sample::{MOST_LOCATION_M, MOST_SPEED_KMH, Sample};

/// No train changes its speed faster, m/s².
const MOST_MPS2: f64 = 3.0;
/// A smaller step is rounding or a slip, m/s.
const LEAST_SPIKE_MPS: f64 = 3.0;
/// A satellite receiver may show a standing train a little below zero, m/s.
const LEAST_MPS: f64 = -0.5;
/// A spike is so many times as far from both neighbours as these are from each other.
const FARTHER: f64 = 5.0;
/// A smaller share of the rows is lost in every log.
const LEAST_MISSING: f64 = 0.05;

fn finding(kind: Kind, value: f64, unit: &'static str, count: usize, line: u64, done: Done) -> Finding {
    Finding { kind, figure: Figure { value, sd: 0.0 }, unit, count, line, done }
}

/// Readings that are no numbers, or beyond the range of their column: left out, so that nothing behind has to think of
/// them.
pub fn impossible(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let most_mps = KmPerHour(MOST_SPEED_KMH).to_mps();
    let (mut count, mut line) = (0, 0);
    for row in rows {
        // NaN is in no range.
        let location = row.location_m.take_if(|m| !(-MOST_LOCATION_M..=MOST_LOCATION_M).contains(m));
        let speed = row.speed_mps.take_if(|mps| !(LEAST_MPS..=most_mps).contains(mps));
        let lost = usize::from(location.is_some()) + usize::from(speed.is_some());
        line = if count == 0 && lost > 0 { row.line } else { line };
        count += lost;
    }
    if count > 0 {
        findings.push(finding(Kind::Impossible, count as f64, "readings", 1, line, Done::LeftOut));
    }
}

/// Speeds that no train reaches from one neighbour and leaves to the other: left out.
pub fn speed_spikes(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let longest_s = 3.5 * usual_step_s(rows);
    let read: Vec<usize> = (0..rows.len()).filter(|i| rows[*i].speed_mps.is_some()).collect();
    let mps = |i: usize| rows[i].speed_mps.unwrap_or_default();
    let found = wild(&read, |[before, first, last, after]| {
        let [into_s, out_s] = [[before, first], [last, after]].map(|[a, b]| rows[b].time_s - rows[a].time_s);
        let dt = into_s.max(out_s);
        let off_mps = (mps(first) - mps(before)).abs().min((mps(last) - mps(after)).abs());
        let beyond_mps = LEAST_SPIKE_MPS + MOST_MPS2 * dt;
        let is_wild = off_mps > beyond_mps && off_mps > FARTHER * (mps(after) - mps(before)).abs();
        (into_s.min(out_s) > 0.0 && dt < longest_s && is_wild).then_some(off_mps)
    });
    if let Some((first, _)) = found.first() {
        let largest_kmh = found.iter().map(|(i, _)| 3.6 * mps(*i)).fold(f64::NEG_INFINITY, f64::max);
        let line = rows[*first].line;
        findings.push(finding(Kind::SpeedSpikes, largest_kmh, "km/h", found.len(), line, Done::LeftOut));
        found.iter().for_each(|(i, _)| rows[*i].speed_mps = None);
    }
}

/// Rows that have only one of location and speed, or neither. Call it before anything is left out for another reason.
pub fn missing(rows: &[Sample], findings: &mut Vec<Finding>) {
    let lacks = |row: &&Sample| row.location_m.is_none() || row.speed_mps.is_none();
    let count = rows.iter().filter(lacks).count();
    let share = count as f64 / rows.len().max(1) as f64;
    if let Some(first) = rows.iter().find(lacks).filter(|_| share > LEAST_MISSING) {
        let percent = 100.0 * share;
        findings.push(finding(Kind::MissingReadings, percent, "% of the rows", count, first.line, Done::Said));
    }
}
