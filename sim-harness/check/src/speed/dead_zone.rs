//! A speed that reads zero below a threshold: tachometers and satellite receivers do. A radar may read one small speed
//! there.
//!
//! In: rows of the runs of one recorder, as read. Out: the threshold with its interval, where the readings say that
//! there is one.
//!
//! ```text
//! P = Π (1 - (T - F)/(a Δt))    chance that no row falls between F, 0 or the small speed, and T at any start or stop, with the rate of speed a just above T
//! ```
//!
//! Every start and stop passes all speeds between within (T - F)/a. Where the rows are near enough in time that some
//! should have been read there, and none was, the readings of zero beside are no standstill.

use crate::figure::{Figure, HALF_95};
use crate::rows::times::{next_row_s, usual_step_s};
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, upper_quantile};

/// A threshold below is that of every recorder, km/h, or a matter of its step: of steps that a wheel has scaled the
/// first looks like what a radar reads.
const LEAST_KMH: f64 = 1.5;
const STEPS: f64 = 3.0;
/// Logarithm of the chance that no row falls below the threshold at any start or stop.
const SURE: f64 = -9.0;
/// The same of all starts, and of all stops: trains that start at a whole second have no smaller reading than what they
/// gain in one, but do not stop so.
const SURE_OF_EACH: f64 = 0.5 * SURE;
/// What a radar may read below its threshold, in place of 0, is no more than this, km/h; of the readings from 0 up to
/// here, this share and so many.
const MOST_FLOOR_KMH: f64 = 1.5;
const OF_FLOOR: (f64, usize) = (0.9, 6);
/// Recorders that write a speed only where it has changed by so much skip the small ones, too: of changes less than
/// this share of the threshold there are at least so many, and both steps of this share of the passes are alike within
/// that, or the rows are none of a clock.
const SMALL_CHANGE: f64 = 0.5;
const OF_SMALL: f64 = 0.2;
const OF_EVEN: f64 = 0.7;
const EVEN: f64 = 0.3;
/// Starts and stops that must say it.
const LEAST_PASSES: usize = 6;
/// One in so many may be a wild reading.
const WILD_SHARE: usize = 40;
/// Rows that are nearer to a reading above zero than this many times the time that a slow start or stop needs are left
/// out.
const MARGIN: f64 = 1.3;
const SLOW_SHARE: f64 = 0.1;
/// The smallest of n readings that are even over a range is within 3/n of its end, in 19 of 20 cases.
const FEW_BELOW: f64 = 3.0;
/// No train needs longer from the threshold to a stand, s.
const LONGEST_S: f64 = 40.0;
/// Between rows that are farther apart a train reaches its speed, and how fast it passed the smallest ones is not
/// known, s.
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
    is_start: bool,
    is_even: bool,
}

/// A threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadZone {
    /// Its speed, km/h.
    pub threshold_kmh: Figure,
    /// Starts and stops that say it.
    pub passes: usize,
    /// What is read below it, km/h.
    pub floor_kmh: f64,
    /// How fast the speed changes there at least, but for one in ten, m/s².
    slow_mps2: f64,
}

/// The threshold of a recorder; none where its readings begin at the smallest speeds. `step_kmh`: step of the speeds, 0
/// without one.
pub fn of<'a>(runs: impl Iterator<Item = &'a [Sample]> + Clone, step_kmh: f64) -> Option<DeadZone> {
    let floor_mps = floor_mps(runs.clone());
    let mut passes: Vec<Pass> = runs.clone().flat_map(|rows| passes(rows, floor_mps)).collect();
    let even = passes.iter().filter(|pass| pass.is_even).count();
    if passes.len() < LEAST_PASSES || (even as f64) < OF_EVEN * passes.len() as f64 {
        return None;
    }
    passes.sort_by(|a, b| a.mps.total_cmp(&b.mps));
    // A few wild readings do not hide it.
    let wild = passes.len() / WILD_SHARE;
    let least_mps = passes[wild].mps;
    // Half a step below the smallest reading nothing is known.
    let threshold_mps = least_mps - 0.5 * step_kmh / 3.6;
    if 3.6 * threshold_mps < LEAST_KMH.max(STEPS * step_kmh.max(3.6 * floor_mps))
        || !is_sure(&passes, threshold_mps - floor_mps)
        || !has_small_changes(runs, threshold_mps)
    {
        return None;
    }
    // The readings just above it are even over one step of the clock: the least of them is nearer, the more there are.
    let rise_mps = median(passes.iter().map(|pass| pass.rate_mps2 * pass.step_s))?;
    let below_mps = rise_mps * (FEW_BELOW * (wild + 1) as f64 / passes.len() as f64).min(1.0);
    let half_kmh = 0.5 * step_kmh;
    let [low_kmh, high_kmh] = [3.6 * (least_mps - below_mps) - half_kmh, 3.6 * least_mps + half_kmh];
    let figure = Figure { value: 0.5 * (low_kmh + high_kmh), sd: (high_kmh - low_kmh) / (2.0 * HALF_95) };
    let slow_mps2 = upper_quantile(passes.iter().map(|pass| pass.rate_mps2), SLOW_SHARE)?;
    Some(DeadZone { threshold_kmh: figure, passes: passes.len(), floor_kmh: 3.6 * floor_mps, slow_mps2 })
}

