//! How a driver brakes: one deceleration for each speed step, and the distance that follows from it.
//!
//! ```text
//! D(v) = sum over the steps of (v_high² - v_low²) / (2 a)
//! ```
//!
//! To stop at a distance d the driver scales all decelerations by D(v)/d; so a late or slow start of the brake is made
//! up for before the stop.

use rand::{Rng, RngExt};
use rand_distr::{Distribution, Normal};

/// Lower edges of the steps, m/s: easing off before the stop, then up to 40, 60, 80, 130 km/h and above.
const FROM_MPS: [f64; 6] = [0.0, EASE_BELOW_MPS, 40.0 / 3.6, 60.0 / 3.6, 80.0 / 3.6, 130.0 / 3.6];

/// Below this speed the driver eases off, so that the train does not stop with a jerk.
const EASE_BELOW_MPS: f64 = 1.5;

/// Mean decelerations of the five steps of the paper, lowest speeds first, m/s². Harder at low speed (its Fig. 8).
const MEAN_MPS2: [f64; 5] = [0.42, 0.37, 0.36, 0.28, 0.27];

/// Coefficient of variation of each step, on top of the driver's own 17.5 %; widest below 40 km/h.
const STEP_SD: [f64; 5] = [0.25, 0.2, 0.2, 0.18, 0.18];
const DRIVER_SD: f64 = 0.175;

/// Decelerations of one driver in one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrakeHabit {
    /// Decelerations below 40, 60, 80, 130 km/h and above, m/s², positive.
    pub rates_mps2: [f64; 5],
    /// From first application to full brake, s.
    pub build_up_s: f64,
}

impl BrakeHabit {
    /// Draws one driver.
    pub fn draw(rng: &mut impl Rng) -> Self {
        let unit = Normal::new(0.0, 1.0).expect("constant");
        let driver = 1.0 + DRIVER_SD * unit.sample(rng);
        let rates_mps2 = std::array::from_fn(|i| {
            let step = 1.0 + STEP_SD[i] * unit.sample(rng);
            (MEAN_MPS2[i] * driver * step).clamp(0.15, 0.6)
        });
        Self { rates_mps2, build_up_s: rng.random_range(2.0..3.0) }
    }

    /// One deceleration at all speeds but the last ones, m/s².
    pub fn constant(rate_mps2: f64) -> Self {
        Self { rates_mps2: [rate_mps2; 5], build_up_s: 2.0 }
    }

    /// This habit with a share of another one.
    pub fn mixed(&self, other: &Self, share: f64) -> Self {
        let mixed = |own: f64, other: f64| own + share * (other - own);
        Self {
            rates_mps2: std::array::from_fn(|i| mixed(self.rates_mps2[i], other.rates_mps2[i])),
            build_up_s: mixed(self.build_up_s, other.build_up_s),
        }
    }

    /// The same driver where the brake gives no more than this deceleration, m/s².
    pub fn at_most(mut self, most_mps2: f64) -> Self {
        for rate in &mut self.rates_mps2 {
            *rate = rate.min(most_mps2);
        }
        self
    }

    /// Deceleration at a speed, m/s², positive.
    pub fn rate_mps2(&self, speed_mps: f64) -> f64 {
        self.step_rate_mps2(FROM_MPS.partition_point(|v| *v <= speed_mps).max(1) - 1)
    }

    /// Distance from a speed to standstill, m, with the brake already built up.
    pub fn distance_m(&self, speed_mps: f64) -> f64 {
        (0..FROM_MPS.len())
            .filter(|i| speed_mps > FROM_MPS[*i])
            .map(|i| {
                let high = FROM_MPS.get(i + 1).map_or(speed_mps, |v| v.min(speed_mps));
                (high * high - FROM_MPS[i] * FROM_MPS[i]) / (2.0 * self.step_rate_mps2(i))
            })
            .sum()
    }

    fn step_rate_mps2(&self, step: usize) -> f64 {
        match step {
            0 => 0.6 * self.rates_mps2[0],
            _ => self.rates_mps2[step - 1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_adds_the_steps_below_the_speed() {
        let habit = BrakeHabit { rates_mps2: [0.4, 0.4, 0.4, 0.2, 0.2], build_up_s: 2.0 };
        assert_eq!(habit.rate_mps2(20.0), 0.4);
        assert_eq!(habit.rate_mps2(30.0), 0.2);
        // 1.5²/0.48 below the easing, (20² - 1.5²)/0.8 above.
        assert!((habit.distance_m(20.0) - (4.6875 + 497.1875)).abs() < 1e-9);
    }
}
