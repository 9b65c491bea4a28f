//! What a replay writes.
//!
//! | file | what it holds |
//! |---|---|
//! | `<run>.estimates.csv` | one row a tick ([`estimates`]) |
//! | `<run>.coast_ahead.csv` | one row a tick, where the track has stops or speed limits ([`coast_ahead`]) |
//! | `features.csv` | one row a run ([`features`]) |
//! | `parameters.csv` | the vehicle after each run, the run's own train, and how often each cause occurred ([`parameters`]) |
//! | `switching_points.csv` | one row for each change of regime ([`features`]) |
//! | `replay.json` | all but the estimates in one file for machines ([`json`]) |

pub(crate) mod coast_ahead;
pub(crate) mod estimates;
pub(crate) mod features;
pub(crate) mod files;
pub(crate) mod json;
pub(crate) mod parameters;

use rayon::prelude::*;
use rundown::estimator::config::Config;
use rundown_files::table::{self, Record};
use rundown_files::{WriteError, replay::ReplayedRun};
use serde_json::Value;
use std::{io::Write, path::Path};

/// Writes all tables of a replay into `folder`, which is made when it does not exist.
pub fn write_tables(folder: &Path, runs: &[ReplayedRun], config: &Config, json: &Value) -> Result<(), WriteError> {
    files::folder(folder)?;
    runs.par_iter().try_for_each(|run| {
        let name = estimates::file_name(run);
        files::file(&folder.join(name), |file| estimates::write(file, run))?;
        if run.coast_ahead.is_empty() {
            return Ok(());
        }
        let name = coast_ahead::file_name(run);
        files::file(&folder.join(name), |file| coast_ahead::write(file, run, &config.coast))
    })?;
    let of_features: Vec<Record> = runs.iter().map(|run| features::record(run, &config.features)).collect();
    files::records(&folder.join("features.csv"), &of_features)?;
    let of_parameters: Vec<Record> = runs.iter().map(parameters::record).collect();
    files::records(&folder.join("parameters.csv"), &of_parameters)?;
    let points: Vec<Record> = runs.iter().flat_map(features::switching_points).collect();
    files::file(&folder.join("switching_points.csv"), |file| {
        if points.is_empty() {
            return writeln!(file, "{}", features::SWITCHING_POINT_COLUMNS.join(","));
        }
        table::write_csv(file, &points)
    })?;
    files::file(&folder.join("replay.json"), |file| {
        serde_json::to_writer_pretty(&mut *file, json)?;
        writeln!(file)
    })
}
