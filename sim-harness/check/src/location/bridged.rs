//! Rows that a straight line bridges, as of a receiver in a tunnel: locations at one pace, mostly with its speed, until
//! a leap.
//!
//! In: rows of a run. Out: the same without what is no reading.
//!
//! ```text
//! v  101.2  93.4  93.4  ...  93.4  93.4  71.8        x on a straight line for so long
//! ```
//!
//! A train that holds its speed exactly runs on a straight line, too. So a leap of the speed at an end of it is asked
//! for that no train makes, or a speed of its own that says otherwise, or locations that scatter everywhere else.

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::stuck::StuckRows;
use crate::rows::times::next_row_s;
use crate::rows::{steps, ways};
use rundown_files::sample::Sample;
use rundown_files::statistics::median;

/// Shorter lines are those of a train that holds its speed: rows, s.
const LEAST_ROWS: usize = 8;
const LEAST_S: f64 = 20.0;
/// Slower ones are those of a train that stands, m/s.
const LEAST_MPS: f64 = 2.0;
/// Steps with which locations are written, m; finer ones are taken for the last.
const WRITTEN_M: [f64; 5] = [10.0, 1.0, 0.1, 0.01, 0.001];
/// Coarser locations lie on a line wherever they are, m.
const MOST_STEP_M: f64 = 2.0;
/// The speed is that of the line in so much of it.
const EQUAL: f64 = 0.7;
/// A leap is more than so many times the changes from row to row beside it, and this, m/s: what trains brake with they
/// brake with for seconds.
const STEADY: f64 = 1.5;
const LEAST_LEAP_MPS: f64 = 0.8;
/// A speed of its own says otherwise where the train was off the line by this, m, and by so many steps.
const LEAST_BESIDE_M: f64 = 15.0;
const LEAST_BESIDE_STEPS: f64 = 3.0;
/// ... and by more than a speed makes that is shown again only where it has changed by 1 km/h, m/s.
const HELD_MPS: f64 = 0.25;
/// It stays there: a wheel that slips comes back within seconds. Rows, and the share of the leap.
const STAYS: usize = 10;
const STAYS_SHARE: f64 = 0.5;
/// A train takes so many rows to go over from its speed to that of a line.
const GOES_OVER: usize = 2;
/// Locations scatter where the median of their third differences is so many steps, and this, m: changes of the
/// acceleration are less in rows so near, s.
const SCATTER: f64 = 5.0;
const LEAST_SCATTER_M: f64 = 0.4;
const MOST_STEP_S: f64 = 2.0;
/// Times between rows that differ by a smaller share are even.
const EVEN: f64 = 0.01;

/// A row with a location: its number, its time, s, its location in the direction of travel, m, its speed, m/s.
#[derive(Clone, Copy)]
struct LineRow {
    row: usize,
    time_s: f64,
    at_m: f64,
    mps: Option<f64>,
    /// The speed stands still here: number of the first and of the last row that has it.
    stuck: Option<[usize; 2]>,
}

/// What one line bridges.
struct Bridge {
    rows: Vec<usize>,
    long_s: f64,
    off_m: f64,
    /// The speeds are bridged, too.
    has_speeds: bool,
}