/// What is read below a threshold, m/s: 0, or the one small speed that there is.
fn floor_mps<'a>(runs: impl Iterator<Item = &'a [Sample]>) -> f64 {
    let small = |mps: &f64| *mps > 0.0 && 3.6 * mps <= MOST_FLOOR_KMH;
    let read: Vec<f64> = runs.flatten().filter_map(|row| row.speed_mps).filter(small).collect();
    let Some(usual) = median(&read) else { return 0.0 };
    let same = read.iter().filter(|mps| **mps == usual).count();
    if same >= OF_FLOOR.1 && same as f64 >= OF_FLOOR.0 * read.len() as f64 { usual } else { 0.0 }
}

/// A moving train's speeds change by less than the threshold, too.
fn has_small_changes<'a>(runs: impl Iterator<Item = &'a [Sample]>, threshold_mps: f64) -> bool {
    let (mut all, mut small) = (0_usize, 0_usize);
    for rows in runs {
        let read: Vec<f64> = rows.iter().filter_map(|row| row.speed_mps).collect();
        for pair in read.windows(2).filter(|pair| pair[0] != pair[1] && pair[0].min(pair[1]) >= threshold_mps) {
            all += 1;
            small += usize::from((pair[1] - pair[0]).abs() < SMALL_CHANGE * threshold_mps);
        }
    }
    small as f64 > OF_SMALL * all as f64
}

/// Neither starts nor stops pass so much without a reading by chance.
fn is_sure(passes: &[Pass], without_mps: f64) -> bool {
    let log_chance = |pass: &Pass| (1.0 - without_mps / (pass.rate_mps2 * pass.step_s)).max(0.05).ln();
    let of = |is_start| passes.iter().filter(|pass| pass.is_start == is_start).map(log_chance).sum::<f64>();
    let [starts, stops] = [true, false].map(of);
    starts + stops < SURE && starts.max(stops) < SURE_OF_EACH
}

/// Readings of zero with one above zero beside.
fn passes(rows: &[Sample], floor_mps: f64) -> Vec<Pass> {
    let longest_s = next_row_s(usual_step_s(rows));
    let pass = |three: [&Sample; 3], is_start| pass(three, longest_s, floor_mps, is_start);
    let ahead = rows.windows(3).filter_map(|three| pass([&three[0], &three[1], &three[2]], true));
    let back = rows.windows(3).filter_map(|three| pass([&three[2], &three[1], &three[0]], false));
    ahead.chain(back).collect()
}

/// From a reading of zero, the first, up.
fn pass([zero, first, second]: [&Sample; 3], longest_s: f64, floor_mps: f64, is_start: bool) -> Option<Pass> {
    let step_s = (first.time_s - zero.time_s).abs();
    let next_s = (second.time_s - first.time_s).abs();
    let (mps, next_mps) = (first.speed_mps?, second.speed_mps?);
    let leaves = zero.speed_mps? <= floor_mps && mps > floor_mps && next_mps > mps;
    let is_even = step_s > 0.0 && next_s > 0.0 && step_s.max(next_s) <= longest_s.min(LONGEST_STEP_S);
    let alike = (step_s - next_s).abs() <= EVEN * step_s.max(next_s);
    (leaves && is_even).then(|| Pass { mps, rate_mps2: (next_mps - mps) / next_s, step_s, is_start, is_even: alike })
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
            let is_zero = |row: &Sample| row.speed_mps.is_some_and(|mps| 3.6 * mps <= self.floor_kmh);
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
