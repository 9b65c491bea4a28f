//! Speeds beyond which a counter or a signal has no value: 127.5 km/h of eight bits in halves.
//!
//! In: rows of a run. Out: the same without the speeds at that value.
//!
//! A driver holds a speed at the limit of the line or the train as well. Then the locations go on as fast as the speed
//! says; where it has come to its end they go on faster.

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::stuck::{self, LEAST_STUCK};
use crate::rows::times::usual_step_s;
use crate::rows::{steps, ways};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use std::collections::HashMap;

/// Shorter stretches at the largest speed say little, s.
const LEAST_S: f64 = 10.0;
/// The way by the locations beyond that by the speed, as a share, beside what it is at other speeds, where a wheel
/// shows as well: at steady ones; of trains that have none, on short hops, at any, where wheels creep, too.
const LEAST_BEYOND: [f64; 2] = [0.015, 0.05];
/// In steps of the speed: one that is rounded may be off by a half, one that is cut off by a whole one.
const LEAST_STEPS: f64 = 1.5;
/// And so many times the noise of two locations, and so far, m.
const NOISE: f64 = 6.0;
const LEAST_BEYOND_M: f64 = 150.0;
/// A train that gets slower again does so from the largest value on, m/s²; a sensor that stood still leaps.
const MOST_MPS2: f64 = 1.5;
/// Speeds below the largest one with which it is compared, as shares of it, and so long a way of them, m.
const BELOW: std::ops::Range<f64> = 0.5..0.97;
const LEAST_BELOW_M: f64 = 1000.0;
/// They change by no more than this, m/s², and the step, from so many seconds before and to as many after.
const STEADY_MPS2: f64 = 0.08;
const STEADY_S: f64 = 10.0;
/// Between two rows the ways by location and by speed differ by no more than this share, and so many times the noise of
/// the location; else the location leaps, or the clock. Nor does the location stand still.
const MOST_OFF: f64 = 0.4;
const MOST_NOISE: f64 = 4.0;

/// Where the speeds of recorders end, m/s, by unit: its runs together show more than each of them.
pub(crate) fn of_units(recordings: &[Recording]) -> HashMap<String, f64> {
    let mut units: HashMap<&str, Vec<AtLargest>> = HashMap::new();
    for recording in recordings.iter().filter(|recording| !recording.speed_is_computed()) {
        units.entry(&recording.unit).or_default().extend(AtLargest::of(&recording.rows));
    }
    let ends = |(unit, held): (&str, Vec<AtLargest>)| Some((unit.to_owned(), AtLargest::end(&held)?));
    units.into_iter().filter_map(ends).collect()
}

/// Where the speeds of this run or of its unit end, m/s.
pub(crate) fn end_of(rows: &[Sample], of_unit: Option<f64>) -> Option<f64> {
    of_unit.or_else(|| AtLargest::end(&[AtLargest::of(rows)?]))
}

/// Leaves out the speeds at this value, m/s.
pub(crate) fn leave_out(rows: &mut [Sample], end_mps: Option<f64>, findings: &mut Vec<Finding>) {
    let Some(most_mps) = end_mps else { return };
    let is_at_most = |row: &Sample| row.speed_mps == Some(most_mps);
    let count = rows.iter().filter(|row| is_at_most(row)).count();
    let Some(line) = rows.iter().find(|row| is_at_most(row)).map(|row| row.line) else { return };
    let figure = Figure { value: 3.6 * most_mps, sd: 0.0 };
    findings.push(Finding { kind: Kind::SaturatedSpeed, figure, unit: "km/h", count, line, done: Done::LeftOut });
    rows.iter_mut().filter(|row| is_at_most(row)).for_each(|row| row.speed_mps = None);
}

/// What a run says of its largest speed, where it holds that for a while.
struct AtLargest {
    most_mps: f64,
    step_mps: f64,
    at_most: Ways,
    /// Below it: at steady speeds, and at any.
    below: [Ways; 2],
    /// Variance of the way by location at the largest speed, m².
    noise_m2: f64,
}

