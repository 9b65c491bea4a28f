//! What an index `runs.csv` beside the files says of their runs: it stays where the files themselves say nothing.

use super::clock::{self, DateOrder, WrittenTime};
use super::staged::Staged;
use jiff::tz::TimeZone;
use rundown_files::refusal::ReadError;
use rundown_files::run_set::{RunFile, RunSet};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// What the indexes say of files, by their paths.
#[derive(Debug, Default)]
pub struct Indexes {
    files: HashMap<PathBuf, RunFile>,
    /// What of them cannot be read.
    pub doubts: Vec<String>,
}

impl Indexes {
    /// Reads the index of each folder once. Out: also those that cannot be read.
    pub fn find<'a>(sources: impl Iterator<Item = &'a Path>) -> (Self, Vec<ReadError>) {
        let mut folders: BTreeMap<&Path, Vec<PathBuf>> = BTreeMap::new();
        for source in sources {
            folders.entry(source.parent().unwrap_or(source)).or_default().push(source.to_owned());
        }
        let (mut listed, mut errors) = (Self::default(), Vec::new());
        for paths in folders.into_values() {
            match RunSet::find(&paths) {
                Ok(set) => {
                    listed.doubts.extend(set.doubts);
                    listed.files.extend(set.files.into_iter().map(|file| (file.path.clone(), file)));
                }
                Err(error) => errors.push(error),
            }
        }
        (listed, errors)
    }

    /// Gives the runs of a file its unit, driver and departure.
    pub fn keep(&self, source: &Path, runs: &mut [Staged]) {
        let Some(file) = self.files.get(source) else { return };
        let departure_s = file.departure_utc.as_deref().and_then(seconds);
        let first_s = runs.first().map_or(0.0, |run| run.begin_s);
        for run in runs {
            if run.unit.is_empty() {
                run.unit.clone_from(&file.unit);
            }
            run.driver.clone_from(&file.driver);
            run.departure_s = run.departure_s.or(departure_s.map(|at| at + run.begin_s - first_s));
        }
    }
}

/// Since 1970 UTC.
fn seconds(text: &str) -> Option<f64> {
    match clock::parse(text, DateOrder::Ymd)? {
        WrittenTime::Instant(seconds) => Some(seconds),
        WrittenTime::Civil(civil) => clock::in_zone(civil, &TimeZone::UTC, None),
        WrittenTime::OfDay(_) => None,
    }
}
