//! Train, track and run of `data/reference`.

use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown::tick::measurement::Measurement;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::run_log::BadRows;
use rundown_files::run_set::RunSet;
use rundown_files::sample::Sample;
use rundown_files::track_file::TrackFile;
use rundown_files::train_file::TrainFile;
use std::path::{Path, PathBuf};

/// A file below `data/`.
pub fn data(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data").join(path)
}

/// The train and the track.
pub fn train_and_track() -> (Train, Track) {
    let (_, train) = TrainFile::read(&data("reference/train.toml")).unwrap_or_else(|error| panic!("{error}"));
    let (_, track) = TrackFile::read(&data("reference/track.toml")).unwrap_or_else(|error| panic!("{error}"));
    (train, track)
}

/// A log as a recording.
pub fn recording(path: &Path) -> Recording {
    let set = RunSet::find(&[path.to_owned()]).unwrap_or_else(|error| panic!("{error}"));
    Recording::read(&set.files[0], BadRows::Refuse, None, DirectionChoice::Auto)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The run.
pub fn measurements() -> Vec<Measurement> {
    recording(&data("reference/run01.csv")).rows.iter().map(Sample::measurement).collect()
}
