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

use super::load;
use super::rows::Believed;
use super::workflow::{Investigation, investigate};
use crate::recording::DirectionChoice;
use crate::run_set::RunSet;
use crate::track_file::TrackFile;
use crate::train_file::TrainFile;
use draw::Set;
use std::fs;
use std::path::Path;
use thiserror::Error;

/// Why a set was not investigated.
#[derive(Debug, Error)]
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
    let failed = |reason: String| BenchError {
        seed: set.ask.seed,
        kinds: set.ask.kinds.join(" + "),
        reason,
    };
    set.write(folder).map_err(|e| failed(e.to_string()))?;
    fs::remove_dir_all(folder.join("truth")).map_err(|e| failed(e.to_string()))?;
    let (_, train) =
        TrainFile::read(&folder.join("train.toml")).map_err(|e| failed(e.to_string()))?;
    let (file, track) =
        TrackFile::read(&folder.join("track.toml")).map_err(|e| failed(e.to_string()))?;
    let logs = RunSet::find(&[folder.join("runs")]).map_err(|e| failed(e.to_string()))?;
    let (runs, notes) = load::runs(&logs, &file, DirectionChoice::Auto);
    if runs.len() != set.ask.runs {
        return Err(failed(format!(
            "{} of {} runs could be read: {}",
            runs.len(),
            set.ask.runs,
            notes.join("; ")
        )));
    }
    let believed = Believed::new(&train, &track);
    let surroundings = load::surroundings(&file);
    Ok(investigate(believed, &surroundings, &runs, None, |_| ()))
}
