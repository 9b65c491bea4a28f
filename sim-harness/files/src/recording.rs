//! A recorded run in the estimator's units.
//!
//! In: a [`RunLog`], the track's centre line, the direction as far as it is known. Out: a [`Recording`]: one [`Sample`]
//! for each row, with its location.
//!
//! A log without a column `location_m`, or with an empty one, is matched onto the centre line. Direction: that of the
//! index, else the one asked for, else found from the locations ([`DirectionChoice::Auto`]): the median of the last
//! ones against the median of the first ones.

use crate::map_matching::{CentreLine, MatchState, NoMatch};
use crate::refusal::{Place, ReadError};
use crate::run_log::{BadRows, RunLog};
use crate::sample::{LOCATION, Sample};
use crate::statistics::median_of;
use crate::units;
use crate::{effect_file::day_of, run_set::RunFile};
use rundown::{model::direction::Direction, model::effects::Surroundings};
use std::path::{Path, PathBuf};

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

/// A run, ready to be replayed.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "as in RunFile, where not said")]
pub struct Recording {
    pub name: String,
    pub path: PathBuf,
    /// Whose memory it belongs to; empty when there is only one unit.
    pub unit: String,
    pub direction: Direction,
    /// Who drove, as the index says; empty where it does not.
    pub driver: String,
    /// Date of the departure, days since 1970-01-01 UTC, if the index has one that can be read.
    pub day: Option<f64>,
    /// All rows of the log, whatever their times.
    pub rows: Vec<Sample>,
    /// Rows of the log that could not be read, and are not among these.
    pub rows_left_out: usize,
    /// What outside the train held the run up, where a diagnosis of all runs found it.
    pub perturbed: Option<String>,
    /// What looked wrong, one line each, with file and line.
    pub warnings: Vec<String>,
}

impl Recording {
    /// Reads a log and makes a recording of it.
    ///
    /// # Errors
    /// As [`RunLog::read`] and [`Recording::new`].
    pub fn read(
        file: &RunFile,
        bad_rows: BadRows,
        line: Option<&CentreLine>,
        choice: DirectionChoice,
    ) -> Result<Self, ReadError> {
        Self::new(file, &RunLog::read(&file.path, bad_rows)?, line, choice)
    }

    /// Gives the rows of a log their locations, and the run its direction.
    ///
    /// # Errors
    /// [`ReadError::Refused`] when the log has coordinates only and the track no centre line.
    pub fn new(
        file: &RunFile,
        log: &RunLog,
        line: Option<&CentreLine>,
        choice: DirectionChoice,
    ) -> Result<Self, ReadError> {
        let mut warnings: Vec<String> = log.bad_rows.iter().map(|row| format!("{row}; the row was left out")).collect();
        warnings.extend(log.warnings.iter().map(ToString::to_string));
        warnings.extend(unknown_columns(&file.path, &log.other_columns));
        let mut rows = log.samples.clone();
        locate(&file.path, &mut rows, log.has_location_column, line, &mut warnings)?;
        let mut warn = |text: String| warnings.push(format!("{}: {text}", file.path.display()));
        let direction = direction(file.direction, choice, &rows, &mut warn);
        if let Some(doubt) = units::doubt(&rows) {
            warn(doubt.to_string());
        }
        Ok(Self {
            name: file.name.clone(),
            path: file.path.clone(),
            unit: file.unit.clone(),
            driver: file.driver.clone(),
            direction,
            day: file.departure_utc.as_deref().and_then(day_of),
            rows,
            rows_left_out: log.bad_rows.len(),
            perturbed: None,
            warnings,
        })
    }

    /// Its speeds are no readings: beside the locations, of which they were computed, they say nothing.
    pub fn speed_is_computed(&self) -> bool {
        self.rows.iter().any(|row| row.speed_is_computed)
    }

    /// What is known of the surroundings before the first row.
    pub fn surroundings(&self) -> Surroundings {
        Surroundings { temperature_c: None, day: self.day }
    }
}

