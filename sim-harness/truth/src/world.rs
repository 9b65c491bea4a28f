//! Everything that acts on the train in one run: the described world, its effects, today's wind, load and weather.
//!
//! In: a scenario and the plan of a run. Out: resistance, gravity and what traction and brake can do, at any moment.
//!
//! ```text
//! dv/dt = effort - r(v, wind) - extras - g/γ * mean gradient         per true rotating mass
//! ```
//!
//! Efforts act in newton: what traction gives, the air takes and a dragging brake holds does not depend on the mass;
//! inertia, gravity and rolling resistance do. All locations here are along the distance travelled: in direction `down`
//! the line is reversed.

use crate::conditions::Scenario;
use crate::effects::{Altered, Capability, Effect, Moment, Setting};
use crate::line::Line;
use crate::motion::Motion;
use crate::plan::RunPlan;
use crate::seeds::stream;
use crate::timetable::Heading;
use crate::train::{GRAVITY_MPS2, TrainTruth};
use crate::weather::Weather;

/// Motors hold nothing below the first of these speeds, and all that they can from the second on, m/s.
const ELECTRIC_BRAKE_MPS: [f64; 2] = [5.0 / 3.6, 15.0 / 3.6];
/// No driver plans to brake more gently than this, m/s².
const LEAST_DECELERATION_MPS2: f64 = 0.1;

/// What has happened in the run so far, as far as it matters for what acts now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct History {
    /// Time since the start of the log, s.
    pub time_s: f64,
    /// When the train first moved, s.
    pub departed_s: Option<f64>,
    /// A brake has been applied since.
    pub braked: bool,
    /// Since when it stands at a stop on the way, s.
    pub standing_since_s: Option<f64>,
    /// How long it stood at the last one, s.
    pub stood_s: Option<f64>,
}

impl History {
    /// The train stops or starts in the step that ends now.
    pub(crate) fn stand(&mut self, from_mps: f64, to_mps: f64) {
        if to_mps > 0.0 {
            self.stood_s = self.standing_since_s.take().map(|since_s| self.time_s - since_s).or(self.stood_s);
        } else if from_mps > 0.0 {
            self.standing_since_s = Some(self.time_s);
        }
    }
}

/// What acts in one run.
#[derive(Clone, Debug)]
pub struct World {
    /// The train as it is today: load, mass, length, Davis parameters.
    pub train: TrainTruth,
    /// The line as it is, in the direction of travel.
    pub line: Line,
    /// Wind against the direction of travel, m/s.
    pub headwind_mps: f64,
    /// Temperature.
    pub weather: Weather,
    /// Indicated over true speed: what the driver reads.
    pub speed_scale: f64,
    /// Notches of the lever; 0: without steps.
    pub notches: u8,
    /// What half of the coasts keep on of the brake, N/kg.
    pub coast_brake_n_per_kg: f64,
    /// The column of the effort has of the brake what the motors hold.
    pub electric_brake_only: bool,
    /// How late the location is beyond the sensors' latency, s.
    pub location_lag_s: f64,
    effects: Vec<Effect>,
    described_over_true_mass: f64,
    season: f64,
}

impl World {
    /// The world of a run. `load` is the mass over the described one, `headwind_mps` the wind of the day, both before
    /// any effect.
    pub fn new(scenario: &Scenario, plan: &RunPlan, load: f64, headwind_mps: f64) -> Self {
        let acting = |(effect, acts): (&Effect, &bool)| acts.then(|| effect.clone());
        let effects: Vec<Effect> = scenario.effects.iter().zip(&plan.acting).filter_map(acting).collect();
        let up = plan.heading == Heading::Up;
        let described = &scenario.train;
        let mut altered = Altered {
            line: scenario.line.clone(),
            train: TrainTruth { davis: described.davis.scaled(scenario.davis_scale), ..*described },
            headwind_mps,
            speed_scale: 1.0,
            location_lag_s: 0.0,
            up_sign: if up { 1.0 } else { -1.0 },
            draws: stream(plan.seed, 5),
        };
        for effect in &effects {
            effect.law().alter(&mut altered);
        }
        let Altered { mut line, train, headwind_mps, speed_scale, location_lag_s, .. } = altered;
        let length_m = line.length_m();
        let effects = match plan.heading {
            Heading::Up => effects,
            Heading::Down => {
                line = line.reversed();
                let mirrored = effects.into_iter().map(|e| e.mirrored(length_m));
                mirrored.collect()
            }
        };
        let train = train.loaded(load);
        Self {
            described_over_true_mass: described.rotating_mass_kg() / train.rotating_mass_kg(),
            weather: scenario.climate.draw(plan.departure_s, &mut stream(plan.seed, 4)),
            season: plan.season,
            train,
            line,
            notches: scenario.notches,
            coast_brake_n_per_kg: scenario.coast_brake_n_per_kg,
            electric_brake_only: scenario.electric_brake_only,
            headwind_mps,
            speed_scale,
            location_lag_s,
            effects,
        }
    }

    fn moment(&self, history: History, motion: Motion) -> Moment {
        Moment {
            motion,
            since_departure_s: history.departed_s.map_or(0.0, |from| history.time_s - from),
            stood_s: history.standing_since_s.map(|from| history.time_s - from).or(history.stood_s),
            braked: history.braked,
            temperature_c: self.weather.temperature_c(history.time_s),
            season: self.season,
        }
    }