/// Leaves out what lies between two readings on a straight line, but for what the speeds that stand still, `stuck`,
/// explain. Out: how many rows, and for how long.
pub(crate) fn leave_out(
    rows: &mut [Sample],
    usual_s: f64,
    stuck: &[StuckRows],
    findings: &mut Vec<Finding>,
) -> Option<String> {
    let step_m = steps::of_location_m(rows.iter())
        .or_else(|| steps::of_scaled_location_m(rows))
        .unwrap_or_else(|| written_m(rows));
    let sign = ways::heading(rows);
    let stuck =
        |row: usize| stuck.iter().map(|stuck| [stuck.from, stuck.to]).find(|[from, to]| (*from..=*to).contains(&row));
    let of = |(row, sample): (usize, &Sample)| {
        let (time_s, at_m, mps) = (sample.time_s, sign * sample.location_m?, sample.speed_mps);
        Some(LineRow { row, time_s, at_m, mps, stuck: stuck(row) })
    };
    let located: Vec<LineRow> = rows.iter().enumerate().filter_map(of).collect();
    if step_m > MOST_STEP_M {
        return None;
    }
    let next_s = next_row_s(usual_s);
    let scatters = usual_s <= MOST_STEP_S
        && third_m(&located, usual_s).is_some_and(|third_m| third_m > LEAST_SCATTER_M.max(SCATTER * step_m));
    let lines = lines(&located, step_m, next_s);
    let found: Vec<Bridge> =
        lines.into_iter().filter_map(|[from, to]| bridge(&located, [from, to], step_m, next_s, scatters)).collect();
    let longest_s = found.iter().map(|bridge| bridge.long_s).max_by(f64::total_cmp)?;
    let largest_m = found.iter().map(|bridge| bridge.off_m).fold(0.0, f64::max);
    let all: usize = found.iter().map(|bridge| bridge.rows.len()).sum();
    let line = rows[found[0].rows[0]].line;
    let figure = Figure { value: largest_m, sd: 0.0 };
    findings.push(Finding { kind: Kind::Bridged, figure, unit: "m", count: found.len(), line, done: Done::LeftOut });
    for bridge in &found {
        for row in &bridge.rows {
            rows[*row].location_m = None;
            rows[*row].speed_mps = rows[*row].speed_mps.filter(|_| !bridge.has_speeds);
        }
    }
    Some(format!("{all} rows, up to {longest_s:.0} s in one piece"))
}

/// The step with which locations are written, m.
fn written_m(rows: &[Sample]) -> f64 {
    // An import may have moved all of them.
    let first_m = rows.iter().find_map(|row| row.location_m).unwrap_or_default();
    let is_written = |step_m: &&f64| {
        let steps = |row: &Sample| row.location_m.map_or(0.0, |m| (m - first_m) / **step_m);
        rows.iter().map(steps).all(|steps| (steps - steps.round()).abs() < 1e-3)
    };
    WRITTEN_M.iter().find(is_written).copied().unwrap_or(WRITTEN_M[4])
}

/// Median of the third differences of a moving train's locations, m.
fn third_m(rows: &[LineRow], usual_s: f64) -> Option<f64> {
    let of = |four: &[LineRow]| {
        let moves = four[3].at_m - four[0].at_m > LEAST_MPS * (four[3].time_s - four[0].time_s);
        let is_even = four.windows(2).all(|pair| ((pair[1].time_s - pair[0].time_s) / usual_s - 1.0).abs() < EVEN);
        let third_m = four[3].at_m - 3.0 * four[2].at_m + 3.0 * four[1].at_m - four[0].at_m;
        (moves && is_even).then_some(third_m.abs())
    };
    median(rows.windows(4).filter_map(of))
}

/// First and last rows of straight lines, each as long as may be.
fn lines(rows: &[LineRow], step_m: f64, next_s: f64) -> Vec<[usize; 2]> {
    let mut found = Vec::new();
    let mut from = 0;
    while from + LEAST_ROWS < rows.len() {
        let (mut least, mut most) = (LEAST_MPS, f64::INFINITY);
        let mut to = from;
        for next in from + 1..rows.len() {
            let (a, b) = (&rows[from], &rows[next]);
            let long_s = b.time_s - a.time_s;
            if rows[next].time_s - rows[next - 1].time_s > next_s || long_s <= 0.0 {
                break;
            }
            let pace = |off_m: f64| (b.at_m - a.at_m + off_m) / long_s;
            (least, most) = (least.max(pace(-step_m)), most.min(pace(step_m)));
            // The last row is on the line as well, or it bridges nothing.
            if least > most {
                break;
            }
            to = next;
        }
        if to - from >= LEAST_ROWS && rows[to].time_s - rows[from].time_s >= LEAST_S {
            found.push([from, to]);
        }
        from = to.max(from + 1);
    }
    found
}