/// A warning of columns that the format does not know: a wanted one may be misspelt.
pub(crate) fn unknown_columns(path: &Path, names: &[String]) -> Option<String> {
    let said = names.iter().map(|name| if name.is_empty() { "one without a name" } else { name });
    let found = said.collect::<Vec<&str>>().join(", ");
    let warning = || format!("{}: expected no other columns, found {found}; they are not used", path.display());
    (!names.is_empty()).then(warning)
}

/// Matches fixes onto the centre line where the rows have no locations: there is no such column, or it is empty.
///
/// # Errors
/// [`ReadError::Refused`] when there is no column and no line either.
pub(crate) fn locate(
    path: &Path,
    rows: &mut [Sample],
    has_location_column: bool,
    line: Option<&CentreLine>,
    warnings: &mut Vec<String>,
) -> Result<(), ReadError> {
    let located = rows.iter().any(|row| row.location_m.is_some());
    let fixes = rows.iter().any(|row| row.latitude_deg.is_some());
    match line {
        Some(line) if !has_location_column || (fixes && !located) => matched(path, line, rows, warnings),
        None if !has_location_column => {
            let message = "expected this column, or a track with a [[centre_line]] to match latitude and longitude onto; found neither";
            return Err(Place::of_file(path).refuse(LOCATION, message).into());
        }
        _ => {}
    }
    Ok(())
}

/// Locations of all fixes. Those that gave none are counted by reason: there may be thousands in one tunnel.
fn matched(path: &Path, line: &CentreLine, rows: &mut [Sample], warnings: &mut Vec<String>) {
    let mut state = MatchState::default();
    let mut lost: Vec<(NoMatch, u64)> = Vec::new();
    for row in rows.iter_mut() {
        let found = line.locate(&mut state, row.time_s, row.latitude_deg, row.longitude_deg);
        row.location_m = found.ok().map(|found| found.location_m);
        lost.extend(found.err().map(|reason| (reason, row.line)));
    }
    for reason in NoMatch::ALL {
        let mut lines = lost.iter().filter(|(lost, _)| *lost == reason).map(|(_, line)| line);
        if let Some(first) = lines.next() {
            let count = 1 + lines.count();
            let (all, word) = (rows.len(), reason.as_str());
            let text = format!("{count} of {all} fixes gave no location ({word}), the first one here");
            warnings.push(Place::of_line(path, *first).refuse("", text).to_string());
        }
    }
}

pub(crate) fn direction(
    indexed: Option<Direction>,
    choice: DirectionChoice,
    rows: &[Sample],
    warn: &mut impl FnMut(String),
) -> Direction {
    let travelled_m = travelled_m(rows);
    let chosen = match choice {
        DirectionChoice::Up => Some(Direction::Up),
        DirectionChoice::Down => Some(Direction::Down),
        DirectionChoice::Auto => None,
    };
    if let (Some(indexed), Some(chosen)) = (indexed, chosen)
        && indexed != chosen
    {
        warn("the direction is that of the index, not the one asked for".to_owned());
    }
    let stated = indexed.or(chosen);
    match (stated, travelled_m) {
        (Some(stated), Some(travelled_m)) => {
            if travelled_m * stated.sign() < -SHORTEST_M {
                let (word, trend) = match stated {
                    Direction::Up => ("up", "fall"),
                    Direction::Down => ("down", "grow"),
                };
                warn(format!(
                    "the direction is stated as {word}, but the locations {trend} by {:.0} m",
                    travelled_m.abs()
                ));
            }
            stated
        }
        (Some(stated), None) => stated,
        (None, Some(travelled_m)) if travelled_m < 0.0 => Direction::Down,
        (None, Some(_)) => Direction::Up,
        (None, None) => {
            warn(
                "expected locations that grow or fall, found none; the direction is taken as up (see --direction)"
                    .to_owned(),
            );
            Direction::Up
        }
    }
}

