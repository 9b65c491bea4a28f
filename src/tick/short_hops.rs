//! Metros, trams and suburban trains: what is different where hops are short.
//!
//! In: speeds, and when. Out: whether hops are short, and what of their coasts counts.
//!
//! A train that runs for minutes coasts for minutes: evidence is gathered over 10 s, a coast is believed after such an
//! interval, and only then learned from. On hops of one or two minutes coasts last 10 to 40 s, and nothing would be
//! left. There evidence is gathered over less, a segment runs on trial from where the coast may have begun, and it is
//! learned from once it is believed. That costs accuracy where it is not needed (a third of the error of r(v) on an
//! intercity), so it is used on short hops alone.
//!
//! Of coasts of 12 s, the usual ones of metros and trams, even that leaves nothing. Speeds in tenths of a km/h show
//! within 4 s what whole ones show within 7, and how a brake begins within 3; clean steps of whole ones lie in between
//! (see [`crate::tick::staircase`]).

use crate::Real;
use crate::extremes::Extremes;
use crate::tick::bounds::settings;
use crate::tick::learning::LeastChange;
use crate::tick::snapshot::in_place;

settings! {
    /// How the resistance is learned on short hops.
    ShortHopConfig in "short_hops" {
        /// Longest hop that is short, s; 0 for none. The first hop of a run is not known to be one.
        hop_s: Real = 300.0, 0.0 to 3600.0;
        /// Spacing of the recogniser's evidence, s, at most that of other hops.
        interval_s: Real = 7.0, 1.0 to 60.0;
        /// Probability that a segment was coasted to this moment, above which it is believed.
        believe_probability: Real = 0.8, 0.5 to 1.0;
        /// Probability that the train coasted already where a segment on trial began; below, it begins again.
        begin_probability: Real = 0.9, 0.5 to 1.0;
        /// Time cut from the end of a segment, s.
        end_cut_s: Real = 6.0, 0.0 to 600.0;
        /// Shortest segment that counts, s.
        min_segment_s: Real = 10.0, 0.0 to 3600.0;
        /// Least described resistance at which coasting is distinguished from holding a speed, N/kg.
        min_resistance_n_per_kg: Real = 0.015, 0.0 to 1.0;
    }
}

/// What of a coast counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pieces {
    /// Spacing of the recogniser's evidence, s.
    pub interval_s: Real,
    /// Time cut from the end of a segment, s.
    pub end_cut_s: Real,
    /// Shortest segment that counts, s.
    pub min_segment_s: Real,
    /// How its speed must change.
    pub least_change: LeastChange,
    /// Standard deviation of a speed, m/s, where it is finer than whole km/h.
    pub speed_sd_mps: Option<f32>,
}

impl ShortHopConfig {
    /// At most what is set, where the speeds are finer than whole km/h, or clean steps.
    fn pieces(&self, speed_sd_mps: Option<f32>, steps: bool) -> Pieces {
        let Self { interval_s, end_cut_s, min_segment_s, .. } = *self;
        let least_change = LeastChange::Share(MIN_CHANGE_SHARE);
        let mut pieces = Pieces { interval_s, end_cut_s, min_segment_s, least_change, speed_sd_mps };
        if speed_sd_mps.is_some() {
            pieces.interval_s = interval_s.at_most(FINE_INTERVAL_S);
            pieces.end_cut_s = end_cut_s.at_most(FINE_END_CUT_S);
            pieces.min_segment_s = min_segment_s.at_most(FINE_MIN_SEGMENT_S);
            pieces.least_change = LeastChange::Fall(LEAST_FALL_MPS2);
        } else if steps {
            pieces.interval_s = interval_s.at_most(STEPS_INTERVAL_S);
            pieces.end_cut_s = end_cut_s.at_most(STEPS_END_CUT_S);
            pieces.min_segment_s = min_segment_s.at_most(STEPS_MIN_SEGMENT_S);
        }
        pieces
    }
}

