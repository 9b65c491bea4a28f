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

/// Before the first interval a mean and a momentary value are as likely as each other.
const SHARE: Real = 0.25;
/// Standard deviation of `s` for a column that is in time.
const SHARE_SD: Real = 0.25;
/// An interval in which the effort changes by less says nothing of `s`, N/kg: gains and gusts would.
const LEAST_CHANGE_N_PER_KG: Real = 0.02;

in_place! {
    /// What is known of an effort column.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct EffortReading {
        /// Efforts of the last two rows, N/kg, where they are known.
        rows: [Option<Real>; 2] = ([None; 2]);
        /// Shortest time between two rows, s: what `s` is of; 0 before the first.
        usual_s: Real = (0.0);
        /// Since the interval began; none where one of its ticks has no effort that is known.
        interval: Option<Window> = (None);
        /// Since the last interval in which the effort hardly changed, that one included.
        window: Option<Window> = (None);
        /// What is known of `s`: mean and variance; nothing where that is 0.
        share: (Real, Real) = ((0.0, 0.0));
    }
}

/// Sums over ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window {
    /// Effort and its change, times the length of the tick, m/s.
    read: Real,
    change: Real,
    /// What the speed asks for, m/s.
    asked: Real,
    time_s: Real,
}

plain! {
    struct Window { read, change, asked, time_s }
}

impl Window {
    const NONE: Self = Self { read: 0.0, change: 0.0, asked: 0.0, time_s: 0.0 };

    fn add(&mut self, next: &Self) {
        self.read += next.read;
        self.change += next.change;
        self.asked += next.asked;
        self.time_s += next.time_s;
    }
}

/// The mean effort of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeanEffort {
    /// Mean, N/kg.
    pub n_per_kg: Real,
    /// Its standard deviation, of an error that stays in the speed.
    pub sd_n_per_kg: Real,
    /// Standard deviation of the change of speed that a late column shows with the next row only, m/s.
    pub unseen_mps: Real,
}

plain! {
    struct MeanEffort { n_per_kg, sd_n_per_kg, unseen_mps }
}

/// What is carried of a vehicle's effort column from run to run: its gain, true over read, and `s`, each with its standard deviation; nothing is known of
/// the default. In whole steps, as it is stored: a board that was restarted goes on with the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    pub(crate) steps: [u16; 4],
}

plain! {
    struct Column { steps }
}

/// What 0 steps are, and how many steps are 1. So 0 steps are no standard deviation: nothing is known.
const STEPS: [(Real, Real); 4] = [(0.0, 1e4), (-1e-4, 1e4), (-32.0, 1e3), (-1e-3, 1e3)];

impl Column {
    /// After a run.
    pub(crate) fn of_run((gain, gain_sd): (Real, Real), reading: &EffortReading) -> Self {
        let (share, variance) = reading.share;
        let share_sd = if variance > 0.0 { libm::sqrt(variance) } else { -1.0 };
        let mut column = Self::default();
        for ((to, number), (origin, steps)) in column.steps.iter_mut().zip([gain, gain_sd, share, share_sd]).zip(STEPS)
        {
            *to = ((number - origin) * steps + 0.5) as u16;
        }
        column
    }

    /// Before the next run: gain, true over read, and its standard deviation, and the same of `s`.
    pub fn next_run(self) -> [Option<(Real, Real)>; 2] {
        let mut numbers = [0.0; 4];
        for ((number, steps), (origin, of_one)) in numbers.iter_mut().zip(self.steps).zip(STEPS) {
            *number = Real::from(steps) / of_one + origin;
        }
        let known = |mean, sd, drift| (sd >= 0.0).then(|| (mean, libm::hypot(sd, drift)));
        let [gain, gain_sd, share, share_sd] = numbers;
        [known(gain, gain_sd, GAIN_DRIFT_SD), known(share, share_sd, SHARE_DRIFT_SD)]
    }
}

impl EffortReading {
    /// The belief of `s` at ticks of this length: mean and variance.
    fn share(&self, config: &EffortReadingConfig, dt_s: Real) -> (Real, Real) {
        let late = config.late_sd_s / dt_s;
        if self.share.1 > 0.0 { self.share } else { (SHARE, SHARE_SD * SHARE_SD + late * late) }
    }

