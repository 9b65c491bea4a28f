//! Where the runs of a replay come from: logs, Parquet files of runs, or a table in memory.

use super::ReplayError;
use crate::logs::{self, Failed};
use crate::parquet_runs::ParquetRuns;
use rayon::prelude::*;
use rundown_files::map_matching::CentreLine;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::run_rows::{self, RunTable};
use rundown_files::{run_log::BadRows, run_set::RunSet};
use std::collections::VecDeque;
use std::path::PathBuf;

/// Runs to be replayed.
#[derive(Clone, Debug)]
pub enum Runs {
    /// Run logs, folders of them, or Parquet files.
    Paths(Vec<PathBuf>),
    /// Tables in memory, with the columns of Parquet files of runs.
    Tables(Vec<RunTable>),
}

/// What of it was read is forgotten.
#[derive(Debug)]
pub(super) enum Source {
    Logs { set: RunSet, next: usize },
    Parquet(ParquetRuns),
    Tables(VecDeque<Recording>),
}

impl Source {
    pub(super) fn open(runs: Runs, line: Option<&CentreLine>) -> Result<Self, ReplayError> {
        match runs {
            Runs::Paths(paths) => match ParquetRuns::open(&paths, line)? {
                Some(runs) => Ok(Self::Parquet(runs)),
                None => Ok(Self::Logs { set: RunSet::find(&paths)?, next: 0 }),
            },
            Runs::Tables(tables) => Ok(Self::Tables(run_rows::recordings(tables, line)?)),
        }
    }

    pub(super) fn runs(&self) -> usize {
        match self {
            Self::Logs { set, .. } => set.files.len(),
            Self::Parquet(runs) => runs.runs(),
            Self::Tables(runs) => runs.len(),
        }
    }

    /// Logs unit by unit: a recorder is judged by its runs that are in memory together.
    pub(super) fn by_unit(&mut self) {
        if let Self::Logs { set, .. } = self {
            set.files.sort_by(|a, b| a.unit.cmp(&b.unit));
        }
    }

    /// The files that are read; a table in memory is none.
    pub(super) fn paths(&self) -> Vec<PathBuf> {
        match self {
            Self::Logs { set, .. } => set.paths(),
            Self::Parquet(runs) => runs.files().to_vec(),
            Self::Tables(_) => Vec::new(),
        }
    }

    pub(super) fn notes(&self) -> &[String] {
        match self {
            Self::Logs { set, .. } => &set.notes,
            Self::Parquet(_) | Self::Tables(_) => &[],
        }
    }

    /// The next runs, at most so many; none after the last. `bad_rows` and `direction` are of logs: tables have no rows
    /// that cannot be read, and say the direction themselves.
    pub(super) fn next_chunk(
        &mut self,
        most: usize,
        bad_rows: BadRows,
        line: Option<&CentreLine>,
        direction: DirectionChoice,
    ) -> Result<Option<Vec<Result<Recording, Failed>>>, ReplayError> {
        let chunk: Vec<Result<Recording, Failed>> = match self {
            Self::Logs { set, next } => {
                let end = next.saturating_add(most).min(set.files.len());
                let files = set.files[*next..end].par_iter();
                *next = end;
                files.map(|file| logs::read(file, bad_rows, line, direction)).collect()
            }
            Self::Parquet(runs) => runs.next_chunk(most)?.into_iter().map(Ok).collect(),
            Self::Tables(runs) => runs.drain(..most.min(runs.len())).map(Ok).collect(),
        };
        Ok((!chunk.is_empty()).then_some(chunk))
    }
}

/// Runs of one name, as different units have them, get their unit's name before it, and a number when that is not
/// enough: no output overwrites another.
pub(super) fn tell_apart(recordings: &mut [Recording]) {
    let mut counts = std::collections::HashMap::new();
    for recording in recordings.iter() {
        *counts.entry(recording.name.clone()).or_insert(0_usize) += 1;
    }
    let mut taken = std::collections::HashMap::new();
    for recording in recordings {
        if counts.get(&recording.name).is_some_and(|count| *count > 1) && !recording.unit.is_empty() {
            recording.name = format!("{}_{}", recording.unit, recording.name);
        }
        let number = taken.entry(recording.name.clone()).or_insert(0_usize);
        *number += 1;
        if *number > 1 {
            recording.name = format!("{}_{number}", recording.name);
        }
    }
}
