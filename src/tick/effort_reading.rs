//! What an effort column says of an interval: its mean, however the recorder made it.
//!
//! In: the efforts read at both ends of a tick, and what the readings of a longer interval say the mean effort was. Out: the mean effort of a tick and its
//! standard deviation.
//!
//! A recorder writes the mean since the last row, or the effort at the moment, and either may be late. With `e` read now and `b` the row before, all of
//! these are, to first order in time,
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
//! `s` is the same for all rows of a recorder. It is a normal belief that each interval updates by how far `e` alone misses the effort that the change of
//! speed asks for; where the effort hardly changes it says nothing and matters nothing.

use crate::Real;
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

/// By how much the gain is another one at another effort or speed, standard deviation. A full effort is ten times the resistance: 2 % of it are 20 % of that, and
/// where the gain was taken to be the same everywhere, a column that is 5 % low at its top speed taught a resistance that is a quarter too large.
const WANDER: f32 = 0.02;
/// How long it stays so, s: as long as a train powers in one piece. Rows within that time say no more than one.
const WANDER_S: f32 = 60.0;

/// Before the first interval a mean and a momentary value are as likely as each other.
const SHARE: f32 = 0.25;
/// Standard deviation of `s` for a column that is in time.
const SHARE_SD: f32 = 0.25;
/// An interval in which the effort changes by less says nothing of `s`, N/kg: gains and gusts would.
const LEAST_CHANGE_N_PER_KG: f32 = 0.02;

in_place! {
    /// What is known of an effort column. In single precision, in which the board's processor calculates itself: a row is worth two digits.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct EffortReading {
        /// Efforts of the last two rows, N/kg, where they are known.
        rows: [Option<f32>; 2] = ([None; 2]);
        /// Shortest time between two rows, s: what `s` is of; 0 before the first.
        usual_s: f32 = (0.0);
        /// Since the interval began; none where one of its ticks has no effort that is known.
        interval: Option<Window> = (None);
        /// Since the last interval in which the effort hardly changed, that one included.
        window: Option<Window> = (None);
        /// What is known of `s`: mean and variance; nothing where that is 0.
        share: (f32, f32) = ((0.0, 0.0));
        /// Tick that this is of, s.
        share_tick_s: f32 = (0.0);
    }
}

/// Sums over ticks: effort, its change, and what the speed asks for, times the length of the tick, m/s; time, s.
type Window = [f32; 4];

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

/// What is carried of a vehicle's effort column from run to run: its gain, true over read, and `s`, each with its standard deviation; nothing is known of
/// the default. In whole steps, as it is stored: a board that was restarted goes on with the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Gain less 1, and its standard deviation, in steps of 1e-4; `s` and its own in steps of 1e-3; the tick that `s` is of in steps of 10 ms. What is known
    /// has a deviation of a step at least.
    pub(crate) steps: [u16; 5],
}

plain! {
    struct Column { steps }
}

impl Column {
    /// After a run.
    pub(crate) fn of_run((gain, gain_sd): (Real, Real), reading: &EffortReading) -> Self {
        let (share, variance) = reading.share;
        // A doubt is rounded up. A number that is none becomes the largest, as one that is too large.
        let tick = 1e2 * reading.share_tick_s;
        let steps = [1e4 * (gain as f32 - 1.0), 1e4 * gain_sd as f32, 1e3 * share, 1e3 * root(variance), tick];
        Self { steps: steps.map(|steps| (steps + 0.999).min(MOST_STEPS) as i16 as u16) }
    }

    /// Variance of the gain as the last run left it; 0: nothing is known of it.
    pub(crate) fn gain_variance(self) -> Real {
        let [(_, variance), _] = self.next_run();
        if variance > 0.0 { (variance - square(GAIN_DRIFT_SD)).max(0.0).into() } else { 0.0 }
    }

    /// How much of what goes with the gain goes with that of the next run, for it drifts between runs; and its variance before.
    pub(crate) fn kept(self) -> (Real, Real) {
        let [(_, after), _] = self.next_run();
        let before = self.gain_variance();
        (if after > 0.0 { before / Real::from(after) } else { 1.0 }, before)
    }

