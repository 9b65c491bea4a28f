//! The truth that `rundown simulate` leaves beside its logs, for the study to show: no estimator sees it.
//!
//! In: the folder of the logs. Out: [`TruthFolder`], and from it a [`CaseTruth`] for each log. A folder `truth` lies beside that of the logs, or there
//! is none: recorded runs have no truth. One that is there and cannot be read, or is not that of a log's times, is an error, never a gap.

use super::case::{CaseTruth, RunTruth};
use crate::simulation::folder::regime_of_word;
use rundown_files::sample::Sample;
use rundown_truth::facts::Mark;
use rundown_truth::sensors::TruthSample;
use rundown_truth::train::DavisTruth;
use serde::Deserialize;
use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Times of a log and of its truth are printed to the millisecond.
const SAME_TIME_S: f64 = 1e-3;

/// The truth of a folder of logs.
#[derive(Clone, Debug)]
pub struct TruthFolder {
    folder: PathBuf,
    runs: HashMap<String, RunTruth>,
}

/// Why a truth that is there cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TruthError {
    /// A file cannot be read, or is not what `rundown simulate` writes.
    #[error("{}: cannot be read as truth: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// The log has a reading at a time that its truth does not have.
    #[error("{}: expected the truth at {time_s} s, as in the log; found none", path.display())]
    OtherTimes {
        /// The file.
        path: PathBuf,
        /// Time of the reading, s.
        time_s: f64,
    },
}

fn file_error(path: &Path, error: impl ToString) -> TruthError {
    TruthError::File { path: path.to_owned(), message: error.to_string() }
}

impl TruthFolder {
    /// The folder `truth` beside a folder of logs; `None` where there is none.
    ///
    /// # Errors
    /// [`TruthError`] when its `truth.json` cannot be read.
    pub fn beside(logs: &Path) -> Result<Option<Self>, TruthError> {
        // Not `logs/../truth`: the folder may be a link, and the name of one in the working folder has no parent.
        let Some(parent) = logs.parent().filter(|_| logs.file_name().is_some()) else {
            return Ok(None);
        };
        let folder = parent.join("truth");
        let path = folder.join("truth.json");
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(file_error(&path, error)),
        };
        let key: Key = serde_json::from_str(&text).map_err(|error| file_error(&path, error))?;
        let run = |run: KeyRun| {
            let truth = run.truth().ok_or_else(|| {
                let message = format!("{}: expected at least one stop, found none", run.file);
                file_error(&path, message)
            })?;
            Ok((run.file, truth))
        };
        Ok(Some(Self { runs: key.runs.into_iter().map(run).collect::<Result<_, _>>()?, folder }))
    }

    /// The truth of a log, a row for each of its rows; `None` when the log is not one of this data set.
    ///
    /// # Errors
    /// [`TruthError`] when the rows cannot be read or are of other times.
    pub fn of(&self, log: &Path, rows: &[Sample]) -> Result<Option<CaseTruth>, TruthError> {
        let Some(name) = log.file_name().and_then(|name| name.to_str()) else {
            return Ok(None);
        };
        let Some(facts) = self.runs.get(name) else {
            return Ok(None);
        };
        let path = self.folder.join(name);
        let all = samples(&path)?;
        // The log may have lost rows since; the truth keeps its own.
        let mut rest = all.iter();
        let sample = |row: &Sample| {
            let time_s = row.time_s;
            let found = rest.find(|sample| sample.time_s > time_s - SAME_TIME_S);
            let found = found.filter(|sample| sample.time_s < time_s + SAME_TIME_S);
            found.copied().ok_or_else(|| TruthError::OtherTimes { path: path.clone(), time_s })
        };
        Ok(Some(CaseTruth { samples: rows.iter().map(sample).collect::<Result<_, _>>()?, facts: *facts }))
    }
}

fn samples(path: &Path) -> Result<Vec<TruthSample>, TruthError> {
    let mut reader = csv::Reader::from_path(path).map_err(|error| file_error(path, error))?;
    let rows = reader.deserialize::<TruthRow>();
    rows.map(|row| {
        let row = row.map_err(|error| file_error(path, error))?;
        let regime = regime_of_word(&row.regime).ok_or_else(|| {
            let message = format!("{} s: expected a regime, found {:?}", row.time_s, row.regime);
            file_error(path, message)
        })?;
        Ok(TruthSample {
            time_s: row.time_s,
            location_m: row.location_m,
            speed_mps: row.speed_mps,
            effort_n_per_kg: row.effort_n_per_kg,
            mean_effort_n_per_kg: row.mean_effort_n_per_kg,
            regime,
            resistance_n_per_kg: row.resistance_n_per_kg,
            extra_n_per_kg: row.extra_n_per_kg,
            gravity_n_per_kg: row.gravity_n_per_kg,
            temperature_c: row.ambient_temperature_c,
        })
    })
    .collect()
}

/// A row of `truth/runNNN.csv`.
#[derive(Deserialize)]
struct TruthRow {
    time_s: f64,
    location_m: f64,
    speed_mps: f64,
    regime: String,
    effort_n_per_kg: f64,
    mean_effort_n_per_kg: f64,
    resistance_n_per_kg: f64,
    extra_n_per_kg: f64,
    gravity_n_per_kg: f64,
    ambient_temperature_c: f64,
}

/// What is read of `truth.json`.
#[derive(Deserialize)]
struct Key {
    runs: Vec<KeyRun>,
}

#[derive(Deserialize)]
struct KeyRun {
    file: String,
    train: KeyTrain,
    davis_with_wind: KeyDavis,
    cruise_mps: f64,
    final_coast: Option<KeyMark>,
    final_brake: KeyMark,
    stops: Vec<KeyMark>,
    mean_power_50_130_w_per_kg: Option<f64>,
    max_power_50_90_w_per_kg: Option<f64>,
}

#[derive(Deserialize)]
struct KeyTrain {
    mass_kg: f64,
    rotating_mass_factor: f64,
}

#[derive(Deserialize)]
struct KeyDavis {
    r0: f64,
    r1: f64,
    r2: f64,
}

#[derive(Clone, Copy, Deserialize)]
struct KeyMark {
    time_s: f64,
    location_m: f64,
    speed_mps: f64,
}

impl From<KeyMark> for Mark {
    fn from(mark: KeyMark) -> Self {
        Self { time_s: mark.time_s, location_m: mark.location_m, speed_mps: mark.speed_mps }
    }
}

impl KeyRun {
    /// `None` when the train never stopped.
    fn truth(&self) -> Option<RunTruth> {
        let KeyDavis { r0, r1, r2 } = self.davis_with_wind;
        Some(RunTruth {
            davis: DavisTruth { r0, r1, r2 },
            rotating_mass_kg: self.train.mass_kg * self.train.rotating_mass_factor,
            cruise_mps: self.cruise_mps,
            final_coast: self.final_coast.map(Mark::from),
            final_brake: self.final_brake.into(),
            stop: (*self.stops.last()?).into(),
            mean_power_50_130_w_per_kg: self.mean_power_50_130_w_per_kg,
            max_power_50_90_w_per_kg: self.max_power_50_90_w_per_kg,
        })
    }
}