/// Median of the last locations minus median of the first ones, m; none without two of them. Rows that were written out
/// of order are taken by their times; a clock that goes back a few times was set.
fn travelled_m(rows: &[Sample]) -> Option<f64> {
    let located = rows.iter().filter_map(|row| Some((row.time_s, row.location_m?)));
    let mut known: Vec<(f64, f64)> = located.filter(|(_, location_m)| location_m.is_finite()).collect();
    let back = known.windows(2).filter(|pair| pair[1].0 < pair[0].0).count();
    if 10 * back > known.len() {
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    let known: Vec<f64> = known.into_iter().map(|(_, location_m)| location_m).collect();
    let deciding = DECIDING.min(known.len() / 2);
    if deciding == 0 {
        return None;
    }
    Some(median_of(&known[known.len() - deciding..]) - median_of(&known[..deciding]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track_file::CentreLinePoint;

    fn recording(text: &str, line: Option<&CentreLine>, indexed: Option<Direction>) -> Result<Recording, ReadError> {
        let log = RunLog::parse("run.csv".as_ref(), text.as_bytes(), BadRows::LeaveOut).unwrap();
        let file = RunFile {
            path: "run.csv".into(),
            name: "run".to_owned(),
            unit: String::new(),
            driver: String::new(),
            direction: indexed,
            departure_utc: None,
        };
        Recording::new(&file, &log, line, DirectionChoice::Auto)
    }

    #[test]
    fn speeds_are_turned_into_metres_per_second_and_missing_ones_stay_missing() {
        let run = recording("time_s,location_m,speed_kmh\n0,5,36\n1,,\n2,8,7\n", None, None).unwrap();
        assert_eq!(run.rows[0].speed_mps, Some(10.0));
        assert_eq!(run.rows[1].location_m, None);
        assert_eq!(run.rows[1].speed_mps, None);
        assert_eq!(run.rows[2].line, 4);
        assert!(run.warnings.is_empty());
    }

    #[test]
    fn unknown_columns_are_warned_of_once() {
        let run =
            recording("time_s,location_m,speed_kmh,note,effort_n_kg\n0,5,36,a,0\n1,9,36,b,0\n", None, None).unwrap();
        assert_eq!(run.warnings, ["run.csv: expected no other columns, found note, effort_n_kg; they are not used"]);
        let run = recording(",time_s,location_m,speed_kmh\n0,0,5,36\n1,1,9,36\n", None, None).unwrap();
        assert_eq!(run.warnings, ["run.csv: expected no other columns, found one without a name; they are not used"]);
    }

    #[test]
    fn direction_is_found_in_spite_of_one_wild_location() {
        let text =
            "time_s,location_m,speed_kmh\n0,9000,0\n1,8990,0\n2,8980,0\n3,8970,0\n4,NaN,0\n5,8900,0\n6,99999,0\n";
        assert_eq!(recording(text, None, None).unwrap().direction, Direction::Down);
    }

    #[test]
    fn direction_is_that_of_the_times_where_rows_are_out_of_order() {
        // Of a train that goes down, the last row first.
        let rows = (0..40).rev().map(|t| format!("{t},{},36\n", 9000 - 10 * t));
        let text = format!("time_s,location_m,speed_kmh\n{}", rows.collect::<String>());
        assert_eq!(recording(&text, None, None).unwrap().direction, Direction::Down);
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
        let found: Vec<_> = run.rows.iter().map(|row| row.location_m.map(f64::round)).collect();
        assert_eq!(found, [Some(5563.0), None, Some(4450.0), None, None]);
        assert_eq!(run.direction, Direction::Down);
        assert_eq!(
            run.warnings,
            [
                "run.csv:3: 2 of 5 fixes gave no location (not_sent), the first one here",
                "run.csv:6: 1 of 5 fixes gave no location (off_the_line), the first one here",
            ]
        );
        let error = recording(text, None, None).unwrap_err().to_string();
        assert!(
            error.starts_with("run.csv: location_m: expected this column, or a track with a [[centre_line]]"),
            "{error}"
        );
        let empty = "time_s,location_m,speed_kmh,latitude_deg,longitude_deg\n0,,0,51.05,5\n1,,0,51.04,5\n";
        let run = recording(empty, Some(&line), None).unwrap();
        let first_m = run.rows[0].location_m.map(f64::round);
        assert_eq!(first_m, Some(5563.0));
    }

    #[test]
    fn without_locations_the_direction_is_a_stated_guess() {
        let run = recording("time_s,location_m,speed_kmh\n0,,36\n1,,36\n", None, None).unwrap();
        assert_eq!(run.direction, Direction::Up);
        assert_eq!(run.warnings.len(), 1);
    }
}
