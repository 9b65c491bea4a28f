//! What an effort column says of an interval: its mean, however the recorder made it.
//!
//! In: the efforts read at both ends of a tick, and what the readings of a longer interval say the mean effort was.
//! Out: the mean effort of a tick and its standard deviation.
//!
//! A recorder writes the mean since the last row, or the effort at the moment, and either may be late. With `e` read
//! now and `b` the row before, all of these are, to first order in time,
//!
//! ```text
//! mean effort of the tick = e + s (b - e)
//! ```
//!
//! | column | s |
//! |---|---|
//! | mean since the last row | 0 |
//! | at the moment | 1/2 |
//! | mean, τ late | -τ/Δt |
//! | at the moment, τ late | 1/2 - τ/Δt |
//!
//! A momentary column that is late by half a tick has the `s` of a mean in time, and is believed as one.
//!
//! `s` is the same for all rows of a recorder that are as far apart; of a tick of another length it is known less well
//! (`share.rs`). It is a normal belief that each interval updates by how far `e` alone misses the effort that the
//! change of speed asks for; where the effort hardly changes it says nothing and matters nothing.
//!
//! A tick goes from one row with an effort to the next one: rows between them that have none, as where the column is
//! sparse, wait for it.

mod share;

use self::share::Share;
use crate::Real;
use crate::extremes::Extremes;
use crate::model::effort::Effort;
use crate::plain::plain;
use crate::tick::bounds::settings;
use crate::tick::snapshot::in_place;
use serde::{Deserialize, Serialize};

settings! {
    /// What is expected of an effort column.
    EffortReadingConfig in "effort_reading" {
        /// White noise of a row, share of its effort.
        noise_share: Real = 0.02, 0.0 to 1.0;
        /// White noise of a row beyond that, N/kg.
        noise_n_per_kg: Real = 5e-4, 0.0 to 1.0;
        /// Standard deviation of the time by which the column is late, s.
        late_sd_s: Real = 2.0, 0.0 to 60.0;
    }
}

/// By how much the gain is another one at another effort or speed, standard deviation. A full effort is ten times the
/// resistance: 2 % of it are 20 % of that, and where the gain was taken to be the same everywhere, a column that is 5 %
/// low at its top speed taught a resistance that is a quarter too large.
const WANDER: f32 = 0.02;
/// How long it stays so, s: as long as a train powers in one piece. Rows within that time say no more than one.
const WANDER_S: f32 = 60.0;

/// An interval in which the effort changes by less says nothing of `s`, N/kg: gains and gusts would.
const LEAST_CHANGE_N_PER_KG: f32 = 0.02;

in_place! {
    /// What is known of an effort column. In single precision, in which the board's processor calculates itself: a row
    /// is worth two digits.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct EffortReading {
        /// Efforts of the last two rows, N/kg, where they are known.
        rows: [Option<f32>; 2] = ([None; 2]);
        /// Length of the tick that ended with the last of them, s.
        tick_s: Real = (0.0);
        /// Since then, where rows have no effort, s.
        waited_s: Real = (0.0);
        /// Usual time between two rows with an effort, s; 0 before the first.
        usual_s: f32 = (0.0);
        /// Since the interval began; none where one of its ticks has no effort that is known.
        interval: Option<Window> = (None);
        /// Since the last interval in which the effort hardly changed, that one included.
        window: Option<Window> = (None);
        share: Share = (Share::UNKNOWN);
    }
}

/// Sums over ticks, m/s: effort, what `s` is multiplied by, and what the speed asks for; time, s; what the kind of the
/// column is multiplied by, m/s.
type Window = [f32; 5];

/// The mean effort of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeanEffort {
    /// Mean, N/kg.
    pub n_per_kg: f32,
    /// Its variance by what stays in the speed, (N/kg)².
    pub variance: f32,
    /// Variance of the change of speed that a late column shows with the next row only, (m/s)².
    pub unseen: f32,
}

plain! {
    struct MeanEffort { n_per_kg, variance, unseen }
}

/// What is carried of a vehicle's effort column from run to run: its gain, true over read, and `s`, each with its
/// standard deviation; nothing is known of the default. In whole steps, as it is stored: a board that was restarted
/// goes on with the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Gain less 1, and its standard deviation, in steps of 1e-4; `s` and its own in steps of 1e-3; the tick that `s`
    /// is of in steps of 10 ms. What is known has a deviation of a step at least.
    pub(crate) steps: [u16; 5],
}

plain! {
    struct Column { steps }
}

