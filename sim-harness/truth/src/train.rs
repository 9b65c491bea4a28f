//! The train as it really is: mass, length, resistance, limits.
//!
//! ```text
//! resistance = r0 + r1 v + r2 (v + w)|v + w|                w is the headwind
//! ```

use serde::{Deserialize, Serialize};

/// Standard gravity, m/s².
pub const GRAVITY_MPS2: f64 = 9.806_65;

/// Running resistance per rotating mass, r0 + r1 v + r2 v²: N/kg, N/(kg m/s), N/(kg (m/s)²).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
        Self { r0: self.r0 * by[0], r1: self.r1 * by[1], r2: self.r2 * by[2] }
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrainTruth {
    /// Mass as loaded, kg.
    pub mass_kg: f64,
    /// Rotating mass factor.
    #[serde(rename = "rotating_mass_factor")]
    pub gamma: f64,
    /// Length, m.
    pub length_m: f64,
    /// Running resistance per rotating mass; files have it apart.
    #[serde(skip)]
    pub davis: DavisTruth,
    /// Largest tractive effort, N.
    pub max_tractive_effort_n: f64,
    /// Largest tractive power at the wheel, W.
    pub max_power_w: f64,
    /// Largest deceleration by the brake alone, m/s², positive.
    pub max_brake_mps2: f64,
}

impl Default for TrainTruth {
    /// Six cars, double deck, 35 % of the seats taken; limits meet near 38 km/h.
    fn default() -> Self {
        Self {
            mass_kg: 364_000.0,
            gamma: 1.06,
            length_m: 162.0,
            davis: DavisTruth { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 },
            max_tractive_effort_n: 192_920.0,
            max_power_w: 2_036_377.8,
            max_brake_mps2: 0.66,
        }
    }
}

impl TrainTruth {
    /// The same train with `factor` times the mass. Rotating masses and air drag in newton stay; rolling resistance
    /// follows the mass.
    pub fn loaded(self, factor: f64) -> Self {
        let mass_kg = self.mass_kg * factor;
        let gamma = 1.0 + (self.gamma - 1.0) / factor;
        let rolling = self.gamma / gamma;
        let air = self.gamma * self.mass_kg / (gamma * mass_kg);
        Self { mass_kg, gamma, davis: self.davis.scaled([rolling, rolling, air]), ..self }
    }

    /// The same train with `factor` times the mass at the same rotating mass factor: inertia, gravity and rolling
    /// resistance in newton grow with it, air drag in newton stays.
    pub fn heavier(self, factor: f64) -> Self {
        Self { mass_kg: self.mass_kg * factor, davis: self.davis.scaled([1.0, 1.0, 1.0 / factor]), ..self }
    }

    /// γ m, kg.
    pub fn rotating_mass_kg(&self) -> f64 {
        self.gamma * self.mass_kg
    }

    /// Running resistance, N/kg. Only air drag feels the wind.
    pub fn resistance_n_per_kg(&self, speed_mps: f64, headwind_mps: f64) -> f64 {
        let air_mps = speed_mps + headwind_mps;
        self.davis.r0 + self.davis.r1 * speed_mps + self.davis.r2 * air_mps * air_mps.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headwind_as_equivalent_parameters_is_the_same_resistance() {
        let train = TrainTruth::default();
        for headwind_mps in [-8.0, 0.0, 8.0] {
            let direct = train.resistance_n_per_kg(30.0, headwind_mps);
            let equivalent = train.davis.with_headwind(headwind_mps).resistance_n_per_kg(30.0);
            assert!((direct - equivalent).abs() < 1e-15);
        }
    }

    #[test]
    fn a_fuller_train_has_the_same_air_drag_in_newton() {
        let empty = TrainTruth::default();
        let newton = |t: TrainTruth, r: f64| r * t.rotating_mass_kg();
        for full in [empty.loaded(1.2), empty.heavier(1.2)] {
            assert!((newton(empty, empty.davis.r2) - newton(full, full.davis.r2)).abs() < 1e-9);
            let rolling = newton(full, full.davis.r0) / newton(empty, empty.davis.r0);
            assert!((rolling - 1.2).abs() < 1e-12);
        }
    }

    #[test]
    fn passengers_do_not_rotate_but_a_wrong_data_sheet_keeps_its_factor() {
        let empty = TrainTruth::default();
        let rotating = |t: TrainTruth| (t.gamma - 1.0) * t.mass_kg;
        assert!((rotating(empty.loaded(1.2)) - rotating(empty)).abs() < 1e-6);
        assert_eq!(empty.heavier(1.2).gamma, empty.gamma);
    }
}
