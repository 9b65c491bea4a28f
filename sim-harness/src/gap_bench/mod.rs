//! Hidden effects: the workflow on sets whose answer is known, blind.
//!
//! | step | where |
//! |---|---|
//! | draw a set by seed: train, line, drivers, sensors, effect | [`draw`] |
//! | write it as `rundown simulate` does, take the key away, investigate | [`blind`] |
//! | compare with the key: names, size, place, intervals, how much of the gap is gone | [`score`] |
//! | many sets in a table | [`table`] |

pub mod draw;
pub mod score;
pub mod table;

use draw::Set;
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown_files::recording::DirectionChoice;
use rundown_files::run_set::RunSet;
use rundown_files::track_file::TrackFile;
use rundown_files::train_file::TrainFile;
use rundown_gap::analysis::Surroundings;
use rundown_gap::load;
use rundown_gap::rows::Believed;
use rundown_gap::runs::Run;
use rundown_gap::workflow::{Investigation, investigate};
use std::error::Error;
use std::fs;
use std::path::Path;

/// Why a set was not investigated.
#[derive(Debug, thiserror::Error)]
#[error("set {seed} ({kinds}): {reason}")]
pub struct BenchError {
    /// Seed of the set.
    pub seed: u64,
    /// What is hidden.
    pub kinds: String,
    /// What happened.
    pub reason: String,
}

/// Writes the set into an empty folder, removes its truth, and investigates what an analyst would have.
/// `None`: the runs have too little to compare.
///
/// # Errors
/// [`BenchError`] when a file could not be written or read.
pub fn blind(set: &Set, folder: &Path) -> Result<Option<Investigation>, BenchError> {
    let failed = |reason: String| BenchError { seed: set.ask.seed, kinds: set.ask.kinds.join(" + "), reason };
    set.write(folder).map_err(|e| failed(e.to_string()))?;
    fs::remove_dir_all(folder.join("truth")).map_err(|e| failed(e.to_string()))?;
    let read = ReadSet::of(folder).map_err(|e| failed(e.to_string()))?;
    if read.runs.len() != set.ask.runs {
        return Err(failed(format!(
            "{} of {} runs could be read: {}",
            read.runs.len(),
            set.ask.runs,
            read.notes.join("; ")
        )));
    }
    Ok(read.investigate())
}

/// What an analyst has of a set.
#[derive(Clone, Debug)]
pub struct ReadSet {
    train: Train,
    track: Track,
    surroundings: Surroundings,
    /// The runs.
    pub runs: Vec<Run>,
    /// What was said while they were read.
    pub notes: Vec<String>,
}

impl ReadSet {
    /// Of a folder as `rundown simulate` writes it.
    ///
    /// # Errors
    /// Names the file.
    pub fn of(folder: &Path) -> Result<Self, Box<dyn Error>> {
        let (_, train) = TrainFile::read(&folder.join("train.toml"))?;
        let (file, track) = TrackFile::read(&folder.join("track.toml"))?;
        let logs = RunSet::find(&[folder.join("runs")])?;
        let (runs, notes) = load::runs(&logs, &file, DirectionChoice::Auto);
        Ok(Self { train, track, surroundings: load::surroundings(&file), runs, notes })
    }

    /// Investigates. `None`: the runs have too little to compare.
    pub fn investigate(&self) -> Option<Investigation> {
        let believed = Believed::new(&self.train, &self.track);
        investigate(believed, &self.surroundings, &self.runs, None, |_| ())
    }
}
