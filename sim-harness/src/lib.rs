//! Rundown's host side: recorded runs through the very estimator of the board, and what it says, as tables and a page.
//!
//! ```text
//! run_set -> run_log -> recording -> replay -> output, report
//!               train_file, track_file, config_file, map_matching
//! ```
//!
//! | question | module |
//! |---|---|
//! | which runs, in which order? | [`run_set`] |
//! | what stands in a log? | [`run_log`] |
//! | what does the estimator get? | [`recording`], [`map_matching`] |
//! | what does it say? | [`replay`] |
//! | what spoils all of it? | [`advice`] |
//! | what does another tool get of what was learned? | [`learned_train`], [`sfera`] |
//! | where is it written? | [`output`], [`table`], [`report`] |
//! | train, track, configuration, effects | [`train_file`], [`track_file`], [`config_file`], [`effect_file`], all by [`toml_file`] |
//! | what does a DAS computer say to the board? | [`desk`] |
//! | how does the host reach a board, and talk to it? | [`link`], [`session`] |
//! | what does a board say, live? | [`display`] |
//! | what really happens, and what sensors make of it? | [`truth`] |
//! | how does a scenario become a folder of logs? | [`simulation`] |
//! | what does the paper's case study say, and is it true? | [`study`] |
//! | what would be the paper's best filter? | [`tune`] |
//! | tables and runs for other tools | [`parquet`] |
//! | the command `rundown` | [`commands`] |
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod advice;
pub mod commands;
pub mod desk;
pub mod display;
pub mod gap_bench;
pub mod learned_train;
pub mod link;
pub mod output;
pub mod report;
pub mod session;
pub mod sfera;
pub mod simulation;
pub mod study;
pub mod tune;
