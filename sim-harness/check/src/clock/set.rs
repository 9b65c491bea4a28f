//! A clock that was set by a few seconds while the train moves.
//!
//! ```text
//! time      41  42  43  51  52  53        the clock leaps by 7 s beside its step, either way,
//! location 120 140 160 180 200 220        but the way to that row is that of one step, and goes on from there
//! ```
//!
//! A location that leaps leaves the clock at its step. Rows that are missing leave the way that the train went
//! meanwhile. Where both came together, the way would be that of one step by chance only. A receiver that still says
//! its last fix as the rows go on makes up for it soon.
//!
//! In: rows around the step. Out: by how much the clock was set, beside the usual step, as the way says it.

use crate::figure::Figure;
use crate::rows::reach::reach_m;
use rundown_files::sample::Sample;
use rundown_files::statistics::{mean_of, squares_about};

/// Slower trains say little about the time by their way, m/s; beside the step, and in the rows before and after it.
const FAST_MPS: f64 = 5.0;
const MOVES_MPS: f64 = 1.5;
/// Rows before and after that are looked at, and as many of them with both readings at least.
const MOST_ROWS: usize = 6;
const LEAST_ROWS: usize = 3;
/// A smaller step of the clock is a second that was lost, or a row that was late, s.
const LEAST_SET_S: f64 = 1.5;
/// So many standard deviations of the way are beyond doubt.
const SURE: f64 = 5.0;
/// The way may miss that of one step by this share of it, and of what the clock was set by.
const MISSED: f64 = 0.25;
/// A location that stands still, or makes up for having done so, is seen within this time, s, ...
const GOES_ON_S: f64 = 20.0;
/// ... by as much of the way that the clock contradicts, or of the way by speed.
const MADE_UP: f64 = 0.5;

/// Rows on one side of the step.
struct Side {
    /// Location at the row beside the step, as all of them say it, m, and how far they scatter around it.
    at_m: f64,
    sd_m: f64,
    speed_mps: f64,
}

/// Time, s, location, m, and speed, m/s, of the rows up to the first slow one.
fn moving<'a>(rows: impl Iterator<Item = &'a Sample>) -> Vec<[f64; 3]> {
    let read = rows.filter_map(|row| Some([row.time_s, row.location_m?, row.speed_mps?]));
    read.take_while(|[.., speed_mps]| *speed_mps > MOVES_MPS).collect()
}

/// Way by speed from one of them to the next, m.
fn by_speed_m(pair: &[[f64; 3]]) -> f64 {
    0.5 * (pair[0][2] + pair[1][2]) * (pair[1][0] - pair[0][0])
}

/// What the rows up to the first slow one say together, the one beside the step first.
fn side<'a>(rows: impl Iterator<Item = &'a Sample>) -> Option<Side> {
    let read = moving(rows.take(MOST_ROWS));
    let is_enough = read.len() >= LEAST_ROWS && read[0][2] > FAST_MPS;
    let ([first, .., last], true) = (read.as_slice(), is_enough) else { return None };
    let forward = ((last[1] - first[1]) * (last[0] - first[0])).signum();
    let (mut way_m, mut places) = (0.0, vec![first[1]]);
    for pair in read.windows(2) {
        way_m += forward * by_speed_m(pair);
        places.push(pair[1][1] - way_m);
    }
    // A location that stands still says nothing.
    if (last[1] - first[1]).abs() < MADE_UP * way_m.abs() {
        return None;
    }
    let at_m = mean_of(&places);
    let variance_m2 = squares_about(at_m, &places) / (places.len() as f64 - 1.0);
    Some(Side { at_m, sd_m: variance_m2.sqrt(), speed_mps: first[2] })
}

