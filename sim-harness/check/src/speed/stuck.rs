//! Speeds that stand still while the locations say otherwise: a recorder that repeats the last one until the next
//! arrives.
//!
//! In: rows of a run. Out: the same without these speeds.
//!
//! ```text
//! v  80  80  80  80  80  80  80  43        and x on its way to slow down
//! off(t) = x(t) - x(0) - v t               how far the train is from where the speed has it
//! ```
//!
//! A driver or a controller holds a speed exactly, too, and a location may be wrong: it leaps at once, or comes back to
//! where the speed has the train. So either the distance of the whole stretch is missing, or the locations run away
//! from the speed, and the speed leaps behind it as that of no train.

use crate::finding::{Finding, Kind};
use crate::rows::stuck::{self, LEAST_STUCK, LEAST_STUCK_M, STUCK_SHARE, StuckRows};
use crate::rows::{steps, ways};
use crate::speed::stuck_by_location::{self, LARGEST_MPS2, Steps};
use rundown_files::sample::Sample;

/// Rows in a row that say the same, and how many show by themselves that the speed stands still.
const FEWEST_ROWS: usize = 2;
const LEAST_ROWS: usize = 3;
/// A wheel is off by less.
const MOST_WHEEL: f64 = 0.06;
/// A speed that stood still for so long, s, shows it as well by less distance beside the leap with which it goes on, by
/// the least so many rows, m.
const LEAST_LEAPT: usize = 8;
const LEAST_LEAPT_S: f64 = 10.0;
const LEAST_LEAPT_M: f64 = 15.0;
/// A leap is more than any train's acceleration makes between two rows, and no less than this, m/s; from zero, which is
/// a stand or that of a sensor with a threshold, more.
const LEAST_LEAP_MPS: f64 = 0.6;
const FROM_ZERO_MPS: f64 = 3.0;
/// The distance that it misses, as a share of that of the whole leap over all of the time: a half where the train
/// changed its speed evenly.
const LEAPT_SHARE: core::ops::Range<f64> = 0.15..1.1;
/// Locations run away where they do so by this many times their usual noise: beside speeds that are held it makes 3.6.
const AWAY_NOISE: f64 = 6.0;
/// ... and by this share of it without the largest step, which may be that of a location that leapt.
const WITHOUT_LEAP: f64 = 0.5;
/// A distance of which one step of the location makes more than this share is that of a location that leapt.
const MOST_OF_LEAP: f64 = 0.7;
/// Without a leap of the speed they end up so far away, m, and by so many times their noise.
const LEAST_AWAY_M: f64 = 50.0;
const ENDS_NOISE: f64 = 12.0;

/// Leaves out the speeds that stand still, but for those at their largest value, m/s, where they come to an end there.
pub(crate) fn leave_out(rows: &mut [Sample], end_mps: Option<f64>, findings: &mut Vec<Finding>) {
    let mut found = found(rows);
    found.retain(|stuck| end_mps.is_none() || rows[stuck.from].speed_mps != end_mps);
    stuck::leave_out(rows, &found, Kind::StuckSpeed, findings);
}

/// Where speeds stand still.
pub fn found(rows: &[Sample]) -> Vec<StuckRows> {
    let usual = UsualReadings::of(rows);
    let stretches =
        stuck::stretches(rows, |row| row.speed_mps, |by_speed, by_location| by_location - by_speed, FEWEST_ROWS);
    let steps = Steps::of(rows, usual.sign, usual.fastest_mps);
    let told = stretches.into_iter().filter_map(|mut stuck| {
        let missed_m = steps.as_ref().and_then(|steps| steps.missed_m(rows, &stuck));
        let away = Away::of(rows, &stuck, &usual)?;
        let shows = stuck.count >= LEAST_ROWS
            && (misses(rows, &stuck, &away, &usual)
                || leaps_evenly(rows, &stuck, &usual)
                || runs_away(rows, &stuck, &away, &usual));
        // What was missed first may be made up for at the end.
        stuck.metres = stuck.metres.abs().max(away.most_m).max(missed_m.unwrap_or(0.0));
        (shows || missed_m.is_some()).then_some(stuck)
    });
    told.collect()
}

