//! Times that a clock made wrong: midnight, set back, set forward.
//!
//! A step of the clock is judged by the distance between the two rows: at 20 m/s an hour is 72 km. While the train
//! stands nothing can be judged, nor where rows are missing between which it may have stood.

use crate::clock::set;
use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::reach::reach_m;
use crate::rows::times::usual_step_s;
use crate::rows::ways;
use rundown_files::sample::Sample;
use rundown_files::statistics::spread;

const DAY_S: f64 = 86_400.0;
/// A clock that goes back by less is a matter of single rows, which a replay drops and counts, s.
const LEAST_BACK_S: f64 = 30.0;
/// ... but where the locations go on it is one that was set, by no less than so many steps.
const LEAST_BACK_STEPS: f64 = 3.0;
/// So many rows that come late are no single ones.
const LEAST_LATE: usize = 4;
/// Shares of rows that have the time of the row before: a smaller one is a matter of single rows, with a larger one no
/// speed fits its location.
const LEAST_SHARED: f64 = 0.05;
const MOST_SHARED: f64 = 0.5;
/// Seconds of the day fall by nearly a day at midnight: by no less and no more than this.
const LEAST_MIDNIGHT_S: f64 = 0.8 * DAY_S;
const MOST_MIDNIGHT_S: f64 = 1.2 * DAY_S;
/// A clock that is further from that of most rows is none, s; one that is set by an hour, or by less, is a summer's.
const LEAST_FOREIGN_S: f64 = 5400.0;
/// Below it the distance says little about the time, m/s.
const FAST_MPS: f64 = 5.0;
/// Rows before and after a step of the clock that say how far the train went.
const SIDE: usize = 3;

/// So many rows on either side say which way the train goes.
const TURN_ROWS: usize = 6;

/// A location that misses so many times its noise stands still.
const LEAST_MISSED: f64 = 5.0;
/// Ways that differ by no more than this share are one.
const SAME_WAY: f64 = 1e-9;

/// Time that passed before a row by the distance from the rows before it to those from it on, where all of them move: a
/// few on both sides, as one location of a receiver may be off by more than a step.
fn by_distance(rows: &[Sample], at: usize) -> Option<f64> {
    let last_before = rows.get(at.checked_sub(1)?)?.time_s;
    let before = middle(&rows[at.saturating_sub(SIDE)..at])?;
    let after = middle(&rows[at..rows.len().min(at + SIDE)])?;
    let speed_mps = 0.5 * (before.speed_mps + after.speed_mps);
    let between_s = (after.location_m - before.location_m).abs() / speed_mps;
    Some(between_s - (last_before - before.time_s) - (after.time_s - rows[at].time_s))
}

/// The way to a row is long enough for a train to stop on it and start again: `dt` s by the clock, `passed_s` by the
/// distance.
fn may_have_stopped(rows: &[Sample], at: usize, [dt, passed_s]: [f64; 2]) -> bool {
    let [before, after] = [rows[at - 1], rows[at]];
    let Some(speeds_mps) = before.speed_mps.zip(after.speed_mps).map(|(a, b)| [a, b]) else { return false };
    let by_speed_m = 0.5 * passed_s * (speeds_mps[0] + speeds_mps[1]);
    // One location alone may be off by more than a step.
    let read_m = before.location_m.zip(after.location_m).map_or(by_speed_m, |(a, b)| (b - a).abs());
    *reach_m(speeds_mps, dt, f64::INFINITY).start() <= by_speed_m.max(read_m)
}

/// Means of rows of a moving train.
struct Middle {
    time_s: f64,
    location_m: f64,
    speed_mps: f64,
}

