//! A recorded run in the estimator's units.
//!
//! In: a [`RunLog`], the track's centre line, the direction as far as it is known. Out: a [`Recording`]: one [`Measurement`] for each row.
//!
//! A log without a column `location_m`, or with an empty one, is matched onto the centre line. Direction: that of the index, else the one asked for, else found
//! from the locations ([`DirectionChoice::Auto`]): the median of the last ones against the median of the first ones.

use crate::effect_file::day_of;
use crate::map_matching::{CentreLine, MatchState, NoMatch};
use crate::run_log::{RunLog, Sample};
use crate::run_set::RunFile;
use crate::units;
use rundown::model::direction::Direction;
use rundown::model::effects::Surroundings;
use rundown::model::units::KmPerHour;
use rundown::tick::measurement::Measurement;
use std::path::PathBuf;
use thiserror::Error;

/// Locations at each end of a run that decide its direction.
const DECIDING: usize = 25;
/// A run shorter than this, m, has no direction of its own: what the index says is not doubted.
const SHORTEST_M: f64 = 200.0;

/// Direction of the runs that no index names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum DirectionChoice {
    /// Locations grow.
    Up,
    /// Locations fall.
    Down,
    /// Found from the locations, run by run.
    #[default]
    Auto,
}

/// One row of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Line of the log, counted from 1.
    pub line: u64,
    /// What the estimator gets.
    pub measurement: Measurement,
    /// Ambient temperature, °C, for the effects that depend on it.
    pub temperature_c: Option<f64>,
}

/// A run, ready to be replayed.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Name in every output.
    pub name: String,
    /// Where it was read from.
    pub path: PathBuf,
    /// Whose memory it belongs to; empty when there is only one unit.
    pub unit: String,
    /// Direction of travel.
    pub direction: Direction,
    /// Date of the departure, days since 1970-01-01 UTC, if the index has one that can be read.
    pub day: Option<f64>,
    /// All rows of the log, whatever their times.
    pub rows: Vec<Row>,
    /// What looked wrong, one line each, with file and line.
    pub warnings: Vec<String>,
}

/// Why a log gives no recording.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// Coordinates only, and nothing to match them onto.
    #[error("{}: expected a column location_m, or a track with a [[centre_line]] to match latitude and longitude onto; found neither", path.display())]
    NoCentreLine {
        /// The log.
        path: PathBuf,
    },
}

impl Recording {
    /// Turns a log into measurements.
    ///
    /// # Errors
    /// [`RecordingError::NoCentreLine`] when the log has coordinates only and the track no centre line.
    pub fn new(
        file: &RunFile,
        log: &RunLog,
        line: Option<&CentreLine>,
        choice: DirectionChoice,
    ) -> Result<Self, RecordingError> {
        let mut warnings = Vec::new();
        let mut warn = |text: String| warnings.push(format!("{}: {text}", file.path.display()));
        for complaint in log.bad_rows.iter() {
            warn(format!("{complaint}; the row was left out"));
        }
        log.warnings.iter().for_each(|complaint| warn(complaint.to_string()));
        let read = log.samples.iter().any(|sample| sample.location_m.is_some());
        let fixes = log.samples.iter().any(|sample| sample.latitude_deg.is_some());
        let locations = match line {
            Some(line) if !log.has_location_column || (fixes && !read) => matched(line, &log.samples, &mut warn),
            None if !log.has_location_column => {
                return Err(RecordingError::NoCentreLine { path: file.path.clone() });
            }
            _ => log.samples.iter().map(|sample| sample.location_m).collect(),
        };
        let direction = direction(file.direction, choice, &locations, &mut warn);
        let rows: Vec<Row> = log.samples.iter().zip(locations).map(row).collect();
        if let Some(doubt) = units::doubt(&rows) {
            warn(doubt.to_string());
        }
        Ok(Self {
            name: file.name.clone(),
            path: file.path.clone(),
            unit: file.unit.clone(),
            direction,
            day: file.departure_utc.as_deref().and_then(day_of),
            rows,
            warnings,
        })
    }

