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
pub(crate) mod json;
pub(crate) mod parameters;

use rayon::prelude::*;
use rundown::estimator::config::Config;
use rundown_files::WriteError;
use rundown_files::replay::ReplayedRun;
use rundown_files::table::{self, Record};
use serde_json::Value;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes all tables of a replay into `folder`, which is made when it does not exist.
pub fn write_tables(folder: &Path, runs: &[ReplayedRun], config: &Config, json: &Value) -> Result<(), WriteError> {
    std::fs::create_dir_all(folder).map_err(|source| WriteError { path: folder.to_owned(), source })?;
    runs.par_iter().try_for_each(|run| {
        let name = estimates::file_name(run);
        write(&folder.join(name), |file| estimates::write(file, run))?;
        if run.coast_ahead.is_empty() {
            return Ok(());
        }
        let name = coast_ahead::file_name(run);
        write(&folder.join(name), |file| coast_ahead::write(file, run, &config.coast))
    })?;
    write_records(&folder.join("features.csv"), runs.iter().map(|run| features::record(run, &config.features)))?;
    write_records(&folder.join("parameters.csv"), runs.iter().map(parameters::record))?;
    let points: Vec<Record> = runs.iter().flat_map(features::switching_points).collect();
    write(&folder.join("switching_points.csv"), |file| {
        if points.is_empty() {
            return writeln!(file, "{}", features::SWITCHING_POINT_COLUMNS.join(","));
        }
        table::write_csv(file, &points)
    })?;
    write(&folder.join("replay.json"), |file| {
        serde_json::to_writer_pretty(&mut *file, json)?;
        writeln!(file)
    })
}

fn write_records(path: &Path, records: impl Iterator<Item = Record>) -> Result<(), WriteError> {
    let records: Vec<Record> = records.collect();
    write(path, |file| table::write_csv(file, &records))
}

fn write(path: &Path, content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), WriteError> {
    let written = File::create(path).and_then(|file| {
        let mut file = BufWriter::new(file);
        content(&mut file)?;
        file.flush()
    });
    written.map_err(|source| WriteError { path: path.to_owned(), source })
}