/// Of the rows that have both readings; none where one of them hardly moves.
fn middle(rows: &[Sample]) -> Option<Middle> {
    let whole = rows.iter().filter_map(|row| Some((row.time_s, row.location_m?, row.speed_mps?)));
    let (mut sum, mut count) = (Middle { time_s: 0.0, location_m: 0.0, speed_mps: 0.0 }, 0.0);
    for (time_s, location_m, speed_mps) in whole {
        if speed_mps <= FAST_MPS {
            return None;
        }
        sum.time_s += time_s;
        sum.location_m += location_m;
        sum.speed_mps += speed_mps;
        count += 1.0;
    }
    let Middle { time_s, location_m, speed_mps } = sum;
    let mean = |sum| sum / count;
    (count > 0.0).then(|| Middle { time_s: mean(time_s), location_m: mean(location_m), speed_mps: mean(speed_mps) })
}

/// The order in which rows that were written out of it belong; none where they were not, or where not the order but the
/// clock is wrong: the way along the locations is then the shorter one as they stand. `place_m`: distance of two rows,
/// where both have a place.
pub fn order(rows: &[Sample], place_m: impl Fn(&Sample, &Sample) -> Option<f64>) -> Option<Vec<usize>> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|a, b| rows[*a].time_s.total_cmp(&rows[*b].time_s));
    if order.is_sorted() {
        return None;
    }
    let way_m = |order: &[usize]| {
        let (mut last, mut all_m): (Option<usize>, f64) = (None, 0.0);
        for i in order {
            match last.map(|last| place_m(&rows[last], &rows[*i])) {
                Some(Some(step_m)) => (last, all_m) = (Some(*i), all_m + step_m.abs()),
                None => last = Some(*i).filter(|i| place_m(&rows[*i], &rows[*i]).is_some()),
                Some(None) => {}
            }
        }
        all_m
    };
    let written: Vec<usize> = (0..rows.len()).collect();
    // Newest first is as long a way, but for the last digits of the sums.
    let as_written_m = way_m(&written);
    (as_written_m > 0.0 && way_m(&order) <= as_written_m * (1.0 + SAME_WAY)).then_some(order)
}

/// Puts rows in order of which whole blocks were written out of it; single late ones are dropped by what follows.
pub fn sort(rows: &mut Vec<Sample>, findings: &mut Vec<Finding>) {
    let mut latest_s = f64::NEG_INFINITY;
    let late = rows.iter().filter(|row| {
        latest_s = latest_s.max(row.time_s);
        row.time_s < latest_s
    });
    let late = late.count();
    let goes_back = |pair: &[Sample]| pair[1].time_s - pair[0].time_s < -LEAST_BACK_S;
    let back: Vec<u64> = rows.windows(2).filter(|pair| goes_back(pair)).map(|pair| pair[1].line).collect();
    let Some(line) = back.first().copied().filter(|_| late >= LEAST_LATE) else { return };
    let metres = |a: &Sample, b: &Sample| Some(b.location_m? - a.location_m?);
    let Some(order) = order(rows, metres) else { return };
    *rows = order.into_iter().map(|from| rows[from]).collect();
    let (figure, count) = (Figure { value: late as f64, sd: 0.0 }, back.len());
    let (kind, done) = (Kind::OutOfOrder, Done::PutRight);
    findings.push(Finding { kind, figure, unit: "rows", count, line, done });
}

/// Rows that have the time of the row before, but other readings: the clock has coarser steps than the log.
pub fn coarse(rows: &[Sample], findings: &mut Vec<Finding>) {
    let is_other = |a: &Sample, b: &Sample| a.location_m != b.location_m || a.speed_mps != b.speed_mps;
    let shared = |pair: &&[Sample]| pair[0].time_s == pair[1].time_s && is_other(&pair[0], &pair[1]);
    let count = rows.windows(2).filter(shared).count();
    let share = count as f64 / rows.len().max(1) as f64;
    let Some(first) = rows.windows(2).find(shared).filter(|_| share > LEAST_SHARED) else { return };
    let figure = Figure { value: 100.0 * share, sd: 0.0 };
    let done = if share > MOST_SHARED { Done::Refused } else { Done::Said };
    findings.push(Finding { kind: Kind::CoarseClock, figure, unit: "% of the rows", count, line: first[1].line, done });
}