impl Column {
    /// After a run.
    pub(crate) fn of_run((gain, gain_sd): (Real, Real), reading: &EffortReading) -> Self {
        let Share { mean: share, variance, tick_s } = reading.share;
        // A doubt is rounded up. A number that is none becomes the largest, as one that is too large.
        let tick = 1e2 * tick_s;
        let steps = [1e4 * (gain as f32 - 1.0), 1e4 * gain_sd as f32, 1e3 * share, 1e3 * root(variance), tick];
        Self { steps: steps.map(|steps| (steps + 0.999).at_most(MOST_STEPS) as i16 as u16) }
    }

    /// Variance of the gain as the last run left it; 0: nothing is known of it.
    pub(crate) fn gain_variance(self) -> Real {
        let [(_, variance), _] = self.next_run();
        if variance > 0.0 { (variance - square(GAIN_DRIFT_SD)).at_least(0.0).into() } else { 0.0 }
    }

    /// How much of what goes with the gain goes with that of the next run, for it drifts between runs; and its variance
    /// before.
    pub(crate) fn kept(self) -> (Real, Real) {
        let [(_, after), _] = self.next_run();
        let before = self.gain_variance();
        (if after > 0.0 { before / Real::from(after) } else { 1.0 }, before)
    }

    /// The gain of the next run, true over read, and its variance; no column is off by more than `described_sd`.
    pub(crate) fn next_gain(self, described_sd: Real) -> (Real, Real) {
        let [(gain, variance), _] = self.next_run();
        let described = described_sd * described_sd;
        (gain.into(), if variance > 0.0 { described.at_most(variance.into()) } else { described })
    }

    /// Before the next run: mean and variance of the gain, true over read, and of `s`; 0 where nothing is known, or a
    /// gain stands there that no sensor has.
    pub fn next_run(self) -> [(f32, f32); 2] {
        let is_gain = (self.steps[0] as i16).unsigned_abs() < MOST_GAIN_STEPS;
        let [gain, gain_sd, share, share_sd, _] = if is_gain { self.steps } else { [0; 5] };
        let mean = |steps: u16, step: f32| f32::from(steps as i16) * step;
        let variance = |steps: u16, step: f32, drift_sd: f32| {
            if steps == 0 { 0.0 } else { square(f32::from(steps) * step) + square(drift_sd) }
        };
        [
            (1.0 + mean(gain, 1e-4), variance(gain_sd, 1e-4, GAIN_DRIFT_SD)),
            (mean(share, 1e-3), variance(share_sd, 1e-3, SHARE_DRIFT_SD)),
        ]
    }
}

impl EffortReading {
    /// The belief of `s` at the usual tick, or before anything is known of it.
    fn share(&self, config: &EffortReadingConfig) -> Share {
        if self.share.is_known() { self.share } else { Share::unknown(config, self.usual_s) }
    }

    /// The last row has no effort, and waits for the next one that has one.
    pub fn waits(&self) -> bool {
        self.waited_s > 0.0
    }

    /// Length of the tick that ended with the last row that has an effort, s.
    pub fn tick_s(&self) -> Real {
        self.tick_s
    }

    /// A row, `dt_s` after the last one. Out: the mean effort of the tick that ended with the row with an effort
    /// before, for what comes next says how far that one had seen it; unless one of the three is missing or a brake
    /// acts, whose effort has another gain. `change_share`: of a change, what stays uncertain, for efforts change
    /// within a tick as they like.
    pub fn read(
        &mut self,
        config: &EffortReadingConfig,
        change_share: Real,
        dt_s: Real,
        effort_n_per_kg: Option<Real>,
    ) -> Option<MeanEffort> {
        let Some(now) = effort_n_per_kg.map(|now| now as f32) else {
            self.wait(dt_s);
            return None;
        };
        if now <= BRAKE_N_PER_KG {
            self.interrupt();
            return None;
        }
        let tick_s = self.waited_s + dt_s;
        let is_tick = (tick_s as f32) < self.longest_s();
        let ([before, last], of_last_s) = (self.rows, self.tick_s as f32);
        // After a gap nothing is known of the mean.
        let last = last.filter(|_| is_tick);
        self.rows = [last, Some(now)];
        self.become_usual(tick_s as f32);
        (self.tick_s, self.waited_s) = (tick_s, 0.0);
        let Some(last) = last else {
            self.interval = None;
            return None;
        };
        self.sum(config, [last, now], dt_s as f32);
        Some(self.mean(config, change_share as f32, of_last_s, [before?, last, now]))
    }