/// What speeds and locations of a run usually have: the direction, the step of the speed, m/s, what the locations miss
/// from row to row, m, their step, m, and the fastest speed, m/s.
struct UsualReadings {
    sign: f64,
    step_mps: f64,
    noise_m: f64,
    step_m: f64,
    fastest_mps: f64,
}

impl UsualReadings {
    fn of(rows: &[Sample]) -> Self {
        let sign = ways::heading(rows);
        // Receivers hold their location at a stand.
        let moving: Vec<Sample> =
            rows.iter().filter(|row| row.speed_mps.is_some_and(|mps| mps > 0.0)).copied().collect();
        Self {
            sign,
            step_mps: steps::of_speed_kmh(rows.iter()).unwrap_or(0.0) / 3.6,
            noise_m: ways::noise_m(&moving, sign),
            step_m: steps::of_location_m(rows.iter()).unwrap_or(0.0),
            fastest_mps: ways::fastest_mps(rows),
        }
    }

    /// A wheel and a step make a held speed miss so much, m/s.
    fn missed_mps(&self, mps: f64) -> f64 {
        MOST_WHEEL * mps + self.step_mps
    }
}

/// The distance of all of the rows is missing, and no leap of the location makes it so; of few rows that are far apart
/// it is one that no train goes between them.
fn misses(rows: &[Sample], stuck: &StuckRows, away: &Away, usual: &UsualReadings) -> bool {
    let far = match rows[stuck.from].speed_mps {
        Some(mps) if mps > 0.0 => usual.missed_mps(mps) / mps,
        _ => STUCK_SHARE,
    };
    let metres = stuck.metres.abs();
    metres > LEAST_STUCK_M
        && metres > far * stuck.way_m
        && !away.leaps(metres)
        && (stuck.count >= LEAST_STUCK || metres > far * stuck.way_m + between_m(rows, stuck) * stuck.count as f64)
}

/// What a train may miss of the way of its speed between two of the rows, m.
fn between_m(rows: &[Sample], stuck: &StuckRows) -> f64 {
    stuck_by_location::between_m((rows[stuck.to].time_s - rows[stuck.from].time_s) / (stuck.count - 1).max(1) as f64)
}

/// How the speed goes on: by how much, m/s, and how much more that is than a train makes in the time, m/s.
fn leap_mps(rows: &[Sample], stuck: &StuckRows, usual: &UsualReadings) -> Option<[f64; 2]> {
    let (last, next) = (rows[stuck.to], rows.get(stuck.to + 1)?);
    let stays_mps = last.speed_mps?;
    let leap_mps = next.speed_mps? - stays_mps;
    let from_zero_mps = if stays_mps > 0.0 { 0.0 } else { FROM_ZERO_MPS };
    let most_mps = usual.step_mps + (LARGEST_MPS2 * (next.time_s - last.time_s)).max(LEAST_LEAP_MPS) + from_zero_mps;
    Some([leap_mps, leap_mps.abs() - most_mps])
}

/// The speed that stood still goes on with a leap that no train makes, and the distance that it misses is that of a
/// train which changed its speed by so much meanwhile.
fn leaps_evenly(rows: &[Sample], stuck: &StuckRows, usual: &UsualReadings) -> bool {
    let held = &rows[stuck.from..=stuck.to];
    let Some([leap_mps, beyond_mps]) = leap_mps(rows, stuck, usual) else { return false };
    let long_s = rows[stuck.to].time_s - rows[stuck.from].time_s;
    beyond_mps > 0.0
        && held[0].speed_mps.is_some_and(|mps| mps > 0.0)
        && held.len() >= LEAST_LEAPT
        && long_s >= LEAST_LEAPT_S
        && LEAPT_SHARE.contains(&(stuck.metres / (leap_mps * long_s)))
        && stuck.metres.abs() > LEAST_LEAPT_M
}