fn bridge(rows: &[LineRow], [from, to]: [usize; 2], step_m: f64, next_s: f64, scatters: bool) -> Option<Bridge> {
    let middle = (from + to) / 2;
    let is_equal = |i: &usize| rows[middle].mps.is_some() && rows[*i].mps == rows[middle].mps;
    let first = (from..=middle).rev().take_while(is_equal).last();
    let last = (middle..=to).take_while(is_equal).last();
    let equal = first.zip(last).filter(|(first, last)| (last - first) as f64 > EQUAL * (to - from) as f64);
    let bridge = |[from, to]: [usize; 2], off_m: f64| Bridge {
        rows: rows[from..=to].iter().map(|located| located.row).collect(),
        long_s: rows[to].time_s - rows[from].time_s,
        off_m,
        has_speeds: equal.is_some(),
    };
    match equal {
        Some((first, last)) => {
            let leaps = || next_s <= next_row_s(MOST_STEP_S) && leaps(rows, [first, last], next_s);
            let is_bridge = scatters || !goes_over(rows, [from, to]) && leaps();
            is_bridge.then(|| bridge([first, last], between_m(rows, [first, last])))
        }
        None => {
            let off_m = beside_m(&rows[from..=to]);
            let least_m = LEAST_BESIDE_M.max(HELD_MPS * (rows[to].time_s - rows[from].time_s));
            let is_off = off_m > least_m.max(LEAST_BESIDE_STEPS * step_m);
            (scatters || is_off && !goes_over(rows, [from, to])).then(|| bridge([from + 1, to - 1], off_m))
        }
    }
}

/// A train goes over to the line, or from it, beside a speed that stands still; a receiver's last speed stands still as
/// long as its line.
fn goes_over(rows: &[LineRow], [from, to]: [usize; 2]) -> bool {
    let [begins, ends] = [rows[from].row, rows[to].row];
    let is_beyond = |[first, last]: [usize; 2]| first + GOES_OVER <= begins || ends + GOES_OVER <= last;
    rows[from..=to].iter().filter_map(|row| row.stuck).any(is_beyond)
}

/// The speed leaps to that of the line, or from it, as that of no train.
fn leaps(rows: &[LineRow], [first, last]: [usize; 2], next_s: f64) -> bool {
    let change = |[a, b]: [&LineRow; 2]| (b.time_s - a.time_s < next_s).then_some((b.mps? - a.mps?).abs());
    let on_mps = rows[first].mps.unwrap_or_default();
    let stays = |beyond: &[LineRow], leap: f64| {
        let off = beyond.iter().filter_map(|row| Some((row.mps? - on_mps).abs()));
        off.fold(f64::INFINITY, f64::min) > STAYS_SHARE * leap
    };
    let is_leap = |at: usize, beyond: &[LineRow]| {
        let beside = beyond.windows(2).filter_map(|pair| change([&pair[0], &pair[1]])).fold(0.0, f64::max);
        let leap = change([&rows[at - 1], &rows[at]]).filter(|leap| *leap > STEADY * beside + LEAST_LEAP_MPS);
        beyond.len() > 1 && leap.is_some_and(|leap| stays(beyond, leap))
    };
    let [before, behind] =
        [&rows[first.saturating_sub(STAYS)..first], &rows[last + 1..rows.len().min(last + 1 + STAYS)]];
    first > 0 && is_leap(first, before) || last + 1 < rows.len() && is_leap(last + 1, behind)
}

/// How far the line is from the way of a train that changes its speed steadily from that before to that behind, m.
fn between_m(rows: &[LineRow], [first, last]: [usize; 2]) -> f64 {
    let mps = |i: Option<usize>| i.and_then(|i| rows.get(i)?.mps).or(rows[first].mps).unwrap_or(0.0);
    let [before, on, behind] = [first.checked_sub(1), Some(first), Some(last + 1)].map(mps);
    let long_s = rows[last].time_s - rows[first].time_s;
    let off_m = |s: f64| long_s * ((before - on) * s * (1.0 - s).powi(2) - (behind - on) * s * s * (1.0 - s));
    (1..20).map(|i| off_m(f64::from(i) / 20.0).abs()).fold(0.0, f64::max)
}

