//! Odometers that turn over or begin again on the way: the locations after that are joined to those before.

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::stuck::{StuckRows, is_beside};
use crate::rows::ways::{LONGEST_S, ahead_m, between, fastest_mps, heading, noise_m, reaches};
use rundown_files::sample::Sample;

/// Turns of odometers, m.
const TURNS_M: [f64; 6] = [10_000.0, 32_768.0, 65_536.0, 100_000.0, 1_000_000.0, 10_000_000.0];
/// A smaller shift of the location is the estimator's to judge: so many times the usual one between two rows, within
/// these, m.
const SHIFT_OVER_NOISE: f64 = 20.0;
const LEAST_SHIFT_M: (f64, f64) = (100.0, 400.0);
/// How far a turn may be off, m, beyond a share of the distance since the last row.
const NEAR_M: f64 = 60.0;
/// A train whose speed is not read runs no faster, m/s; only a turn well above the way at that pace shows then.
const MOST_MPS: f64 = 100.0;
const WELL_BELOW: f64 = 0.45;
/// So many rows before and behind tell which way the locations go.
const NEAR_ROWS: usize = 6;
/// An odometer that has gone so far, m, and reads less than that, has begun again at zero.
const BEGINS_AGAIN_M: (f64, f64) = (1000.0, 100.0);
/// One that has gone less has where it does so often, as at each stop: so many times, and it reads less than this, m.
const OFTEN: usize = 3;
const ZERO_M: f64 = 10.0;
/// Over so many steps locations show that they go on.
const STAYS_STEPS: usize = 3;

/// Joins what wraps and resets have torn apart. `stuck`: speeds that stand still, beside which locations seem to begin
/// elsewhere.
pub fn join(rows: &mut [Sample], stuck: &[StuckRows], findings: &mut Vec<Finding>) {
    let overall = heading(rows);
    let least_m = (SHIFT_OVER_NOISE * noise_m(rows, overall)).clamp(LEAST_SHIFT_M.0, LEAST_SHIFT_M.1);
    let (mut shift_m, mut last_read_m) = (0.0, 0.0);
    let mut pace_mps = 0.0;
    let mut last: Option<(usize, Sample)> = None;
    // Distance by speed since the location last changed: one that stood still and catches up begins nowhere again.
    let mut waited_m = 0.0;
    // Locations that go on at a pace of their own beside a speed that stands still begin nowhere again.
    let mut was_off = false;
    let fastest_mps = fastest_mps(rows);
    let is_often = begins_often(rows);
    for i in 0..rows.len() {
        let Some(read_m) = rows[i].location_m.filter(|m| m.is_finite()) else {
            continue;
        };
        if let Some((at, before)) = last {
            let step_m = read_m + shift_m - before.location_m.unwrap_or(read_m);
            let way = |sign: f64| ExpectedWay::of([&before, &rows[i]], sign, pace_mps);
            let is_away = |way: &ExpectedWay| way.misses(step_m, least_m) && way.misses(step_m - waited_m, least_m);
            let (mut sign, mut expected) = (overall, way(overall));
            if is_away(&expected) {
                // A train may turn on the way.
                sign = heading_near(rows, i).unwrap_or(overall);
                expected = way(sign);
            }
            let is_off = is_away(&expected) && !may_go([&before, &rows[i]], sign * step_m, fastest_mps);
            let jump_m = step_m - expected.way_m;
            waited_m = if read_m == last_read_m { waited_m + expected.way_m } else { 0.0 };
            let goes_on_off = std::mem::replace(&mut was_off, is_off);
            let stays = (is_off && !goes_on_off).then(|| stays(rows, i, sign)).flatten();
            if let Some(steps) = stays {
                // An odometer that goes on where it was has not turned over: a clock was set, or the location stood
                // still.
                let turned = |turn_m: f64| (read_m - last_read_m).abs() > 0.5 * turn_m;
                let may_turn = |turn_m: f64| turn_m > expected.least_turn_m && turned(turn_m);
                let is_near = |turn_m: f64| (jump_m.abs() - turn_m).abs() < expected.allowed_m;
                let turn = TURNS_M.iter().find(|turn| is_near(**turn) && may_turn(**turn));
                let gone_m = before.location_m.map_or(0.0, |m| (m - shift_m).abs());
                let zero = (read_m.abs() < BEGINS_AGAIN_M.1 && gone_m > BEGINS_AGAIN_M.0)
                    || (is_often && read_m.abs() < ZERO_M);
                let (kind, change_m) = match turn {
                    Some(turn) => (Kind::Wrap, -turn.copysign(jump_m)),
                    None => (Kind::Reset, -jump_m),
                };
                let done = if turn.is_some() || zero { Done::PutRight } else { Done::Said };
                // A turn shows at the end of a log, too, where little is left.
                let is_shown = turn.is_some() || steps == STAYS_STEPS;
                if is_shown && (done == Done::PutRight || !is_beside(stuck, [at, i])) {
                    let figure = Figure { value: jump_m, sd: 0.0 };
                    findings.push(Finding { kind, figure, unit: "m", count: 1, line: rows[i].line, done });
                }
                if is_shown && done == Done::PutRight {
                    shift_m += change_m;
                }
            }
        }
        rows[i].location_m = Some(read_m + shift_m);
        if let Some((_, before)) = last.filter(|(_, before)| rows[i].time_s > before.time_s) {
            let step_m = read_m + shift_m - before.location_m.unwrap_or(read_m);
            pace_mps = (step_m / (rows[i].time_s - before.time_s)).clamp(-MOST_MPS, MOST_MPS);
        }
        (last, last_read_m) = (Some((i, rows[i])), read_m);
    }
}