    /// A row without an effort: until the next one that has one, the last one goes on.
    fn wait(&mut self, dt_s: Real) {
        let waited_s = self.waited_s + dt_s;
        let last = self.rows[1].filter(|_| (waited_s as f32) < self.longest_s());
        let Some(last) = last else {
            self.interrupt();
            return;
        };
        self.waited_s = waited_s;
        if let Some([read, ..]) = &mut self.interval {
            *read += last * dt_s as f32;
        }
    }

    /// Longest time between two rows with an effort of which the mean is known, s.
    fn longest_s(&self) -> f32 {
        (LONGEST_TICK * self.usual_s).at_least(LONGEST_S)
    }

    /// The usual tick follows those of the log, a gap hardly.
    fn become_usual(&mut self, tick_s: f32) {
        let most_s = if self.usual_s > 0.0 { LONGEST_TICK * self.usual_s } else { tick_s };
        let usual_s = if self.usual_s > 0.0 { self.usual_s } else { tick_s };
        self.usual_s = usual_s + (tick_s.at_most(most_s) - usual_s) / USUAL_ROWS;
    }

    /// Takes the tick that ends now into the interval, of which rows without an effort have taken the last one so far.
    /// `dt_s` after the last row.
    fn sum(&mut self, config: &EffortReadingConfig, [last, now]: [f32; 2], dt_s: f32) {
        let tick_s = self.tick_s as f32;
        let [of_share_s, of_kind_s] = self.share(config).weights_s(config, tick_s);
        if let Some([read, change, .., kind]) = &mut self.interval {
            *read += now * dt_s + (now - last) * (tick_s - dt_s);
            *change += (last - now) * of_share_s;
            *kind += (last - now) * of_kind_s;
        }
    }

    /// The mean effort of a tick of `tick_s` that ended with the row `last`.
    fn mean(
        &self,
        config: &EffortReadingConfig,
        change_share: f32,
        tick_s: f32,
        [before, last, now]: [f32; 3],
    ) -> MeanEffort {
        let Share { mean: share, variance: share_variance, .. } = self.share(config).at(config, tick_s);
        let (late, momentary) = ((-share).at_least(0.0), share.at_least(0.0));
        // What is not seen of a late column's tick is taken from the rows on both sides of its end, so it is as much
        // too little before a change as it is too much after it, and gone with the next row. It is a doubt of the
        // reading of the speed.
        let (behind, ahead) = (before - last, last - now);
        // Of a column in time the change is taken around the row, by which it is doubted: with that up to the row a
        // mean whose noise hides the change of a falling effort would be believed more than one whose noise adds to it,
        // and r become too large.
        let seen = if late > 0.0 { 0.5 + 0.5 * late.at_most(1.0) } else { (0.5 - momentary).at_least(0.0) };
        let change = behind + seen * (ahead - behind);
        // A momentary value misses what happened within the tick. Power is turned off at the same places in each run,
        // so what is missed of a large change is no noise: such a row hardly teaches.
        let within = change_share + MISSED * momentary * (1.0 + change.abs() / SMALL_CHANGE_N_PER_KG);
        let noise = config.noise_share as f32 * last + config.noise_n_per_kg as f32;
        let wander = square(WANDER * last) * (WANDER_S / tick_s).at_least(1.0);
        MeanEffort {
            n_per_kg: last + share * change,
            variance: square(noise) + wander + (share_variance + square(within)) * square(change),
            unseen: square(late * tick_s) * (square(UNSEEN_N_PER_KG) + square(MISSED * ahead)),
        }
    }

    /// A run begins with what is known of `s`: mean and variance, and the column that holds its tick.
    pub(crate) fn begin_run(&mut self, share: (f32, f32), column: Column) {
        self.share = Share { mean: share.0, variance: share.1, tick_s: 1e-2 * f32::from(column.steps[4]) };
    }

    /// The log begins again after a pause, or a brake acts: what was learned of the column stays.
    pub fn interrupt(&mut self) {
        self.rows = [None; 2];
        self.waited_s = 0.0;
        self.interval = None;
    }

    /// An interval begins, which no other one comes before.
    pub fn begin_interval(&mut self) {
        self.interval = Some([0.0; 5]);
        self.window = None;
    }

