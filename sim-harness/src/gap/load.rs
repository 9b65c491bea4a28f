//! Runs from a folder, as the gap workflow takes them.

use super::analysis::Surroundings;
use super::runs::{Run, Sample};
use crate::map_matching::CentreLine;
use crate::recording::{DirectionChoice, Recording, RecordingError};
use crate::run_log::{BadRows, RunLog, RunLogError};
use crate::run_set::RunFile;
use crate::track_file::TrackFile;
use jiff::civil::{Date, DateTime};
use thiserror::Error;

/// Why a log gives no run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LoadError {
    /// It cannot be read.
    #[error(transparent)]
    Log(#[from] RunLogError),
    /// It has no location.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// Its departure is no date.
    #[error("{file}: expected departure_utc like 2026-01-31T06:30:00Z, found {found:?}")]
    Departure {
        /// The log.
        file: String,
        /// What stands in the index.
        found: String,
    },
}

/// Days from 1970-01-01 to a date, or to a date and time, in UTC.
fn day(text: &str) -> Option<f64> {
    let plain = text.trim().trim_end_matches('Z').replace(' ', "T");
    let at = plain
        .parse::<DateTime>()
        .or_else(|_| plain.parse::<Date>().map(|date| date.at(0, 0, 0, 0)))
        .ok()?;
    let epoch = jiff::civil::date(1970, 1, 1).at(0, 0, 0, 0);
    let since = at.since(epoch).ok()?;
    since.total(jiff::Unit::Second).ok().map(|s| s / 86_400.0)
}

/// Reads one run.
///
/// # Errors
/// [`LoadError`] names file and place.
pub fn run(
    file: &RunFile,
    line: Option<&CentreLine>,
    direction: DirectionChoice,
) -> Result<(Run, Vec<String>), LoadError> {
    let log = RunLog::read(&file.path, BadRows::LeaveOut)?;
    let recording = Recording::new(file, &log, line, direction)?;
    let day = match file
        .departure_utc
        .as_deref()
        .filter(|text| !text.is_empty())
    {
        Some(text) => Some(day(text).ok_or_else(|| LoadError::Departure {
            file: file.path.display().to_string(),
            found: text.to_owned(),
        })?),
        None => None,
    };
    let mut samples: Vec<Sample> = Vec::with_capacity(recording.rows.len());
    for (row, sample) in recording.rows.iter().zip(&log.samples) {
        let measurement = &row.measurement;
        // Times that do not increase were reported when the log was read.
        if samples
            .last()
            .is_some_and(|last| last.time_s >= measurement.time_s)
        {
            continue;
        }
        samples.push(Sample {
            time_s: measurement.time_s,
            location_m: measurement.location_m,
            speed_mps: measurement.speed_mps,
            effort_n_per_kg: measurement.effort_n_per_kg,
            temperature_c: sample.ambient_temperature_c,
        });
    }
    let run = Run {
        name: recording.name,
        direction: recording.direction,
        day,
        samples,
    };
    Ok((run, recording.warnings))
}

/// What the track file says beside gradients.
pub fn surroundings(track: &TrackFile) -> Surroundings {
    Surroundings {
        curves: track
            .curve
            .iter()
            .map(|c| (c.from_m, c.to_m, rundown::effects::roeckl(c.radius_m)))
            .collect(),
        tunnels: track.tunnel.iter().map(|t| (t.from_m, t.to_m)).collect(),
        feeding: track
            .feeding_section
            .iter()
            .map(|f| (f.from_m, f.to_m))
            .collect(),
        stops: track.stop.iter().map(|s| s.at_m).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::day;

    #[test]
    fn dates_are_days_since_1970() {
        assert_eq!(day("1970-01-02"), Some(1.0));
        assert_eq!(day("2026-01-01T12:00:00Z"), Some(20_454.5));
        assert_eq!(day("2026-01-01 12:00:00"), Some(20_454.5));
        assert_eq!(day("soon"), None);
    }
}
