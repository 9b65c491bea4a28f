//! Parquet: tables and runs for other tools, and runs from them.
//!
//! The format's own columns are written and read; nothing is held but one group of rows. [`TableWriter`] writes the
//! same records as [`crate::table`]; [`RunReader`] reads runs that lie in one file, with the columns of
//! [`crate::sample::COLUMNS`] and `run`, `unit`, `direction`.

mod columns;
mod runs;
mod table;

pub use runs::{RunReader, RunWriter};
pub use table::TableWriter;

use crate::refusal::{ReadError, Refusal};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a Parquet file cannot be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "said by the messages")]
pub enum ParquetError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    /// It is no Parquet file, or is broken.
    #[error("{}: {source}", path.display())]
    Format { path: PathBuf, source: parquet::errors::ParquetError },
    /// It is no file of runs.
    #[error(transparent)]
    Runs(#[from] ReadError),
}

impl From<Refusal> for ParquetError {
    fn from(refusal: Refusal) -> Self {
        Self::Runs(refusal.into())
    }
}

impl ParquetError {
    fn io(path: &Path, source: std::io::Error) -> Self {
        let path = path.to_owned();
        Self::Io { path, source }
    }

    fn format(path: &Path, source: parquet::errors::ParquetError) -> Self {
        let path = path.to_owned();
        Self::Format { path, source }
    }
}
