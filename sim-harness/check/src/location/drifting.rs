//! Odometers that are set right on the way, as by balises: between two corrections the location drifts, and leaps back
//! at each.
//!
//! In: runs of one recorder. Out: by how much of the way their locations drift; these are put right.
//!
//! ```text
//! leap at k = change of (x - ∫ v dt) at once        leap = - drift × way since the last leap
//! ```
//!
//! The corrections bring the location back, so what drifts between them is spread over the way since the last one. A
//! speed of the same wheel drifts with the location, and one of another sensor does not; either shows its true scale
//! only beside locations that were brought back. Leaps of a clock that loses seconds go with the speed, and slips of a
//! wheel with neither.

use crate::rows::times::next_row_s;
use crate::rows::ways;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::{extremes, mean, median, spread};

/// Rows before and behind a leap whose means are compared.
const AROUND: usize = 3;
/// A leap is beyond so many times the usual scatter of these means, and this, m.
const LEAST_LEAP: f64 = 6.0;
const LEAST_LEAP_M: f64 = 1.5;
/// A change of the speed leaps by as much where the speed is late by so much, s.
const MOST_LATE_S: f64 = 2.0;
/// Larger ones are another chainage, m; where the train stands so is a larger share of the way before: a wheel wears by
/// a few per cent, and chainages have no steps at stations.
const MOST_LEAP_M: f64 = 100.0;
const MOST_SHARE: f64 = 0.03;
const STANDS_MPS: f64 = 1.0;
/// So much of it is between two rows: a wheel that slips takes seconds.
const AT_ONCE: f64 = 0.6;
/// So many leaps of a recorder show that they go with the way ...
const LEAST_LEAPS: usize = 8;
/// ... where what is left of their squares is less than this share, than half of what is left of seconds that the clock
/// loses, and not much more than of leaps that go with the speed otherwise.
const MOST_LEFT: f64 = 0.3;
const LESS_THAN_BY_SECONDS: f64 = 0.5;
const THAN_BY_SPEED: f64 = 2.0;
/// Leaps of a run that say how fast it drifts; one of fewer drifts as the others do.
const LEAST_OF_RUN: usize = 3;

/// What the locations of a recorder do between corrections.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Drift {
    /// Share of the way, mean of the sizes over the runs, with the sign of most.
    pub(crate) share: f64,
    pub(crate) leaps: usize,
    of_runs: [f64; 2],
    way_m: f64,
    largest_m: f64,
}

impl Drift {
    pub(crate) fn evidence(&self) -> String {
        let [least, most] = self.of_runs.map(|share| 100.0 * share);
        let Self { way_m, largest_m, .. } = self;
        let way_km = way_m / 1000.0;
        format!("each {way_km:.1} km, by up to {largest_m:.0} m; in single runs {least:.2} to {most:.2} %")
    }
}

/// A row with location and speed: its number, its location in the direction of travel, m, its speed, m/s, its time, s.
#[derive(Clone, Copy)]
struct Located {
    row: usize,
    at_m: f64,
    mps: f64,
    time_s: f64,
}

#[derive(Clone, Copy)]
struct Leap {
    /// The first located row behind it.
    behind: usize,
    /// Where the train was, m.
    at_m: f64,
    /// By how much the location was ahead of it, m.
    off_m: f64,
    mps: f64,
    /// Since the leap before it, m; none of the first one of a run.
    way_m: Option<f64>,
}

