//! Speeds that repeat the last value for a few rows while the train changes its speed: sample and hold.
//!
//! In: rows of a run, as read. Out: which rows hold an old value, and of how many that could have shown it.
//!
//! ```text
//! v  ... 62.1  63.9  63.9  63.9  69.2  71.0 ...        repeats between steps of 1.8, then the steps that were missed
//! ```
//!
//! A rounded speed repeats, too, where it changes by less than its step from row to row. So only those rows are asked
//! where it changes by more, before and after, and only such repeats count after which the speed catches up.

use crate::rows::times::{next_row_s, usual_step_s};
use rundown_files::sample::Sample;

/// A speed that changes by fewer steps from row to row repeats by rounding alone.
const STEPS: f64 = 1.4;
/// A smaller change from row to row may be noise, m/s.
const LEAST_CHANGE_MPS: f64 = 0.25;
/// More repeats are a sensor that stands still, which is asked elsewhere.
const MOST_REPEATS: usize = 8;
/// What is caught up, as a share of the steps that were missed.
const CAUGHT_UP: f64 = 0.45;
/// The change before and that after are those of one train: neither is more than so many times the other.
const ALIKE: f64 = 3.0;
/// A train that brakes on and off has a repeat now and then: held are at least so many rows, and such a share of those
/// asked.
const LEAST_HELD: usize = 3;
const LEAST_SHARE: f64 = 0.01;

/// Rows that hold an old value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Held {
    /// Their numbers.
    pub rows: Vec<usize>,
    /// Rows that would have shown it.
    pub asked: usize,
}

/// How many rows of some runs hold an old value, of how many; none where it is no more than a train does by itself.
pub fn beyond_chance(runs: &[Held]) -> Option<[usize; 2]> {
    let [held, asked] = [runs.iter().map(|run| run.rows.len()).sum::<usize>(), runs.iter().map(|run| run.asked).sum()];
    (held >= LEAST_HELD && held as f64 > LEAST_SHARE * asked as f64).then_some([held, asked])
}

/// What of a run is held. `step_mps`: step of the speeds, 0 without one.
pub fn of(rows: &[Sample], step_mps: f64) -> Held {
    let longest_s = next_row_s(usual_step_s(rows));
    let least_mps = LEAST_CHANGE_MPS.max(STEPS * step_mps);
    let mut held = Held::default();
    let mut first = 1;
    while first + 2 < rows.len() {
        let Some(mps) = rows[first].speed_mps else {
            first += 1;
            continue;
        };
        let repeats = rows[first + 1..].iter().take_while(|row| row.speed_mps == Some(mps)).count();
        let last = first + repeats;
        if let Some(is_held) = asked(rows, [first, last], least_mps, longest_s) {
            held.asked += 1;
            if is_held {
                held.asked += repeats;
                held.rows.extend(first + 1..=last);
            }
        }
        first = last + 1;
    }
    held
}

/// Whether the rows after `first` up to `last` hold its value; none where nothing can be said.
fn asked(rows: &[Sample], [first, last]: [usize; 2], least_mps: f64, longest_s: f64) -> Option<bool> {
    let around = rows.get(first - 1..last + 3)?;
    let is_even =
        around.windows(2).all(|pair| (f64::MIN_POSITIVE..=longest_s).contains(&(pair[1].time_s - pair[0].time_s)));
    let mps = |i: usize| rows[i].speed_mps;
    let (before, jump, after) =
        (mps(first)? - mps(first - 1)?, mps(last + 1)? - mps(last)?, mps(last + 2)? - mps(last + 1)?);
    // A train at a stand repeats its zero.
    let moves = mps(first)? > 0.0 && mps(last + 2)? > 0.0 && mps(first - 1)? > 0.0;
    let one_way = before * after > 0.0 && before * jump > 0.0;
    let [small, large] = [before.abs().min(after.abs()), before.abs().max(after.abs())];
    if !(is_even && moves && one_way && small > least_mps && large < ALIKE * small) {
        return None;
    }
    let repeats = last - first;
    let missed_mps = repeats as f64 * 0.5 * (small + large);
    let is_caught_up = jump.abs() > small + CAUGHT_UP * missed_mps;
    Some((1..=MOST_REPEATS).contains(&repeats) && is_caught_up)
}