    /// The gain of the next run, true over read, and its variance; no column is off by more than `described_sd`.
    pub(crate) fn next_gain(self, described_sd: Real) -> (Real, Real) {
        let [(gain, variance), _] = self.next_run();
        let described = described_sd * described_sd;
        (gain.into(), if variance > 0.0 { described.min(variance.into()) } else { described })
    }

    /// Before the next run: mean and variance of the gain, true over read, and of `s`; 0 where nothing is known, or a gain stands there that no sensor has.
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
    /// The belief of `s`: mean and variance. The same age is another share of another tick.
    fn share(&self, config: &EffortReadingConfig) -> (f32, f32) {
        let late = config.late_sd_s as f32 / self.usual_s;
        let is_of_this_tick = (self.share_tick_s - self.usual_s).abs() < SAME_TICK * self.usual_s;
        if is_of_this_tick && self.share.1 > 0.0 { self.share } else { (SHARE, SHARE_SD * SHARE_SD + late * late) }
    }

    /// A row, `dt_s` after the last one. Out: the mean effort of the tick that ended with the row before, for what comes next says how far that one had
    /// seen it; unless one of the three is missing or a brake acts, whose effort has another gain.
    /// `change_share`: of a change, what stays uncertain, for efforts change within a tick as they like.
    pub fn read(
        &mut self,
        config: &EffortReadingConfig,
        change_share: Real,
        dt_s: Real,
        effort_n_per_kg: Option<Real>,
    ) -> Option<MeanEffort> {
        let dt_s = dt_s as f32;
        let [before, last] = self.rows;
        self.usual_s = if self.usual_s > 0.0 { self.usual_s.min(dt_s) } else { dt_s };
        // `s` is a share of the usual tick: after a gap nothing is known of the mean.
        let last = last.filter(|_| dt_s < LONGEST_TICK * self.usual_s);
        let now = effort_n_per_kg.map(|now| now as f32).filter(|now| *now > BRAKE_N_PER_KG);
        self.rows = [last, now];
        let Some((last, now)) = last.zip(now) else {
            self.interval = None;
            return None;
        };
        if let Some([read, change, ..]) = &mut self.interval {
            *read += now * dt_s;
            *change += (last - now) * dt_s;
        }
        let (share, share_variance) = self.share(config);
        let (late, momentary) = ((-share).max(0.0), share.max(0.0));
        // What is not seen of a late column's tick is taken from the rows on both sides of its end, so it is as much too little before a change as it is
        // too much after it, and gone with the next row. It is a doubt of the reading of the speed.
        let (behind, ahead) = (before? - last, last - now);
        // Of a column in time the change is taken around the row, by which it is doubted: with that up to the row a mean whose noise hides the change of a
        // falling effort would be believed more than one whose noise adds to it, and r become too large.
        let seen = if late > 0.0 { 0.5 + 0.5 * late.min(1.0) } else { (0.5 - momentary).max(0.0) };
        let change = behind + seen * (ahead - behind);
        // A momentary value misses what happened within the tick. Power is turned off at the same places in each run, so what is missed of a large change
        // is no noise: such a row hardly teaches.
        let within = change_share as f32 + MISSED * momentary * (1.0 + change.abs() / SMALL_CHANGE_N_PER_KG);
        let noise = config.noise_share as f32 * last + config.noise_n_per_kg as f32;
        let wander = square(WANDER * last) * (WANDER_S / dt_s).max(1.0);
        Some(MeanEffort {
            n_per_kg: last + share * change,
            variance: square(noise) + wander + (share_variance + square(within)) * square(change),
            unseen: square(late * dt_s) * (square(UNSEEN_N_PER_KG) + square(MISSED * ahead)),
        })
    }

    /// A run begins with what is known of `s`: mean and variance, and the column that holds its tick.
    pub(crate) fn begin_run(&mut self, share: (f32, f32), column: Column) {
        self.share = share;
        self.share_tick_s = 1e-2 * f32::from(column.steps[4]);
    }

    /// The log begins again after a pause: what was learned of the column stays.
    pub fn interrupt(&mut self) {
        self.rows = [None; 2];
        self.interval = None;
    }