/// Puts right the locations of these runs where they drift beyond doubt.
pub(crate) fn put_right(recordings: &mut [Recording], usable: &[usize]) -> Option<Drift> {
    let of_run = |i: &usize| leaps(&located(&recordings[*i].rows));
    let runs: Vec<Vec<Leap>> = usable.iter().map(of_run).collect();
    let known = |leaps: &[Leap]| leaps.iter().filter_map(|leap| Some([leap.way_m?, leap.off_m, leap.mps])).collect();
    let pairs: Vec<Vec<[f64; 3]>> = runs.iter().map(|leaps| known(leaps)).collect();
    let all = pairs.concat();
    let usual = [0, 1, 2].map(|which| slope(&all, which));
    // A slope of its own explains all leaps of a run that has one or two.
    let slope_of = |run: &[[f64; 3]], which: usize| {
        if run.len() >= LEAST_OF_RUN { slope(run, which) } else { usual[which] }
    };
    let share = |run: &Vec<[f64; 3]>| slope_of(run, 0);
    let left = |which: usize| -> f64 { pairs.iter().map(|run| left_m2(run, which, slope_of(run, which))).sum() };
    let squares: f64 = all.iter().map(|[_, off_m, _]| off_m * off_m).sum();
    let by_second = |sign: f64| all.iter().map(|[_, off_m, mps]| (off_m - sign * mps).powi(2)).sum::<f64>();
    let by_time = (LESS_THAN_BY_SECONDS * by_second(1.0).min(by_second(-1.0))).min(THAN_BY_SPEED * left(2));
    let goes_with_way = left(0) < by_time.min(MOST_LEFT * squares);
    if all.len() < LEAST_LEAPS || !goes_with_way {
        return None;
    }
    let mut shares: Vec<f64> = pairs.iter().filter(|run| run.len() >= LEAST_OF_RUN).map(share).collect();
    if shares.is_empty() {
        shares.push(usual[0]);
    }
    for (i, (leaps, pairs)) in usable.iter().zip(runs.iter().zip(&pairs)) {
        bring_back(&mut recordings[*i].rows, leaps, share(pairs));
    }
    let mean = mean(shares.iter().map(|share| share.abs())).unwrap_or_default();
    Some(Drift {
        share: mean.copysign(shares.iter().sum()),
        leaps: runs.iter().map(Vec::len).sum(),
        of_runs: extremes(&shares).into(),
        way_m: median(all.iter().map(|[way_m, ..]| *way_m))?,
        largest_m: all.iter().map(|[_, off_m, _]| off_m.abs()).fold(0.0, f64::max),
    })
}

/// What a leap is off by, over its way or its speed.
fn slope(leaps: &[[f64; 3]], which: usize) -> f64 {
    let sum = |other: usize| leaps.iter().map(|leap| leap[which] * leap[other]).sum::<f64>();
    sum(1) / sum(which).max(f64::MIN_POSITIVE)
}

/// What a run leaves of the squares of its leaps with a slope, m².
fn left_m2(leaps: &[[f64; 3]], which: usize, slope: f64) -> f64 {
    leaps.iter().map(|leap| (leap[1] - slope * leap[which]).powi(2)).sum()
}

fn located(rows: &[Sample]) -> Vec<Located> {
    let sign = ways::heading(rows);
    let of = |(row, sample): (usize, &Sample)| {
        Some(Located { row, at_m: sign * sample.location_m?, mps: sample.speed_mps?, time_s: sample.time_s })
    };
    rows.iter().enumerate().filter_map(of).collect()
}

