//! Locations that a sensor made wrong: wraps, resets, spikes, sensors that stand still, two directions.

use crate::agreement::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::reach::reach_m;
use crate::row_step::{self, longest_step_s, usual_step_s};
use crate::steps;
use rundown_files::sample::Sample;
use rundown_files::statistics::spread;
use std::ops::RangeInclusive;

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
/// What a train does in a longer gap is not asked, s.
const LONGEST_S: f64 = 3600.0;
/// So many rows before and behind tell which way the locations go.
const NEAR_ROWS: usize = 6;
/// An odometer that has gone so far, m, and reads less than that, has begun again at zero.
const BEGINS_AGAIN_M: (f64, f64) = (1000.0, 100.0);
/// One that has gone less has where it does so often, as at each stop: so many times, and it reads less than this, m.
const OFTEN: usize = 3;
const ZERO_M: f64 = 10.0;
/// A sensor that stands still over less is not said to, m.
pub(crate) const LEAST_STUCK_M: f64 = 150.0;
/// ... nor over less than this share of the distance.
pub(crate) const STUCK_SHARE: f64 = 0.2;
/// Rows in a row that say the same.
pub(crate) const LEAST_STUCK: usize = 4;
/// Fewer show it where the location then makes up for what it missed but for this share.
const MADE_UP: f64 = 0.5;
/// A train that comes to a stand beside a speed that stands still goes in so many seconds less than this share of the
/// way by that speed, s; and the speed stands still for this share of what the location seems to miss.
const SLOWS_S: f64 = 5.0;
const SLOWED: f64 = 0.6;
const MOST_OF_IT: f64 = 0.8;
/// Locations scatter by less, m.
const LEAST_OLD_M: f64 = 15.0;
/// Of a receiver that holds its location between fixes this share of the rows that show it say the same as the row
/// before, and so many rows.
const HELD_SHARE: f64 = 0.2;
const LEAST_HELD: usize = 10;
/// A row shows it where the train runs so many steps of the location since the row before, and no less than this, m.
const HELD_STEPS: f64 = 2.0;
const LEAST_RUN_M: f64 = 3.0;
/// Both directions, if each has at least this, m.
const LEAST_WAY_M: f64 = 500.0;

fn finding(kind: Kind, value: f64, count: usize, line: u64, done: Done) -> Finding {
    Finding { kind, figure: Figure { value, sd: 0.0 }, unit: "m", count, line, done }
}

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
                    findings.push(finding(kind, jump_m, 1, rows[i].line, done));
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

/// The largest speed that was read, m/s.
pub(crate) fn fastest_mps(rows: &[Sample]) -> f64 {
    rows.iter().filter_map(|row| row.speed_mps).fold(0.0, f64::max)
}

/// The ways that a train may go from one row to the other, whatever it does between them, m.
fn reaches(a: &Sample, b: &Sample, fastest_mps: f64) -> Option<RangeInclusive<f64>> {
    Some(reach_m([a.speed_mps?, b.speed_mps?], b.time_s - a.time_s, fastest_mps))
}

/// How far the step of the location from row to row usually is from that by speed, m.
pub(crate) fn noise_m(rows: &[Sample], sign: f64) -> f64 {
    let off = rows.windows(2).filter_map(|pair| {
        let step_m = pair[1].location_m? - pair[0].location_m?;
        Some(step_m - sign * between(&pair[0], &pair[1]))
    });
    spread(off)
}

/// +1 where locations grow more often than they fall.
pub fn heading(rows: &[Sample]) -> f64 {
    if ahead_m(rows) < 0.0 { -1.0 } else { 1.0 }
}

/// How far locations grow in all, m; a leap is no way.
fn ahead_m(rows: &[Sample]) -> f64 {
    let located: Vec<f64> = rows.iter().filter_map(|row| row.location_m).collect();
    located.windows(2).map(|pair| (pair[1] - pair[0]).clamp(-100.0, 100.0)).sum()
}