/// The way from one row to the next that is expected, m.
struct ExpectedWay {
    way_m: f64,
    /// How far the turn of an odometer may be from a jump.
    allowed_m: f64,
    /// No smaller turn shows.
    least_turn_m: f64,
}

impl ExpectedWay {
    /// By the speeds of both rows, or, without any, by the pace of the locations before.
    fn of([a, b]: [&Sample; 2], sign: f64, pace_mps: f64) -> Self {
        if let Some(most_m) = most_m(a, b) {
            let allowed_m = NEAR_M + most_m;
            let way_m = pace_mps / MOST_MPS * most_m;
            return Self { way_m, allowed_m, least_turn_m: allowed_m / WELL_BELOW };
        }
        let way_m = sign * between(a, b);
        Self { way_m, allowed_m: NEAR_M + 0.3 * way_m.abs(), least_turn_m: 0.0 }
    }

    fn misses(&self, step_m: f64, least_m: f64) -> bool {
        (step_m - self.way_m).abs() > least_m + 0.5 * self.way_m.abs()
    }
}

/// A train may go so far ahead from one row to the next, m, whatever it does.
fn may_go([a, b]: [&Sample; 2], ahead_m: f64, fastest_mps: f64) -> bool {
    let by_speed = || reaches(a, b, fastest_mps).is_some_and(|reach| reach.contains(&ahead_m));
    most_m(a, b).map_or_else(by_speed, |most_m| ahead_m.abs() <= most_m)
}

/// The longest way from one row to the next, m, where the speed is read in neither.
fn most_m(a: &Sample, b: &Sample) -> Option<f64> {
    a.speed_mps.or(b.speed_mps).is_none().then(|| MOST_MPS * (b.time_s - a.time_s).clamp(0.0, LONGEST_S))
}

/// +1 or -1 where locations grow or fall around row `i`, but for the step to it.
fn heading_near(rows: &[Sample], i: usize) -> Option<f64> {
    let end = (i + NEAR_ROWS).min(rows.len());
    let ahead_m = ahead_m(&rows[i.saturating_sub(NEAR_ROWS)..i]) + ahead_m(&rows[i..end]);
    (ahead_m != 0.0).then(|| ahead_m.signum())
}

/// The turn of an odometer, m, nearest to a jump of the location.
pub fn turn_m(jump_m: f64) -> f64 {
    let off = |turn: &f64| (jump_m.abs() - turn).abs();
    TURNS_M.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or_default()
}

