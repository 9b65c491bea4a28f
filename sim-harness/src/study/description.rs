//! The description that goes with a simulation: what the manufacturer and the infrastructure manager say, which is not what is true.

use crate::simulation::scenario_file::Simulation;
use rundown::model::bounds::OutOfRange;
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown_files::toml_file::TomlError;
use rundown_files::track_file::TrackFile;
use rundown_files::train_file::TrainFile;
use std::path::Path;
use thiserror::Error;

/// Train and track as described.
#[derive(Clone, Debug)]
pub struct Description {
    /// The train.
    pub train: Train,
    /// The track.
    pub track: Track,
}

/// Why a simulation has none that an estimator takes.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DescriptionError {
    /// Of the train.
    #[error(transparent)]
    Train(#[from] OutOfRange),
    /// Of the track.
    #[error(transparent)]
    Track(#[from] TomlError),
    /// A description that no file can hold.
    #[error("{0}")]
    Text(#[from] toml::ser::Error),
}

/// Of a simulation.
///
/// # Errors
/// [`DescriptionError`] when the estimator does not take its train or its track.
pub fn of(simulation: &Simulation) -> Result<Description, DescriptionError> {
    // The track is written and read, so that what is simulated is described by a file that a person could write.
    let text = toml::to_string(&simulation.track)?;
    let (_, track) = TrackFile::parse(Path::new("track.toml"), &text)?;
    let train: &TrainFile = &simulation.train;
    Ok(Description { train: train.train()?, track })
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