    /// What is known of the surroundings before the first row.
    pub fn surroundings(&self) -> Surroundings {
        Surroundings { temperature_c: None, day: self.day }
    }
}

impl Row {
    /// Takes this row's temperature into what is known of the surroundings. An empty field, or one that a board refuses: as it was.
    pub fn update(&self, surroundings: &mut Surroundings) {
        let now = Surroundings { temperature_c: self.temperature_c.or(surroundings.temperature_c), ..*surroundings };
        if now.are_plausible() {
            *surroundings = now;
        }
    }
}

fn row((sample, location_m): (&Sample, Option<f64>)) -> Row {
    let measurement = Measurement {
        time_s: sample.time_s,
        location_m,
        speed_mps: sample.speed_kmh.map(|speed_kmh| KmPerHour(speed_kmh).to_mps()),
        effort_n_per_kg: sample.effort_n_per_kg,
    };
    Row { line: sample.line, measurement, temperature_c: sample.ambient_temperature_c }
}

/// Locations of all fixes. Those that gave none are counted by reason: there may be thousands in one tunnel.
fn matched(line: &CentreLine, samples: &[Sample], warn: &mut impl FnMut(String)) -> Vec<Option<f64>> {
    let mut state = MatchState::default();
    let mut lost: Vec<(NoMatch, u64)> = Vec::new();
    let locations = samples
        .iter()
        .map(|sample| match line.locate(&mut state, sample.time_s, sample.latitude_deg, sample.longitude_deg) {
            Ok(found) => Some(found.location_m),
            Err(reason) => {
                lost.push((reason, sample.line));
                None
            }
        })
        .collect();
    for reason in NoMatch::ALL {
        let mut lines = lost.iter().filter(|(lost, _)| *lost == reason).map(|(_, line)| line);
        if let Some(first) = lines.next() {
            let count = 1 + lines.count();
            let (all, word) = (samples.len(), reason.as_str());
            warn(format!("line {first}: {count} of {all} fixes gave no location ({word}), the first one here"));
        }
    }
    locations
}

fn direction(
    indexed: Option<Direction>,
    choice: DirectionChoice,
    locations: &[Option<f64>],
    warn: &mut impl FnMut(String),
) -> Direction {
    let travelled_m = travelled_m(locations);
    let stated = indexed.or(match choice {
        DirectionChoice::Up => Some(Direction::Up),
        DirectionChoice::Down => Some(Direction::Down),
        DirectionChoice::Auto => None,
    });
    match (stated, travelled_m) {
        (Some(stated), Some(travelled_m)) => {
            if travelled_m * stated.sign() < -SHORTEST_M {
                let (word, way) = match stated {
                    Direction::Up => ("up", "fall"),
                    Direction::Down => ("down", "grow"),
                };
                warn(format!(
                    "the direction is stated as {word}, but the locations {way} by {:.0} m",
                    travelled_m.abs()
                ));
            }
            stated
        }
        (Some(stated), None) => stated,
        (None, Some(travelled_m)) if travelled_m < 0.0 => Direction::Down,
        (None, Some(_)) => Direction::Up,
        (None, None) => {
            warn("no location from which to tell the direction; taken as up (see --direction)".to_owned());
            Direction::Up
        }
    }
}

/// Median of the last locations minus median of the first ones, m; none without two of them.
fn travelled_m(locations: &[Option<f64>]) -> Option<f64> {
    let known: Vec<f64> = locations.iter().flatten().copied().filter(|location| location.is_finite()).collect();
    let deciding = DECIDING.min(known.len() / 2);
    if deciding == 0 {
        return None;
    }
    Some(median(&known[known.len() - deciding..]) - median(&known[..deciding]))
}