    /// An interval begins, which no other one comes before.
    pub fn begin_interval(&mut self) {
        self.interval = Some([0.0; 4]);
        self.window = None;
    }

    /// An interval ends and the next one begins: `effort` by the change of speed, with the standard deviations of that change, m/s, and of the resistance,
    /// N/kg. `gain` is true over read.
    ///
    /// `s` is learned over a window from one interval in which the effort hardly changes to the next one, where nothing is unseen; single rows of a late
    /// column would say too little. A window that is further from what is expected than four standard deviations (a brake that the column does not show, a
    /// slip) says no more than one that is so far.
    pub fn compare(
        &mut self,
        config: &EffortReadingConfig,
        interval_s: Real,
        effort: &Effort,
        [speed_sd_mps, resistance_sd]: [Real; 2],
        (gain, gain_sd): (Real, Real),
    ) {
        let interval = self.interval.replace([0.0; 4]);
        let Some([read, change, ..]) = interval else {
            self.window = None;
            return;
        };
        let time_s = interval_s as f32;
        let interval = [read, change, effort.effort_n_per_kg as f32 * time_s, time_s];
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
        let Some([read, change, asked, time_s]) = window else {
            return;
        };
        let (share, share_variance) = self.share(config);
        let (gain, gain_sd) = (gain as f32, gain_sd as f32);
        let column = gain * change;
        // Resistance and gain are off alike in each window, and what they have in common with `s` is not carried: where the effort falls in all of them, as
        // where trains power from a stop and then brake, no number of windows says more of `s` than one that knows its own errors.
        let common = square(resistance_sd as f32 * time_s) + square(gain_sd * read);
        let own = square(speed_sd_mps as f32)
            + square(config.noise_share as f32 * read) * self.usual_s / time_s
            + square(MISSED * share.max(0.0) * column);
        let expected = share_variance * square(column) + common + own;
        let least = (COMMON * common / square(column)).min(share_variance);
        let after = (share_variance * (common + own) / expected).max(least);
        if after >= share_variance {
            return;
        }
        let limit = GATE * root(expected);
        let missed = (asked - gain * read - share * column).min(limit).max(-limit);
        self.share = (share + (1.0 - after / share_variance) / column * missed, after);
        self.share_tick_s = self.usual_s;
    }
}

fn square(x: f32) -> f32 {
    x * x
}

fn root(x: f32) -> f32 {
    libm::sqrt(x.into()) as f32
}

