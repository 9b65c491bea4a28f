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
use crate::tick::bounds::settings;
use crate::tick::snapshot::in_place;

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
        /// Effort of the last row, N/kg.
        last_n_per_kg: Option<Real> = (None);
        /// Shortest time between two rows, s: what `s` is of; 0 before the first.
        usual_s: Real = (0.0);
        /// Since the interval began: sums of effort and of its change over the ticks, times their length, N s/kg.
        effort: Real = (0.0);
        change: Real = (0.0);
        /// How many ticks; none where one of them has no effort that is known.
        ticks: Option<u32> = (None);
        /// Information on `s`, beyond what was known before.
        information: Real = (0.0);
        vector: Real = (0.0);
    }
}

/// An effort over an interval and its standard deviation, N/kg.
pub type Known = (Real, Real);

impl EffortReading {
    /// The belief of `s` at ticks of this length: mean and standard deviation.
    pub fn share(&self, config: &EffortReadingConfig, dt_s: Real) -> (Real, Real) {
        let late = config.late_sd_s / dt_s;
        let before = 1.0 / (SHARE_SD * SHARE_SD + late * late);
        let information = before + self.information;
        (((before * SHARE) + self.vector) / information, 1.0 / libm::sqrt(information))
    }

    /// A row. Out: the mean effort since the last one, unless one of the two is missing or a brake acts, whose effort has another gain.
    /// `change_share`: of a change, what stays uncertain, for efforts change within a tick as they like.
    pub fn read(
        &mut self,
        config: &EffortReadingConfig,
        change_share: Real,
        dt_s: Real,
        effort_n_per_kg: Option<Real>,
    ) -> Option<Known> {
        let before = core::mem::replace(&mut self.last_n_per_kg, effort_n_per_kg);
        self.usual_s = if self.usual_s > 0.0 { self.usual_s.min(dt_s) } else { dt_s };
        // `s` is a share of the usual tick: after a gap nothing is known of the mean.
        let usual = dt_s < LONGEST_TICK * self.usual_s;
        let known = before.zip(effort_n_per_kg).filter(|(before, now)| usual && before.min(*now) > BRAKE_N_PER_KG);
        let Some((before, now)) = known else {
            self.ticks = None;
            return None;
        };
        self.effort += now * dt_s;
        self.change += (before - now) * dt_s;
        self.ticks = self.ticks.map(|ticks| ticks.saturating_add(1));
        let (share, share_sd) = self.share(config, dt_s);
        let unseen = UNSEEN_N_PER_KG * (-share).max(0.0);
        let noise = config.noise_share * now.abs() + config.noise_n_per_kg + unseen;
        // Of a mean that is in time nothing is missing; the further a column is from one, the more of what happened within the tick.
        let within = change_share + MISSED * share.abs();
        let of_share = libm::hypot(share_sd, within) * (before - now);
        Some((now + share * (before - now), libm::hypot(noise, of_share)))
    }

    /// The log begins again after a pause: what was learned of the column stays.
    pub fn interrupt(&mut self) {
        self.last_n_per_kg = None;
        self.ticks = None;
    }

    /// An interval begins.
    pub fn begin_interval(&mut self) {
        (self.effort, self.change, self.ticks) = (0.0, 0.0, Some(0));
    }

    /// An interval ends: `effort` by the change of speed, with the standard deviation of that, N/kg. `gain` is true over read. One that is further from
    /// what is expected than four standard deviations says nothing: a brake that the column does not show, a slip.
    pub fn compare(&mut self, config: &EffortReadingConfig, interval_s: Real, effort: &Effort, sd: Real, gain: Known) {
        let (read, change, ticks) = (self.effort / interval_s, self.change / interval_s, self.ticks);
        let Some(ticks @ 1..) = ticks.filter(|_| change.abs() > LEAST_CHANGE_N_PER_KG) else {
            return;
        };
        let (gain, gain_sd) = gain;
        let noise = config.noise_share * read;
        let variance = sd * sd + gain_sd * gain_sd * read * read + noise * noise / Real::from(ticks);
        let column = gain * change;
        let (share, share_sd) = self.share(config, self.usual_s);
        let missed = effort.effort_n_per_kg - gain * read;
        let expected_sd = libm::sqrt(variance + column * column * (share_sd * share_sd + MISSED * MISSED / 4.0));
        if (missed - share * column).abs() > GATE * expected_sd {
            return;
        }
        self.information += column * column / variance;
        self.vector += column * missed / variance;
    }
}

