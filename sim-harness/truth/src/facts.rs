//! What a test may want to know about a run, gathered while it is driven.
//!
//! In: every step of the run. Out: [`Facts`]. Marks are exact to one step.

use crate::habits::Habits;
use crate::plan::RunPlan;
use crate::regime::Regime;
use crate::sensors::TruthSample;
use crate::train::{DavisTruth, TrainTruth};
use crate::weather::Weather;
use crate::world::World;
use serde::{Deserialize, Serialize};

/// When, where and how fast.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the units are in the names")]
pub struct Mark {
    pub time_s: f64,
    pub location_m: f64,
    pub speed_mps: f64,
}

/// The truth about a run as a whole. Power is per rotating mass, W/kg, effort times speed at the wheel.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// Seed, direction, departure, effects.
    pub plan: RunPlan,
    /// Start of the coast that ended in the final brake; `None` if the driver braked from power.
    pub final_coast: Option<Mark>,
    /// Start of the brake towards the platform, from the speed of the line. With a zone of 40 km/h it ends there, and
    /// [`stop_brake`](Self::stop_brake) follows; the paper's final brake is from here to the stop.
    pub final_brake: Mark,
    /// Start of the last unbroken brake to standstill. The same as the final brake where there is no zone.
    pub stop_brake: Mark,
    /// Standstill at the last stop.
    pub stop: Mark,
    /// All standstills in order, unscheduled ones included; the last is `stop`.
    pub stops: Vec<Mark>,
    /// The speed the driver wanted to keep, m/s.
    pub cruise_mps: f64,
    /// Mean over time while accelerating after a stop, 50 to 130 km/h; `None` if the train never did.
    pub mean_power_50_130_w_per_kg: Option<f64>,
    /// Largest there, 50 to 90 km/h: the crosses of the paper's Fig. 9.
    pub max_power_50_90_w_per_kg: Option<f64>,
    /// Largest of the whole run.
    pub max_power_w_per_kg: f64,
    /// Running resistance of this run as still air would have it: load and wind included.
    pub davis: DavisTruth,
    /// The train as it was in this run.
    pub train: TrainTruth,
    /// Mass by passengers over the described one; an effect on the mass is not in it.
    pub load: f64,
    /// Temperature.
    pub weather: Weather,
    /// Wind against the direction of travel, m/s.
    pub headwind_mps: f64,
    /// The driver.
    pub habits: Habits,
}

/// Gathers the facts.
#[derive(Debug, Default)]
pub struct FactsRecorder {
    last: Regime,
    coast: Option<Mark>,
    final_coast: Option<Mark>,
    final_brake: Option<Mark>,
    stop_brake: Option<Mark>,
    stops: Vec<Mark>,
    /// The train has left the acceleration after a stop.
    has_accelerated: bool,
    power_sum: f64,
    power_steps: usize,
    max_50_90: Option<f64>,
    max: f64,
}

impl FactsRecorder {
    /// One step, from the row before to its own. `plateau`: between the approach brake and the stop.
    pub fn observe(&mut self, from: &TruthSample, to: &TruthSample, plateau: bool) {
        let mark = |at: &TruthSample| Mark { time_s: at.time_s, location_m: at.location_m, speed_mps: at.speed_mps };
        let regime = to.regime;
        if regime != self.last {
            if regime == Regime::Brake {
                self.stop_brake = Some(mark(from));
                if !plateau {
                    self.final_brake = Some(mark(from));
                    self.final_coast = self.coast.filter(|_| self.last == Regime::Coast);
                }
            }
            if regime == Regime::Coast && !plateau {
                self.coast = Some(mark(from));
            }
            self.last = regime;
        }
        if from.speed_mps > 0.0 && to.speed_mps == 0.0 {
            self.stops.push(mark(to));
            self.has_accelerated = false;
        }
        let speed_mps = (from.speed_mps + to.speed_mps) / 2.0;
        let power = to.effort_n_per_kg * speed_mps;
        self.max = self.max.max(power);
        let kmh = 3.6 * speed_mps;
        if kmh > 50.0 && regime != Regime::Traction {
            self.has_accelerated = true;
        }
        if !self.has_accelerated && regime == Regime::Traction && (50.0..=130.0).contains(&kmh) {
            self.power_sum += power;
            self.power_steps += 1;
            if kmh <= 90.0 {
                self.max_50_90 = Some(self.max_50_90.map_or(power, |max| max.max(power)));
            }
        }
    }

    /// The facts of a run that ended at a platform; `None` if the train never braked or never stopped.
    pub fn finish(self, plan: RunPlan, world: &World, load: f64, habits: Habits) -> Option<Facts> {
        let mean = self.power_sum / self.power_steps as f64;
        Some(Facts {
            plan,
            final_coast: self.final_coast,
            final_brake: self.final_brake?,
            stop_brake: self.stop_brake?,
            stop: *self.stops.last()?,
            stops: self.stops,
            cruise_mps: habits.cruise_mps,
            mean_power_50_130_w_per_kg: (self.power_steps > 0).then_some(mean),
            max_power_50_90_w_per_kg: self.max_50_90,
            max_power_w_per_kg: self.max,
            davis: world.train.davis.with_headwind(world.headwind_mps),
            train: world.train,
            load,
            weather: world.weather,
            headwind_mps: world.headwind_mps,
            habits,
        })
    }
}
