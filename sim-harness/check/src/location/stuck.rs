//! Locations that stand still while the train does not: of a sensor that fails for a while, or of a receiver that holds
//! them between its fixes.

use crate::finding::{Finding, Kind};
use crate::rows::steps;
use crate::rows::stuck::{self, LEAST_STUCK, LEAST_STUCK_M, STUCK_SHARE, StuckRows};
use crate::rows::ways::{between, fastest_mps, heading, reaches};
use rundown_files::sample::Sample;
use std::ops::RangeInclusive;

/// Fewer rows than `LEAST_STUCK` show it where the location then makes up for what it missed but for this share.
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

/// Locations that stand still while the train does not: left out.
pub(crate) fn leave_out(rows: &mut [Sample], findings: &mut Vec<Finding>) {
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
    let mut places = stuck::stretches(rows, |row| row.location_m, |by_speed, _| by_speed, 2);
    places.retain(tells);
    places.iter_mut().for_each(|stuck| stuck.begins_old = last_new(rows, stuck.from, sign) < stuck.from);
    stuck::leave_out(rows, &places, Kind::StuckLocation, findings);
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