/// Share of a change that a column misses for each unit of `s`.
const MISSED: f32 = 0.5;
/// What the effort differs from that of two rows that are alike, standard deviation, N/kg.
const UNSEEN_N_PER_KG: f32 = 0.02;
/// A change of a momentary effort beyond which its row teaches less, N/kg.
const SMALL_CHANGE_N_PER_KG: f32 = 0.05;
/// Ticks that differ by less, as a share, are the same: clocks do.
const SAME_TICK: f32 = 0.1;
/// Longest tick that is a usual one, in usual ones.
const LONGEST_TICK: f32 = 1.5;
/// Standard deviations beyond which a window is not believed as it is.
const GATE: f32 = 4.0;
/// Twice the standard deviations of resistance and gain, squared: those are known beside an `s` that is taken for right.
const COMMON: f32 = 4.0;
/// What two bytes of a record hold.
const MOST_STEPS: f32 = 16_383.0;
/// Gain less 1 that no sensor has, in steps of 1e-4.
const MOST_GAIN_STEPS: u16 = 5000;
/// By how much the gain changes from one run to the next, standard deviation: a recorder that was swapped is believed some runs later.
const GAIN_DRIFT_SD: f32 = 0.002;
/// The same of `s`.
const SHARE_DRIFT_SD: f32 = 0.01;
/// Rows below are of a brake, N/kg.
const BRAKE_N_PER_KG: f32 = -0.01;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tick::snapshot::InPlace as _;

    const TICK_S: Real = 10.0;

    /// The row of a time.
    type Row = fn(Real) -> Real;

    /// A driver's effort, N/kg: power on and off with ramps of 6 s, at odds with the ticks.
    fn effort_n_per_kg(time_s: Real) -> Real {
        let phase_s = time_s % 83.0;
        0.3 * (phase_s / 6.0).min((46.0 - phase_s) / 6.0).clamp(0.0, 1.0)
    }

    fn mean_n_per_kg(from_s: Real, to_s: Real) -> Real {
        let steps = 200;
        let at = |i: i32| from_s + (to_s - from_s) * (Real::from(i) + 0.5) / Real::from(steps);
        (0..steps).map(|i| effort_n_per_kg(at(i))).sum::<Real>() / Real::from(steps)
    }

    /// The reading after 200 ticks of a column, and the errors of the last 100 means in their standard deviations, root mean square.
    fn learned(column: Row, tick_s: Real) -> (EffortReading, Real) {
        let config = EffortReadingConfig::default();
        let mut reading = EffortReading::ZEROED;
        reading.begin_interval();
        let (mut square, mut count) = (0.0, 0.0);
        for tick in 0..200 {
            let time_s = Real::from(tick) * tick_s;
            let known = reading.read(&config, 0.05, tick_s, Some(column(time_s)));
            let effort_n_per_kg = mean_n_per_kg(time_s - tick_s, time_s);
            let effort = Effort { effort_n_per_kg, acceleration_mps2: 0.0, resistance_n_per_kg: 0.0 };
            reading.compare(&config, tick_s, &effort, [0.1, 2e-3], (1.0, 0.01));
            if let Some(mean) = known.filter(|_| tick >= 100) {
                let error = Real::from(mean.n_per_kg) - mean_n_per_kg(time_s - 2.0 * tick_s, time_s - tick_s);
                // What was not seen before the tick and after it.
                let variance = Real::from(mean.variance) + 2.0 * Real::from(mean.unseen) / (tick_s * tick_s);
                square += error * error / variance;
                count += 1.0;
            }
        }
        (reading, libm::sqrt(square / count))
    }

    /// Trains that power from a stop and then brake show the end of each powering phase alone.
    #[test]
    fn a_resistance_that_is_off_is_no_age_however_often_the_effort_falls() {
        let config = EffortReadingConfig::default();
        let mut reading = EffortReading::ZEROED;
        // The resistance is larger than learned by a standard deviation.
        let (resistance_sd, off_n_per_kg) = (3e-3, 3e-3);
        for _ in 0..300 {
            reading.begin_interval();
            for tick in 0..60 {
                let effort_n_per_kg: Real = if tick < 30 { 0.7 } else { 0.1 };
                reading.read(&config, 0.05, 1.0, Some(effort_n_per_kg));
                if tick % 10 == 9 {
                    let mean_n_per_kg = if tick < 30 { 0.7 } else { 0.1 } + off_n_per_kg;
                    let effort =
                        Effort { effort_n_per_kg: mean_n_per_kg, acceleration_mps2: 0.0, resistance_n_per_kg: 0.0 };
                    reading.compare(&config, 10.0, &effort, [0.1, resistance_sd], (1.0, 2e-3));
                }
            }
            reading.interrupt();
        }
        let (share, variance) = reading.share;
        assert!(share.abs() < 2.0 * root(variance) && root(variance) < 0.4, "{share} {}", root(variance));
    }

    #[test]
    fn a_mean_a_moment_and_a_late_column_are_told_apart() {
        let cases: [(&str, Row, Real); 4] = [
            ("mean", |t| mean_n_per_kg(t - TICK_S, t), 0.0),
            ("moment", effort_n_per_kg, 0.5),
            ("mean, 1 s late", |t| mean_n_per_kg(t - TICK_S - 1.0, t - 1.0), -0.1),
            ("mean, 2 s late", |t| mean_n_per_kg(t - TICK_S - 2.0, t - 2.0), -0.2),
        ];
        for (name, column, expected) in cases {
            let (reading, deviations) = learned(column, TICK_S);
            let (share, variance) = (Real::from(reading.share.0), Real::from(reading.share.1));
            let off = (share - expected) / variance.sqrt();
            assert!(
                (share - expected).abs() < 0.05 && off.abs() < 2.5,
                "{name}: {share}, off by {off} standard deviations"
            );
            assert!(deviations < 2.0, "{name}: errors of {deviations} standard deviations");
        }
    }

    /// Row by row a late column is off by what a change of the effort makes; over the change it is not.
    #[test]
    fn what_a_late_column_has_not_seen_comes_with_the_next_rows() {
        let config = EffortReadingConfig::default();
        let late = |t: Real| mean_n_per_kg(t - TICK_S - 1.0, t - 1.0);
        let (mut reading, _) = learned(late, TICK_S);
        reading.share = (-0.1, 1e-6);
        // Power is on from 2075 s on; before and long after the effort is steady.
        let (mut error, mut largest, mut unseen) = (0.0_f64, 0.0_f64, 0.0_f64);
        for tick in 200..213 {
            let time_s = Real::from(tick) * TICK_S;
            let known = reading.read(&config, 0.05, TICK_S, Some(late(time_s)));
            let Some(mean) = known.filter(|_| tick > 206) else { continue };
            error += TICK_S * (Real::from(mean.n_per_kg) - mean_n_per_kg(time_s - 2.0 * TICK_S, time_s - TICK_S));
            (largest, unseen) = (largest.max(error.abs()), unseen.max(Real::from(mean.unseen).sqrt()));
        }
        assert!(largest > 0.03 && largest < 2.0 * unseen, "{largest} m/s, {unseen} m/s expected");
        assert!(error.abs() < 0.03, "{error} m/s stay");
    }

    #[test]
    fn a_column_is_carried_in_steps_with_its_doubt_and_a_drift() {
        let mut reading = EffortReading::ZEROED;
        assert_eq!(Column::default().next_run(), [(1.0, 0.0), (0.0, 0.0)]);
        let unknown = Column::of_run((1.0312, 0.004), &reading).next_run();
        assert!(unknown[0].1 > 0.0 && unknown[1].1 == 0.0, "{unknown:?}");
        for share in [-0.1, 0.0, 0.5, -7.25, 16.3] {
            (reading.share, reading.share_tick_s) = ((share, 1e-8), TICK_S as f32);
            let [gain, found] = Column::of_run((1.0312, 0.004), &reading).next_run();
            assert!((gain.0 - 1.0312).abs() < 1e-4 && (gain.1.sqrt() - 0.004_f32.hypot(GAIN_DRIFT_SD)).abs() < 1.1e-4);
            assert!((found.0 - share).abs() < 1e-3 && (found.1.sqrt() - SHARE_DRIFT_SD).abs() < 1e-3, "{found:?}");
        }
    }

    #[test]
    fn a_gain_that_no_sensor_has_is_not_taken_up() {
        for (gain, is_sound) in [(0.2, true), (0.49, true), (-0.49, true), (0.5, false), (-3.2, false)] {
            let column = Column::of_run((1.0 + gain, 0.01), &EffortReading::ZEROED);
            let [(mean, variance), _] = column.next_run();
            assert_eq!((variance > 0.0, (f64::from(mean) - 1.0 - gain).abs() < 1e-3), (is_sound, is_sound), "{gain}");
        }
    }

    #[test]
    fn a_missing_row_or_a_brake_gives_no_mean_and_teaches_nothing() {
        let config = EffortReadingConfig::default();
        for spoilt in [None, Some(-0.3)] {
            let mut reading = EffortReading::ZEROED;
            reading.begin_interval();
            let mut read = |effort| reading.read(&config, 0.05, TICK_S, effort);
            assert!([Some(0.1), Some(0.1)].map(&mut read).iter().all(Option::is_none), "two rows before a mean");
            assert!(read(Some(0.3)).is_some());
            assert!([spoilt, Some(0.3), Some(0.3)].map(read).iter().all(Option::is_none), "{spoilt:?}");
            let effort = Effort { effort_n_per_kg: 0.2, acceleration_mps2: 0.0, resistance_n_per_kg: 0.0 };
            let before = reading.share(&config);
            for _ in 0..3 {
                reading.compare(&config, TICK_S, &effort, [0.1, 0.0], (1.0, 0.03));
            }
            assert_eq!(reading.share(&config), before);
        }
    }
}
