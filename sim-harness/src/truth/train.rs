//! The train as it really is, and its motion.
//!
//! In: effort held over one short step, the line, the wind. Out: location and speed at the end of the step.
//!
//! ```text
//! dv/dt = u - r0 - r1 v - r2 (v + w)|v + w| - 9.80665/gamma * mean gradient
//! ds/dt = v
//! ```
//!
//! w is the headwind. Classical Runge-Kutta of fourth order; a train that would roll back stands instead.

use crate::truth::line::Line;

/// Standard gravity, m/s².
pub const GRAVITY_MPS2: f64 = 9.806_65;

/// Running resistance per rotating mass, r0 + r1 v + r2 v²: N/kg, N/(kg m/s), N/(kg (m/s)²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DavisTruth {
    /// Constant part.
    pub r0: f64,
    /// Linear part.
    pub r1: f64,
    /// Quadratic part.
    pub r2: f64,
}

impl DavisTruth {
    /// Each parameter multiplied by its own factor.
    pub fn scaled(self, by: [f64; 3]) -> Self {
        Self {
            r0: self.r0 * by[0],
            r1: self.r1 * by[1],
            r2: self.r2 * by[2],
        }
    }

    /// Resistance in still air, N/kg.
    pub fn resistance_n_per_kg(&self, speed_mps: f64) -> f64 {
        self.r0 + speed_mps * (self.r1 + speed_mps * self.r2)
    }

    /// The parameters that give, in still air, the same resistance as these in a headwind: r2 (v + w)² multiplied out.
    /// Exact while v + w is not negative.
    pub fn with_headwind(self, headwind_mps: f64) -> Self {
        Self {
            r0: self.r0 + self.r2 * headwind_mps * headwind_mps,
            r1: self.r1 + 2.0 * self.r2 * headwind_mps,
            r2: self.r2,
        }
    }
}

/// The train.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrainTruth {
    /// Mass as loaded, kg.
    pub mass_kg: f64,
    /// Rotating mass factor.
    pub gamma: f64,
    /// Length, m.
    pub length_m: f64,
    /// Running resistance per rotating mass.
    pub davis: DavisTruth,
    /// Largest tractive effort, N.
    pub max_tractive_effort_n: f64,
    /// Largest tractive power at the wheel, W.
    pub max_power_w: f64,
}

impl Default for TrainTruth {
    /// Six cars, double deck, 35 % of the seats taken; limits meet near 38 km/h.
    fn default() -> Self {
        Self {
            mass_kg: 364_000.0,
            gamma: 1.06,
            length_m: 162.0,
            davis: DavisTruth {
                r0: 7.38e-3,
                r1: 1.6e-4,
                r2: 2.8e-5,
            },
            max_tractive_effort_n: 192_920.0,
            max_power_w: 2_036_377.8,
        }
    }
}

/// Location of the front and speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// m.
    pub location_m: f64,
    /// m/s, never negative.
    pub speed_mps: f64,
}

impl TrainTruth {
    /// The same train with `factor` times the mass. Rotating masses and air drag in newton stay; rolling resistance follows the mass.
    pub fn loaded(self, factor: f64) -> Self {
        let mass_kg = self.mass_kg * factor;
        let gamma = 1.0 + (self.gamma - 1.0) / factor;
        let rolling = self.gamma / gamma;
        let air = self.gamma * self.mass_kg / (gamma * mass_kg);
        Self {
            mass_kg,
            gamma,
            davis: self.davis.scaled([rolling, rolling, air]),
            ..self
        }
    }

    /// γ m, kg.
    pub fn rotating_mass_kg(&self) -> f64 {
        self.gamma * self.mass_kg
    }

    /// Largest tractive effort at a speed, N/kg: constant, then constant power; each limit times its share.
    pub fn max_effort_n_per_kg(&self, speed_mps: f64, effort_share: f64, power_share: f64) -> f64 {
        let effort_n = self.max_tractive_effort_n * effort_share;
        // At standstill the quotient is infinite and the constant effort wins.
        let power_n = self.max_power_w * power_share / speed_mps;
        effort_n.min(power_n) / self.rotating_mass_kg()
    }

    /// Running resistance, N/kg. Only air drag feels the wind.
    pub fn resistance_n_per_kg(&self, speed_mps: f64, headwind_mps: f64) -> f64 {
        let air_mps = speed_mps + headwind_mps;
        self.davis.r0 + self.davis.r1 * speed_mps + self.davis.r2 * air_mps * air_mps.abs()
    }

    /// Gravity along the track, N/kg, positive uphill.
    pub fn gravity_n_per_kg(&self, line: &Line, front_m: f64) -> f64 {
        GRAVITY_MPS2 / self.gamma * line.mean_gradient(front_m, self.length_m)
    }

    /// Everything that brakes a coasting train, N/kg: resistance and gravity.
    pub fn load_n_per_kg(&self, line: &Line, motion: Motion, headwind_mps: f64) -> f64 {
        self.resistance_n_per_kg(motion.speed_mps, headwind_mps)
            + self.gravity_n_per_kg(line, motion.location_m)
    }