/// Distance by speed between two rows, m.
fn between(a: &Sample, b: &Sample) -> f64 {
    let speeds = [a.speed_mps, b.speed_mps].into_iter().flatten();
    let count = speeds.clone().count().max(1) as f64;
    speeds.sum::<f64>() / count * (b.time_s - a.time_s).clamp(0.0, LONGEST_S)
}

/// Over so many steps locations show that they go on.
const STAYS_STEPS: usize = 3;

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

/// A speed that stands still is one of those between these rows.
fn is_beside(stuck: &[StuckRows], [from, to]: [usize; 2]) -> bool {
    stuck.iter().any(|stuck| stuck.from <= to && from <= stuck.to)
}

/// So many wild readings may stand together.
const MOST_WILD: usize = 3;

/// Readings, of these rows, that are far from those before and behind: each with how far. `far` takes the last reading
/// that is not wild, the first and the last of those that may be, and the next one.
pub(crate) fn wild(read: &[usize], far: impl Fn([usize; 4]) -> Option<f64>) -> Vec<(usize, f64)> {
    let mut found = Vec::new();
    let Some(mut before) = read.first().copied() else { return found };
    let mut at = 1;
    while at + 1 < read.len() {
        let together = (1..=MOST_WILD).find_map(|long| {
            let after = *read.get(at + long)?;
            Some((long, far([before, read[at], read[at + long - 1], after])?))
        });
        match together {
            Some((long, off)) => {
                found.extend(read[at..at + long].iter().map(|i| (*i, off)));
                at += long;
            }
            None => {
                before = read[at];
                at += 1;
            }
        }
    }
    found
}

/// A location nearer to its neighbours is none of a spike, m.
const LEAST_SPIKE_M: f64 = 80.0;

/// Locations far from both neighbours, which agree with each other: left out. Beside speeds that stand still, `stuck`,
/// they seem to be.
pub(crate) fn spikes(rows: &mut [Sample], stuck: &[StuckRows], findings: &mut Vec<Finding>) {
    let sign = heading(rows);
    let located: Vec<usize> = (0..rows.len()).filter(|i| rows[*i].location_m.is_some()).collect();
    let fastest_mps = fastest_mps(rows);
    let off_m = |a: usize, b: usize| {
        let [a, b] = [a, b].map(|i| &rows[i]);
        let step_m = b.location_m.unwrap_or_default() - a.location_m.unwrap_or_default();
        // Between rows far apart a train starts or stops, and runs another way than the mean of both speeds says.
        let reach = reaches(a, b, fastest_mps).filter(|_| b.time_s - a.time_s > row_step::MOST_MEAN_S);
        reach.map_or_else(
            || (step_m - sign * between(a, b)).abs(),
            |reach| {
                let way_m = sign * step_m;
                (reach.start() - way_m).max(way_m - reach.end()).max(0.0)
            },
        )
    };
    let found = wild(&located, |[before, first, last, after]| {
        if is_beside(stuck, [before, after]) {
            return None;
        }
        // Hardly any is, and most are asked no more than this.
        let first_m = off_m(before, first);
        if first_m <= LEAST_SPIKE_M {
            return None;
        }
        let least_m = first_m.min(off_m(last, after));
        (least_m > LEAST_SPIKE_M && least_m > 5.0 * off_m(before, after)).then_some(first_m)
    });
    if let Some((first, _)) = found.first() {
        let largest_m = found.iter().map(|(_, off)| *off).fold(0.0, f64::max);
        findings.push(finding(Kind::LocationSpikes, largest_m, found.len(), rows[*first].line, Done::LeftOut));
        found.iter().for_each(|(i, _)| rows[*i].location_m = None);
    }
}

/// Locations that stand still while the train does not: left out.
pub fn stuck_locations(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let (sign, held_m) = (heading(rows), least_held_m(rows));
    let few_m = LEAST_STUCK_M.max(HELD_STEPS * steps::of_location_m(rows.iter()).unwrap_or(0.0));
    let is_far = |stuck: &StuckRows| match held_m {
        Some(least_m) => stuck.metres > least_m,
        None if stuck.count >= LEAST_STUCK => stuck.metres > LEAST_STUCK_M,
        None => stuck.metres > few_m && makes_up(rows, stuck, sign),
    };
    let tells = |stuck: &StuckRows| {
        stuck.metres > STUCK_SHARE * stuck.way_m && is_far(stuck) && !comes_to_a_stand(rows, stuck, sign)
    };
    let mut places = stretches(rows, |row| row.location_m, |by_speed, _| by_speed, 2);
    places.retain(tells);
    places.iter_mut().for_each(|stuck| stuck.begins_old = last_new(rows, stuck.from, sign) < stuck.from);
    leave_out(rows, &places, Kind::StuckLocation, findings);
}

