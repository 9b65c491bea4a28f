//! The case study as it is described to a board, and what its sensors read.

use crate::prelude::*;
use rundown::model::effects::Effects;
use rundown::model::units::KmPerHour;
use rundown_truth::sensors::Sample;

/// The manufacturer's description that every simulated vehicle deviates from.
pub const TRAIN: TrainDescription = TrainDescription { max_power_w: 2_036_377.8, ..TrainDescription::CASE_STUDY };
/// Its Davis coefficients.
pub const NOMINAL: Davis = TRAIN.davis;

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

/// The description with the limits of the scenario's line and a stop at its end.
pub fn with_targets(config: Config, scenario: &Scenario) -> Description {
    let limits = scenario.line.limits_kmh().iter();
    let limits = limits.map(|&(at_m, kmh)| Target { at_m, limit_mps: Some(KmPerHour(kmh).to_mps()) });
    let end = Target { at_m: scenario.line.length_m(), limit_mps: None };
    Description { targets: limits.chain([end]).collect(), ..description(config, scenario) }
}

/// The measurements of a simulated run.
pub fn measurements(run: &Run) -> Vec<Measurement> {
    let of_sample = |sample: &Sample| Measurement {
        time_s: sample.time_s,
        location_m: sample.location_m,
        speed_mps: sample.speed_kmh.map(|kmh| kmh / 3.6),
        effort_n_per_kg: Some(sample.effort_n_per_kg),
    };
    run.samples.iter().map(of_sample).collect()
}
