//! Estimates judged against truth: the case study's vehicles, for tests and benchmarks.

use crate::prelude::*;
use rundown::model::effects::Effects;
use rundown_truth::scenario::fleet;
pub use sim_harness::accuracy_bench::score::{
    Errors, FleetFigures, JudgedVehicle, davis, measurements, regime, replay, resistance,
};

/// The manufacturer's description that every simulated vehicle deviates from.
pub const TRAIN: TrainDescription = TrainDescription { max_power_w: 2_036_377.8, ..TrainDescription::CASE_STUDY };
/// Its Davis coefficients.
pub const NOMINAL: Davis = TRAIN.davis;
/// Speeds at which its resistance is judged, km/h.
pub const BAND_KMH: [f64; 2] = [20.0, 140.0];

/// The same as the estimator takes it.
pub fn train() -> Train {
    Train::try_new(TRAIN).unwrap()
}

/// The scenario's line and a train as described (not as it truly is).
pub fn description(config: Config, scenario: &Scenario) -> Description {
    let gradients = scenario.line.gradients_permille().iter();
    Description {
        train: TRAIN,
        track_length_m: scenario.line.length_m(),
        gradients: gradients.map(|&(from_m, permille)| Gradient { from_m, permille }).collect(),
        curves: Vec::new(),
        targets: Vec::new(),
        effects: Effects::NONE,
        config,
    }
}

/// An estimator for them.
pub fn estimator(config: Config, scenario: &Scenario) -> Estimator {
    description(config, scenario).estimator().unwrap()
}

/// Vehicles: scale of r0, r1, r2 of each; runs of each.
pub fn judge(config: Config, scenario: &Scenario, scales: &[[f64; 3]], runs: usize, seed: u64) -> FleetFigures {
    let mut table = FleetFigures::default();
    let estimator = estimator(config, scenario);
    for (index, scale) in scales.iter().enumerate() {
        let runs = fleet(scenario, *scale, runs, seed + 1000 * index as u64);
        let truth = Davis { r0: NOMINAL.r0 * scale[0], r1: NOMINAL.r1 * scale[1], r2: NOMINAL.r2 * scale[2] };
        table.judge_vehicle(&JudgedVehicle { estimator: &estimator, truth, band_kmh: BAND_KMH }, &runs);
    }
    table
}
