//! The truth that `rundown simulate` leaves beside its logs, for the study to show: no estimator sees it.
//!
//! In: the folder of the logs. Out: [`TruthFolder`], and from it a [`CaseTruth`] for each log. A folder `truth` lies
//! beside that of the logs, or there is none: recorded runs have no truth. One that is there and cannot be read, or is
//! not that of a log's times, is an error, never a gap.

use super::case::{CaseTruth, RunTruth};
use rundown_files::sample::Sample;
use rundown_truth::sensors::TruthSample;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::{collections::HashMap, fmt::Display, io::ErrorKind};

/// Times of a log and of its truth are printed to the millisecond.
const SAME_TIME_S: f64 = 1e-3;

#[derive(Clone, Debug)]
pub struct TruthFolder {
    folder: PathBuf,
    runs: HashMap<String, RunTruth>,
}

fn file_error(path: &Path, error: impl Display) -> String {
    format!("{}: cannot be read as truth: {error}", path.display())
}

impl TruthFolder {
    /// The folder `truth` beside a folder of logs; `None` where there is none.
    pub fn beside(logs: &Path) -> Result<Option<Self>, String> {
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
        let key: TruthKey = serde_json::from_str(&text).map_err(|error| file_error(&path, error))?;
        Ok(Some(Self { runs: key.runs.into_iter().map(|run| (run.file, run.truth)).collect(), folder }))
    }

    /// The truth of a log, a row for each of its rows; `None` when the log is not one of this data set.
    pub fn of(&self, log: &Path, rows: &[Sample]) -> Result<Option<CaseTruth>, String> {
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
            found.copied().ok_or_else(|| {
                format!("{}: expected the truth at {time_s} s, as in the log; found none", path.display())
            })
        };
        Ok(Some(CaseTruth { samples: rows.iter().map(sample).collect::<Result<_, _>>()?, facts: *facts }))
    }
}

fn samples(path: &Path) -> Result<Vec<TruthSample>, String> {
    let read = || csv::Reader::from_path(path)?.into_deserialize().collect::<Result<Vec<TruthSample>, csv::Error>>();
    read().map_err(|error| file_error(path, error))
}

#[derive(Deserialize)]
struct TruthKey {
    runs: Vec<KeyRun>,
}

#[derive(Deserialize)]
struct KeyRun {
    file: String,
    #[serde(flatten)]
    truth: RunTruth,
}