/// The location leaps to where the train is by then: one that stood still for few rows may else be that of a train that
/// stands beside a wrong speed.
fn makes_up(rows: &[Sample], stuck: &StuckRows, sign: f64) -> bool {
    let Some((between, ways_m)) = to_next(rows, stuck, sign) else { return false };
    // The speed may stand still, too, while the train brakes.
    let [from, next] = between.map(|i| rows[i]);
    let is_reached = reaches(&from, &next, fastest_mps(rows)).is_some_and(|reach| reach.contains(&ways_m[0]));
    is_made_up(ways_m, stuck) || is_reached
}

/// From the last new location to the next one: these rows, and the ways by location and by speed, m.
fn to_next(rows: &[Sample], stuck: &StuckRows, sign: f64) -> Option<([usize; 2], [f64; 2])> {
    let next = (stuck.to + 1..rows.len()).find(|i| rows[*i].location_m.is_some())?;
    let from = last_new(rows, stuck.from, sign);
    Some(([from, next], ways_m(rows, from..=next, sign)))
}

fn is_made_up([way_m, by_speed_m]: [f64; 2], stuck: &StuckRows) -> bool {
    (way_m - by_speed_m).abs() < MADE_UP * stuck.metres
}

/// It is the speed that stands still: the train slows down by its locations before they stand, and goes on from there.
fn comes_to_a_stand(rows: &[Sample], stuck: &StuckRows, sign: f64) -> bool {
    let Some(stays_mps) = rows[stuck.from].speed_mps else { return false };
    let slows_s = rows[stuck.from].time_s - SLOWS_S;
    let slows = (0..stuck.from).rev().find(|i| rows[*i].location_m.is_some() && rows[*i].time_s <= slows_s);
    let Some(slows) = slows else { return false };
    let stays = |i: &usize| rows[*i].speed_mps.is_none_or(|mps| mps == stays_mps);
    let last = (slows..=stuck.to).take_while(stays).last().unwrap_or(slows).max(stuck.from);
    let [way_m, by_speed_m] = ways_m(rows, slows..=stuck.from, sign);
    let stuck_m = stays_mps * (rows[last].time_s - rows[stuck.from].time_s);
    let goes_on = to_next(rows, stuck, sign).is_some_and(|(_, ways_m)| !is_made_up(ways_m, stuck));
    way_m < SLOWED * by_speed_m && stuck_m > MOST_OF_IT * stuck.metres && goes_on
}

/// The row before one whose location is no new one: the way to it is too short. Else that row.
fn last_new(rows: &[Sample], from: usize, sign: f64) -> usize {
    let Some(before) = (0..from).rev().find(|i| rows[*i].location_m.is_some()) else { return from };
    let [way_m, by_speed_m] = ways_m(rows, before..=from, sign);
    if by_speed_m - way_m > LEAST_OLD_M.max(STUCK_SHARE * by_speed_m) { before } else { from }
}

/// From the first to the last of these rows: the way by location and that by speed, m.
fn ways_m(rows: &[Sample], of: RangeInclusive<usize>, sign: f64) -> [f64; 2] {
    let rows = &rows[of];
    let ends = rows.first().zip(rows.last());
    let by_location_m = ends.and_then(|(a, b)| Some(sign * (b.location_m? - a.location_m?)));
    [by_location_m.unwrap_or(0.0), rows.windows(2).map(|pair| between(&pair[0], &pair[1])).sum()]
}