    /// A row, `dt_s` after the last one. Out: the mean effort of the tick that ended with the row before, for what comes next tells how far that one had
    /// seen it; unless one of the three is missing or a brake acts, whose effort has another gain.
    /// `change_share`: of a change, what stays uncertain, for efforts change within a tick as they like.
    pub fn read(
        &mut self,
        config: &EffortReadingConfig,
        change_share: Real,
        dt_s: Real,
        effort_n_per_kg: Option<Real>,
    ) -> Option<MeanEffort> {
        let [before, last] = self.rows;
        self.usual_s = if self.usual_s > 0.0 { self.usual_s.min(dt_s) } else { dt_s };
        // `s` is a share of the usual tick: after a gap nothing is known of the mean.
        let last = last.filter(|_| dt_s < LONGEST_TICK * self.usual_s);
        let now = effort_n_per_kg.filter(|now| *now > BRAKE_N_PER_KG);
        self.rows = [last, now];
        let Some((last, now)) = last.zip(now) else {
            self.interval = None;
            return None;
        };
        if let Some(interval) = &mut self.interval {
            interval.read += now * dt_s;
            interval.change += (last - now) * dt_s;
        }
        let before = before?;
        let (share, share_variance) = self.share(config, dt_s);
        // A late column is taken to lie half-way between two rows where the speed is read: so its error is the same before a change as after it, and ends
        // with it. It is one of the reading of the speed.
        let (late, momentary) = ((-share).max(0.0), share.max(0.0));
        let (behind, ahead) = (before - last, last - now);
        let half_way = 0.5 + 0.5 * late.min(1.0);
        let change = if late > 0.0 { behind + half_way * (ahead - behind) } else { behind };
        let noise = config.noise_share * last.abs() + config.noise_n_per_kg;
        // Of a mean nothing is missing; the further a column is from one, the more of what happened within the tick.
        // Power is turned off at the
        // same places of a line run after run, and a moment within the tick that is missed each time alike is no noise: such a row hardly teaches.
        let within = change_share + momentary * MISSED * (1.0 + change.abs() / SMALL_CHANGE_N_PER_KG);
        Some(MeanEffort {
            n_per_kg: last + share * change,
            sd_n_per_kg: libm::sqrt(noise * noise + (share_variance + within * within) * change * change),
            unseen_mps: late * dt_s * libm::hypot(UNSEEN_N_PER_KG, MISSED * ahead),
        })
    }

    /// A run begins with what is known of `s`: mean and standard deviation.
    pub(crate) fn begin_run(&mut self, share: Option<(Real, Real)>) {
        let (share, sd) = share.unwrap_or_default();
        self.share = (share, sd * sd);
    }

    /// The log begins again after a pause: what was learned of the column stays.
    pub fn interrupt(&mut self) {
        self.rows = [None; 2];
        self.interval = None;
    }

    /// An interval begins, which no other one comes before.
    pub fn begin_interval(&mut self) {
        self.interval = Some(Window::NONE);
        self.window = None;
    }

