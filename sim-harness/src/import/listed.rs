//! What an index `runs.csv` beside the files says of their runs: it stays where the files themselves say nothing.

use super::clock::{self, DateOrder, WrittenTime};
use super::staged::Staged;
use jiff::tz::TimeZone;
use rundown_files::refusal::ReadError;
use rundown_files::run_set::RunSet;
use std::path::Path;

/// Unit, driver and departure of the runs of a file, by the index beside it.
///
/// # Errors
/// The index cannot be read.
pub fn keep(source: &Path, runs: &mut [Staged]) -> Result<(), ReadError> {
    let Some(listed) = RunSet::find(&[source.to_owned()])?.files.into_iter().next() else { return Ok(()) };
    let departure_s = listed.departure_utc.as_deref().and_then(seconds);
    let first_s = runs.first().map_or(0.0, |run| run.begin_s);
    for run in runs {
        if run.unit.is_empty() {
            run.unit.clone_from(&listed.unit);
        }
        run.driver.clone_from(&listed.driver);
        run.departure_s = run.departure_s.or(departure_s.map(|at| at + run.begin_s - first_s));
    }
    Ok(())
}

/// Since 1970 UTC.
fn seconds(text: &str) -> Option<f64> {
    match clock::parse(text, DateOrder::Ymd)? {
        WrittenTime::Instant(seconds) => Some(seconds),
        WrittenTime::Civil(civil) => clock::in_zone(civil, &TimeZone::UTC, None),
        WrittenTime::OfDay(_) => None,
    }
}