/// Share of a change that a column misses for each unit of `s`.
const MISSED: Real = 0.5;
/// What a column that is late by a whole tick has not seen of its end, standard deviation over all ticks, N/kg.
const UNSEEN_N_PER_KG: Real = 0.03;
/// Longest tick that is a usual one, in usual ones.
const LONGEST_TICK: Real = 1.5;
/// Standard deviations beyond which an interval is not believed.
const GATE: Real = 4.0;
/// Rows below are of a brake, N/kg.
const BRAKE_N_PER_KG: Real = -0.01;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tick::snapshot::InPlace as _;

    const TICK_S: Real = 10.0;

    /// The row of a time.
    type Column = fn(Real) -> Real;

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

    /// What is believed of `s` after 100 ticks of a column, and the errors of the last 50 means in their standard deviations, root mean square.
    fn learned(column: Column) -> (Real, Real) {
        let config = EffortReadingConfig::default();
        let mut reading = EffortReading::ZEROED;
        reading.begin_interval();
        let (mut square, mut count) = (0.0, 0.0);
        for tick in 0..100 {
            let time_s = Real::from(tick) * TICK_S;
            let known = reading.read(&config, 0.05, TICK_S, Some(column(time_s)));
            let truth = mean_n_per_kg(time_s - TICK_S, time_s);
            let effort = Effort { effort_n_per_kg: truth, acceleration_mps2: 0.0, resistance_n_per_kg: 0.0 };
            reading.compare(&config, TICK_S, &effort, 0.012, (1.0, 0.03));
            reading.begin_interval();
            if let Some((mean, sd)) = known.filter(|_| tick >= 50) {
                square += (mean - truth) * (mean - truth) / (sd * sd);
                count += 1.0;
            }
        }
        (reading.share(&config, TICK_S).0, libm::sqrt(square / count))
    }

    #[test]
    fn a_mean_a_moment_and_a_late_column_are_told_apart() {
        let cases: [(&str, Column, Real); 3] = [
            ("mean", |t| mean_n_per_kg(t - TICK_S, t), 0.0),
            ("moment", effort_n_per_kg, 0.5),
            ("mean, 2 s late", |t| mean_n_per_kg(t - TICK_S - 2.0, t - 2.0), -0.2),
        ];
        for (name, column, expected) in cases {
            let (share, deviations) = learned(column);
            assert!((share - expected).abs() < 0.1, "{name}: {share}");
            assert!(deviations < 2.0, "{name}: errors of {deviations} standard deviations");
        }
    }

    #[test]
    fn a_missing_row_or_a_brake_gives_no_mean_and_teaches_nothing() {
        let config = EffortReadingConfig::default();
        for spoilt in [None, Some(-0.3)] {
            let mut reading = EffortReading::ZEROED;
            reading.begin_interval();
            assert!(reading.read(&config, 0.05, TICK_S, Some(0.1)).is_none(), "the first row has none before it");
            assert!(reading.read(&config, 0.05, TICK_S, Some(0.3)).is_some());
            let effort = Effort { effort_n_per_kg: 0.2, acceleration_mps2: 0.0, resistance_n_per_kg: 0.0 };
            reading.begin_interval();
            reading.read(&config, 0.05, TICK_S, spoilt);
            assert!(reading.read(&config, 0.05, TICK_S, Some(0.3)).is_none());
            let before = reading.share(&config, TICK_S);
            reading.compare(&config, TICK_S, &effort, 0.012, (1.0, 0.03));
            assert_eq!(reading.share(&config, TICK_S), before);
        }
    }
}
