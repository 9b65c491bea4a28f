//! Metros, trams and suburban trains: what is different where hops are short.
//!
//! In: whether the train stands, and when. Out: whether its hops are short.
//!
//! A train that runs for minutes coasts for minutes: evidence is gathered over 10 s, a coast is believed after such an interval, and only then learned from.
//! On hops of one or two minutes coasts last 10 to 40 s, and nothing would be left. There evidence is gathered over less, a segment runs on trial from
//! where the coast may have begun, and it is learned from once it is believed. That costs accuracy where it is not needed (a third of the error of r(v) on
//! an intercity), so it is used on short hops alone.

use crate::Real;
use crate::tick::bounds::settings;
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

/// [`MIN_CHANGE_SHARE`](crate::tick::learning::MIN_CHANGE_SHARE) of their coasts, which are shorter.
pub const MIN_CHANGE_SHARE: Real = 0.02;

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
    }
}

impl Hops {
    /// A tick with a speed.
    pub fn observe(&mut self, config: &ShortHopConfig, time_s: Real, standing: bool) {
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

    /// The last hop was short, and this one is not longer yet.
    pub fn are_short(&self, config: &ShortHopConfig, time_s: Real) -> bool {
        self.last_short && self.stood_s.is_some_and(|stood_s| time_s - stood_s <= config.hop_s)
    }
}

/// Probability that an interval was coasted as a whole, below which a segment ends: with 0.3, as on other hops, gentle brakes were learned from, and r(v) of
/// one vehicle in six became a fifth too large with an interval that did not hold it.
pub const END_PROBABILITY: Real = 0.5;
/// A train that moves for less has been shunted, s.
const LEAST_HOP_S: Real = 30.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn after(stands_at_s: &[Real], time_s: Real) -> bool {
        let config = ShortHopConfig::default();
        let mut hops = Hops { stood_s: None, moved: false, last_short: false };
        for at_s in stands_at_s {
            hops.observe(&config, *at_s, true);
            if *at_s >= 10.0 {
                hops.observe(&config, *at_s + 1.0, false);
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
}