/// Middle value, the upper one of two; of a list that is not empty.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run_log::BadRows;
    use crate::track_file::CentreLinePoint;

    fn recording(
        text: &str,
        line: Option<&CentreLine>,
        indexed: Option<Direction>,
    ) -> Result<Recording, RecordingError> {
        let log = RunLog::parse("run.csv".as_ref(), text.as_bytes(), BadRows::LeaveOut).unwrap();
        let file = RunFile {
            path: "run.csv".into(),
            name: "run".to_owned(),
            unit: String::new(),
            direction: indexed,
            departure_utc: None,
        };
        Recording::new(&file, &log, line, DirectionChoice::Auto)
    }

    #[test]
    fn speeds_are_turned_into_metres_per_second_and_missing_ones_stay_missing() {
        let run = recording("time_s,location_m,speed_kmh\n0,5,36\n1,,\n2,8,7\n", None, None).unwrap();
        assert_eq!(run.rows[0].measurement.speed_mps, Some(10.0));
        assert_eq!(run.rows[1].measurement.location_m, None);
        assert_eq!(run.rows[1].measurement.speed_mps, None);
        assert_eq!(run.rows[2].line, 4);
        assert!(run.warnings.is_empty());
    }

    #[test]
    fn direction_is_found_in_spite_of_one_wild_location() {
        let text =
            "time_s,location_m,speed_kmh\n0,9000,0\n1,8990,0\n2,8980,0\n3,8970,0\n4,NaN,0\n5,8900,0\n6,99999,0\n";
        assert_eq!(recording(text, None, None).unwrap().direction, Direction::Down);
    }

    #[test]
    fn the_index_decides_and_is_doubted_aloud() {
        let text = "time_s,location_m,speed_kmh\n0,0,0\n10,900,0\n";
        let run = recording(text, None, Some(Direction::Down)).unwrap();
        assert_eq!(run.direction, Direction::Down);
        assert_eq!(run.warnings, ["run.csv: the direction is stated as down, but the locations grow by 900 m"]);
    }

    #[test]
    fn coordinates_are_matched_and_lost_fixes_are_counted() {
        let point = |at_m, latitude_deg| CentreLinePoint { at_m, latitude_deg, longitude_deg: 5.0 };
        let line = CentreLine::new(&[point(0.0, 51.0), point(11_126.0, 51.1)]).unwrap();
        let text =
            "time_s,speed_kmh,latitude_deg,longitude_deg\n0,0,51.05,5\n1,0,,\n2,0,51.04,5\n3,0,,5\n4,0,51.03,7\n";
        let run = recording(text, Some(&line), None).unwrap();
        let found: Vec<_> = run.rows.iter().map(|row| row.measurement.location_m.map(f64::round)).collect();
        assert_eq!(found, [Some(5563.0), None, Some(4450.0), None, None]);
        assert_eq!(run.direction, Direction::Down);
        assert_eq!(
            run.warnings,
            [
                "run.csv: line 3: 2 of 5 fixes gave no location (not_sent), the first one here",
                "run.csv: line 6: 1 of 5 fixes gave no location (off_the_line), the first one here",
            ]
        );
        assert!(matches!(recording(text, None, None), Err(RecordingError::NoCentreLine { .. })));
        let empty = "time_s,location_m,speed_kmh,latitude_deg,longitude_deg\n0,,0,51.05,5\n1,,0,51.04,5\n";
        let run = recording(empty, Some(&line), None).unwrap();
        let first_m = run.rows[0].measurement.location_m.map(f64::round);
        assert_eq!(first_m, Some(5563.0));
    }

    #[test]
    fn without_locations_the_direction_is_a_stated_guess() {
        let run = recording("time_s,location_m,speed_kmh\n0,,36\n1,,36\n", None, None).unwrap();
        assert_eq!(run.direction, Direction::Up);
        assert_eq!(run.warnings.len(), 1);
    }
}
