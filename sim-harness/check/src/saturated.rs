//! Speeds beyond which a counter or a signal has no value: 127.5 km/h of eight bits in halves.
//!
//! In: rows of a run. Out: the same without the speeds at that value.
//!
//! A driver holds a speed at the limit of the line or the train as well. Then the locations go on as fast as the speed
//! says; where it has come to its end they go on faster.

use crate::agreement::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::stuck_rows::{self, LEAST_STUCK};
use crate::{steps, ways};
use rundown_files::sample::Sample;

/// Shorter stretches at the largest speed say little, s.
const LEAST_S: f64 = 20.0;
/// The way by the locations beyond that by the speed, as shares: of wheels and of rounding there is none, for it is
/// compared with that at other speeds.
const LEAST_BEYOND: f64 = 0.015;
/// In steps of the speed: one that is rounded may be off by a half, one that is cut off by a whole one.
const LEAST_STEPS: f64 = 1.5;
/// And so many times the noise of two locations, and so far, m.
const NOISE: f64 = 6.0;
const LEAST_BEYOND_M: f64 = 50.0;
/// A train that gets slower again does so from the largest value on, m/s²; a sensor that stood still leaps.
const MOST_MPS2: f64 = 1.5;
/// Speeds below the largest one with which it is compared, as shares of it, and so long a way of them, m.
const BELOW: std::ops::Range<f64> = 0.5..0.97;
const LEAST_BELOW_M: f64 = 2000.0;

/// Leaves out the speeds at the largest value.
pub(crate) fn leave_out(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let Some(most_mps) = saturates_at(rows) else { return };
    let is_at_most = |row: &Sample| row.speed_mps == Some(most_mps);
    let count = rows.iter().filter(|row| is_at_most(row)).count();
    let line = rows.iter().find(|row| is_at_most(row)).map_or(0, |row| row.line);
    let figure = Figure { value: 3.6 * most_mps, sd: 0.0 };
    findings.push(Finding { kind: Kind::SaturatedSpeed, figure, unit: "km/h", count, line, done: Done::LeftOut });
    rows.iter_mut().filter(|row| is_at_most(row)).for_each(|row| row.speed_mps = None);
}

/// The largest speed, m/s, where the train is faster.
fn saturates_at(rows: &[Sample]) -> Option<f64> {
    let most_mps = ways::fastest_mps(rows);
    let (by_location, by_speed) = below_m(rows, most_mps);
    let usual = by_location / by_speed;
    if by_speed < LEAST_BELOW_M || usual <= 0.0 {
        return None;
    }
    let step_mps = steps::of_speed_kmh(rows.iter()).unwrap_or(0.0) / 3.6;
    let stretches = stuck_rows::stretches(rows, |row| row.speed_mps, |_, by_location| by_location, LEAST_STUCK);
    let at_most = stretches.iter().filter(|stretch| {
        let long_s = rows[stretch.to].time_s - rows[stretch.from].time_s;
        rows[stretch.from].speed_mps == Some(most_mps) && long_s >= LEAST_S && goes_on_from(rows, stretch.to, step_mps)
    });
    let (mut beyond_m, mut way_m, mut count) = (0.0, 0.0, 0);
    for stretch in at_most {
        let by_speed_m = most_mps * (rows[stretch.to].time_s - rows[stretch.from].time_s);
        beyond_m += stretch.metres / usual - by_speed_m;
        way_m += by_speed_m;
        count += 1;
    }
    let noise_m = ways::noise_m(rows, ways::heading(rows)) * f64::from(count).sqrt();
    let least_m = way_m * LEAST_BEYOND.max(LEAST_STEPS * step_mps / most_mps);
    let is_faster = count > 0 && beyond_m > least_m.max(NOISE * noise_m).max(LEAST_BEYOND_M);
    is_faster.then_some(most_mps)
}