impl AtLargest {
    fn of(rows: &[Sample]) -> Option<Self> {
        let most_mps = ways::fastest_mps(rows);
        let step_mps = steps::of_speed_kmh(rows.iter()).unwrap_or(0.0) / 3.6;
        let mut held = stuck::stretches(rows, |row| row.speed_mps, |_, _| 0.0, LEAST_STUCK);
        held.retain(|held| {
            let long_s = rows[held.to].time_s - rows[held.from].time_s;
            rows[held.from].speed_mps == Some(most_mps) && long_s >= LEAST_S && goes_on_from(rows, held.to, step_mps)
        });
        if held.is_empty() {
            return None;
        }
        let noise_m = ways::noise_m(rows, ways::heading(rows));
        let mut at_most = Ways::default();
        let pairs = held.iter().flat_map(|held| rows[held.from..=held.to].windows(2));
        pairs.for_each(|pair| at_most.add(&pair[0], &pair[1], noise_m));
        let below = below(rows, most_mps, step_mps, noise_m);
        Some(Self { most_mps, step_mps, at_most, below, noise_m2: noise_m * noise_m * held.len() as f64 })
    }

    /// The largest speed of these runs, m/s, where the trains are faster.
    fn end(runs: &[Self]) -> Option<f64> {
        let most_mps = runs.iter().map(|run| run.most_mps).fold(0.0, f64::max);
        let (mut at_most, mut below, mut noise_m2, mut step_mps) =
            (Ways::default(), [Ways::default(), Ways::default()], 0.0, 0.0_f64);
        for run in runs.iter().filter(|run| run.most_mps == most_mps) {
            at_most.join(&run.at_most);
            below.iter_mut().zip(&run.below).for_each(|(all, own)| all.join(own));
            noise_m2 += run.noise_m2;
            step_mps = step_mps.max(run.step_mps);
        }
        let usual = below.iter().zip(LEAST_BEYOND).find(|(below, _)| below.by_speed_m > LEAST_BELOW_M);
        let (below, least) = usual.filter(|(below, _)| below.by_location_m > 0.0)?;
        let beyond_m = at_most.by_location_m * below.by_speed_m / below.by_location_m - at_most.by_speed_m;
        let least_m = at_most.by_speed_m * least.max(LEAST_STEPS * step_mps / most_mps);
        (beyond_m > least_m.max(NOISE * noise_m2.sqrt()).max(LEAST_BEYOND_M)).then_some(most_mps)
    }
}

/// Whether the next speed is one of a train that had this one.
fn goes_on_from(rows: &[Sample], last: usize, step_mps: f64) -> bool {
    let mut next = rows[last + 1..].iter().filter_map(|row| Some((row.time_s, row.speed_mps?)));
    let (time_s, mps) = (rows[last].time_s, rows[last].speed_mps.unwrap_or(0.0));
    next.next().is_some_and(|(next_s, next_mps)| mps - next_mps <= MOST_MPS2 * (next_s - time_s) + step_mps)
}

/// Ways by location and by speed, m, of steps that a train can go, whichever way: no leap of the location counts.
#[derive(Default)]
struct Ways {
    by_location_m: f64,
    by_speed_m: f64,
}

impl Ways {
    fn join(&mut self, other: &Self) {
        self.by_location_m += other.by_location_m;
        self.by_speed_m += other.by_speed_m;
    }

    fn add(&mut self, a: &Sample, b: &Sample, noise_m: f64) {
        let Some((from_m, to_m)) = a.location_m.zip(b.location_m) else { return };
        let (step_m, by_speed_m) = ((to_m - from_m).abs(), ways::between(a, b));
        let is_near = (step_m - by_speed_m).abs() < MOST_OFF * by_speed_m + MOST_NOISE * noise_m;
        if b.time_s > a.time_s && step_m > 0.0 && is_near {
            self.by_location_m += step_m;
            self.by_speed_m += by_speed_m;
        }
    }
}

