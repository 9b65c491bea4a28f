//! The resistance's share of the mean power, corrected when more is known.
//!
//! A run accelerates before it coasts, so the power is calculated with a resistance that is learned only later. In:
//! each interval that counted, with the Davis coefficients of its time. Out: by how much the mean power changes with
//! the coefficients known now.
//!
//! ```text
//! ΔP = Σ Δt v (Δr0 + Δr1 v + Δr2 v²) / Σ Δt
//! ```

use crate::Real;
use crate::model::resistance::Davis;
use crate::plain::plain;

/// Moments of the intervals that counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Hindsight {
    time_s: Real,
    /// Σ Δt v, Σ Δt v², Σ Δt v³.
    moments: [Real; 3],
    /// Σ Δt v r(v) with the coefficients of the time.
    taken_j_per_kg: Real,
}

plain! {
    struct Hindsight { time_s, moments, taken_j_per_kg }
}

impl Hindsight {
    /// No interval.
    pub(super) const ZEROED: Self = Self { time_s: 0.0, moments: [0.0; 3], taken_j_per_kg: 0.0 };

    pub(super) fn add(&mut self, davis: &Davis, speed_mps: Real, dt_s: Real) {
        let run_m = speed_mps * dt_s;
        self.time_s += dt_s;
        for (moment, power) in self.moments.iter_mut().zip([1.0, speed_mps, speed_mps * speed_mps]) {
            *moment += run_m * power;
        }
        self.taken_j_per_kg += run_m * davis.resistance_n_per_kg(speed_mps);
    }

    /// What the mean power gains with these coefficients, W/kg.
    pub(super) fn correction_w_per_kg(&self, davis: &Davis) -> Real {
        if self.time_s == 0.0 {
            return 0.0;
        }
        let [first, second, third] = self.moments;
        let now = davis.r0 * first + davis.r1 * second + davis.r2 * third;
        (now - self.taken_j_per_kg) / self.time_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_follows_what_was_learned_later() {
        let before = Davis { r0: 0.01, r1: 0.0, r2: 0.0 };
        let after = Davis { r0: 0.012, r1: 1e-4, r2: 0.0 };
        let mut hindsight = Hindsight::default();
        assert_eq!(hindsight.correction_w_per_kg(&after), 0.0);
        hindsight.add(&before, 20.0, 10.0);
        assert!(hindsight.correction_w_per_kg(&before).abs() < 1e-15);
        assert!((hindsight.correction_w_per_kg(&after) - 20.0 * (0.002 + 0.002)).abs() < 1e-15);
    }
}