/// Whether the next speed is one of a train that had this one.
fn goes_on_from(rows: &[Sample], last: usize, step_mps: f64) -> bool {
    let mut next = rows[last + 1..].iter().filter_map(|row| Some((row.time_s, row.speed_mps?)));
    let (time_s, mps) = (rows[last].time_s, rows[last].speed_mps.unwrap_or(0.0));
    next.next().is_some_and(|(next_s, next_mps)| mps - next_mps <= MOST_MPS2 * (next_s - time_s) + step_mps)
}

/// Ways by location and by speed between rows of speeds below the largest, m.
fn below_m(rows: &[Sample], most_mps: f64) -> (f64, f64) {
    let is_below = |row: &Sample| row.speed_mps.is_some_and(|mps| BELOW.contains(&(mps / most_mps)));
    let steps = rows.windows(2).filter(|pair| is_below(&pair[0]) && is_below(&pair[1]));
    let ways = steps.filter_map(|pair| {
        let step_m = pair[1].location_m? - pair[0].location_m?;
        Some((step_m, ways::between(&pair[0], &pair[1])))
    });
    let (by_location, by_speed) = ways.fold((0.0, 0.0), |sums, way| (sums.0 + way.0, sums.1 + way.1));
    (by_location.abs(), by_speed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up to 140 km/h, held, and down again; what the recorder reads of it by `read`, in km/h, and locations that count
    /// `scale` metres for one.
    fn rows(read: impl Fn(f64) -> f64, scale: f64) -> Vec<Sample> {
        let kmh = |t: f64| (0.6 * t).min(140.0).min(0.6 * (900.0 - t)).max(0.0);
        let mut at_m = 0.0;
        let row = |second: u32| {
            let t = f64::from(second);
            at_m += kmh(t) / 3.6;
            let location_m = Some((scale * at_m + 3.0 * (0.7 * t).sin()).round());
            Sample { time_s: t, location_m, speed_mps: Some(read(kmh(t)) / 3.6), ..Sample::default() }
        };
        (0..900).map(row).collect()
    }

    fn found(mut rows: Vec<Sample>) -> (Vec<Finding>, usize) {
        let mut findings = Vec::new();
        leave_out(&mut rows, &mut findings);
        (findings, rows.iter().filter(|row| row.speed_mps.is_none()).count())
    }

    #[test]
    fn a_speed_that_ends_at_its_largest_value_is_left_out_there() {
        for (most_kmh, step_kmh) in [(127.5, 0.5), (127.0, 1.0), (127.5, 0.1)] {
            for scale in [0.97, 1.0, 1.03] {
                let read = |kmh: f64| ((kmh / step_kmh).round() * step_kmh).min(most_kmh);
                let (findings, left_out) = found(rows(read, scale));
                assert_eq!(findings.iter().map(|found| found.kind).collect::<Vec<_>>(), [Kind::SaturatedSpeed]);
                assert!((findings[0].figure.value - most_kmh).abs() < 1e-9 && left_out == findings[0].count);
                assert!(left_out > 250, "{left_out}");
            }
        }
    }

    #[test]
    fn a_sensor_that_stands_still_at_its_largest_reading_is_no_range() {
        let stuck = |mut rows: Vec<Sample>| {
            let from = rows.iter().position(|row| row.speed_mps > Some(110.0 / 3.6)).unwrap();
            let stays = rows[from].speed_mps;
            rows[from..790].iter_mut().for_each(|row| row.speed_mps = stays);
            rows
        };
        assert_eq!(found(stuck(rows(f64::round, 1.0))), (Vec::new(), 0));
    }

    #[test]
    fn a_speed_that_is_held_is_none_whatever_its_wheel_and_its_rounding() {
        for scale in [0.97, 1.0, 1.03] {
            for read in [f64::round, f64::floor, f64::ceil, |kmh: f64| kmh] {
                let (findings, left_out) = found(rows(read, scale));
                assert!(findings.is_empty() && left_out == 0, "{scale}: {findings:?}");
            }
        }
    }
}
