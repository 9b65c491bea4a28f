//! Estimates judged against truth: the case study's vehicles, for tests and benchmarks.

use crate::prelude::*;
pub use board_tests::described::{NOMINAL, TRAIN, description, measurements, train};
use rundown_truth::scenario::fleet;
pub use sim_harness::accuracy_bench::score::{Errors, FleetFigures, JudgedVehicle, davis, regime, replay, resistance};

/// Speeds at which the resistance of the case study's train is judged, km/h.
pub const BAND_KMH: [f64; 2] = [20.0, 140.0];

/// An estimator of a scenario's train and line.
pub fn estimator(config: Config, scenario: &Scenario) -> Estimator {
    description(config, scenario).estimator().unwrap()
}

/// Judges vehicles with these scales of r0, r1, r2, so many runs of each.
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