/// How far the train is from the line by its speeds, m.
fn beside_m(rows: &[LineRow]) -> f64 {
    let read: Option<Vec<[f64; 2]>> = rows.iter().map(|row| Some([row.time_s, row.mps?])).collect();
    let Some(ways_m) = read.map(|read| ways::run_until_m(&read)) else { return 0.0 };
    let (Some(first), Some(last), Some(way_m)) = (rows.first(), rows.last(), ways_m.last()) else { return 0.0 };
    let long_s = last.time_s - first.time_s;
    let off_m = rows.iter().zip(&ways_m).map(|(row, at_m)| at_m - way_m * (row.time_s - first.time_s) / long_s);
    off_m.map(f64::abs).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// 1200 s of a train that starts, cruises as `held` says, coasts and brakes; locations scatter by so much, m.
    fn log(seed: u64, scatter_m: f64, held: bool) -> Vec<Sample> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mut at_m, mut mps) = (0.0, 0.0_f64);
        let row = |i: u32| {
            let before_mps = mps;
            mps = match i % 400 {
                0..60 => mps + 0.45,
                60..250 if held => mps,
                60..250 => mps + 0.1 * (f64::from(i) / 17.0).sin(),
                250..340 => mps - 0.06,
                _ => (mps - 0.6).max(0.0),
            };
            at_m += 0.5 * (before_mps + mps);
            let read_m = at_m + scatter_m * random.random_range(-1.0..=1.0);
            Sample {
                line: u64::from(i) + 2,
                time_s: f64::from(i),
                location_m: Some((10.0 * read_m).round() / 10.0),
                speed_mps: Some((36.0 * mps).round() / 36.0),
                ..Sample::default()
            }
        };
        (0..1200).map(row).collect()
    }

    /// What a receiver makes of rows `from` to `to` without reception.
    fn bridge(rows: &mut [Sample], [from, to]: [usize; 2], with_speeds: bool) {
        let [a, b] = [rows[from - 1], rows[to + 1]];
        let mps = (b.location_m.unwrap() - a.location_m.unwrap()) / (b.time_s - a.time_s);
        for row in &mut rows[from..=to] {
            let read_m = a.location_m.unwrap() + mps * (row.time_s - a.time_s);
            row.location_m = Some((10.0 * read_m).round() / 10.0);
            row.speed_mps = if with_speeds { Some((36.0 * mps).round() / 36.0) } else { row.speed_mps };
        }
    }

    fn left_out(rows: &mut [Sample]) -> Vec<Finding> {
        let mut findings = Vec::new();
        leave_out(rows, 1.0, &[], &mut findings);
        findings
    }

    #[test]
    fn what_is_bridged_without_reception_is_left_out() {
        for (seed, scatter_m) in (0..5).flat_map(|seed| [0.0, 0.5, 3.0].map(|scatter_m| (seed, scatter_m))) {
            for with_speeds in [true, false] {
                let mut rows = log(seed, scatter_m, false);
                bridge(&mut rows, [220, 320], with_speeds);
                bridge(&mut rows, [660, 760], with_speeds);
                let found = left_out(&mut rows);
                assert_eq!(found.iter().map(|one| (one.kind, one.count)).collect::<Vec<_>>(), [(Kind::Bridged, 2)]);
                assert!((20.0..400.0).contains(&found[0].figure.value), "{found:?}");
                let is_out = |row: &Sample| row.location_m.is_none() && (row.speed_mps.is_none() == with_speeds);
                assert!(rows[225..=315].iter().chain(&rows[665..=755]).all(is_out), "{seed} {scatter_m} {with_speeds}");
                let out = rows.iter().filter(|row| row.location_m.is_none()).count();
                assert!(out <= 210, "{seed} {scatter_m} {with_speeds}: {out}");
            }
        }
    }

    /// As automatic trains do, by locations without scatter, also in whole km/h and metres.
    #[test]
    fn a_train_that_holds_its_speed_is_no_straight_line_without_readings() {
        for (seed, held) in (0..10).flat_map(|seed| [(seed, false), (seed, true)]) {
            for scatter_m in [0.0, 0.5, 3.0] {
                assert_eq!(left_out(&mut log(seed, scatter_m, held)), [], "{seed} {held} {scatter_m}");
            }
            let mut whole = log(seed, 0.0, held);
            for row in &mut whole {
                row.location_m = row.location_m.map(f64::round);
                row.speed_mps = row.speed_mps.map(|mps| (3.6 * mps).round() / 3.6);
            }
            assert_eq!(left_out(&mut whole), [], "{seed} {held}");
            // Rows 1 and 2 s apart in turn, and a wheel that slips for some seconds.
            let mut uneven: Vec<Sample> = log(seed, 0.0, held).into_iter().filter(|row| row.line % 3 != 0).collect();
            assert_eq!(left_out(&mut uneven), [], "{seed} {held}");
            let mut slips = log(seed, 0.0, held);
            slips[240..244].iter_mut().for_each(|row| row.speed_mps = row.speed_mps.map(|mps| mps + 4.0));
            assert_eq!(left_out(&mut slips), [], "{seed} {held}");
        }
    }
}