/// Of speeds below the largest: while the train neither powers nor brakes much, for wheels creep while it does, and of
/// all.
fn below(rows: &[Sample], most_mps: f64, step_mps: f64, noise_m: f64) -> [Ways; 2] {
    let is_below = |row: &Sample| row.speed_mps.is_some_and(|mps| BELOW.contains(&(mps / most_mps)));
    let beside = (STEADY_S / usual_step_s(rows).max(1e-3)).ceil() as usize;
    let changes_little = |from: &Sample, to: &Sample| {
        let change = from.speed_mps.zip(to.speed_mps).map(|(a, b)| (b - a).abs());
        change.is_some_and(|mps| mps <= STEADY_MPS2 * (to.time_s - from.time_s) + step_mps)
    };
    let is_steady = |i: usize| {
        let ends = i.checked_sub(beside).zip(rows.get(i + beside));
        ends.is_some_and(|(from, to)| changes_little(&rows[from], &rows[i]) && changes_little(&rows[i], to))
    };
    let [mut steady, mut all] = [Ways::default(), Ways::default()];
    for (i, pair) in rows.windows(2).enumerate().filter(|(_, pair)| is_below(&pair[0]) && is_below(&pair[1])) {
        all.add(&pair[0], &pair[1], noise_m);
        if is_steady(i) {
            steady.add(&pair[0], &pair[1], noise_m);
        }
    }
    [steady, all]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up to 100 km/h, held, up to 140, held, and down again; what the recorder reads of it by `read`, in km/h, and
    /// locations that count `scale` metres for one.
    fn rows(read: impl Fn(f64) -> f64, scale: f64) -> Vec<Sample> {
        let kmh = |t: f64| (0.6 * t).min(100.0).max(0.6 * (t - 100.0)).min(140.0).min(0.6 * (1000.0 - t)).max(0.0);
        let mut at_m = 0.0;
        let row = |second: u32| {
            let t = f64::from(second);
            at_m += kmh(t) / 3.6;
            let location_m = Some((scale * at_m + 3.0 * (0.7 * t).sin()).round());
            Sample { time_s: t, location_m, speed_mps: Some(read(kmh(t)) / 3.6), ..Sample::default() }
        };
        (0..1000).map(row).collect()
    }

    fn found(mut rows: Vec<Sample>) -> (Vec<Finding>, usize) {
        let mut findings = Vec::new();
        let end_mps = end_of(&rows, None);
        leave_out(&mut rows, end_mps, &mut findings);
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
    fn a_run_that_shows_where_speeds_end_speaks_for_the_others_of_its_unit() {
        let read = |kmh: f64| ((2.0 * kmh).round() / 2.0).min(127.5);
        let run = |unit: &str, kmh: f64| {
            let mut rows = rows(read, 1.0);
            let reads = |row: &Sample| row.speed_mps.is_none_or(|mps| 3.6 * mps < kmh);
            rows.retain(reads);
            Recording { unit: unit.to_owned(), rows, ..Recording::default() }
        };
        let recordings = [run("a", 200.0), run("a", 120.0), run("b", 120.0)];
        let ends = of_units(&recordings);
        assert_eq!((ends.get("a"), ends.get("b")), (Some(&(127.5 / 3.6)), None));
        // It gets there for a moment.
        let mut rows = run("a", 120.0).rows;
        rows[200].speed_mps = Some(127.5 / 3.6);
        let mut findings = Vec::new();
        assert_eq!(end_of(&rows, None), None);
        let end_mps = end_of(&rows, ends.get("a").copied());
        leave_out(&mut rows, end_mps, &mut findings);
        assert_eq!((findings[0].count, rows[200].speed_mps), (1, None));
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

    /// Each with exact speeds.
    #[test]
    fn a_location_that_leaps_or_turns_and_a_wheel_that_creeps_make_no_end_of_the_speeds() {
        let exact = || rows(f64::round, 1.0);
        let shifted = |from: usize, by_m: f64| {
            let mut rows = exact();
            rows[from..].iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| m + by_m));
            rows
        };
        let at = |row: usize, at_m: f64| {
            let mut rows = exact();
            rows[row].location_m = Some(at_m);
            rows
        };
        let mut there_and_back = exact();
        there_and_back[450..].iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| 40_000.0 - m));
        // Reads too much while the train powers, the more the slower it is.
        let mut creeps = exact();
        let creep = |mps: f64| 1.0 + 0.3 * (1.0 - 3.6 * mps / 140.0);
        let powers = |(t, _): &(usize, &mut Sample)| (0..167).contains(t) || (266..333).contains(t);
        creeps.iter_mut().enumerate().filter(powers).for_each(|(_, row)| {
            row.speed_mps = row.speed_mps.map(|mps| (3.6 * mps * creep(mps)).round().min(140.0) / 3.6);
        });
        let mut late = exact();
        late[220..].iter_mut().for_each(|row| row.time_s += 600.0);
        let logs = [
            late,
            shifted(150, 30_000.0),
            shifted(500, 30_000.0),
            shifted(500, -9000.0),
            at(700, 0.0),
            there_and_back,
            creeps,
        ];
        for (i, rows) in logs.into_iter().enumerate() {
            assert_eq!(found(rows), (Vec::new(), 0), "{i}");
        }
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
