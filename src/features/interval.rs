//! What happened between two ticks, and stretches of about `window_s` made of it.
//!
//! In: two ticks in a row. Out: [`Interval`], with the effort that is the mean since the tick before, and the regime of
//! the later tick, which was recognised from just this effort. Ticks that come faster than `window_s` are taken
//! together: over 1 s a speed in whole km/h is wrong by up to 0.28 m/s², over 10 s by a tenth of it. Such a
//! [`Stretches`] has the regime that held longest in it. An interval without effort (dropout) ends the stretch it falls
//! in, and the next one does not follow it.

use super::Observation;
use crate::Real;
use crate::plain::plain;
use crate::tick::regime::Regime;
use crate::tick::snapshot::in_place;

/// From one tick to the next, or several of them taken together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    /// Speed at its beginning, m/s.
    pub(super) before_mps: Real,
    /// Speed at its end, m/s.
    pub(super) after_mps: Real,
    /// Length, s.
    pub(super) dt_s: Real,
    /// Effort times time, m/s.
    pub(super) impulse_mps: Real,
    /// Effort times mean speed times time, J/kg.
    pub(super) work_j_per_kg: Real,
    /// Regime.
    pub(super) regime: Regime,
}

plain! {
    struct Interval { before_mps, after_mps, dt_s, impulse_mps, work_j_per_kg, regime }
}

impl Interval {
    const ZEROED: Self = Self {
        before_mps: 0.0,
        after_mps: 0.0,
        dt_s: 0.0,
        impulse_mps: 0.0,
        work_j_per_kg: 0.0,
        regime: Regime::Standstill,
    };

    /// None where a reading is missing or time stood still.
    pub(super) fn between(before: &Observation, after: &Observation) -> Option<Self> {
        let effort = after.effort_n_per_kg?;
        if after.dt_s.is_nan() || after.dt_s <= 0.0 {
            return None;
        }
        let impulse_mps = effort * after.dt_s;
        Some(Self {
            before_mps: before.speed_mps,
            after_mps: after.speed_mps,
            dt_s: after.dt_s,
            impulse_mps,
            work_j_per_kg: impulse_mps * 0.5 * (before.speed_mps + after.speed_mps),
            regime: after.regime,
        })
    }

    /// Mean effort, N/kg.
    pub(super) fn effort_n_per_kg(&self) -> Real {
        self.impulse_mps / self.dt_s
    }

    /// Mean of the speeds at both ends, m/s.
    pub(super) fn mean_mps(&self) -> Real {
        0.5 * (self.before_mps + self.after_mps)
    }

    /// Mean effort times mean speed, W/kg. Its kinetic part, (v2² - v1²) / 2 dt, is exact however the speed runs in
    /// between.
    pub(super) fn power_w_per_kg(&self) -> Real {
        self.work_j_per_kg / self.dt_s
    }

    /// Mean acceleration, m/s².
    pub(super) fn acceleration_mps2(&self) -> Real {
        (self.after_mps - self.before_mps) / self.dt_s
    }
}

in_place! {
    /// Takes intervals together until they are long enough.
    #[derive(Clone, Debug)]
    pub(super) struct Stretches {
        open: Option<Interval> = (None, zeroed Some(Interval::ZEROED));
        time_s: [Real; 5] = ([0.0; 5]);
    }
}

impl Stretches {
    /// The stretch that this interval completes. `least_s` of 0 gives every interval back.
    pub(super) fn push(&mut self, least_s: Real, interval: &Interval) -> Option<Interval> {
        let mut sum = *interval;
        if let Some(open) = self.open {
            sum.before_mps = open.before_mps;
            sum.dt_s += open.dt_s;
            sum.impulse_mps += open.impulse_mps;
            sum.work_j_per_kg += open.work_j_per_kg;
        } else {
            self.time_s = [0.0; 5];
        }
        if let Some(time_s) = self.time_s.get_mut(interval.regime as usize) {
            *time_s += interval.dt_s;
        }
        // Three quarters: a clock that is a little fast must not join two samples.
        if sum.dt_s < 0.75 * least_s {
            self.open = Some(sum);
            return None;
        }
        let mut longest_s = 0.0;
        for (regime, time_s) in Regime::ALL.into_iter().zip(self.time_s) {
            if time_s > longest_s {
                longest_s = time_s;
                sum.regime = regime;
            }
        }
        self.open = None;
        Some(sum)
    }

    /// Forgets the open stretch.
    pub(super) fn interrupt(&mut self) {
        self.open = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tick::snapshot::InPlace;

    fn second(before_mps: Real, regime: Regime) -> Interval {
        Interval { before_mps, after_mps: before_mps + 0.5, dt_s: 1.0, impulse_mps: 0.5, work_j_per_kg: 1.0, regime }
    }

    #[test]
    fn short_ticks_are_taken_together() {
        let mut stretches = Stretches::ZEROED;
        stretches.clear_fields();
        let regimes = [Regime::Cruise, Regime::Traction, Regime::Traction];
        let mut made = None;
        for (k, regime) in regimes.into_iter().enumerate() {
            assert_eq!(made, None);
            made = stretches.push(4.0, &second(10.0 + 0.5 * k as Real, regime));
        }
        let made = made.unwrap();
        assert_eq!((made.before_mps, made.after_mps, made.dt_s), (10.0, 11.5, 3.0));
        assert_eq!((made.effort_n_per_kg(), made.power_w_per_kg()), (0.5, 1.0));
        assert_eq!(made.regime, Regime::Traction);
        assert_eq!(stretches.push(0.0, &second(1.0, Regime::Coast)), Some(second(1.0, Regime::Coast)));
    }
}
