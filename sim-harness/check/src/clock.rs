//! Times that a clock made wrong: midnight, set back, set forward.
//!
//! A step of the clock is judged by the distance between the two rows: at 20 m/s an hour is 72 km. While the train stands nothing can be judged.

use crate::agreement::Figure;
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
/// Rows before and after a step of the clock that say how far the train went.
const SIDE: usize = 3;

/// Usual time between rows, s.
pub fn usual_step_s(rows: &[Sample]) -> f64 {
    let steps = rows.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
    let steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
    if steps.is_empty() { 1.0 } else { median(&steps) }
}

/// Time that passed before a row by the distance from the rows before it to those from it on, where all of them move: a few on both sides, as one
/// location of a receiver may be off by more than a step.
fn by_distance(rows: &[Sample], at: usize) -> Option<f64> {
    let last_before = rows.get(at.checked_sub(1)?)?.time_s;
    let before = middle(&rows[at.saturating_sub(SIDE)..at])?;
    let after = middle(&rows[at..rows.len().min(at + SIDE)])?;
    let speed_mps = 0.5 * (before.speed_mps + after.speed_mps);
    let between_s = (after.location_m - before.location_m).abs() / speed_mps;
    Some(between_s - (last_before - before.time_s) - (after.time_s - rows[at].time_s))
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

/// Puts times right that went back by much, or on by more than the train moved.
pub fn put_right(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let step_s = usual_step_s(rows);
    let mut shift_s = 0.0;
    for i in 1..rows.len() {
        let read_s = rows[i].time_s;
        let dt = read_s + shift_s - rows[i - 1].time_s;
        let passed_s = by_distance(rows, i);
        // The noise of the locations may leave less than nothing; a location that is stuck on one side leaves a step less, on both two.
        let passed_s = passed_s.filter(|seconds| (-0.5 * step_s..=20.0 * step_s).contains(seconds));
        let passed_s = passed_s.map(|seconds| if seconds < 0.5 * step_s { step_s } else { seconds });
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
            let passed_s = passed_s.unwrap_or(step_s);
            found(Kind::ClockSetBack, dt - passed_s);
            shift_s += passed_s - dt;
        } else if dt > LEAST_BACK_S.max(20.0 * step_s)
            && stays
            && let Some(passed_s) = passed_s
        {
            found(Kind::ClockSetForward, dt - passed_s);
            shift_s += passed_s - dt;
        }
        rows[i].time_s += shift_s;
    }
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
