//! Recorded runs as `study` and `tune` take them: with the descriptions of their train and track, or not at all.

use super::{Failure, screen};
use crate::study::source::RunSource;
use rundown::{model::track::Track, model::train::Train};
use rundown_files::{map_matching::CentreLine, track_file::TrackFile, train_file::TrainFile};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct RecordedRuns {
    /// Recorded runs: logs or Parquet files, or folders of them; without it the case study is simulated
    #[arg(long, value_name = "DIR", num_args = 1.., requires_all = ["train", "track"])]
    runs: Vec<PathBuf>,
    /// Description of the train of recorded runs
    #[arg(long, value_name = "T.toml", requires = "runs")]
    train: Option<PathBuf>,
    /// Description of the track of recorded runs
    #[arg(long, value_name = "K.toml", requires = "runs")]
    track: Option<PathBuf>,
}

pub(super) struct Opened {
    pub(super) train_file: TrainFile,
    pub(super) train: Train,
    pub(super) track_file: TrackFile,
    pub(super) track: Track,
    pub(super) source: RunSource,
}

impl RecordedRuns {
    /// Reads the descriptions and finds the runs; `None` when none are asked for.
    pub(super) fn open(&self) -> Result<Option<Opened>, Failure> {
        let (Some(train), Some(track)) = (&self.train, &self.track) else {
            return Ok(None);
        };
        let (train_file, train) = TrainFile::read(train)?;
        let (track_file, track) = TrackFile::read(track)?;
        let line = CentreLine::new(&track_file.centre_line);
        let source = RunSource::recorded(&self.runs, line, screen::note)?;
        Ok(Some(Opened { train_file, train, track_file, track, source }))
    }
}
