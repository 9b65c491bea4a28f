//! Logs as recordings, or why one cannot be used.

use rundown_files::map_matching::CentreLine;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::run_log::{BadRows, RunLog};
use rundown_files::run_set::RunFile;
use std::path::PathBuf;

/// A log that cannot be used.
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
    let failed = |error: String| Failed { file: file.path.clone(), error };
    let log = RunLog::read(&file.path, bad_rows).map_err(|error| failed(error.to_string()))?;
    Recording::new(file, &log, line, direction).map_err(|error| failed(error.to_string()))
}
