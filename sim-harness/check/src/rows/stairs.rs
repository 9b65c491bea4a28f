//! A column that stands still from row to row and then changes at once: its repeats, its changes, its usual change.

use crate::figure::{Figure, HALF_95};
use crate::rows::times::{next_row_s, usual_step_s};
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, sd_of_median, sorted, spread};

/// Fewer changes between repeats say nothing.
const LEAST_STAIRS: usize = 20;
/// The median of these changes is of so many steps; one step more is what a train may change by in a row after it was
/// held.
const STEPS: f64 = 1.9;
/// Of the changes after repeats such a share has a repeat behind it, too: a train that was held goes on changing.
const BETWEEN: f64 = 0.3;
/// No larger share of the readings stands still for longer than until a recorder writes them in any case.
const LONGER: f64 = 0.15;
/// Share of the rows that repeat: fewer are chance, and a receiver that stood still for a while.
const LEAST_SHARE: f64 = 0.15;

/// What of a column stands still.
#[derive(Default)]
pub(crate) struct Stairs {
    /// Rows that repeat the reading of the row before.
    pub(crate) repeats: Vec<usize>,
    /// Rows that have a reading other than 0, as has the row before.
    readings: usize,
    /// Changes after repeats.
    after: usize,
    /// Those of them with a repeat behind, not negative.
    between: Vec<f64>,
    /// How many rows the reading before each of these was repeated.
    long: Vec<usize>,
}

/// Usual distance between neighbouring readings that are ever shown: the step, whatever scale and offset it has.
pub(crate) fn level(rows: &[Sample], reading: impl Fn(&Sample) -> Option<f64>) -> f64 {
    let mut levels = sorted(rows.iter().filter_map(reading).filter(|reading| *reading != 0.0));
    levels.dedup();
    spacing(&levels)
}

/// The same of these, in order.
pub(crate) fn spacing(levels: &[f64]) -> f64 {
    median(levels.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(0.0)
}

impl Stairs {
    pub(crate) fn of(rows: &[Sample], reading: impl Fn(&Sample) -> Option<f64>) -> Self {
        let longest_s = next_row_s(usual_step_s(rows));
        // From the row before to this one; none at a stand, or without an effort, and where rows or readings are
        // missing.
        let change = |i: usize| {
            let pair = [rows.get(i.checked_sub(1)?)?, rows.get(i)?];
            let [before, now] = [reading(pair[0])?, reading(pair[1])?];
            (before != 0.0 && now != 0.0 && pair[1].time_s - pair[0].time_s <= longest_s).then_some(now - before)
        };
        let (mut stairs, mut long) = (Self::default(), 0);
        for i in 1..rows.len() {
            let Some(changed) = change(i) else {
                long = 0;
                continue;
            };
            stairs.readings += 1;
            if changed == 0.0 {
                stairs.repeats.push(i);
                long += 1;
                continue;
            }
            if long > 0 {
                stairs.after += 1;
                if change(i + 1) == Some(0.0) {
                    stairs.between.push(changed.abs());
                    stairs.long.push(long);
                }
            }
            long = 0;
        }
        stairs
    }

    /// The usual change, where the column stands still and then changes by several steps at once.
    pub(crate) fn usual(&self, step: f64) -> Option<Figure> {
        let count = self.between.len();
        let value = median(&self.between).filter(|_| count >= LEAST_STAIRS)?;
        let is_some = self.repeats.len() as f64 > LEAST_SHARE * self.readings as f64;
        let spread = spread(self.between.iter().map(|change| change - value));
        let sd = sd_of_median(spread, count).max(0.5 * step / HALF_95);
        let are_stairs = is_some && value >= STEPS * step && count as f64 >= BETWEEN * self.after as f64;
        are_stairs.then_some(Figure { value, sd })
    }

    /// Without the changes after which a recorder writes a reading again in any case: those that come after as many
    /// rows as most others, and hardly one later.
    pub(crate) fn without_beats(mut self) -> Self {
        let mut long = self.long.clone();
        long.sort_unstable();
        let Some(beat) = long.chunk_by(|a, b| a == b).max_by_key(|alike| alike.len()).map(|alike| alike[0]) else {
            return self;
        };
        let longer = long.iter().filter(|long| **long > beat).count();
        if longer as f64 <= LONGER * long.len() as f64 {
            let before = self.between.len();
            let mut is_sooner = self.long.iter().map(|long| *long < beat);
            self.between.retain(|_| is_sooner.next().unwrap_or_default());
            self.after -= before - self.between.len();
        }
        self
    }

    /// Share of the changes between repeats that are within `range` of so much.
    pub(crate) fn share_near(&self, value: f64, range: std::ops::Range<f64>) -> f64 {
        let near = self.between.iter().filter(|change| range.contains(&(*change / value)));
        near.count() as f64 / self.between.len() as f64
    }
}