    /// An interval ends and the next one begins: `effort` by the change of speed, with the standard deviations of that
    /// change, m/s, and of the resistance, N/kg. `gain` is true over read.
    ///
    /// `s` is learned over a window from one interval in which the effort hardly changes to the next one, where nothing
    /// is unseen; single rows of a late column would say too little. A window that is further from what is expected
    /// than four standard deviations (a brake that the column does not show, a slip) says no more than one that is so
    /// far.
    pub fn compare(
        &mut self,
        config: &EffortReadingConfig,
        interval_s: Real,
        effort: &Effort,
        [speed_sd_mps, resistance_sd]: [Real; 2],
        (gain, gain_sd): (Real, Real),
    ) {
        let interval = self.interval.replace([0.0; 5]);
        let Some([read, change, _, _, kind]) = interval else {
            self.window = None;
            return;
        };
        let time_s = interval_s as f32;
        let interval = [read, change, effort.effort_n_per_kg as f32 * time_s, time_s, kind];
        let steady = change.abs() < LEAST_CHANGE_N_PER_KG * self.usual_s;
        let window = self.window.map(|mut window| {
            window.iter_mut().zip(interval).for_each(|(sum, more)| *sum += more);
            window
        });
        if !steady {
            self.window = window;
            return;
        }
        self.window = Some(interval);
        let Some(window) = window else {
            return;
        };
        self.learn(config, window, [speed_sd_mps as f32, resistance_sd as f32], (gain as f32, gain_sd as f32));
        if self.share.is_known() && !self.share.is_of(self.usual_s) {
            self.share = self.share.at(config, self.usual_s);
            // Its sums are of the tick before.
            self.window = None;
        }
    }

    /// What a window says of `s`.
    fn learn(
        &mut self,
        config: &EffortReadingConfig,
        [read, change, asked, time_s, kind]: Window,
        [speed_sd_mps, resistance_sd]: [f32; 2],
        (gain, gain_sd): (f32, f32),
    ) {
        let believed = self.share(config);
        let Share { mean: share, variance: share_variance, tick_s } = believed;
        let (kind_mean, kind_variance) = believed.kind_beyond(config);
        let column = gain * change;
        // Resistance and gain are off alike in each window, and what they have in common with `s` is not carried: where
        // the effort falls in all of them, as where trains power from a stop and then brake, no number of windows says
        // more of `s` than one that knows its own errors.
        let common = square(resistance_sd * time_s) + square(gain_sd * read) + kind_variance * square(gain * kind);
        let own = square(speed_sd_mps)
            + square(config.noise_share as f32 * read) * self.usual_s / time_s
            + square(MISSED * share.at_least(0.0) * column);
        let expected = share_variance * square(column) + common + own;
        let least = (COMMON * common / square(column)).at_most(share_variance);
        let after = (share_variance * (common + own) / expected).at_least(least);
        if after >= share_variance {
            return;
        }
        let limit = GATE * root(expected);
        let missed = (asked - gain * (read + kind_mean * kind) - share * column).at_most(limit).at_least(-limit);
        self.share = Share { mean: share + (1.0 - after / share_variance) / column * missed, variance: after, tick_s };
    }
}

fn square(x: f32) -> f32 {
    x * x
}

fn root(x: f32) -> f32 {
    crate::roots::square_root(x.into()) as f32
}

/// Share of a change that a column misses for each unit of `s`.
const MISSED: f32 = 0.5;
/// What the effort differs from that of two rows that are alike, standard deviation, N/kg.
const UNSEEN_N_PER_KG: f32 = 0.02;
/// A change of a momentary effort beyond which its row teaches less, N/kg.
const SMALL_CHANGE_N_PER_KG: f32 = 0.05;
/// Longest tick that is a usual one, in usual ones.
const LONGEST_TICK: f32 = 1.5;
/// A tick up to this is none too long whatever is usual, s: rows 10 s apart teach, and one that is late by half of
/// that.
const LONGEST_S: f32 = 15.0;
/// Rows by which the usual tick follows those of the log. Judgement: fewer than a run has in a minute at 1 s, and no
/// single gap moves it by a tenth.
const USUAL_ROWS: f32 = 32.0;
/// Standard deviations beyond which a window is not believed as it is.
const GATE: f32 = 4.0;
/// Twice the standard deviations of resistance and gain, squared: those are known beside an `s` that is taken for
/// right.
const COMMON: f32 = 4.0;
/// What two bytes of a record hold.
const MOST_STEPS: f32 = 16_383.0;
/// Gain less 1 that no sensor has, in steps of 1e-4.
const MOST_GAIN_STEPS: u16 = 5000;
/// By how much the gain changes from one run to the next, standard deviation: a recorder that was swapped is believed
/// some runs later.
const GAIN_DRIFT_SD: f32 = 0.002;
/// The same of `s`.
const SHARE_DRIFT_SD: f32 = 0.01;
/// Rows below are of a brake, N/kg.
const BRAKE_N_PER_KG: f32 = -0.01;

#[cfg(test)]
mod tests;
