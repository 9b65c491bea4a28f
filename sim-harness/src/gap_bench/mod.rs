//! Hidden effects: the workflow on sets whose answer is known, blind.
//!
//! | step | where |
//! |---|---|
//! | draw a set by seed: train, line, drivers, sensors, effect | [`draw`] |
//! | write it as `rundown simulate` does, take the key away, investigate | [`blind`] |
//! | compare with the key: names, size, place, intervals, how much of the gap is gone | [`score`] |
//! | many sets in a table | [`table`] |
//! | sets of others, with their keys | [`folder`] |
//! | what `sets.json` has | [`fields`] |

pub mod draw;
pub mod fields;
pub mod folder;
pub mod nuisance;
pub mod score;
pub mod table;

use draw::Set;
use rundown_gap::answer::whole::Answer;
use rundown_gap::config::GapConfig;
use rundown_gap::input::Input;
use rundown_gap::refusal::Refusal;
use std::{fs, path::Path};

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

impl BenchError {
    /// Of a set.
    pub fn new(set: &Set, reason: impl std::fmt::Display) -> Self {
        Self { seed: set.request.seed, kinds: set.request.kinds.join(" + "), reason: reason.to_string() }
    }
}

/// An answer, or why the set was refused.
pub type Outcome = Result<Answer, Refusal>;

/// Writes the set into an empty folder, removes its truth, and investigates what an analyst would have.
///
/// # Errors
/// [`BenchError`] when a file could not be written or read.
pub fn blind(set: &Set, folder: &Path) -> Result<Outcome, BenchError> {
    set.write(folder).map_err(|error| BenchError::new(set, error))?;
    fs::remove_dir_all(folder.join("truth")).map_err(|error| BenchError::new(set, error))?;
    Ok(Input::of_set(folder).and_then(answer))
}

fn answer(input: Input) -> Outcome {
    rundown_gap::run(input, GapConfig::default(), None, |_| ())
}
