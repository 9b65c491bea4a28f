//! What a replay writes.
//!
//! | file | what it holds |
//! |---|---|
//! | `<run>.estimates.csv` | one row a tick ([`estimates`]) |
//! | `<run>.coast_ahead.csv` | one row a tick, where the track has stops or speed limits ([`coast_ahead`]) |
//! | `features.csv` | one row a run ([`features`]) |
//! | `parameters.csv` | the vehicle after each run, the run's own train, and how often each cause occurred ([`parameters`]) |
//! | `switching_points.csv` | one row for each change of regime ([`features`]) |
//! | `replay.json` | all but the estimates in one file for machines (`json`) |

pub mod coast_ahead;
pub mod document;
pub mod estimates;
pub mod features;
pub(crate) mod files;
pub mod json;
pub mod parameters;

use rayon::prelude::*;
use rundown::estimator::config::Config;
use rundown_files::column::{self, Column};
use rundown_files::{WriteError, replay::ReplayedRun};
use serde_json::Value;
use std::{borrow::Borrow, io::Write, path::Path};

/// Writes all tables of a replay into `folder`.
pub(crate) fn write_tables(
    folder: &Path,
    runs: &[ReplayedRun],
    config: &Config,
    json: &Value,
) -> Result<(), WriteError> {
    runs.par_iter().try_for_each(|run| {
        let name = estimates::file_name(run);
        files::file(&folder.join(name), |file| estimates::write(file, run))?;
        if run.coast_ahead.is_empty() {
            return Ok(());
        }
        let name = coast_ahead::file_name(run);
        files::file(&folder.join(name), |file| coast_ahead::write(file, run, &config.coast))
    })?;
    table(folder, "features.csv", &features::columns(&config.features), runs)?;
    table(folder, "parameters.csv", &parameters::columns(), runs)?;
    table(folder, "switching_points.csv", &features::switch_columns(), runs.iter().flat_map(features::switches))?;
    files::file(&folder.join("replay.json"), |file| {
        serde_json::to_writer_pretty(&mut *file, json)?;
        writeln!(file)
    })
}

fn table<Row>(
    folder: &Path,
    name: &str,
    columns: &[Column<Row>],
    rows: impl IntoIterator<Item: Borrow<Row>>,
) -> Result<(), WriteError> {
    files::file(&folder.join(name), |file| column::write_csv(file, columns, rows))
}