const FINE_INTERVAL_S: Real = 4.0;
const FINE_END_CUT_S: Real = 3.0;
const FINE_MIN_SEGMENT_S: Real = 7.0;
const STEPS_INTERVAL_S: Real = 6.0;
const STEPS_END_CUT_S: Real = 4.0;
const STEPS_MIN_SEGMENT_S: Real = 8.0;
/// A speed that is held wanders by less, and where a driver takes back the power near the speed that is wanted it
/// rises: both look like coasts on gentle slopes. Of steeper coasts enough are left. By whole km/h the coasts would be
/// chosen for their rounding, and r(v) of suburban trains became too large.
const LEAST_FALL_MPS2: Real = 0.02;
/// [`learning::MIN_CHANGE_SHARE`](crate::tick::learning::MIN_CHANGE_SHARE) of their coasts, which are shorter.
const MIN_CHANGE_SHARE: Real = 0.02;

/// Mean change of the change from one reading to the next below which speeds are fine, m/s, of those that are not none:
/// in whole km/h (or mph) none is so small, and noise of 0.1 m/s has more.
const FINE_MPS: f32 = 0.25 / 3.6;
/// Beyond this a change counts no more, m/s: where a brake is applied it says nothing of the readings.
const MOST_CHANGE_MPS: f32 = 0.4 / 3.6;
/// Standard deviation of a reading over that mean: √(2/π) √6 of it are the mean of y₀ - 2 y₁ + y₂.
const SD_SHARE: f32 = 0.5;
/// So many of them are no lapses.
const LEAST_CHANGES: u16 = 10;
/// Equal but for the rounding of the numbers, m/s.
const ROUNDING_MPS: f32 = 0.01 / 3.6;
/// Changes that are counted at most.
const MOST_CHANGES: u16 = 1000;

in_place! {
    /// The hops of a run.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub struct Hops {
        /// When the train stood last, s.
        stood_s: Option<Real> = (None);
        /// It has been seen to move since.
        moved: bool = (false);
        /// The last hop was short.
        last_short: bool = (false);
        /// The last speed and its change, m/s; how often the change was another one than before, and by how much.
        last_mps: f32 = (0.0);
        last_change_mps: f32 = (0.0);
        changes: u16 = (0);
        changed_mps: f32 = (0.0);
    }
}

impl Hops {
    /// A tick with a speed.
    pub fn observe(&mut self, config: &ShortHopConfig, time_s: Real, speed_mps: Real, standing: bool) {
        self.compare(speed_mps as f32);
        if !standing {
            self.moved = true;
            return;
        }
        let hop_s = self.stood_s.map(|stood_s| time_s - stood_s);
        if core::mem::take(&mut self.moved) && hop_s.is_some_and(|hop_s| hop_s > LEAST_HOP_S) {
            self.last_short = hop_s.is_some_and(|hop_s| hop_s <= config.hop_s);
        }
        self.stood_s = Some(time_s);
    }

    // In single precision, in which the board's processor calculates itself.
    fn compare(&mut self, speed_mps: f32) {
        let change_mps = speed_mps - core::mem::replace(&mut self.last_mps, speed_mps);
        let other_mps = (change_mps - core::mem::replace(&mut self.last_change_mps, change_mps)).abs();
        if other_mps > ROUNDING_MPS && self.changes < MOST_CHANGES {
            self.changes += 1;
            self.changed_mps += other_mps.at_most(MOST_CHANGE_MPS);
        }
    }

    /// Standard deviation of a speed as it is read, m/s, if it is neither coarse nor noisy. The changes have those of
    /// the train in them, so it is rather too large.
    pub fn speed_sd_mps(&self) -> Option<f32> {
        let mean_mps = self.changed_mps / f32::from(self.changes);
        (self.changes >= LEAST_CHANGES && mean_mps < FINE_MPS).then_some(SD_SHARE * mean_mps)
    }

