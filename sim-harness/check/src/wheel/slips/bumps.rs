//! Bumps of the speed that a slip may be: beside the straight line between the speeds before and behind, there at once
//! and gone at once.

use super::Chord;
use crate::agreement::compared::Row;
use std::ops::Range;

/// From the last speed before a slip to the first one behind it, s.
const SHORTEST_S: f64 = 3.0;
const LONGEST_S: f64 = 16.0;
/// A slip begins and ends within so long, s.
const AT_ONCE_S: f64 = 1.5;
/// By so much the speed is off between, everywhere: share of it, and m/s.
const LEAST_SHARE: f64 = 0.04;
const LEAST_MPS: f64 = 0.3;
/// Between, the least share is so much of the largest: the speed of a train whose power fades is a bump, too, which
/// comes and goes slowly.
const FLAT: f64 = 0.5;
/// In its last seconds the reading goes back by such a part of it: a train that powers loses no speed.
const ENDS_S: f64 = 2.5;
const BACK: f64 = 0.25;
/// A slower train, before or behind it, starts or stops, m/s.
const SLOWEST_MPS: f64 = 1.5;
/// Acceleration of a train that may power, and of one that brakes, m/s².
const POWERS_MPS2: f64 = -0.05;
const BRAKES_MPS2: f64 = -0.2;

/// A bump of the speed.
pub(super) struct Bump {
    /// The last row before it and the first one behind it.
    pub(super) rows: Range<usize>,
    /// Way by the readings over that of the train between its ends, less 1.
    pub(super) share: f64,
    /// How far the reading is from the line everywhere, m/s, by the root of the time, s.
    size: f64,
}

/// Bumps of the speed that do not overlap, the larger ones first.
pub(super) fn of_part(part: &[Row], sign: f64) -> Vec<Bump> {
    let of_row = |from: usize| {
        let near = part[from + 1..].iter().take_while(|row| row.time_s <= part[from].time_s + LONGEST_S).count();
        let of = (from + 2..=from + near).filter_map(move |end| bump(part, from..end, sign));
        of.max_by(|a, b| a.size.total_cmp(&b.size))
    };
    let mut tried: Vec<Bump> = (0..part.len()).filter_map(of_row).collect();
    tried.sort_by(|a, b| b.size.total_cmp(&a.size));
    let mut found: Vec<Bump> = Vec::new();
    for bump in tried {
        let is_apart = |other: &Bump| other.rows.end <= bump.rows.start || bump.rows.end <= other.rows.start;
        if found.iter().all(is_apart) {
            found.push(bump);
        }
    }
    found.sort_by_key(|bump| bump.rows.start);
    found
}

/// The bump between two rows, where there is one.
fn bump(part: &[Row], rows: Range<usize>, sign: f64) -> Option<Bump> {
    let line = Chord::through(part[rows.start], part[rows.end]);
    let acts = if sign > 0.0 { line.mps2 > POWERS_MPS2 } else { line.mps2 < BRAKES_MPS2 };
    if line.long_s() < SHORTEST_S || !acts || line.to.speed_mps < SLOWEST_MPS {
        return None;
    }
    let (mut shares, mut least_mps) = (Vec::new(), f64::INFINITY);
    let (mut all_over_mps, mut all_mps) = (0.0, 0.0);
    for row in &part[rows.start + 1..rows.end] {
        let mps = line.at(row.time_s);
        let over_mps = sign * (row.speed_mps - mps);
        let is_full = row.time_s >= line.from.time_s + AT_ONCE_S && row.time_s <= line.to.time_s - AT_ONCE_S;
        if over_mps < if is_full { LEAST_MPS.max(LEAST_SHARE * mps) } else { 0.0 } {
            return None;
        }
        if is_full {
            shares.push(over_mps / mps.max(SLOWEST_MPS));
            least_mps = least_mps.min(over_mps);
            (all_over_mps, all_mps) = (all_over_mps + over_mps, all_mps + mps);
        }
    }
    let last = part[rows.start + 1..rows.end].iter().filter(|row| row.time_s >= line.to.time_s - ENDS_S);
    let back_mps = last.map(|row| sign * (row.speed_mps - line.to.speed_mps)).fold(0.0, f64::max);
    if sign > 0.0 && back_mps < BACK * least_mps {
        return None;
    }
    let [least, most] = [f64::min, f64::max].map(|of| shares.iter().copied().reduce(of));
    let share = sign * all_over_mps / all_mps;
    (least? > FLAT * most?).then_some(Bump { rows, share, size: least_mps * line.long_s().sqrt() })
}
