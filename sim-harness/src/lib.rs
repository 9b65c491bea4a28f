//! Rundown's host side: recorded runs through the very estimator of the board, and what it says, as tables and a page.
//!
//! | question | module |
//! |---|---|
//! | the command `rundown` | [`commands`] |
//! | how do logs of any recorder become run logs? | [`import`] |
//! | what did a recorder do to its logs? | [`checking`] |
//! | how are recorded runs replayed? | [`replaying`], of logs [`logs`] can read, or of Parquet files (`parquet_runs`) |
//! | what invalidates a whole replay? where are its results written? | `advice`, [`output`], `report` |
//! | what does another tool get of what was learned? | [`exporting`]: `learned_train`, of a board `recorded_board`, `exchange` |
//! | how does a train or track of another tool become ours? | [`converting`] |
//! | how does a scenario become a folder of logs? | [`simulation`] |
//! | what does the paper's case study say, and is it true? | `study` |
//! | what would be the paper's best filter? | `tune` |
//! | how near does the estimator come to the truth, and to what is possible? | [`accuracy_bench`], `bound` |
//! | how often does the diagnosis of logs find an injected defect? | [`check_bench`] |
//! | how often are perturbed runs recognised, and wrong gradients? | [`perturbed_bench`], [`gradient_bench`] |
//! | how often does the gap workflow find a hidden effect? | [`gap_bench`] |
//! | how does the host reach a board, and talk to it? | `link`, `session` |
//! | what does a board say, live? | `display` |
//!
//! The last two are the cargo feature `link`, which is on by default: all that needs what a board needs. Files are read
//! by `rundown_files`, what really happens is `rundown_truth`, pages are drawn by `rundown_pages`, the gap workflow is
//! `rundown_gap`, what a DAS computer says to the board `rundown_desk`.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod accuracy_bench;
mod advice;
mod alike;
mod bound;
pub mod check_bench;
pub mod checking;
pub mod commands;
pub mod converting;
#[cfg(feature = "link")]
pub mod display;
mod exchange;
pub mod exporting;
pub mod gap_bench;
pub mod gradient_bench;
pub mod import;
mod learned_train;
#[cfg(feature = "link")]
pub mod link;
pub mod logs;
pub mod output;
mod parquet_runs;
pub mod perturbed_bench;
#[cfg(feature = "link")]
mod recorded_board;
pub mod replaying;
pub mod report;
#[cfg(feature = "link")]
pub mod session;

pub mod simulation;
mod study;
mod tune;