/// The odometer begins again at zero at each stop: short hops, too, bring it there again and again.
fn begins_often(rows: &[Sample]) -> bool {
    let mut last_m: f64 = 0.0;
    let begins = rows.iter().filter_map(|row| row.location_m).filter(|now_m| {
        let before_m = std::mem::replace(&mut last_m, *now_m);
        now_m.abs() < ZERO_M && before_m.abs() > LEAST_SHIFT_M.0
    });
    begins.count() >= OFTEN
}

/// The locations go on from row `i` as the speed says, from row to row and over all of them: it is no spike, and no
/// speed that stands still. Out: over how many steps, fewer than asked at the end of a log.
fn stays(rows: &[Sample], i: usize, sign: f64) -> Option<usize> {
    let located = rows[i..].iter().filter(|row| row.location_m.is_some()).take(STAYS_STEPS + 1);
    let located: Vec<&Sample> = located.collect();
    let steps = located.windows(2).map(|pair| {
        let step_m = pair[1].location_m.unwrap_or_default() - pair[0].location_m.unwrap_or_default();
        let most_m = most_m(pair[0], pair[1]);
        (step_m, most_m.map_or_else(|| sign * between(pair[0], pair[1]), |most_m| step_m.clamp(-most_m, most_m)))
    });
    let steps: Vec<(f64, f64)> = steps.collect();
    let agree = |(by_location, by_speed): (f64, f64)| (by_location - by_speed).abs() < 100.0 + 0.5 * by_location.abs();
    let all = steps.iter().fold((0.0, 0.0), |sum, step| (sum.0 + step.0, sum.1 + step.1));
    (steps.iter().copied().all(agree) && agree(all)).then_some(steps.len())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// 20 m/s, a row every 5 s.
    fn rows(location_m: impl Fn(usize) -> f64, time_s: impl Fn(usize) -> f64) -> Vec<Sample> {
        let row = |i| Sample {
            time_s: time_s(i),
            location_m: Some(location_m(i)),
            speed_mps: Some(20.0),
            line: i as u64 + 2,
            ..Sample::default()
        };
        (0..60).map(row).collect()
    }

    fn joined(mut rows: Vec<Sample>) -> (Vec<Sample>, Vec<Finding>) {
        let mut findings = Vec::new();
        join(&mut rows, &[], &mut findings);
        (rows, findings)
    }

    #[test]
    fn an_odometer_that_wraps_is_joined() {
        let time_s = |i| 5.0 * i as f64;
        let (rows, findings) = joined(rows(|i| (7_000.0 + 100.0 * i as f64) % 10_000.0, time_s));
        assert_eq!(findings.iter().map(|finding| finding.kind).collect::<Vec<_>>(), [Kind::Wrap]);
        assert!(rows.windows(2).all(|pair| pair[1].location_m > pair[0].location_m));
    }

    #[test]
    fn an_odometer_beside_no_speed_wraps_where_its_turn_is_far_above_the_way_from_row_to_row() {
        let kinds = |step_s: f64, turn_m: f64, sign: f64| {
            let mut all =
                rows(|i| (sign * (0.7 * turn_m + 20.0 * step_s * i as f64)).rem_euclid(turn_m), |i| step_s * i as f64);
            all.iter_mut().for_each(|row| row.speed_mps = None);
            let (rows, findings) = joined(all);
            let goes_on = |pair: &[Sample]| (pair[1].location_m.unwrap() - pair[0].location_m.unwrap()) * sign > 0.0;
            (findings.iter().map(|one| one.kind).collect::<Vec<_>>(), rows.windows(2).all(goes_on))
        };
        for (step_s, turn_m, sign) in
            [(5.0, 10_000.0, 1.0), (5.0, 10_000.0, -1.0), (20.0, 32_768.0, -1.0), (30.0, 65_536.0, 1.0)]
        {
            assert_eq!(kinds(step_s, turn_m, sign), (vec![Kind::Wrap], true), "{step_s} {turn_m} {sign}");
        }
        assert!(!kinds(60.0, 10_000.0, 1.0).1);
    }

    #[test]
    fn an_odometer_that_wraps_in_the_last_row_is_joined_and_a_leap_there_is_none() {
        let last = |location_m: f64| {
            let mut all = rows(|i| 4_000.0 + 100.0 * i as f64, |i| 5.0 * i as f64);
            all[59].location_m = Some(location_m);
            let (rows, findings) = joined(all);
            (rows[59].location_m.unwrap(), findings.len())
        };
        assert_eq!(last(-100.0), (9_900.0, 1));
        assert_eq!(last(2_000.0), (2_000.0, 0));
    }

    /// Hops of 600 m at 10 m/s, and stands of 30 s between them: each was cut off as a run of its own, too short for
    /// one.
    #[test]
    fn an_odometer_that_begins_again_at_each_stop_of_a_tram_is_joined() {
        let hops = |count: usize| {
            let row = |second: usize| {
                let at = second % 90;
                let (metres, mps) = if at < 60 { (10 * at, 10.0) } else { (600, 0.0) };
                Sample {
                    time_s: second as f64,
                    location_m: Some(metres as f64),
                    speed_mps: Some(mps),
                    line: second as u64 + 2,
                    ..Sample::default()
                }
            };
            joined((0..90 * count).map(row).collect())
        };
        let (rows, findings) = hops(5);
        assert_eq!(findings.len(), 4);
        assert!(findings.iter().all(|finding| finding.done == Done::PutRight), "{findings:?}");
        assert!(rows.windows(2).all(|pair| pair[1].location_m >= pair[0].location_m));
        // Once is another chainage.
        assert!(hops(2).1.iter().all(|finding| finding.done == Done::Said));
    }

    #[test]
    fn a_speed_that_stands_still_is_no_location_that_begins_again() {
        let mut all = rows(|i| 175.0 * i as f64, |i| 5.0 * i as f64);
        all.iter_mut().for_each(|row| row.speed_mps = Some(35.0));
        all[20..32].iter_mut().for_each(|row| row.speed_mps = Some(0.0));
        assert_eq!(joined(all).1, []);
    }

    /// 420 s at 20 m/s are near 10 000 m, of which the odometer did not turn over.
    #[test]
    fn a_clock_that_is_set_forward_is_no_wrap() {
        let time_s = |i| 5.0 * i as f64 + if i > 30 { 470.0 } else { 0.0 };
        let location_m = |i| 34_700_000.0 + 100.0 * i as f64;
        let (rows, findings) = joined(rows(location_m, time_s));
        assert!(
            findings.iter().all(|finding| finding.kind != Kind::Wrap && finding.done == Done::Said),
            "{findings:?}"
        );
        assert_eq!(rows[59].location_m, Some(location_m(59)));
    }

    /// A row a second of a train with this speed, m/s.
    pub(crate) fn read_at(speed_mps: impl Fn(f64) -> f64) -> Vec<Sample> {
        let mut at_m = 0.0;
        let row = |second: u32| {
            let time_s = f64::from(second);
            at_m += speed_mps(time_s - 0.5);
            Sample { time_s, location_m: Some(at_m), speed_mps: Some(speed_mps(time_s)), ..Sample::default() }
        };
        (0..300).map(row).collect()
    }

    #[test]
    fn a_stop_or_a_hop_of_which_the_rows_are_missing_is_no_location_that_begins_again() {
        let stops = |second: f64| ((second - 150.0).abs() - 10.0).clamp(0.0, 20.0);
        let hops = |second: f64| (40.0 - (second - 150.0).abs()).max(second - 250.0).clamp(0.0, 20.0);
        for rows in [read_at(stops), read_at(hops)] {
            assert_eq!(joined([&rows[..124], &rows[176..]].concat()).1, []);
        }
        // No train stops within 100 m and goes on at 20 m/s.
        let mut rows = read_at(|_| 20.0);
        rows[150..].iter_mut().for_each(|row| row.time_s += 30.0);
        assert_eq!(joined(rows).1.len(), 1);
    }
}
