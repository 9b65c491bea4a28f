//! Train, track and run of `data/reference`, or logs of the reader's own.

use crate::prelude::*;

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

/// The logs that tests read, with their track and train: those of the folder that `RUNDOWN_LOGS` names, else the run of
/// `data/reference`.
pub struct Logs {
    /// Where track, train and what else describes the logs lie.
    pub folder: PathBuf,
    /// The logs.
    pub set: RunSet,
}

impl Logs {
    /// Finds them: in the folder itself, or in its folder `runs`.
    pub fn find() -> Self {
        let own = std::env::var_os("RUNDOWN_LOGS").map(PathBuf::from);
        let folder = own.clone().unwrap_or_else(|| data("reference"));
        let runs = match own {
            Some(_) if folder.join("runs").is_dir() => folder.join("runs"),
            Some(_) => folder.clone(),
            None => folder.join("run01.csv"),
        };
        let set = RunSet::find(&[runs]).unwrap_or_else(|error| panic!("{error}"));
        Self { folder, set }
    }

    /// `track.toml`, or the only file `track_*.toml`.
    pub fn track(&self) -> (TrackFile, Track) {
        let is_track = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("track") && name.ends_with(".toml")
        };
        let mut files: Vec<PathBuf> =
            self.folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).filter(is_track).collect();
        files.sort();
        let file = files.first().unwrap_or_else(|| panic!("{}: expected a track.toml", self.folder.display()));
        TrackFile::read(file).unwrap_or_else(|error| panic!("{error}"))
    }

    /// `train.toml`; where there is none, that of `data/reference`.
    pub fn train(&self) -> (TrainFile, Train) {
        let own = self.folder.join("train.toml");
        let file = if own.is_file() { own } else { data("reference/train.toml") };
        TrainFile::read(&file).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// The run.
pub fn measurements() -> Vec<Measurement> {
    recording(&data("reference/run01.csv")).rows.iter().map(Sample::measurement).collect()
}