/// The distance that shows a location to be an old one, m, where a receiver holds it between its fixes.
fn least_held_m(rows: &[Sample]) -> Option<f64> {
    let least_m = (HELD_STEPS * steps::of_location_m(rows.iter()).unwrap_or(0.0)).max(LEAST_RUN_M);
    let shown = rows.windows(2).filter_map(|pair| {
        let [before_m, now_m] = [pair[0].location_m?, pair[1].location_m?];
        (between(&pair[0], &pair[1]) > least_m).then_some(before_m == now_m)
    });
    let (asked, held) = shown.fold((0, 0), |(asked, held), same| (asked + 1, held + usize::from(same)));
    (held >= LEAST_HELD && held as f64 > HELD_SHARE * f64::from(asked)).then_some(least_m)
}

pub(crate) fn leave_out(rows: &mut [Sample], stretches: &[StuckRows], kind: Kind, findings: &mut Vec<Finding>) {
    let Some(first) = stretches.first() else {
        return;
    };
    let metres = stretches.iter().map(|stretch| stretch.metres.abs()).sum();
    findings.push(finding(kind, metres, stretches.len(), rows[first.from].line, Done::LeftOut));
    for StuckRows { from, to, begins_old, .. } in stretches {
        if kind == Kind::StuckLocation {
            // The first of them was mostly read while the sensor still worked.
            rows[from + usize::from(!begins_old)..=*to].iter_mut().for_each(|row| row.location_m = None);
        } else {
            rows[*from..=*to].iter_mut().for_each(|row| row.speed_mps = None);
        }
    }
}

/// Rows in which a reading stays the same, and the distance that it misses.
pub struct StuckRows {
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// How many of them have the reading.
    pub(crate) count: usize,
    /// The first has an old one already.
    begins_old: bool,
    pub(crate) metres: f64,
    /// The distance in these rows, by speed or by location.
    pub(crate) way_m: f64,
}

/// Stretches of so many rows at least in which a reading stays the same, with the `missing` of distance by speed and by
/// location. Where rows are missing a train may have stopped, and the reading be a new one.
pub(crate) fn stretches(
    rows: &[Sample],
    reading: fn(&Sample) -> Option<f64>,
    missing: fn(f64, f64) -> f64,
    least: usize,
) -> Vec<StuckRows> {
    let mut found = Vec::new();
    let mut from = 0;
    let longest_s = longest_step_s(usual_step_s(rows));
    while from < rows.len() {
        let Some(stays) = reading(&rows[from]) else {
            from += 1;
            continue;
        };
        // A reading that is lost between two equal ones ends nothing.
        let goes_on = |i: &usize| *i == from || rows[*i].time_s - rows[i - 1].time_s <= longest_s;
        let alike = (from..rows.len()).take_while(goes_on).map(|i| (i, reading(&rows[i])));
        let alike = alike.take_while(|(_, read)| read.is_none_or(|read| read == stays));
        let read: Vec<usize> = alike.filter_map(|(i, read)| read.map(|_| i)).collect();
        let (same, to) = (read.len(), read.last().copied().unwrap_or(from));
        if same >= least {
            let located = (from..=to).filter(|i| rows[*i].location_m.is_some());
            let [first, last] = [located.clone().min().unwrap_or(from), located.max().unwrap_or(from)];
            let by_speed = run_m(&rows[from..=to], [first, last].map(|i| rows[i].time_s));
            let by_location = rows[first].location_m.zip(rows[last].location_m).map_or(0.0, |(a, b)| (b - a).abs());
            let metres = missing(by_speed, by_location);
            let (begins_old, way_m) = (false, by_speed.max(by_location));
            found.push(StuckRows { from, to, count: same, begins_old, metres, way_m });
        }
        from = to + 1;
    }
    found
}

/// Distance by speed from the first row to each of them, m; of each row its time, s, and its speed, m/s.
pub(crate) fn run_until_m(rows: &[[f64; 2]]) -> Vec<f64> {
    let mut ways_m = vec![0.0];
    for pair in rows.windows(2) {
        let [[a_s, a_mps], [b_s, b_mps]] = [pair[0], pair[1]];
        ways_m.push(ways_m[ways_m.len() - 1] + 0.5 * (a_mps + b_mps) * (b_s - a_s).max(0.0));
    }
    ways_m
}

