//! What people bring and what a replay makes of it: run logs, descriptions of train and track, configurations, effects.
//!
//! ```text
//! run_set -> run_log -> recording -> replay
//!               train_file, track_file, config_file, map_matching
//! ```
//!
//! | question | module |
//! |---|---|
//! | which runs, in which order? | [`run_set`] |
//! | what stands in a log? | [`run_log`], its columns [`sample`]; several runs in one table: [`run_rows`] |
//! | what is refused, and how is it said? | [`refusal`] |
//! | what does the estimator get? | [`recording`], [`map_matching`] on the [`ellipsoid`], [`units`] |
//! | what does it say? | [`replay`] |
//! | train, track, configuration, effects | [`train_file`], [`track_file`] (and which of the two: `exchanged`), [`config_file`], [`effect_file`], all by [`toml_file`] |
//! | how do results get into their folder? | [`folder`] |
//! | tables and runs for other tools | [`mod@column`], [`table`], [`parquet`] |
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod column;
pub mod config_file;
pub mod effect_file;
pub mod effect_frame;
pub mod ellipsoid;
mod exchanged;
pub mod folder;
pub mod map_matching;
pub mod off_track;
pub mod parquet;
pub mod recording;
pub mod refusal;
pub mod replay;
pub mod run_log;
pub mod run_rows;
pub mod run_set;
pub mod sample;
pub mod statistics;
pub mod table;
pub mod toml_file;
pub mod track_file;
pub mod train_file;
pub mod units;

use std::{io, path::PathBuf};
use thiserror::Error;

/// A file that could not be written.
#[derive(Debug, Error)]
#[error("{}: cannot be written: {source}; choose another folder with --out", folder::shown(path).display())]
#[expect(missing_docs, reason = "said by the messages")]
pub struct WriteError {
    pub path: PathBuf,
    pub source: io::Error,
}
