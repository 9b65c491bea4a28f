//! Times that a clock made wrong: midnight, set back, set forward, lost seconds.
//!
//! A step of the clock is judged by the distance between the two rows: at 20 m/s an hour is 72 km. While the train stands nothing can be judged.

use crate::agreement::{Figure, spread};
use crate::finding::{Done, Finding, Kind};
use rundown_files::sample::Sample;
use rundown_files::units::median;

const DAY_S: f64 = 86_400.0;
/// A clock that goes back by less is a matter of single rows, which a replay drops and counts, s.
const LEAST_BACK_S: f64 = 30.0;
/// Seconds of the day fall by nearly a day at midnight: by no less than this.
const LEAST_MIDNIGHT_S: f64 = 0.8 * DAY_S;
/// Below it the distance says little about the time, m/s.
const FAST_MPS: f64 = 5.0;
/// Metres more than the speed says, in standard deviations of the location, that are no chance: their even intervals say the rest.
const SEEN: f64 = 3.5;
/// A run loses a second now and then if at least so many rows show it.
const LEAST_LOST: usize = 5;

/// Usual time between rows, s.
pub fn usual_step_s(rows: &[Sample]) -> f64 {
    let steps = rows.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
    let steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
    if steps.is_empty() { 1.0 } else { median(&steps) }
}

/// Time that passed between two rows by the distance between them, where both move.
fn by_distance(a: &Sample, b: &Sample) -> Option<f64> {
    let speed_mps = 0.5 * (a.speed_mps? + b.speed_mps?);
    let distance_m = (b.location_m? - a.location_m?).abs();
    (a.speed_mps?.min(b.speed_mps?) > FAST_MPS).then_some(distance_m / speed_mps)
}

/// Puts times right that went back by much, or on by more than the train moved.
pub fn put_right(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let step_s = usual_step_s(rows);
    let mut shift_s = 0.0;
    for i in 1..rows.len() {
        let read_s = rows[i].time_s;
        let before = rows[i - 1];
        let dt = read_s + shift_s - before.time_s;
        let passed_s = by_distance(&before, &rows[i]);
        let usual = |seconds: f64| (0.5 * step_s..=20.0 * step_s).contains(&seconds);
        // The rows that follow tell a clock that was set from one row with a wrong time.
        let stays = rows.get(i + 1).is_some_and(|next| (next.time_s - read_s - step_s).abs() < 0.5 * step_s);
        let mut found = |kind, change_s: f64| {
            let figure = Figure { value: change_s, sd: 0.0 };
            findings.push(Finding { kind, figure, unit: "s", count: 1, line: rows[i].line, done: Done::PutRight });
        };
        if dt <= -LEAST_MIDNIGHT_S {
            found(Kind::Midnight, DAY_S);
            shift_s += DAY_S;
        } else if dt < -LEAST_BACK_S && stays {
            let passed_s = passed_s.filter(|seconds| usual(*seconds)).unwrap_or(step_s);
            found(Kind::ClockSetBack, dt - passed_s);
            shift_s += passed_s - dt;
        } else if dt > LEAST_BACK_S.max(20.0 * step_s)
            && stays
            && let Some(passed_s) = passed_s.filter(|seconds| usual(*seconds))
        {
            found(Kind::ClockSetForward, dt - passed_s);
            shift_s += passed_s - dt;
        }
        rows[i].time_s += shift_s;
    }
}

/// Finds rows that hold one second more than their clock says, and puts the times after them right. Only logs of whole seconds, every few of them, can show it.
pub fn lost_seconds(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let left: Vec<Option<(f64, f64)>> = rows
        .windows(2)
        .map(|pair| {
            let dt = pair[1].time_s - pair[0].time_s;
            let passed_s = by_distance(&pair[0], &pair[1]).filter(|_| dt > 0.0 && dt <= 10.0)?;
            let speed_mps = 0.5 * (pair[0].speed_mps? + pair[1].speed_mps?);
            Some(((passed_s - dt) * speed_mps, speed_mps))
        })
        .collect();
    let metres: Vec<f64> = left.iter().flatten().map(|(metres, _)| *metres).collect();
    let sd_m = spread(&metres).max(0.3);
    let off = |i: usize| left.get(i).copied().flatten();
    let lost: Vec<usize> = (0..left.len())
        .filter(|i| {
            let Some((metres, speed_mps)) = off(*i) else {
                return false;
            };
            let second = (metres - speed_mps).abs() < (3.0 * sd_m).max(0.1 * speed_mps) && metres > SEEN * sd_m;
            // A location that jumps ahead comes back, or had been behind.
            let compensated = [i.wrapping_sub(1), i + 1].into_iter().filter_map(off);
            second && compensated.map(|(other, _)| other).all(|other| other > -0.5 * metres)
        })
        .collect();
    // A location that jumps about seems to hold a second less as often, and comes at random: a clock that is slow loses its seconds at even intervals.
    let gained = metres.iter().filter(|metres| **metres < -SEEN * sd_m).count();
    if lost.len() < LEAST_LOST || lost.len() * 10 > metres.len() || 3 * gained > lost.len() || !even(&lost, rows) {
        return;
    }
    let share = lost.len() as f64 / metres.len() as f64;
    let sd = (share * (1.0 - share) / metres.len() as f64).sqrt();
    let figure = Figure { value: 100.0 * share, sd: 100.0 * sd };
    let (count, line) = (lost.len(), rows[lost[0] + 1].line);
    findings.push(Finding {
        kind: Kind::LostSeconds,
        figure,
        unit: "% of the rows",
        count,
        line,
        done: Done::PutRight,
    });
    let mut shift_s = 0.0;
    for (i, row) in rows.iter_mut().enumerate() {
        if i > 0 && lost.binary_search(&(i - 1)).is_ok() {
            shift_s += 1.0;
        }
        row.time_s += shift_s;
    }
}

/// Most of the times between lost seconds are a whole number of times the shortest usual one: some are lost unseen, while the train stands.
fn even(lost: &[usize], rows: &[Sample]) -> bool {
    let mut between: Vec<f64> = lost.windows(2).map(|pair| rows[pair[1]].time_s - rows[pair[0]].time_s).collect();
    between.sort_by(f64::total_cmp);
    let Some(base_s) = between.get(between.len() / 4).copied() else {
        return false;
    };
    let even = between.iter().filter(|seconds| {
        let periods = **seconds / base_s;
        periods > 0.5 && (periods - periods.round()).abs() < 0.1
    });
    even.count() as f64 >= 0.8 * between.len() as f64
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
