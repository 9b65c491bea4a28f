//! Rows of several runs in one table, from a Parquet file or from memory, as recordings. The rows of a run follow each
//! other, runs one after the other.
//!
//! In: batches of rows, column by column. Out: a [`Recording`] for each run, with its locations and direction.

use crate::column::{About, Kind};
use crate::map_matching::CentreLine;
use crate::recording::{self, DirectionChoice, Recording};
use crate::refusal::{Place, ReadError, Refusal};
use crate::sample::{self, COLUMNS, LOCATION, NumberColumn, Sample};
use crate::units;
use rundown::model::direction::Direction;
use std::collections::{HashSet, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// Columns of texts: name of the run, which is needed, its unit, its direction and its driver.
pub const TEXTS: [&str; 4] = ["run", "unit", "direction", "driver"];
/// What they say.
const MEANINGS: [&str; TEXTS.len()] = [
    "name of the run; its rows follow each other",
    "unit whose vehicle is carried from run to run",
    "`up` or `down`",
    "who drove, empty where it is not known",
];

/// The columns of a table of runs.
pub fn run_columns() -> Vec<About> {
    let text = |(name, meaning): (&str, &str)| About::new(name, Kind::Text, meaning);
    TEXTS.into_iter().zip(MEANINGS).map(text).chain(COLUMNS.iter().map(NumberColumn::about)).collect()
}

/// Some rows, column by column; every column has as many.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Those of [`TEXTS`]; all missing where there is no such column.
    pub texts: [Vec<Option<String>>; TEXTS.len()],
    /// Those of [`COLUMNS`] that are there.
    pub numbers: Vec<(&'static NumberColumn, Vec<Option<f64>>)>,
}

/// Where columns of runs stand among others.
#[derive(Clone, Debug)]
pub struct Places {
    /// Of [`TEXTS`].
    pub texts: [Option<usize>; TEXTS.len()],
    /// Of the columns of [`COLUMNS`] that are there.
    pub numbers: Vec<(&'static NumberColumn, usize)>,
    unknown: Vec<String>,
}

impl Places {
    /// Finds the columns by their names.
    ///
    /// # Errors
    /// [`Refusal`]: a column is missing that runs need.
    pub fn find(path: &Path, names: &[String]) -> Result<Self, Refusal> {
        let find = |name: &str| names.iter().position(|found| found == name);
        let missing = [TEXTS[0]].into_iter().filter(|name| find(name).is_none());
        if let Some(name) = missing.chain(sample::missing(|name| find(name).is_some())).next() {
            return Err(Place::of_file(path).refuse(name, "expected a column of this name, found none"));
        }
        let known = |name: &String| TEXTS.contains(&name.as_str()) || COLUMNS.iter().any(|column| column.name == name);
        let numbers = COLUMNS.iter().filter_map(|column| Some((column, find(column.name)?))).collect();
        let unknown = names.iter().filter(|name| !known(name) && !is_index(name)).cloned().collect();
        Ok(Self { texts: TEXTS.map(find), numbers, unknown })
    }
}

/// What pandas adds for the index of a frame: no column of the user.
fn is_index(name: &str) -> bool {
    let level = name.strip_prefix("__index_level_").and_then(|name| name.strip_suffix("__"));
    level.is_some_and(|level| level.parse::<u32>().is_ok())
}

/// Takes batches, gives recordings. Holds a batch and the run that the next batch may go on with.
#[derive(Debug)]
pub struct Recordings {
    path: PathBuf,
    line: Option<CentreLine>,
    has_location: bool,
    /// Rows so far.
    row: usize,
    /// What is to be said with the first run.
    warnings: Vec<String>,
    ready: VecDeque<Open>,
    open: Option<Open>,
    /// Digests of unit and name of the runs so far: a fleet has many.
    begun: HashSet<u64>,
}

/// A run whose rows are being collected.
#[derive(Debug)]
struct Open {
    name: String,
    unit: String,
    driver: String,
    direction: Option<Direction>,
    rows: Vec<Sample>,
}

impl Recordings {
    /// Of a table with these columns; `path` is for the messages. Coordinates are matched onto `line` as those of a log
    /// are.
    pub fn new(path: &Path, places: &Places, line: Option<&CentreLine>) -> Self {
        Self {
            path: path.to_owned(),
            line: line.cloned(),
            has_location: places.numbers.iter().any(|(column, _)| column.name == LOCATION),
            row: 0,
            warnings: recording::unknown_columns(path, &places.unknown).into_iter().collect(),
            ready: VecDeque::new(),
            open: None,
            begun: HashSet::new(),
        }
    }

    /// A run is complete.
    pub fn is_ready(&self) -> bool {
        !self.ready.is_empty()
    }

    /// Adds the next rows.
    ///
    /// # Errors
    /// [`Refusal`] of a row without a run, of a direction that is none, and of a run that goes on after another one.
    pub fn add(&mut self, batch: &Batch) -> Result<(), Refusal> {
        let [names, units, directions, drivers] = &batch.texts;
        for (row, name) in names.iter().enumerate() {
            let Some(name) = name.as_deref().filter(|name| !name.is_empty()) else {
                let place = Place::of_line(&self.path, self.row as u64 + 1);
                return Err(place.refuse(TEXTS[0], "expected the name of the run in each row, found an empty cell"));
            };
            let unit = units.get(row).and_then(Option::as_deref).unwrap_or_default();
            if self.open.as_ref().is_some_and(|open| open.name != name || open.unit != unit) {
                self.ready.extend(self.open.take());
            }
            self.row += 1;
            if self.open.is_none() && !self.begun.insert(digest(unit, name)) {
                let place = Place::of_line(&self.path, self.row as u64);
                let found = format!(
                    "expected the rows of a run one after the other, found {name:?} once more after another run: sort by run and time_s, or give each run a name of its own"
                );
                return Err(place.refuse(TEXTS[0], found));
            }
            // A row without a time cannot be after the last: the estimator drops and counts it.
            let mut sample = Sample { line: self.row as u64, time_s: f64::NAN, ..Sample::default() };
            for (column, values) in &batch.numbers {
                if let Some(value) = values.get(row).copied().flatten() {
                    (column.set)(&mut sample, value);
                }
            }
            if let Some(open) = &mut self.open {
                open.rows.push(sample);
                continue;
            }
            let direction = self.direction(directions.get(row).and_then(Option::as_deref))?;
            let driver = drivers.get(row).cloned().flatten().unwrap_or_default();
            self.open =
                Some(Open { name: name.to_owned(), unit: unit.to_owned(), driver, direction, rows: vec![sample] });
        }
        Ok(())
    }

    /// That of the row.
    fn direction(&self, word: Option<&str>) -> Result<Option<Direction>, Refusal> {
        match word {
            None | Some("") => Ok(None),
            Some("up") => Ok(Some(Direction::Up)),
            Some("down") => Ok(Some(Direction::Down)),
            Some(other) => {
                let place = Place::of_line(&self.path, self.row as u64);
                Err(place.refuse(TEXTS[2], format!("expected up, down or an empty cell, found {other:?}")))
            }
        }
    }

    /// The next run that is complete, after the last row also the one that is open; none where there is none. Runs
    /// without a direction have the one that their locations have.
    ///
    /// # Errors
    /// [`ReadError`] when there are coordinates only and no line.
    pub fn next(&mut self, is_ended: bool) -> Result<Option<Recording>, ReadError> {
        let open = if is_ended { self.open.take() } else { None };
        self.ready.extend(open);
        let Some(Open { name, unit, driver, direction, mut rows }) = self.ready.pop_front() else {
            return Ok(None);
        };
        let mut warnings = std::mem::take(&mut self.warnings);
        recording::locate(&self.path, &mut rows, self.has_location, self.line.as_ref(), &mut warnings)?;
        let mut warn = |text: String| warnings.push(format!("{}: run {name}: {text}", self.path.display()));
        let direction = recording::direction(direction, DirectionChoice::Auto, &rows, &mut warn);
        if let Some(doubt) = units::doubt(&rows) {
            warn(doubt.to_string());
        }
        Ok(Some(Recording {
            name,
            path: self.path.clone(),
            unit,
            driver,
            direction,
            rows,
            warnings,
            ..Recording::default()
        }))
    }
}

fn digest(unit: &str, name: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    (unit, name).hash(&mut hasher);
    hasher.finish()
}

/// A table of runs in memory.
#[derive(Clone, Debug)]
pub struct RunTable {
    /// For the messages.
    pub path: PathBuf,
    /// Where the columns stood.
    pub places: Places,
    /// The rows.
    pub batches: Vec<Batch>,
}

impl RunTable {
    /// All runs.
    ///
    /// # Errors
    /// As [`Recordings::add`] and [`Recordings::next`].
    pub fn recordings(self, line: Option<&CentreLine>) -> Result<VecDeque<Recording>, ReadError> {
        let mut collected = Recordings::new(&self.path, &self.places, line);
        for batch in self.batches {
            collected.add(&batch)?;
        }
        let mut recordings = VecDeque::new();
        while let Some(recording) = collected.next(true)? {
            recordings.push_back(recording);
        }
        Ok(recordings)
    }
}

/// All runs of several tables; a run is in one of them.
///
/// # Errors
/// As [`RunTable::recordings`], and [`Refusal`] of a run that an earlier table has, too.
pub fn recordings(tables: Vec<RunTable>, line: Option<&CentreLine>) -> Result<VecDeque<Recording>, ReadError> {
    let (mut all, mut begun) = (VecDeque::new(), HashSet::new());
    for table in tables {
        for recording in table.recordings(line)? {
            let Recording { path, name, unit, .. } = &recording;
            if !begun.insert(digest(unit, name)) {
                let expected = "expected each run in one table";
                let mend = "concatenate its rows, or give each run a name of its own";
                let found = format!("{expected}, found {name:?} in an earlier one, too: {mend}");
                return Err(Place::of_file(path).refuse(TEXTS[0], found).into());
            }
            all.push_back(recording);
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three rows of a run, 100 m apart.
    fn table(run: &str, directions: [Option<&str>; 3], step_m: f64) -> RunTable {
        let names = ["run", "direction", "time_s", "location_m", "speed_kmh", "note"].map(str::to_owned);
        let places = Places::find("runs".as_ref(), &names).unwrap();
        let numbers = places.numbers.iter().map(|(column, _)| {
            let value = |row: u32| Some(if column.name == LOCATION { step_m } else { 10.0 } * f64::from(row));
            (*column, (0..3).map(value).collect())
        });
        let batch = Batch {
            texts: [
                vec![Some(run.to_owned()); 3],
                vec![None; 3],
                directions.map(|word| word.map(str::to_owned)).to_vec(),
                vec![None; 3],
            ],
            numbers: numbers.collect(),
        };
        RunTable { path: "runs".into(), places, batches: vec![batch] }
    }

    #[test]
    fn a_run_without_a_direction_has_that_of_its_locations() {
        for (step_m, expected) in [(100.0, Direction::Up), (-100.0, Direction::Down)] {
            let runs = table("a", [None; 3], step_m).recordings(None).unwrap();
            assert_eq!((runs.len(), runs[0].direction, runs[0].rows.len()), (1, expected, 3));
        }
        let stated = table("a", [Some("up"); 3], -200.0).recordings(None).unwrap();
        assert_eq!(stated[0].direction, Direction::Up);
        let expected = "runs: run a: the direction is stated as up, but the locations fall by 400 m";
        assert_eq!(stated[0].warnings[1], expected);
    }

    /// A frame that was sorted by time, or shuffled: each change of the name would be a run of its own.
    #[test]
    fn a_run_that_comes_back_is_refused() {
        let mut mixed = table("a", [None; 3], 100.0);
        for name in ["b", "a"] {
            mixed.batches.extend(table(name, [None; 3], 100.0).batches);
        }
        let error = mixed.recordings(None).unwrap_err().to_string();
        assert!(
            error.starts_with("runs:7: run: expected the rows of a run one after the other, found \"a\" once more"),
            "{error}"
        );
    }

    #[test]
    fn units_are_doubted_as_those_of_a_log_are() {
        let names = ["run", "time_s", "location_m", "speed_kmh", "effort_n_per_kg"].map(str::to_owned);
        let places = Places::find("runs".as_ref(), &names).unwrap();
        let of = |values: fn(f64) -> f64| (0..60).map(|row| Some(values(f64::from(row)))).collect::<Vec<_>>();
        for (effort, is_doubted) in [(0.3, false), (120.0, true)] {
            let mut numbers = [of(|t| 10.0 * t), of(|t| 200.0 * t), of(|_| 72.0), vec![Some(effort); 60]];
            let numbers = places.numbers.iter().map(|(column, at)| (*column, std::mem::take(&mut numbers[at - 1])));
            let texts = [vec![Some("a".to_owned()); 60], vec![None; 60], vec![None; 60], vec![None; 60]];
            let batch = Batch { texts, numbers: numbers.collect() };
            let table = RunTable { path: "runs".into(), places: places.clone(), batches: vec![batch] };
            let warnings = table.recordings(None).unwrap()[0].warnings.join("; ");
            assert_eq!(warnings.contains("a force has to be divided"), is_doubted, "{warnings}");
        }
    }

    #[test]
    fn a_row_without_a_run_is_refused() {
        let mut missing = table("a", [None; 3], 1.0);
        missing.batches[0].texts[0][1] = None;
        let error = missing.recordings(None).unwrap_err().to_string();
        assert_eq!(error, "runs:2: run: expected the name of the run in each row, found an empty cell");
    }

    #[test]
    fn a_run_of_two_tables_is_refused_and_others_follow_each_other() {
        let of = |names: &[&str]| recordings(names.iter().map(|name| table(name, [None; 3], 1.0)).collect(), None);
        let names: Vec<String> = of(&["b", "a"]).unwrap().into_iter().map(|run| run.name).collect();
        assert_eq!(names, ["b", "a"]);
        let error = of(&["b", "b"]).unwrap_err().to_string();
        assert!(
            error.starts_with("runs: run: expected each run in one table, found \"b\" in an earlier one"),
            "{error}"
        );
    }

    #[test]
    fn the_index_of_pandas_is_no_unknown_column() {
        let names = ["run", "time_s", "location_m", "speed_kmh", "__index_level_0__", "__index_level_12__"];
        let unknown = |more: &str| {
            let names: Vec<String> = names.into_iter().chain([more]).map(str::to_owned).collect();
            Places::find("runs".as_ref(), &names).unwrap().unknown
        };
        assert_eq!(unknown("unit"), <[&str; 0]>::default());
        for name in ["__index_level__", "__index_level_x__", "index", ""] {
            assert_eq!(unknown(name), [name]);
        }
    }

    #[test]
    fn another_word_is_no_direction() {
        let error = table("a", [Some("DOWN"), None, None], 1.0).recordings(None).unwrap_err().to_string();
        assert_eq!(error, "runs:1: direction: expected up, down or an empty cell, found \"DOWN\"");
    }

    #[test]
    fn a_run_goes_on_in_the_next_batch_and_another_name_or_unit_begins_another_one() {
        let mut first = table("a", [None; 3], 100.0);
        for name in ["a", "b", "b"] {
            first.batches.extend(table(name, [None; 3], 100.0).batches);
        }
        first.batches[3].texts[1] = vec![Some("unit 2".to_owned()); 3];
        let runs = first.recordings(None).unwrap();
        let found: Vec<_> = runs.iter().map(|run| (run.name.as_str(), run.rows.len())).collect();
        assert_eq!(found, [("a", 6), ("b", 3), ("b", 3)]);
        assert_eq!(runs[0].warnings, ["runs: expected no other columns, found note; they are not used"]);
        assert_eq!(runs[1].rows[0].line, 7);
    }
}
