//! A speed that reads zero below a threshold: tachometers and satellite receivers do.
//!
//! In: rows of the runs of one recorder, as read. Out: the threshold with its interval, where the readings say that there is one.
//!
//! ```text
//! P = Π (1 - T/(a Δt))          chance that no row falls between 0 and T at any start or stop, with the rate of speed a just above T
//! ```
//!
//! Every start and stop passes all speeds below T within T/a. Where the rows are near enough in time that some should have been read there, and none was, the
//! readings of zero beside are no standstill.

use crate::agreement::{Figure, HALF_95};
use crate::row_step::{next_row_s, usual_step_s};
use rundown_files::sample::Sample;
use rundown_files::statistics::median;

/// A threshold below is that of every recorder, km/h, or a matter of its step.
const LEAST_KMH: f64 = 3.0;
const STEPS: f64 = 2.5;
/// Logarithm of the chance that no row falls below the threshold at any start or stop.
const SURE: f64 = -9.0;
/// Starts and stops that must say it.
const LEAST_PASSES: usize = 6;
/// One in so many may be a wild reading.
const WILD_SHARE: usize = 40;
/// Rows that are nearer to a reading above zero than this many times the time that a slow start or stop needs are left out.
const MARGIN: f64 = 1.3;
const SLOW_SHARE: f64 = 0.1;
/// The smallest of n readings that are even over a range is within 3/n of its end, in 19 of 20 cases.
const FEW_BELOW: f64 = 3.0;
/// No train needs longer from the threshold to a stand, s.
const LONGEST_S: f64 = 40.0;
/// Between rows that are farther apart a train reaches its speed, and how fast it passed the smallest ones is not known, s.
const LONGEST_STEP_S: f64 = 20.0;
/// A train that is read as standing did not move farther, m, beyond what it needs.
const STANDING_M: f64 = 30.0;

/// A start or a stop: readings of zero beside readings above.
#[derive(Clone, Copy)]
struct Pass {
    /// The first or last reading above zero, m/s.
    mps: f64,
    /// How fast the speed changes there, m/s².
    rate_mps2: f64,
    /// Between the reading of zero and that, s.
    step_s: f64,
}

/// A threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadZone {
    /// Its speed, km/h.
    pub threshold_kmh: Figure,
    /// Starts and stops that say it.
    pub passes: usize,
    /// How fast the speed changes there at least, but for one in ten, m/s².
    slow_mps2: f64,
}

/// The threshold of a recorder; none where its readings begin at the smallest speeds. `step_kmh`: step of the speeds, 0 without one.
pub fn of<'a>(runs: impl Iterator<Item = &'a [Sample]>, step_kmh: f64) -> Option<DeadZone> {
    let mut passes: Vec<Pass> = runs.flat_map(passes).collect();
    if passes.len() < LEAST_PASSES {
        return None;
    }
    passes.sort_by(|a, b| a.mps.total_cmp(&b.mps));
    // A few wild readings do not hide it.
    let wild = passes.len() / WILD_SHARE;
    let least_mps = passes[wild].mps;
    // Half a step below the smallest reading nothing is known.
    let threshold_mps = least_mps - 0.5 * step_kmh / 3.6;
    if 3.6 * threshold_mps < LEAST_KMH.max(STEPS * step_kmh) {
        return None;
    }
    let log_chance = |pass: &Pass| (1.0 - threshold_mps / (pass.rate_mps2 * pass.step_s)).max(0.05).ln();
    if passes.iter().map(log_chance).sum::<f64>() > SURE {
        return None;
    }
    // The readings just above it are even over one step of the clock: the least of them is nearer, the more there are.
    let rise_mps = median(passes.iter().map(|pass| pass.rate_mps2 * pass.step_s))?;
    let below_mps = rise_mps * (FEW_BELOW * (wild + 1) as f64 / passes.len() as f64).min(1.0);
    let half_kmh = 0.5 * step_kmh;
    let [low_kmh, high_kmh] = [3.6 * (least_mps - below_mps) - half_kmh, 3.6 * least_mps + half_kmh];
    let figure = Figure { value: 0.5 * (low_kmh + high_kmh), sd: (high_kmh - low_kmh) / (2.0 * HALF_95) };
    let mut rates: Vec<f64> = passes.iter().map(|pass| pass.rate_mps2).collect();
    rates.sort_by(f64::total_cmp);
    let slow_mps2 = rates[(SLOW_SHARE * rates.len() as f64) as usize];
    Some(DeadZone { threshold_kmh: figure, passes: passes.len(), slow_mps2 })
}

/// Readings of zero with one above zero beside.
fn passes(rows: &[Sample]) -> Vec<Pass> {
    let longest_s = next_row_s(usual_step_s(rows));
    let ahead = rows.windows(3).filter_map(|three| pass([&three[0], &three[1], &three[2]], longest_s));
    let back = rows.windows(3).filter_map(|three| pass([&three[2], &three[1], &three[0]], longest_s));
    ahead.chain(back).collect()
}

/// From a reading of zero, the first, up.
fn pass([zero, first, second]: [&Sample; 3], longest_s: f64) -> Option<Pass> {
    let step_s = (first.time_s - zero.time_s).abs();
    let next_s = (second.time_s - first.time_s).abs();
    let (mps, next_mps) = (first.speed_mps?, second.speed_mps?);
    let is_start = zero.speed_mps? == 0.0 && mps > 0.0 && next_mps > mps;
    let is_even = step_s > 0.0 && next_s > 0.0 && step_s.max(next_s) <= longest_s.min(LONGEST_STEP_S);
    (is_start && is_even).then(|| Pass { mps, rate_mps2: (next_mps - mps) / next_s, step_s })
}

impl DeadZone {
    /// Leaves out the readings of zero at which the train may have moved. Out: how many, and the first line of them.
    pub fn leave_out(&self, rows: &mut [Sample]) -> (usize, u64) {
        let threshold_mps = self.threshold_kmh.value / 3.6;
        let needed_s = (MARGIN * threshold_mps / self.slow_mps2).min(LONGEST_S);
        let moved_m = 2.0 * needed_s * threshold_mps + STANDING_M;
        let (mut count, mut line) = (0, 0);
        let mut from = 0;
        while from < rows.len() {
            let is_zero = |row: &Sample| row.speed_mps == Some(0.0);
            let to = from + rows[from..].iter().take_while(|row| is_zero(row)).count();
            if to == from {
                from += 1;
                continue;
            }
            let [begin_s, end_s] = [rows[from].time_s, rows[to - 1].time_s];
            let located = || rows[from..to].iter().filter_map(|row| row.location_m);
            let way_m = located().next().zip(located().next_back()).map_or(0.0, |(a, b)| (b - a).abs());
            let creeps = way_m > moved_m;
            let [has_before, has_after] = [from > 0, to < rows.len()];
            for row in &mut rows[from..to] {
                let beside =
                    has_before && row.time_s - begin_s < needed_s || has_after && end_s - row.time_s < needed_s;
                if creeps || beside {
                    row.speed_mps = None;
                    (count, line) = (count + 1, if count == 0 { row.line } else { line });
                }
            }
            from = to;
        }
        (count, line)
    }
}