    /// One step under a constant effort. A train that stops within the step stands at its end, held by the brake.
    pub fn advance(
        &self,
        line: &Line,
        motion: Motion,
        effort_n_per_kg: f64,
        headwind_mps: f64,
        step_s: f64,
    ) -> Motion {
        let slope = |m: Motion| {
            (
                m.speed_mps,
                effort_n_per_kg - self.load_n_per_kg(line, m, headwind_mps),
            )
        };
        let along = |(ds, dv): (f64, f64), t: f64| Motion {
            location_m: motion.location_m + ds * t,
            speed_mps: motion.speed_mps + dv * t,
        };
        let k1 = slope(motion);
        let k2 = slope(along(k1, step_s / 2.0));
        let k3 = slope(along(k2, step_s / 2.0));
        let k4 = slope(along(k3, step_s));
        let mean = |f: fn((f64, f64)) -> f64| (f(k1) + 2.0 * f(k2) + 2.0 * f(k3) + f(k4)) / 6.0;
        let (ds, dv) = (mean(|k| k.0), mean(|k| k.1));
        let end = along((ds, dv), step_s);
        if end.speed_mps > 0.0 {
            end
        } else {
            // v²/(2|a|) with the mean deceleration of the step.
            let rest_m = if dv < 0.0 {
                motion.speed_mps * motion.speed_mps / (-2.0 * dv)
            } else {
                0.0
            };
            Motion {
                location_m: motion.location_m + rest_m,
                speed_mps: 0.0,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coasting_against_a_constant_resistance_follows_the_closed_form() {
        let davis = DavisTruth {
            r0: 0.03,
            r1: 0.0,
            r2: 0.0,
        };
        let train = TrainTruth {
            davis,
            ..TrainTruth::default()
        };
        let line = Line::level(50_000.0, 140.0);
        let mut motion = Motion {
            location_m: 100.0,
            speed_mps: 38.0,
        };
        for _ in 0..6000 {
            motion = train.advance(&line, motion, 0.0, 0.0, 0.1);
        }
        let t = 600.0;
        assert!((motion.speed_mps - (38.0 - 0.03 * t)).abs() < 1e-9);
        assert!((motion.location_m - (100.0 + 38.0 * t - 0.015 * t * t)).abs() < 1e-6);
    }

    #[test]
    fn coasting_against_air_alone_follows_the_closed_form() {
        // dv/dt = -r2 v²  =>  1/v = 1/v0 + r2 t
        let davis = DavisTruth {
            r0: 0.0,
            r1: 0.0,
            r2: 2.8e-5,
        };
        let train = TrainTruth {
            davis,
            ..TrainTruth::default()
        };
        let line = Line::level(50_000.0, 140.0);
        let mut motion = Motion {
            location_m: 0.0,
            speed_mps: 38.0,
        };
        for _ in 0..6000 {
            motion = train.advance(&line, motion, 0.0, 0.0, 0.1);
        }
        let expected = 1.0 / (1.0 / 38.0 + 2.8e-5 * 600.0);
        assert!((motion.speed_mps - expected).abs() < 1e-9);
        assert!((motion.location_m - (38.0_f64 / expected).ln() / 2.8e-5).abs() < 1e-6);
    }

    #[test]
    fn a_braked_train_stops_after_the_closed_form_distance_and_stands() {
        let davis = DavisTruth {
            r0: 0.0,
            r1: 0.0,
            r2: 0.0,
        };
        let train = TrainTruth {
            davis,
            ..TrainTruth::default()
        };
        let line = Line::level(1_000.0, 140.0);
        let mut motion = Motion {
            location_m: 0.0,
            speed_mps: 10.03,
        };
        for _ in 0..1000 {
            motion = train.advance(&line, motion, -0.5, 0.0, 0.1);
        }
        assert_eq!(motion.speed_mps, 0.0);
        assert!((motion.location_m - 10.03 * 10.03).abs() < 1e-9);
    }

    #[test]
    fn headwind_as_equivalent_parameters_is_the_same_resistance() {
        let train = TrainTruth::default();
        for headwind_mps in [-8.0, 0.0, 8.0] {
            let direct = train.resistance_n_per_kg(30.0, headwind_mps);
            let equivalent = train
                .davis
                .with_headwind(headwind_mps)
                .resistance_n_per_kg(30.0);
            assert!((direct - equivalent).abs() < 1e-15);
        }
    }

    #[test]
    fn a_fuller_train_has_the_same_air_drag_in_newton() {
        let empty = TrainTruth::default();
        let full = empty.loaded(1.2);
        let newton = |t: TrainTruth, r: f64| r * t.rotating_mass_kg();
        assert!((newton(empty, empty.davis.r2) - newton(full, full.davis.r2)).abs() < 1e-9);
        assert!((newton(full, full.davis.r0) / newton(empty, empty.davis.r0) - 1.2).abs() < 1e-12);
    }
}