/// Puts times right that went back by much, or on by more than the train moved.
pub fn put_right(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let usual = UsualRows::of(rows);
    let mut shift_s = 0.0;
    // By how much each clock was set beside the first one, and how many rows have it.
    let mut clocks = vec![(0.0, usize::from(!rows.is_empty()))];
    for i in 1..rows.len() {
        let dt = rows[i].time_s + shift_s - rows[i - 1].time_s;
        if let Some((kind, figure)) = step_of_clock(rows, i, dt, &usual) {
            // Midnight is said as the day that it takes.
            shift_s += if kind == Kind::Midnight { DAY_S } else { -figure.value };
            if kind != Kind::Midnight {
                clocks.push((clocks[clocks.len() - 1].0 + figure.value, 0));
            }
            findings.push(Finding { kind, figure, unit: "s", count: 1, line: rows[i].line, done: Done::PutRight });
        }
        rows[i].time_s += shift_s;
        clocks.last_mut().into_iter().for_each(|(_, count)| *count += 1);
    }
    let set_s = usual_clock_s(&clocks);
    rows.iter_mut().for_each(|row| row.time_s += set_s);
}

/// How far the clock of most rows is from the first one, s: that one runs on where nobody set it by hours, as where a
/// recorder begins at its first day until its clock is set.
fn usual_clock_s(clocks: &[(f64, usize)]) -> f64 {
    let rows_of = |set_s: f64| {
        let same = clocks.iter().filter(|(other_s, _)| (other_s - set_s).abs() < LEAST_FOREIGN_S);
        same.map(|(_, count)| count).sum::<usize>()
    };
    let first = rows_of(0.0);
    let most = clocks.iter().max_by_key(|(set_s, count)| (rows_of(*set_s), *count));
    most.filter(|(set_s, _)| rows_of(*set_s) > first).map_or(0.0, |(set_s, _)| *set_s)
}

/// What rows usually have between them: time, s, with its scatter, and how far the locations miss the way by speed, m.
struct UsualRows {
    step_s: Figure,
    noise_m: f64,
}

impl UsualRows {
    fn of(rows: &[Sample]) -> Self {
        let step_s = usual_step_s(rows);
        let off = rows.windows(2).map(|pair| pair[1].time_s - pair[0].time_s - step_s);
        let step_s = Figure { value: step_s, sd: spread(off) };
        Self { step_s, noise_m: ways::noise_m(rows, ways::heading(rows)) }
    }
}

/// What the clock did before row `i`, which it has `dt` s after the one before.
fn step_of_clock(rows: &[Sample], i: usize, dt: f64, usual: &UsualRows) -> Option<(Kind, Figure)> {
    let step_s = usual.step_s.value;
    let exactly = |value: f64| Figure { value, sd: 0.0 };
    if (-MOST_MIDNIGHT_S..=-LEAST_MIDNIGHT_S).contains(&dt) {
        return Some((Kind::Midnight, exactly(DAY_S)));
    }
    // Of a receiver that says its last fix nobody knows how far the train went meanwhile.
    if dt > step_s && [i - 1, i + 1].into_iter().any(|at| stands_still(rows, at, usual.noise_m)) {
        return None;
    }
    // A train that comes back stood meanwhile, where its recorder was silent.
    if dt > step_s && turns(rows, i) {
        return None;
    }
    if let Some(change_s) = set::by(rows, i, dt, usual.step_s, usual.noise_m) {
        return Some((if change_s.value > 0.0 { Kind::ClockSetForward } else { Kind::ClockSetBack }, change_s));
    }
    // The rows that follow tell a clock that was set from one row with a wrong time.
    let next = rows.get(i + 1)?;
    if (next.time_s - rows[i].time_s - step_s).abs() >= 0.5 * step_s {
        return None;
    }
    let passed_s = by_distance(rows, i);
    // The noise of the locations may leave less than nothing; a location that is stuck on one side leaves a step less,
    // on both two.
    let passed_s = passed_s.filter(|seconds| (-0.5 * step_s..=20.0 * step_s).contains(seconds));
    let passed_s = passed_s.map(|seconds| if seconds < 0.5 * step_s { step_s } else { seconds });
    if dt < -LEAST_BACK_S || dt < -LEAST_BACK_STEPS * step_s && passed_s.is_some() {
        return Some((Kind::ClockSetBack, exactly(dt - passed_s.unwrap_or(step_s))));
    }
    let passed_s = passed_s.filter(|_| dt > LEAST_BACK_S.max(20.0 * step_s))?;
    let is_set = !may_have_stopped(rows, i, [dt, passed_s]) && set::goes_on(rows, i, dt - passed_s);
    is_set.then(|| (Kind::ClockSetForward, exactly(dt - passed_s)))
}

