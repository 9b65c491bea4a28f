//! Intervals that lie wholly inside one regime, so that their mean effort is a level and not a mixture.
//!
//! In: intervals in order. Out: those of one regime whose neighbours have it too: the interval in which it begins and
//! the interval in which it ends are left out, however much of them it filled. So each interval waits for the next one.
//!
//! Near the end of an acceleration the 1 km/h of the readings makes single intervals look like cruising. They are kept
//! when the regime goes on after at most `bridge_samples` of them with at least half the effort: to leave out just the
//! intervals with a small reading would bias the mean.

use super::interval::Interval;
use crate::tick::regime::Regime;
use crate::tick::snapshot::in_place;
use heapless::Vec;

const MAX_HELD: usize = 12;

in_place! {
    /// The filter for one regime.
    #[derive(Clone, Debug)]
    pub(super) struct SteadyIntervals {
        regime: Regime = (Regime::Standstill);
        /// The interval before was of the regime.
        inside: bool = (false);
        /// One interval of the regime, then the cruising ones after it.
        held: Vec<Interval, MAX_HELD> = (in place);
    }
}

impl SteadyIntervals {
    pub(super) fn begin(&mut self, regime: Regime) {
        self.regime = regime;
        self.interrupt();
    }

    /// Those intervals that `next` shows to be steady; to be asked before it is taken.
    #[inline(never)]
    pub(super) fn shown_by(&self, next: &Interval) -> &[Interval] {
        match next.regime {
            regime if regime == self.regime => &self.held,
            // A stop ends the brake after the interval before it.
            Regime::Standstill => self.held.get(..1).unwrap_or_default(),
            Regime::Traction | Regime::Cruise | Regime::Coast | Regime::Brake => &[],
        }
    }

    /// Takes the next interval.
    #[inline(never)]
    pub(super) fn push(&mut self, bridge_samples: u32, next: &Interval) {
        if next.regime == self.regime {
            self.held.clear();
            // Just cleared: there is room.
            let _kept = !self.inside || self.held.push(*next).is_ok();
            self.inside = true;
            return;
        }
        let like_before = self.held.first().is_some_and(|held| next.effort_n_per_kg() / held.effort_n_per_kg() >= 0.5);
        let bridged = next.regime == Regime::Cruise
            && like_before
            && self.held.len() <= bridge_samples as usize
            && self.held.push(*next).is_ok();
        if !bridged {
            self.interrupt();
        }
    }

    /// The next interval does not follow the last one.
    pub(super) fn interrupt(&mut self) {
        self.held.clear();
        self.inside = false;
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::Real;
    use crate::tick::snapshot::InPlace;
    use Regime::{Brake, Coast, Cruise, Standstill, Traction};

    fn accepted(wanted: Regime, rows: &[(Regime, Real)]) -> std::vec::Vec<Real> {
        let mut steady = SteadyIntervals::ZEROED;
        steady.begin(wanted);
        let mut efforts = std::vec::Vec::new();
        for &(regime, effort) in rows {
            let interval = Interval {
                before_mps: 20.0,
                after_mps: 21.0,
                dt_s: 1.0,
                impulse_mps: effort,
                work_j_per_kg: 0.0,
                regime,
            };
            efforts.extend(steady.shown_by(&interval).iter().map(|kept| kept.impulse_mps));
            steady.push(2, &interval);
        }
        efforts
    }

    #[test]
    fn first_and_last_interval_are_left_out() {
        let rows = [(Coast, 0.0), (Traction, 0.2), (Traction, 0.4), (Traction, 0.5), (Traction, 0.1), (Coast, 0.0)];
        assert_eq!(accepted(Traction, &rows), [0.4, 0.5]);
    }

    #[test]
    fn a_small_reading_inside_stays_and_a_pause_does_not() {
        let small = [(Traction, 0.2), (Traction, 0.21), (Cruise, 0.15), (Traction, 0.22), (Traction, 0.2)];
        assert_eq!(accepted(Traction, &small), [0.21, 0.15, 0.22]);
        let pause =
            [(Traction, 0.2), (Traction, 0.21), (Cruise, 0.05), (Traction, 0.22), (Traction, 0.2), (Traction, 0.2)];
        assert_eq!(accepted(Traction, &pause), [0.2]);
        let hold = [(Traction, 0.2), (Traction, 0.21), (Cruise, 0.15), (Cruise, 0.15), (Cruise, 0.15), (Traction, 0.2)];
        assert!(accepted(Traction, &hold).is_empty());
    }

    #[test]
    fn the_interval_before_the_stop_is_kept() {
        let rows = [(Coast, 0.0), (Brake, -0.1), (Brake, -0.5), (Brake, -0.6), (Standstill, -0.2)];
        assert_eq!(accepted(Brake, &rows), [-0.5, -0.6]);
    }
}