    /// An interval ends and the next one begins: `effort` by the change of speed, with the standard deviations of that change, m/s, and of the resistance,
    /// N/kg. `gain` is true over read.
    ///
    /// `s` is learned over a window from one interval in which the effort hardly changes to the next one: there it is known what has not been seen yet.
    /// Within a window that is not, and single rows would say too little of a late column. A window that is further from what is expected than four
    /// standard deviations says no more than one that is so far: a brake that the column does not show, a slip.
    pub fn compare(
        &mut self,
        config: &EffortReadingConfig,
        interval_s: Real,
        effort: &Effort,
        [speed_sd_mps, resistance_sd]: [Real; 2],
        (gain, gain_sd): (Real, Real),
    ) {
        let Some(mut interval) = self.interval.replace(Window::NONE) else {
            self.window = None;
            return;
        };
        interval.asked = effort.effort_n_per_kg * interval_s;
        interval.time_s = interval_s;
        let steady = interval.change.abs() < LEAST_CHANGE_N_PER_KG * self.usual_s;
        let Some(window) = &mut self.window else {
            self.window = Some(interval).filter(|_| steady);
            return;
        };
        window.add(&interval);
        if !steady {
            return;
        }
        let window = core::mem::replace(window, interval);
        let (share, share_variance) = self.share(config, self.usual_s);
        let column = gain * window.change;
        let square = |x: Real| x * x;
        let late_s = (-share).max(0.0) * self.usual_s;
        let variance = square(speed_sd_mps)
            + square(resistance_sd * window.time_s)
            + square(gain_sd * window.read)
            + square(config.noise_share * window.read) * self.usual_s / window.time_s
            + 2.0 * square(UNSEEN_N_PER_KG * late_s)
            + square(MISSED * share.max(0.0) * column);
        let expected = share_variance * column * column + variance;
        let limit = GATE * libm::sqrt(expected);
        let missed = (window.asked - gain * window.read - share * column).clamp(-limit, limit);
        let weight = share_variance * column / expected;
        self.share = (share + weight * missed, share_variance * variance / expected);
    }
}

/// Share of a change that a column misses for each unit of `s`.
const MISSED: Real = 0.5;
/// What the effort differs from the half of two rows that are alike, standard deviation, N/kg.
const UNSEEN_N_PER_KG: Real = 0.02;
/// A change of a momentary effort beyond which its row teaches less, N/kg.
const SMALL_CHANGE_N_PER_KG: Real = 0.05;
/// Longest tick that is a usual one, in usual ones.
const LONGEST_TICK: Real = 1.5;
/// Standard deviations beyond which an interval is not believed.
const GATE: Real = 4.0;
/// By how much the gain changes from one run to the next, standard deviation: that of a recorder that was swapped is believed some runs later.
const GAIN_DRIFT_SD: Real = 0.002;
/// The same of `s`.
const SHARE_DRIFT_SD: Real = 0.01;
/// Rows below are of a brake, N/kg.
const BRAKE_N_PER_KG: Real = -0.01;

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
                let error = mean.n_per_kg - mean_n_per_kg(time_s - 2.0 * tick_s, time_s - tick_s);
                // What was not seen before the tick and after it.
                let variance = mean.sd_n_per_kg.powi(2) + 2.0 * (mean.unseen_mps / tick_s).powi(2);
                square += error * error / variance;
                count += 1.0;
            }
        }
        (reading, libm::sqrt(square / count))
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
            let (share, variance) = reading.share;
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
            error += TICK_S * (mean.n_per_kg - mean_n_per_kg(time_s - 2.0 * TICK_S, time_s - TICK_S));
            (largest, unseen) = (largest.max(error.abs()), unseen.max(mean.unseen_mps));
        }
        assert!(largest > 0.03 && largest < 2.0 * unseen, "{largest} m/s, {unseen} m/s expected");
        assert!(error.abs() < 0.03, "{error} m/s stay");
    }

    #[test]
    fn a_column_is_carried_in_steps_with_its_doubt_and_a_drift() {
        let mut reading = EffortReading::ZEROED;
        assert_eq!(Column::default().next_run(), [None, None]);
        let unknown = Column::of_run((1.0312, 0.004), &reading).next_run();
        assert!(unknown[0].is_some() && unknown[1].is_none(), "{unknown:?}");
        for share in [-0.1, 0.5, -7.25] {
            reading.share = (share, 1e-8);
            let [gain, found] = Column::of_run((1.0312, 0.004), &reading).next_run().map(Option::unwrap);
            assert!((gain.0 - 1.0312).abs() < 1e-4 && (gain.1 - libm::hypot(0.004, GAIN_DRIFT_SD)).abs() < 1e-4);
            assert!((found.0 - share).abs() < 1e-3 && (found.1 - SHARE_DRIFT_SD).abs() < 1e-3, "{found:?}");
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
            let before = reading.share(&config, TICK_S);
            for _ in 0..3 {
                reading.compare(&config, TICK_S, &effort, [0.1, 0.0], (1.0, 0.03));
            }
            assert_eq!(reading.share(&config, TICK_S), before);
        }
    }
}
