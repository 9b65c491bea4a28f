//! Logs as recordings, or why one cannot be used.

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