    /// What the effects add to the resistance, N/kg.
    pub fn extra_n_per_kg(&self, history: History, motion: Motion) -> f64 {
        let at = self.moment(history, motion);
        let setting =
            Setting { train: &self.train, line: &self.line, described_over_true_mass: self.described_over_true_mass };
        self.effects.iter().fold(0.0, |sum, effect| sum + effect.law().extra_n_per_kg(&setting, &at))
    }

    /// Resistance with wind and effects, without gravity, N/kg.
    pub fn resistance_n_per_kg(&self, history: History, motion: Motion) -> f64 {
        self.train.resistance_n_per_kg(motion.speed_mps, self.headwind_mps) + self.extra_n_per_kg(history, motion)
    }

    /// Gravity along the track, N/kg, positive uphill.
    pub fn gravity_n_per_kg(&self, motion: Motion) -> f64 {
        let gradient = self.line.mean_gradient(motion.location_m, self.train.length_m);
        GRAVITY_MPS2 / self.train.gamma * gradient
    }

    /// Everything that brakes a coasting train, N/kg.
    pub fn load_n_per_kg(&self, history: History, motion: Motion) -> f64 {
        self.resistance_n_per_kg(history, motion) + self.gravity_n_per_kg(motion)
    }

    /// Largest tractive effort for a lever at these shares of effort and power, N/kg: constant, then constant power;
    /// the smaller of what is demanded and what the effects leave.
    pub fn max_effort_n_per_kg(&self, motion: Motion, effort_share: f64, power_share: f64) -> f64 {
        let mut left = Capability::WHOLE;
        for effect in &self.effects {
            effect.law().cap(&mut left, motion);
        }
        let effort_n = self.train.max_tractive_effort_n * (effort_share * left.scale).min(left.effort_cap);
        // At standstill the quotient is infinite and the constant effort wins.
        let power_w = self.train.max_power_w * (power_share * left.scale).min(left.power_cap);
        effort_n.min(power_w / motion.speed_mps) / self.train.rotating_mass_kg()
    }

    /// Largest brake effort, N/kg, positive.
    pub fn max_brake_n_per_kg(&self) -> f64 {
        self.train.max_brake_mps2 * self.described_over_true_mass
    }

    /// A deceleration that the brake can give everywhere on this line, with a tenth in reserve, m/s².
    pub fn safe_deceleration_mps2(&self) -> f64 {
        let steepest = self.line.gradients_permille().iter().map(|g| g.1).fold(0.0, f64::min);
        let downhill = GRAVITY_MPS2 / self.train.gamma * steepest / 1000.0;
        (0.9 * self.max_brake_n_per_kg() + downhill).max(LEAST_DECELERATION_MPS2)
    }

    /// What arrives at the wheels of a demanded effort, N/kg.
    pub fn applied_n_per_kg(&self, demanded: f64, motion: Motion) -> f64 {
        if demanded < 0.0 {
            let share = |effect: &Effect| effect.law().brake_share(motion.speed_mps);
            demanded * self.effects.iter().map(share).product::<f64>()
        } else {
            demanded.min(self.max_effort_n_per_kg(motion, 1.0, 1.0))
        }
    }

    /// What the train's computer reports for it, N/kg of *described* rotating mass: the traction that is applied, and
    /// the brake that is demanded (it knows pressures, not friction), or of the brake what the motors hold.
    pub fn reported_n_per_kg(&self, [demanded, applied]: [f64; 2], motion: Motion) -> f64 {
        let least = if self.electric_brake_only { -self.electric_brake_n_per_kg(motion) } else { f64::NEG_INFINITY };
        demanded.min(applied).max(least) / self.described_over_true_mass
    }

    /// What the motors can hold, N/kg: as much as their traction, and next to standstill nothing.
    fn electric_brake_n_per_kg(&self, motion: Motion) -> f64 {
        let [none_mps, all_mps] = ELECTRIC_BRAKE_MPS;
        let share = ((motion.speed_mps - none_mps) / (all_mps - none_mps)).clamp(0.0, 1.0);
        share * self.max_effort_n_per_kg(motion, 1.0, 1.0)
    }

    /// One step under a constant effort at the wheels.
    pub fn advance(&self, history: History, motion: Motion, applied: f64, step_s: f64) -> Motion {
        motion.advance(step_s, |m, t| {
            let then = History { time_s: history.time_s + t, ..history };
            applied - self.load_n_per_kg(then, m)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is reported of a brake of 0.5 N/kg at a speed, N/kg.
    fn reported(electric_brake_only: bool, kmh: f64) -> f64 {
        let scenario = Scenario { electric_brake_only, ..Scenario::default() };
        let world = World::new(&scenario, &RunPlan::alone(&scenario, 1), 1.0, 0.0);
        let motion = Motion { location_m: 1_000.0, speed_mps: kmh / 3.6 };
        world.reported_n_per_kg([-0.5; 2], motion)
    }

    #[test]
    fn of_the_electric_brake_alone_there_is_as_much_as_the_motors_give_and_nothing_at_walking_pace() {
        for kmh in [4.0, 60.0, 140.0] {
            assert!((reported(false, kmh) + 0.5).abs() < 1e-12);
        }
        assert_eq!(reported(true, 4.0), 0.0);
        // 2036 kW of 364 t times 1.06, and the limit by effort, 0.5 N/kg.
        assert!((reported(true, 140.0) + 2_036_377.8 / (140.0 / 3.6) / (364_000.0 * 1.06)).abs() < 1e-9);
        assert!((reported(true, 20.0) + 0.5).abs() < 0.01);
    }
}