/// The locations run away from the speed on the way, whatever makes up for it before the speed leaps.
fn runs_away(rows: &[Sample], stuck: &StuckRows, away: &Away, usual: &UsualReadings) -> bool {
    let least_m = (AWAY_NOISE * usual.noise_m).max(2.0 * usual.step_m).max(between_m(rows, stuck)).max(LEAST_LEAPT_M);
    let long_s = rows[stuck.to].time_s - rows[stuck.from].time_s;
    let is_away = away.most_m > least_m && away.most_m - away.leap_m > WITHOUT_LEAP * least_m;
    let leaps = leap_mps(rows, stuck, usual).is_some_and(|[_, beyond_mps]| beyond_mps > 0.0);
    let moved = rows[stuck.from].speed_mps.is_some_and(|mps| mps > 0.0);
    let ends_away = moved && !away.leaps(away.most_m) && away.ends_m > LEAST_AWAY_M.max(ENDS_NOISE * usual.noise_m);
    stuck.count >= LEAST_STUCK && long_s >= LEAST_LEAPT_S && is_away && !away.is_wild && (leaps || ends_away)
}

/// How locations run away from a speed that stays the same, m, beyond what a wheel and a step make.
struct Away {
    /// Between any two of the rows.
    most_m: f64,
    /// From where that begins to the last row.
    ends_m: f64,
    /// Between two neighbours, with what a wheel makes.
    leap_m: f64,
    /// No train of this run leaps so.
    is_wild: bool,
}

impl Away {
    fn of(rows: &[Sample], stuck: &StuckRows, usual: &UsualReadings) -> Option<Self> {
        let first = rows[stuck.from];
        let stays_mps = first.speed_mps?;
        let missed_mps = usual.missed_mps(stays_mps);
        // A train that goes back in the same log reads speeds above zero.
        let mut read_m = rows[stuck.from..=stuck.to].iter().filter_map(|row| row.location_m);
        let runs_m = read_m.next().zip(read_m.next_back()).map_or(0.0, |(first, last)| last - first);
        let sign = if runs_m == 0.0 { usual.sign } else { runs_m.signum() };
        let off = |row: &Sample| {
            let run_s = row.time_s - first.time_s;
            Some((run_s, sign * row.location_m? - stays_mps * run_s))
        };
        let offs: Vec<(f64, f64)> = rows[stuck.from..=stuck.to].iter().filter_map(off).collect();
        let mut away = Self { most_m: 0.0, ends_m: 0.0, leap_m: 0.0, is_wild: false };
        let (Some(first), Some(last)) = (offs.first(), offs.last()) else { return Some(away) };
        for side in [1.0, -1.0] {
            let beyond_m = |(run_s, off_m): &(f64, f64)| side * off_m - missed_mps * run_s;
            let mut least = first;
            for now in &offs {
                least = if beyond_m(now) < beyond_m(least) { now } else { least };
                let away_m = beyond_m(now) - beyond_m(least);
                if away_m > away.most_m {
                    // What was off before, and is made up for, is that of a location.
                    let ends_m = (last.1 - least.1).abs().min((last.1 - first.1).abs());
                    away.most_m = away_m;
                    away.ends_m = ends_m - missed_mps * (last.0 - least.0);
                }
            }
        }
        for pair in offs.windows(2) {
            let [(a_s, a_m), (b_s, b_m)] = [pair[0], pair[1]];
            away.leap_m = away.leap_m.max((b_m - a_m).abs());
            away.is_wild |= (b_m - a_m).abs() > usual.fastest_mps * (b_s - a_s) + AWAY_NOISE * usual.noise_m;
        }
        Some(away)
    }