/// Distance by speed from one time to another: between two rows with a speed their mean, whatever rows stand between
/// them, before the first and after the last of them that speed.
fn run_m(rows: &[Sample], [from_s, to_s]: [f64; 2]) -> f64 {
    let read: Vec<(f64, f64)> = rows.iter().filter_map(|row| Some((row.time_s, row.speed_mps?))).collect();
    let (Some(first), Some(last)) = (read.first(), read.last()) else { return 0.0 };
    let all = [&[(from_s.min(first.0), first.1)], &read[..], &[(to_s.max(last.0), last.1)]].concat();
    let way = |pair: &[(f64, f64)]| {
        let [(a_s, a_mps), (b_s, b_mps)] = [pair[0], pair[1]];
        let long_s = b_s - a_s;
        // The part of it between the two times.
        let [begins_s, ends_s] = [a_s.max(from_s), b_s.min(to_s)];
        let at = |time_s: f64| if long_s > 0.0 { a_mps + (b_mps - a_mps) * (time_s - a_s) / long_s } else { a_mps };
        0.5 * (at(begins_s) + at(ends_s)) * (ends_s - begins_s).max(0.0)
    };
    all.windows(2).map(way).sum()
}

/// Rows at each end whose median is the end: one wild row is none.
const AT_END: usize = 5;

/// There and back in one log.
pub fn two_directions(rows: &[Sample], findings: &mut Vec<Finding>) {
    let mut latest_s = f64::NEG_INFINITY;
    // A row that comes late is no way back.
    let on_time = rows.iter().filter(|row| {
        let later = row.time_s > latest_s;
        latest_s = latest_s.max(row.time_s);
        later
    });
    let located: Vec<(u64, f64)> = on_time.filter_map(|row| Some((row.line, row.location_m?))).collect();
    let smooth: Vec<(u64, f64)> = located.windows(AT_END).map(middle).collect();
    let (Some((_, first_m)), Some((_, last_m))) = (smooth.first(), smooth.last()) else {
        return;
    };
    // The far end, and how far the train comes back from it.
    let turns = [1.0, -1.0].into_iter().filter_map(|sign| {
        let (line, end_m) = smooth.iter().max_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1)))?;
        let [there, back] = [sign * (end_m - first_m), sign * (end_m - last_m)];
        (there.min(back) > LEAST_WAY_M).then_some((*line, there.min(back)))
    });
    if let Some((line, metres)) = turns.max_by(|a, b| a.1.total_cmp(&b.1)) {
        findings.push(finding(Kind::TwoDirections, metres, 1, line, Done::Refused));
    }
}

/// The row in the middle of some, by their locations.
fn middle(rows: &[(u64, f64)]) -> (u64, f64) {
    let mut sorted = rows.to_vec();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    sorted[sorted.len() / 2]
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

    /// A start and a stop within 60 s at 0.6 m/s²: 229 m beside the mean of both speeds.
    #[test]
    fn starts_and_stops_between_rows_far_apart_make_no_location_wild() {
        let speed_mps = |second: f64| (0.6 * ((second % 400.0) - 50.0).min(350.0 - (second % 400.0))).clamp(0.0, 30.0);
        let log = |phase: usize| -> Vec<Sample> {
            let mut at_m = 0.0;
            let row = |second: usize| {
                let time_s = second as f64;
                at_m += speed_mps(time_s - 0.5);
                Sample { time_s, location_m: Some(at_m), speed_mps: Some(speed_mps(time_s)), ..Sample::default() }
            };
            (0..4000).map(row).skip(phase).step_by(60).collect()
        };
        for phase in [0, 13, 29, 47] {
            let (mut rows, mut findings) = (log(phase), Vec::new());
            spikes(&mut rows, &[], &mut findings);
            assert_eq!(findings, [], "{phase}");
            rows[20].location_m = rows[20].location_m.map(|m| m + 4000.0);
            spikes(&mut rows, &[], &mut findings);
            assert_eq!(findings.len(), 1, "{phase}");
        }
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