    /// What counts of coasts on short hops; `None` on longer ones.
    /// `steps`: the speeds are whole steps with little noise.
    pub fn pieces(&self, config: &ShortHopConfig, time_s: Real, steps: bool) -> Option<Pieces> {
        self.are_short(config, time_s).then(|| config.pieces(self.speed_sd_mps(), steps))
    }

    /// The last hop was short, and this one is not longer yet.
    fn are_short(&self, config: &ShortHopConfig, time_s: Real) -> bool {
        self.last_short && self.stood_s.is_some_and(|stood_s| time_s - stood_s <= config.hop_s)
    }
}

/// Probability that an interval was coasted as a whole, below which a segment ends: with 0.3, as on other hops, gentle
/// brakes were learned from, and r(v) of one vehicle in six became a fifth too large with an interval that did not hold
/// it.
pub const END_PROBABILITY: Real = 0.5;
/// A train that moves for less has been shunted, s.
const LEAST_HOP_S: Real = 30.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn after(stands_at_s: &[Real], time_s: Real) -> bool {
        let config = ShortHopConfig::default();
        let mut hops = Hops::default();
        for at_s in stands_at_s {
            hops.observe(&config, *at_s, 0.0, true);
            if *at_s >= 10.0 {
                hops.observe(&config, *at_s + 1.0, 5.0, false);
            }
        }
        hops.are_short(&config, time_s)
    }

    #[test]
    fn hops_are_short_after_a_short_one_until_one_lasts() {
        assert!(!after(&[0.0, 9.0, 60.0], 70.0), "standing is no hop, however long nothing was read");
        assert!(!after(&[0.0, 10.0, 20.0], 60.0), "shunting is none");
        assert!(after(&[0.0, 10.0, 120.0, 150.0], 200.0));
        assert!(!after(&[0.0, 10.0, 120.0, 150.0], 460.0), "this one lasts");
        assert!(!after(&[0.0, 120.0, 150.0, 900.0], 950.0), "the last one lasted");
    }

    /// A train that starts, rolls and brakes, and speeds that are rounded to a step and noisy: what is found, km/h.
    fn sd_kmh(step_kmh: Real, noise_kmh: Real) -> Option<Real> {
        let mut hops = Hops::default();
        for tick in 0..60 {
            let time_s = Real::from(tick);
            let train_kmh = (3.0 * time_s).min(60.0 - 0.15 * time_s).min(4.0 * (60.0 - time_s));
            let noisy_kmh = train_kmh + noise_kmh * libm::sin(2.5 * time_s);
            let kmh = libm::round(noisy_kmh / step_kmh) * step_kmh;
            hops.observe(&ShortHopConfig::default(), time_s, kmh / 3.6, tick == 0);
        }
        hops.speed_sd_mps().map(|sd_mps| 3.6 * Real::from(sd_mps))
    }

    #[test]
    fn speeds_of_whole_units_and_noisy_ones_are_not_fine() {
        for (step_kmh, noise_kmh) in [(1.0, 0.0), (1.609_344, 0.0), (0.5, 0.0), (0.1, 0.5)] {
            assert_eq!(sd_kmh(step_kmh, noise_kmh), None);
        }
    }

    #[test]
    fn the_noise_of_fine_speeds_is_found_from_them() {
        for (step_kmh, amplitude_kmh) in [(0.1, 0.0), (0.1, 0.05), (0.01, 0.07)] {
            let noise_kmh = libm::sqrt(amplitude_kmh * amplitude_kmh / 2.0 + step_kmh * step_kmh / 12.0);
            let found_kmh = sd_kmh(step_kmh, amplitude_kmh).unwrap();
            assert!((noise_kmh..3.0 * noise_kmh).contains(&found_kmh), "{step_kmh} {amplitude_kmh}: {found_kmh}");
        }
    }
}
