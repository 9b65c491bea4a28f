//! Logs as recordings, or why one cannot be used.

use rundown_check::{Check, Known, check_after, rows::same::Seen};
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::refusal::{ReadError, Refusal};
use rundown_files::{map_matching::CentreLine, run_log::BadRows, run_set::RunFile};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A log that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failed {
    /// Where it lies.
    pub file: PathBuf,
    /// Why: a line for each bad row.
    pub error: String,
    /// The first place that is wrong, where it is known.
    pub refusal: Option<Box<Refusal>>,
}

impl Failed {
    fn of(file: &Path, error: &ReadError) -> Self {
        let refusal = match error {
            ReadError::Refused(refusal) => Some(refusal.clone()),
            ReadError::BadRows { rows, .. } => rows.first().cloned(),
            _ => None,
        };
        Self { file: file.to_owned(), error: error.to_string(), refusal: refusal.map(Box::new) }
    }

    /// As the results have it.
    pub(crate) fn json(&self) -> Value {
        json!({ "file": self.file.to_string_lossy(), "errors": self.error.lines().collect::<Vec<&str>>() })
    }
}

/// Reads a log.
///
/// # Errors
/// [`Failed`] says why it cannot be used.
pub fn read(
    file: &RunFile,
    bad_rows: BadRows,
    line: Option<&CentreLine>,
    direction: DirectionChoice,
) -> Result<Recording, Failed> {
    Recording::read(file, bad_rows, line, direction).map_err(|error| Failed::of(&file.path, &error))
}

/// Diagnoses recordings, puts right what is beyond doubt, and refuses those that cannot be used. Out: each in its
/// place, and what was found. `seen`: the logs that were read before.
pub fn diagnosed_each(
    mut recordings: Vec<Recording>,
    known: &Known,
    seen: &mut Seen,
) -> (Vec<Result<Recording, Failed>>, Check) {
    let found = check_after(&mut recordings, known, seen);
    let each = recordings.into_iter().zip(&found.runs).map(|(recording, run)| match run.refusal() {
        None => Ok(recording),
        Some(finding) => {
            let error = format!("{}: {}", recording.path.display(), run.said(finding));
            Err(Failed { file: recording.path, error, refusal: None })
        }
    });
    (each.collect(), found)
}

/// The same, those that can be used apart from the others.
pub fn diagnosed(recordings: Vec<Recording>, known: &Known, seen: &mut Seen) -> (Vec<Recording>, Vec<Failed>, Check) {
    let (each, found) = diagnosed_each(recordings, known, seen);
    let (mut used, mut failed) = (Vec::new(), Vec::new());
    for one in each {
        match one {
            Ok(recording) => used.push(recording),
            Err(failure) => failed.push(failure),
        }
    }
    (used, failed, found)
}
