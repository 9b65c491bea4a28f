//! `[train]` of a scenario file: as in a train file, and how the truth differs.

use rundown::model::resistance::Davis;
use rundown_truth::train::{DavisTruth, TrainTruth};
use serde::Deserialize;

/// The table; what it leaves out is that of the case study.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrainTable {
    pub name: String,
    pub mass_kg: f64,
    pub rotating_mass_factor: f64,
    pub length_m: f64,
    pub max_tractive_effort_n: f64,
    pub max_power_w: f64,
    pub max_brake_mps2: f64,
    pub davis: Davis,
    pub true_davis_over_described: [f64; 3],
}

impl Default for TrainTable {
    fn default() -> Self {
        Self::of(&TrainTruth::default())
    }
}

impl TrainTable {
    /// The table of a train that is as described.
    pub fn of(train: &TrainTruth) -> Self {
        Self {
            name: "double-deck electric unit, six cars".to_owned(),
            mass_kg: train.mass_kg,
            rotating_mass_factor: train.gamma,
            length_m: train.length_m,
            max_tractive_effort_n: train.max_tractive_effort_n,
            max_power_w: train.max_power_w,
            max_brake_mps2: train.max_brake_mps2,
            davis: Davis { r0: train.davis.r0, r1: train.davis.r1, r2: train.davis.r2 },
            true_davis_over_described: [1.0; 3],
        }
    }

    /// The described train as the truth has it.
    pub(super) fn truth(&self) -> TrainTruth {
        let Davis { r0, r1, r2 } = self.davis;
        TrainTruth {
            mass_kg: self.mass_kg,
            gamma: self.rotating_mass_factor,
            length_m: self.length_m,
            davis: DavisTruth { r0, r1, r2 },
            max_tractive_effort_n: self.max_tractive_effort_n,
            max_power_w: self.max_power_w,
            max_brake_mps2: self.max_brake_mps2,
        }
    }
}
