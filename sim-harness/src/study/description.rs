//! The description that goes with a scenario: what the manufacturer and the infrastructure manager say, which is not what is true.

use crate::track_file::{GradientEntry, SpeedLimit, TrackFile};
use crate::train_file::{DavisTable, TrainFile};
use crate::truth::scenario::Scenario;
use rundown::track::Track;
use rundown::train::Train;

/// Largest deceleration of the case study's train, m/s² (Fig. 3).
const MAX_BRAKE_MPS2: f64 = 0.66;

/// Train and track as described.
#[derive(Clone, Debug)]
pub struct Description {
    /// The train, as a file would say it.
    pub train_file: TrainFile,
    /// The track, as a file would say it.
    pub track_file: TrackFile,
    /// The train.
    pub train: Train,
    /// The track.
    pub track: Track,
}

/// Of a scenario: its train before load and Davis scale, its line.
///
/// # Panics
/// If the scenario's train or line is none that an estimator takes.
pub fn of(scenario: &Scenario) -> Description {
    let (train, line) = (&scenario.train, &scenario.line);
    let train_file = TrainFile {
        name: "six-car double-deck Intercity (simulated)".to_owned(),
        mass_kg: train.mass_kg,
        rotating_mass_factor: train.gamma,
        length_m: train.length_m,
        max_tractive_effort_n: train.max_tractive_effort_n,
        max_power_w: train.max_power_w,
        max_brake_mps2: MAX_BRAKE_MPS2,
        davis: DavisTable {
            r0: train.davis.r0,
            r1: train.davis.r1,
            r2: train.davis.r2,
        },
        effect: Vec::new(),
    };
    let track_file = TrackFile {
        name: "Eindhoven Centraal to 's-Hertogenbosch (simulated, gradients invented)".to_owned(),
        length_m: line.length_m(),
        gradient: line
            .gradients_permille()
            .iter()
            .map(|&(from_m, permille)| GradientEntry { from_m, permille })
            .collect(),
        speed_limit: line
            .limits_kmh()
            .iter()
            .map(|&(from_m, kmh)| SpeedLimit { from_m, kmh })
            .collect(),
        ..TrackFile::default()
    };
    // Written and read, so that what is simulated is described by files that a person could write.
    let parsed_train = toml::to_string(&train_file)
        .map(|text| TrainFile::parse("train.toml".as_ref(), &text).map(|(_, train)| train));
    let parsed_track = toml::to_string(&track_file)
        .map(|text| TrackFile::parse("track.toml".as_ref(), &text).map(|(_, track)| track));
    match (parsed_train, parsed_track) {
        (Ok(Ok(train)), Ok(Ok(track))) => Description {
            train_file,
            track_file,
            train,
            track,
        },
        (train, track) => panic!("no description of the scenario: {train:?}, {track:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_case_study_is_described_and_its_truth_is_not() {
        let scenario = Scenario {
            davis_scale: [0.8; 3],
            ..Scenario::default()
        };
        let description = of(&scenario);
        assert_eq!(description.train.davis().r0, scenario.train.davis.r0);
        assert_eq!(description.track.length_m(), 32_103.0);
    }
}
