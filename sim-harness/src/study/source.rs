//! Where the runs of a study come from, chunk by chunk: simulated, folders of logs, or one Parquet file.

use super::case::{Case, fleet_run};
use crate::map_matching::CentreLine;
use crate::output::json::Failed;
use crate::parquet::{ParquetError, RunReader};
use crate::recording::{DirectionChoice, Recording};
use crate::run_log::{BadRows, RunLog};
use crate::run_set::{RunFile, RunSet};
use crate::truth::scenario::Scenario;
use rayon::prelude::*;
use std::path::Path;

/// Runs that are in memory at a time.
pub const CHUNK: usize = 256;

/// Runs, in order.
#[derive(Debug)]
pub enum Source {
    /// A fleet of units.
    Simulated(Box<Simulated>),
    /// Logs.
    Logs(Logs),
    /// One file.
    Parquet(Box<RunReader>),
}

/// A fleet of units, simulated as it is needed.
#[derive(Clone, Debug)]
pub struct Simulated {
    scenario: Scenario,
    seed: u64,
    runs: usize,
    next: usize,
}

/// Logs in folders.
#[derive(Clone, Debug)]
pub struct Logs {
    files: Vec<RunFile>,
    line: Option<CentreLine>,
    next: usize,
}

/// Why there are no runs.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// The file of runs is broken.
    #[error(transparent)]
    Parquet(#[from] ParquetError),
}

impl Source {
    /// So many runs of a scenario.
    pub fn simulated(scenario: Scenario, seed: u64, runs: usize) -> Self {
        Self::Simulated(Box::new(Simulated {
            scenario,
            seed,
            runs,
            next: 0,
        }))
    }

    /// Logs that were found.
    pub fn logs(set: RunSet, line: Option<CentreLine>) -> Self {
        Self::Logs(Logs {
            files: set.files,
            line,
            next: 0,
        })
    }

    /// A Parquet file of runs.
    ///
    /// # Errors
    /// [`SourceError`] when it cannot be read.
    pub fn parquet(path: &Path) -> Result<Self, SourceError> {
        Ok(Self::Parquet(Box::new(RunReader::open(path)?)))
    }

    /// Number of runs.
    pub fn total(&self) -> usize {
        match self {
            Self::Simulated(simulated) => simulated.runs,
            Self::Logs(logs) => logs.files.len(),
            Self::Parquet(reader) => reader.runs(),
        }
    }

    /// The runs are simulated, and their truth is known.
    pub fn is_simulated(&self) -> bool {
        matches!(self, Self::Simulated(_))
    }

    /// The next runs, at most [`CHUNK`]; none after the last. A log that cannot be used is in its place.
    ///
    /// # Errors
    /// [`SourceError`] when a file of runs is broken.
    pub fn next_chunk(&mut self) -> Result<Option<Vec<Result<Case, Failed>>>, SourceError> {
        let chunk: Vec<Result<Case, Failed>> = match self {
            Self::Simulated(simulated) => {
                let range = advance(&mut simulated.next, simulated.runs);
                let (scenario, seed) = (&simulated.scenario, simulated.seed);
                let run = |index| Ok(fleet_run(scenario, seed, index));
                range.into_par_iter().map(run).collect()
            }
            Self::Logs(logs) => {
                let range = advance(&mut logs.next, logs.files.len());
                let line = logs.line.as_ref();
                logs.files[range]
                    .par_iter()
                    .map(|file| read(file, line))
                    .collect()
            }
            Self::Parquet(reader) => {
                let mut chunk = Vec::new();
                while chunk.len() < CHUNK
                    && let Some(recording) = reader.next_run()?
                {
                    chunk.push(Ok(Case {
                        recording,
                        truth: None,
                    }));
                }
                chunk
            }
        };
        Ok((!chunk.is_empty()).then_some(chunk))
    }
}

fn advance(next: &mut usize, end: usize) -> std::ops::Range<usize> {
    let from = *next;
    *next = (from + CHUNK).min(end);
    from..*next
}

fn read(file: &RunFile, line: Option<&CentreLine>) -> Result<Case, Failed> {
    let failed = |error: String| Failed {
        file: file.path.clone(),
        error,
    };
    let log =
        RunLog::read(&file.path, BadRows::Refuse).map_err(|error| failed(error.to_string()))?;
    let recording = Recording::new(file, &log, line, DirectionChoice::Auto)
        .map_err(|error| failed(error.to_string()))?;
    Ok(Case {
        recording,
        truth: None,
    })
}
