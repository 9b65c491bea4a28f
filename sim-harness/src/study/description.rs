//! The description that goes with a simulation: what the manufacturer and the infrastructure manager say, which is not
//! what is true.

use super::Refused;
use crate::simulation::scenario_file::Simulation;
use rundown::{model::track::Track, model::train::Train};
use rundown_files::track_file::TrackFile;
use std::path::Path;

#[derive(Clone, Debug)]
pub struct Believed {
    pub train: Train,
    pub track: Track,
}

/// Of a simulation, as far as the estimator takes its train and its track.
pub fn of(simulation: &Simulation) -> Result<Believed, Refused> {
    // The track is written and read, so that what is simulated is described by a file that a person could write.
    let text = toml::to_string(&simulation.track)?;
    let (_, track) = TrackFile::parse(Path::new("track.toml"), &text)?;
    Ok(Believed { train: simulation.train.train()?, track })
}

#[cfg(test)]
mod tests {
    use super::super::case::case_study;
    use super::*;

    #[test]
    fn the_case_study_is_described_and_its_truth_is_not() {
        let simulation = case_study().unwrap();
        let description = of(&simulation).unwrap();
        assert_eq!(description.train.davis().r0, 7.38e-3);
        assert_eq!(simulation.scenario.davis_scale, [0.92; 3]);
        assert_eq!(description.track.length_m(), 32_103.0);
    }
}