fn leaps(rows: &[Located]) -> Vec<Leap> {
    let ways_m = ways::run_until_m(&rows.iter().map(|row| [row.time_s, row.mps]).collect::<Vec<_>>());
    let step = |i: usize| [rows[i].at_m - rows[i - 1].at_m, ways_m[i] - ways_m[i - 1]];
    // The wheels that give location and speed may differ.
    let usual = median((1..rows.len()).map(step).filter(|[_, way_m]| *way_m > 1.0).map(|[at_m, way_m]| at_m / way_m));
    let Some(usual) = usual else { return Vec::new() };
    let off_m: Vec<f64> = rows.iter().zip(&ways_m).map(|(row, way_m)| row.at_m - usual * way_m).collect();
    let times: Vec<f64> = rows.iter().map(|row| row.time_s).collect();
    let usual_s = median(times.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(1.0);
    let longest_s = 2.0 * AROUND as f64 * next_row_s(usual_s);
    let mean = |of: std::ops::Range<usize>| off_m[of].iter().sum::<f64>() / AROUND as f64;
    let change_m = |i: usize| {
        let around = i.checked_sub(AROUND)?..i + AROUND;
        let is_whole = around.end <= rows.len() && rows[around.end - 1].time_s - rows[around.start].time_s < longest_s;
        is_whole.then(|| mean(i..around.end) - mean(around.start..i))
    };
    let changes_m: Vec<Option<f64>> = (0..rows.len()).map(change_m).collect();
    let least_m = LEAST_LEAP_M.max(LEAST_LEAP * spread(changes_m.iter().flatten()));
    let mut found: Vec<Leap> = Vec::new();
    for i in AROUND..rows.len() {
        let Some(change_m) = changes_m[i] else { continue };
        let near = &changes_m[i - AROUND..(i + AROUND + 1).min(rows.len())];
        let is_largest = near.iter().flatten().all(|other| other.abs() <= change_m.abs());
        let dv_mps = rows[i + AROUND - 1].mps - rows[i - AROUND].mps;
        let since_m = rows[i].at_m - found.last().map_or(rows[0].at_m, |before| before.at_m);
        let stands = rows[i].mps.max(rows[i - 1].mps) < STANDS_MPS;
        let most_m = if stands { MOST_LEAP_M.max(MOST_SHARE * since_m) } else { MOST_LEAP_M };
        let is_far = (least_m + MOST_LATE_S * dv_mps.abs()..most_m).contains(&change_m.abs());
        let at_once_m = (off_m[i] - off_m[i - 1]) * change_m.signum();
        // Between rows that are missing the train has stood, or braked and started.
        let follows = times[i] - times[i - 1] <= next_row_s(usual_s);
        if follows && is_largest && is_far && at_once_m > AT_ONCE * change_m.abs() {
            let at_m = rows[i].at_m;
            let way_m = found.last().map(|before| at_m - before.at_m);
            found.push(Leap { behind: i, at_m, off_m: -change_m, mps: rows[i].mps, way_m });
        }
    }
    found.iter_mut().for_each(|leap| leap.behind = rows[leap.behind].row);
    found
}

/// Takes off what has drifted since the last leap; before the first and behind the last one as in all of the run.
fn bring_back(rows: &mut [Sample], leaps: &[Leap], share: f64) {
    let sign = ways::heading(rows);
    let begins_m = rows.iter().find_map(|row| row.location_m).map_or(0.0, |m| sign * m);
    for (i, row) in rows.iter_mut().enumerate() {
        let Some(at_m) = row.location_m.map(|m| sign * m) else { continue };
        let next = leaps.partition_point(|leap| leap.behind <= i);
        let last_m = next.checked_sub(1).map(|last| leaps[last].at_m);
        let off_m = match (last_m, leaps.get(next)) {
            (Some(last_m), Some(leap)) => leap.off_m * (at_m - last_m) / (leap.at_m + leap.off_m - last_m).max(1.0),
            (Some(last_m), None) => share * (at_m - last_m),
            (None, Some(leap)) => leap.off_m - share * (leap.at_m + leap.off_m - at_m),
            (None, None) => share * (at_m - begins_m),
        };
        row.location_m = Some(sign * (at_m - off_m));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of 10 s of a train at 20 m/s. Halfway `missing_s` more pass, in which it goes `less_m` less than the speeds
    /// around say.
    fn leaps_of(missing_s: f64, less_m: f64) -> usize {
        let row = |row: usize| {
            let behind = row >= 20;
            let time_s = 10.0 * row as f64 + if behind { missing_s } else { 0.0 };
            let at_m = 20.0 * time_s - if behind { less_m } else { 0.0 } + 0.01 * (row % 3) as f64;
            Located { row, at_m, mps: 20.0, time_s }
        };
        leaps(&(0..40).map(row).collect::<Vec<_>>()).len()
    }

    #[test]
    fn a_stop_between_two_rows_is_no_correction() {
        assert_eq!(leaps_of(0.0, 40.0), 1);
        assert_eq!(leaps_of(30.0, 40.0), 0);
        assert_eq!(leaps_of(0.0, 0.0), 0);
    }
}