/// By how much the clock was set at row `at`, which is `dt` s after the one before: none where it was not, or by too
/// little to be seen. `step_s`: usual time between rows, and its standard deviation; `noise_m`: how far a step of the
/// location usually is from that by speed.
pub(crate) fn by(rows: &[Sample], at: usize, dt: f64, step_s: Figure, noise_m: f64) -> Option<Figure> {
    let change_s = dt - step_s.value;
    let stays = rows.get(at + 1)?.time_s - rows[at].time_s;
    if change_s.abs() < LEAST_SET_S || (stays - step_s.value).abs() > 0.5 * step_s.value {
        return None;
    }
    let [before, after] = [side(rows[..at].iter().rev())?, side(rows[at..].iter())?];
    let speed_mps = 0.5 * (before.speed_mps + after.speed_mps);
    let sd_s = before.sd_m.hypot(after.sd_m).max(noise_m) / speed_mps;
    let way_m = (after.at_m - before.at_m).abs();
    let missed_s = (way_m / speed_mps - step_s.value).abs();
    let is_one_step =
        sd_s < step_s.value && missed_s < MISSED * change_s.abs() && missed_s < MISSED * step_s.value + 2.0 * sd_s;
    let reach = reach_m([before.speed_mps, after.speed_mps], dt.max(0.0), f64::INFINITY);
    let is_beyond = if change_s > 0.0 { way_m < *reach.start() } else { way_m > *reach.end() };
    let figure = Figure { value: change_s, sd: sd_s.hypot(step_s.sd) };
    (is_one_step && is_beyond && change_s.abs() > SURE * figure.sd && goes_on(rows, at, change_s)).then_some(figure)
}

/// Before and after row `at` the location goes with the speed, and makes up for nothing of what the clock was set by.
pub(crate) fn goes_on(rows: &[Sample], at: usize, change_s: f64) -> bool {
    let (before_s, after_s) = (rows[at - 1].time_s - GOES_ON_S, rows[at].time_s + GOES_ON_S);
    let before = rows[..at].iter().rev().enumerate().take_while(|(i, row)| *i < MOST_ROWS || row.time_s >= before_s);
    let after = rows[at..].iter().enumerate().take_while(|(i, row)| *i < MOST_ROWS || row.time_s <= after_s);
    goes_with_speed(before.map(|(_, row)| row), change_s) && goes_with_speed(after.map(|(_, row)| row), change_s)
}

/// Of the rows up to the first slow one.
fn goes_with_speed<'a>(rows: impl Iterator<Item = &'a Sample>, change_s: f64) -> bool {
    let read = moving(rows);
    let [first, .., last] = read.as_slice() else { return true };
    let by_speed_m = read.windows(2).map(by_speed_m).sum::<f64>().abs();
    let by_location_m = (last[1] - first[1]).abs();
    let off_m = (by_location_m - by_speed_m).abs();
    off_m < MADE_UP * first[2] * change_s.abs() && off_m < MADE_UP * by_speed_m
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row every `step_s` of a train at this speed; `of` gives what clock and location are off by, second by second.
    fn rows(step_s: f64, speed_mps: f64, of: impl Fn(f64) -> [f64; 2]) -> Vec<Sample> {
        let row = |i: u32| {
            let t = step_s * f64::from(i);
            let [clock_s, location_m] = of(t);
            let location_m = Some(speed_mps * t + location_m + 0.5 * f64::from(i * 7919 % 5));
            Sample { time_s: t + clock_s, location_m, speed_mps: Some(speed_mps), ..Sample::default() }
        };
        (0..60).map(row).collect()
    }

    /// What the clock is said to be set by at row 30.
    fn found(rows: &[Sample], step_s: f64) -> Option<f64> {
        let step = Figure { value: step_s, sd: 0.0 };
        by(rows, 30, rows[30].time_s - rows[29].time_s, step, 0.5).map(|figure| figure.value)
    }

    #[test]
    fn a_clock_that_is_set_by_seconds_is_known_by_the_way_to_the_next_row() {
        for (step_s, set_s) in [(1.0, 2.0), (1.0, 7.0), (1.0, -3.0), (2.0, 5.0), (10.0, 20.0), (10.0, -10.0)] {
            let set = |sign: f64| rows(step_s, 37.0, |t| [if t < 30.0 * step_s { 0.0 } else { sign * set_s }, 0.0]);
            assert_eq!(found(&set(1.0), step_s), Some(set_s), "{step_s} s");
            let turned: Vec<Sample> =
                set(1.0).iter().map(|row| Sample { location_m: row.location_m.map(|m| -m), ..*row }).collect();
            assert_eq!(found(&turned, step_s), Some(set_s), "{step_s} s, locations fall");
        }
    }

    #[test]
    fn locations_that_leap_and_rows_that_are_missing_are_no_clock() {
        let leaps = rows(1.0, 37.0, |t| [0.0, if t < 30.0 { 0.0 } else { -260.0 }]);
        assert_eq!(found(&leaps, 1.0), None);
        let missing: Vec<Sample> = rows(1.0, 37.0, |_| [0.0; 2])
            .into_iter()
            .enumerate()
            .filter(|(i, _)| !(30..37).contains(i))
            .map(|(_, row)| row)
            .collect();
        assert_eq!(found(&missing, 1.0), None);
    }
}