    /// One step of the location makes most of such a distance.
    fn leaps(&self, metres: f64) -> bool {
        self.leap_m >= MOST_OF_LEAP * metres
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::location::odometer::tests::read_at;

    /// A second, and what the train does in it: 30 m/s, then this acceleration from second 100 on.
    fn driven(acceleration_mps2: f64) -> Vec<Sample> {
        let (mut mps, mut at_m) = (30.0_f64, 0.0);
        let row = |second: u32| {
            let change = if second < 100 { 0.0 } else { acceleration_mps2 };
            let before_mps = mps;
            mps = (mps + change).max(0.0);
            at_m += 0.5 * (before_mps + mps);
            let read = (36.0 * mps).round() / 36.0;
            Sample { time_s: f64::from(second), location_m: Some(at_m), speed_mps: Some(read), ..Sample::default() }
        };
        (0..400).map(row).collect()
    }

    #[test]
    fn a_speed_that_stands_still_in_a_coast_is_seen_by_the_leap_with_which_it_goes_on() {
        let mut rows = driven(-0.03);
        let stays = rows[150].speed_mps;
        rows[150..210].iter_mut().for_each(|row| row.speed_mps = stays);
        let mut findings = Vec::new();
        leave_out(&mut rows, None, &mut findings);
        assert_eq!(findings.iter().map(|finding| finding.kind).collect::<Vec<_>>(), [Kind::StuckSpeed]);
        assert!(rows[152..210].iter().all(|row| row.speed_mps.is_none()) && rows[215].speed_mps.is_some());
        // Held, then braked as hard as trains do.
        for acceleration_mps2 in [-0.03, -1.2] {
            leave_out(&mut driven(acceleration_mps2), None, &mut findings);
            assert_eq!(findings.len(), 1);
        }
    }

    /// Down to 8 m/s and up to 32: the distance is that of the held speed when it goes on.
    #[test]
    fn a_speed_that_stands_still_is_seen_where_the_train_makes_up_for_what_it_missed() {
        let slows_and_powers = |t: f64| (20.0 - (t - 100.0).clamp(0.0, 12.0) + (t - 112.0).clamp(0.0, 24.0)).max(0.0);
        let mut findings = Vec::new();
        leave_out(&mut read_at(slows_and_powers), None, &mut findings);
        assert_eq!(findings, []);
        let mut rows = read_at(slows_and_powers);
        rows[90..142].iter_mut().for_each(|row| row.speed_mps = Some(20.0));
        leave_out(&mut rows, None, &mut findings);
        assert_eq!(findings.iter().map(|finding| finding.kind).collect::<Vec<_>>(), [Kind::StuckSpeed]);
        assert!(findings[0].figure.value > 100.0, "{findings:?}");
    }

    #[test]
    fn a_location_that_leaps_beside_a_held_speed_is_no_speed_that_stands_still() {
        // Held, then an emergency brake.
        let held = |t: f64| (20.0 - 2.8 * (t - 200.0).max(0.0)).max(0.0);
        for leap_m in [60.0, 230.0, 5000.0] {
            let mut rows = read_at(held);
            rows[150..].iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| m + leap_m));
            let mut findings = Vec::new();
            leave_out(&mut rows, None, &mut findings);
            assert_eq!(findings, [], "{leap_m}");
        }
    }

    /// The distance between two rows without a speed was taken to be none, so the locations of a steady train ran away
    /// from it.
    #[test]
    fn a_steady_speed_that_stands_in_every_fifth_row_is_no_sensor_that_stands_still() {
        let mut rows = read_at(|_| 20.0);
        rows.iter_mut().enumerate().filter(|(i, _)| i % 5 != 0).for_each(|(_, row)| row.speed_mps = None);
        let mut findings = Vec::new();
        leave_out(&mut rows, None, &mut findings);
        assert_eq!(findings, []);
        // One that is off by a half is found as in full columns.
        rows.iter_mut().for_each(|row| row.speed_mps = row.speed_mps.map(|mps| 0.5 * mps));
        leave_out(&mut rows, None, &mut findings);
        assert_eq!(findings.iter().map(|finding| finding.kind).collect::<Vec<_>>(), [Kind::StuckSpeed]);
    }
}
