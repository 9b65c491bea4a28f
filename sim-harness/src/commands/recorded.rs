//! Recorded runs as `study` and `tune` take them: with the descriptions of their train and track, or not at all.

use super::{Failure, Strict, screen};
use crate::study::source::RunSource;
use rundown::{estimator::config::Config, model::track::Track, model::train::Train, tick::sensor::Rounding};
use rundown_check::gradients::Answer;
use rundown_check::{Known, limits::Described};
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
    /// Take the runs as they are: what `rundown check` would put right is left as it is
    #[arg(long)]
    pub(super) as_recorded: bool,
    /// Count runs with red signals, restrictions or other disturbances, too; without it they are set aside, with a note
    #[arg(long, requires = "runs")]
    pub(super) keep_perturbed: bool,
    #[command(flatten)]
    pub(super) strict: Strict,
    /// Description of the track of recorded runs
    #[arg(long, value_name = "K.toml", requires = "runs")]
    track: Option<PathBuf>,
}

pub(super) struct OpenedCase {
    pub(super) train_file: TrainFile,
    pub(super) train: Train,
    pub(super) track_file: TrackFile,
    pub(super) track: Track,
    pub(super) source: RunSource,
    /// What an estimator puts right by itself, and what is known of the line.
    pub(super) known: Known,
    /// The files that were read, and those that will be.
    pub(super) inputs: Vec<PathBuf>,
    /// The estimator's, as far as the track is doubted.
    pub(super) config: Config,
    /// What the coasts say of the descriptions.
    pub(super) answer: Answer,
}

impl RecordedRuns {
    /// Reads the descriptions and finds the runs; `None` when none are asked for.
    /// `config`: that of the estimator.
    pub(super) fn open(&self, config: &Config) -> Result<Option<OpenedCase>, Failure> {
        self.open_as(config, self.as_recorded)
    }

    /// The same, but that runs are left to be diagnosed by `OpenedCase::known`.
    pub(super) fn open_undiagnosed(&self, config: &Config) -> Result<Option<OpenedCase>, Failure> {
        self.open_as(config, true)
    }

    fn open_as(&self, config: &Config, as_recorded: bool) -> Result<Option<OpenedCase>, Failure> {
        let (Some(train), Some(track)) = (&self.train, &self.track) else {
            return Ok(None);
        };
        let described = [train.clone(), track.clone()];
        let (train_file, train) = TrainFile::read(train)?;
        let (track_file, track) = TrackFile::read(track)?;
        let line = CentreLine::new(&track_file.centre_line);
        let known = Known {
            truncates: config.sensor.rounding == Rounding::Truncated,
            scale: false,
            stops_m: track_file.stops_m(),
            limits: Described::of(Some(train), Some(&track_file)),
            track: Some(track.clone()),
            moves_locations: true,
        };
        let diagnosed = (!as_recorded).then(|| known.clone());
        let mut source = RunSource::recorded(&self.runs, line, diagnosed, self.keep_perturbed, screen::note)?;
        let answer = source.of_descriptions(&train, &track, track_file.said_sd_permille(config))?;
        let config = track_file.doubted(*config);
        let inputs = [described.to_vec(), source.files()].concat();
        Ok(Some(OpenedCase { train_file, train, track_file, track, source, known, inputs, config, answer }))
    }
}