/// The locations go one way before row `at` and the other way from it on.
fn turns(rows: &[Sample], at: usize) -> bool {
    let before_m = ways::ahead_m(&rows[at.saturating_sub(TURN_ROWS)..at]);
    let after_m = ways::ahead_m(&rows[at..rows.len().min(at + TURN_ROWS)]);
    before_m * after_m < 0.0
}

/// Location and speed are those of the row before, and the train moves.
fn stands_still(rows: &[Sample], at: usize, noise_m: f64) -> bool {
    let Some(pair) = at.checked_sub(1).and_then(|before| rows.get(before..=at)) else { return false };
    let [(Some(before_m), Some(before_mps)), (Some(at_m), Some(at_mps))] =
        [pair[0], pair[1]].map(|row| (row.location_m, row.speed_mps))
    else {
        return false;
    };
    let missed_m = at_mps * (pair[1].time_s - pair[0].time_s);
    before_m == at_m && before_mps == at_mps && at_mps > FAST_MPS && missed_m > LEAST_MISSED * noise_m
}

/// Rows that are missing while the train stands, and while it moves.
pub fn gaps(rows: &[Sample], findings: &mut Vec<Finding>) {
    let step_s = usual_step_s(rows);
    let long = (3.5 * step_s).max(15.0_f64.min(6.0 * step_s));
    let (mut standing, mut moving) = ((0.0, 0, 0), (0.0, 0, 0));
    for pair in rows.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let dt = b.time_s - a.time_s;
        if dt <= long {
            continue;
        }
        let slow = [a, b].iter().all(|row| row.speed_mps.is_none_or(|mps| mps < 2.0));
        let near = a.location_m.zip(b.location_m).is_none_or(|(a, b)| (b - a).abs() < 60.0);
        let gap = if slow && near { &mut standing } else { &mut moving };
        *gap = (gap.0 + dt - step_s, gap.1 + 1, if gap.1 == 0 { b.line } else { gap.2 });
    }
    for (kind, (seconds, count, line)) in [(Kind::MissingStandstill, standing), (Kind::Gaps, moving)] {
        if count > 0 {
            let figure = Figure { value: seconds, sd: 0.0 };
            findings.push(Finding { kind, figure, unit: "s", count, line, done: Done::Said });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_written_newest_first_are_turned_whatever_their_digits_add_up_to() {
        let row = |i: u32| {
            let at_m = 17.3 * f64::from(i) + 0.1 * f64::from(i * 7919 % 13);
            Sample { time_s: f64::from(i), location_m: Some(at_m), ..Sample::default() }
        };
        let metres = |a: &Sample, b: &Sample| Some(b.location_m? - a.location_m?);
        for count in 100..200 {
            let rows: Vec<Sample> = (0..count).rev().map(row).collect();
            let turned: Vec<usize> = (0..count as usize).rev().collect();
            assert_eq!(order(&rows, metres), Some(turned), "{count} rows");
        }
    }

    /// Rows at these times and locations, of a train that runs at this speed at all of them.
    fn found_forward(speed_mps: f64, of_row: impl Fn(u32) -> (f64, f64)) -> Vec<Kind> {
        let row = |i: u32| {
            let (time_s, location_m) = of_row(i);
            Sample { time_s, location_m: Some(location_m), speed_mps: Some(speed_mps), ..Sample::default() }
        };
        let (mut rows, mut findings) = ((0..60).map(row).collect::<Vec<Sample>>(), Vec::new());
        put_right(&mut rows, &mut findings);
        findings.iter().map(|finding| finding.kind).collect()
    }

    /// A tunnel behind two rows of one fix: the way over it looked like that of 10 s.
    #[test]
    fn a_receiver_that_says_its_last_fix_before_a_gap_is_no_clock() {
        let read = [
            (4063.13, 95.63),
            (4327.76, 95.93),
            (4595.81, 96.14),
            (4864.64, 97.65),
            (5148.98, 106.93),
            (5451.36, 102.68),
            (5699.81, 77.09),
            (5699.81, 77.09),
            (6027.16, 22.83),
            (6124.11, 47.22),
            (6282.58, 66.53),
            (6488.78, 80.24),
            (6728.38, 87.61),
            (6970.18, 87.93),
        ];
        let row = |(i, (location_m, kmh)): (usize, &(f64, f64))| {
            let time_s = 10.0 * i as f64 + if i < 8 { 0.0 } else { 40.0 };
            Sample { time_s, location_m: Some(*location_m), speed_mps: Some(kmh / 3.6), ..Sample::default() }
        };
        let (mut rows, mut findings) = (read.iter().enumerate().map(row).collect::<Vec<Sample>>(), Vec::new());
        put_right(&mut rows, &mut findings);
        assert_eq!(findings, []);
    }

    /// A recorder that is silent below 8 m/s: 40 min between a train that comes in and one that goes back.
    #[test]
    fn a_train_that_comes_back_set_no_clock() {
        let found = |there: f64, back: f64| {
            found_forward(8.0, |i| {
                let (t, is_after) = (f64::from(i), i >= 30);
                (t + if is_after { 2400.0 } else { 0.0 }, 8.0 * if is_after { there + back * (t - 29.0) } else { t })
            })
        };
        assert_eq!(found(33.0, -1.0), []);
        assert_eq!(found(29.0, 1.0), [Kind::ClockSetForward]);
    }

    /// A recorder begins at its first day until it has its clock set, or one forgets it for a while.
    #[test]
    fn the_clock_of_most_rows_is_right() {
        let begin_s = 946_684_800.0;
        let times = |forgets: std::ops::Range<u32>, by_s: f64| {
            let row = |i: u32| Sample {
                time_s: begin_s + f64::from(i) + if forgets.contains(&i) { -by_s } else { 0.0 },
                location_m: Some(20.0 * f64::from(i)),
                speed_mps: Some(20.0),
                ..Sample::default()
            };
            let mut rows: Vec<Sample> = (0..60).map(row).collect();
            put_right(&mut rows, &mut Vec::new());
            assert!(rows.windows(2).all(|pair| pair[1].time_s - pair[0].time_s == 1.0), "{forgets:?} {by_s}");
            rows[0].time_s - begin_s
        };
        let years_s = 9e8;
        assert_eq!([times(0..20, years_s), times(40..60, years_s), times(20..29, years_s)], [0.0; 3]);
        assert_eq!(times(0..40, years_s), -years_s);
        // By an hour it is a summer's.
        assert_eq!(times(0..20, 3600.0), -3600.0);
    }

    #[test]
    fn a_clock_is_set_forward_where_no_train_stops_on_the_way_between_the_rows() {
        let found = |speed_mps, [jump_s, way_m]: [f64; 2]| {
            found_forward(speed_mps, |i| {
                let (t, is_after) = (f64::from(i), f64::from(u8::from(i >= 30)));
                (t + jump_s * is_after, speed_mps * t + way_m * is_after)
            })
        };
        // 140 m more are those of a metro that brakes and starts again with 1.0 m/s².
        assert_eq!(found(12.0, [40.0, 140.0]), []);
        assert_eq!(found(12.0, [40.0, 0.0]), [Kind::ClockSetForward]);
        assert_eq!(found(6.0, [3600.0, 0.0]), [Kind::ClockSetForward]);
    }
}
