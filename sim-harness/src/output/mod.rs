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
pub mod fields;
pub(crate) mod files;
pub mod json;
pub(crate) mod markdown;
pub mod parameters;
pub mod tables;

use rayon::prelude::*;
use rundown::estimator::config::Config;
use rundown_files::{WriteError, replay::ReplayedRun};
use serde_json::Value;
use std::{io::Write, path::Path};
use tables::{Format, whole};

/// Writes all tables of a replay into `folder`.
pub(crate) fn write_tables(
    folder: &Path,
    runs: &[ReplayedRun],
    config: &Config,
    format: Format,
    json: &Value,
) -> Result<(), WriteError> {
    runs.par_iter().try_for_each(|run| {
        whole(folder, &estimates::stem(run), estimates::columns(), format, estimates::rows(run))?;
        if run.coast_ahead.is_empty() {
            return Ok(());
        }
        let rows = coast_ahead::rows(run, &config.coast);
        whole(folder, &coast_ahead::stem(run), coast_ahead::columns(), format, rows)
    })?;
    whole(folder, "features", features::columns(&config.features), format, runs)?;
    whole(folder, "parameters", parameters::columns(), format, runs)?;
    let switches = runs.iter().flat_map(features::switches);
    whole(folder, "switching_points", features::switch_columns(), format, switches)?;
    files::file(&folder.join("replay.json"), |file| {
        serde_json::to_writer_pretty(&mut *file, json)?;
        writeln!(file)
    })
}
