//! Logs as recordings, or why one cannot be used.

use rundown_check::{Check, Known, check_beside};
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::{map_matching::CentreLine, run_log::BadRows, run_set::RunFile};
use std::path::PathBuf;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failed {
    pub file: PathBuf,
    pub error: String,
}

pub fn read(
    file: &RunFile,
    bad_rows: BadRows,
    line: Option<&CentreLine>,
    direction: DirectionChoice,
) -> Result<Recording, Failed> {
    Recording::read(file, bad_rows, line, direction)
        .map_err(|error| Failed { file: file.path.clone(), error: error.to_string() })
}

/// Diagnoses recordings, puts right what is beyond doubt, and refuses those that cannot be used. Out: each in its place, and what was found.
pub fn diagnosed_each(mut recordings: Vec<Recording>, known: Known) -> (Vec<Result<Recording, Failed>>, Check) {
    let found = check_beside(&mut recordings, known);
    let each = recordings.into_iter().zip(&found.runs).map(|(recording, run)| match run.refusal() {
        None => Ok(recording),
        Some(finding) => {
            let error = format!("{}: {finding}", recording.path.display());
            Err(Failed { file: recording.path, error })
        }
    });
    (each.collect(), found)
}

/// The same, those that can be used apart from the others.
pub fn diagnosed(recordings: Vec<Recording>, known: Known) -> (Vec<Recording>, Vec<Failed>, Check) {
    let (each, found) = diagnosed_each(recordings, known);
    let (mut used, mut failed) = (Vec::new(), Vec::new());
    for one in each {
        match one {
            Ok(recording) => used.push(recording),
            Err(failure) => failed.push(failure),
        }
    }
    (used, failed, found)
}
