//! Run logs in one file: the rows of a run follow each other, runs one after the other.

use super::columns;
use super::{ParquetError, TableWriter};
use crate::column::{About, Kind};
use crate::recording::{self, Recording};
use crate::sample::{self, COLUMNS, Column, LOCATION, Sample};
use crate::table::{Cell, Record};
use crate::{map_matching::CentreLine, refusal::Place};
use parquet::file::reader::{FileReader, SerializedFileReader};
use rundown::model::direction::Direction;
use std::path::{Path, PathBuf};
use std::{collections::VecDeque, fs::File};

/// Columns of texts: name of the run, which is needed, its unit, its direction and its driver.
const TEXTS: [&str; 4] = ["run", "unit", "direction", "driver"];
/// What they say.
const MEANINGS: [&str; TEXTS.len()] = [
    "name of the run; its rows follow each other",
    "unit whose vehicle is carried from run to run",
    "`up` or `down`",
    "who drove, empty where it is not known",
];

/// The columns of a file of runs.
pub fn run_columns() -> Vec<About> {
    let text = |(name, meaning): (&str, &str)| About::new(name, Kind::Text, meaning);
    TEXTS.into_iter().zip(MEANINGS).map(text).chain(COLUMNS.iter().map(Column::about)).collect()
}

/// Reads runs, holding one group of rows and one run at a time.
pub struct RunReader {
    path: PathBuf,
    reader: SerializedFileReader<File>,
    runs: usize,
    group: usize,
    /// Where the texts stand.
    texts: [Option<usize>; TEXTS.len()],
    /// The known columns of numbers that are there, with their places.
    numbers: Vec<(&'static Column, usize)>,
    line: Option<CentreLine>,
    row: usize,
    /// What is to be said with the first run.
    warnings: Vec<String>,
    /// Complete runs of the groups read so far.
    ready: VecDeque<Recording>,
    /// The run that the next group may go on with.
    open: Option<Recording>,
}

impl std::fmt::Debug for RunReader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RunReader").field("path", &self.path).field("runs", &self.runs).finish_non_exhaustive()
    }
}

impl RunReader {
    /// Opens a file and counts its runs. Coordinates are matched onto `line` as those of a log are.
    ///
    /// # Errors
    /// [`ParquetError`] when it cannot be read, or lacks a column that runs need.
    pub fn open(path: &Path, line: Option<&CentreLine>) -> Result<Self, ParquetError> {
        let file = File::open(path).map_err(|source| ParquetError::io(path, source))?;
        log::info!("read {}", path.display());
        let format = |source| ParquetError::format(path, source);
        let reader = SerializedFileReader::new(file).map_err(format)?;
        let schema = reader.metadata().file_metadata().schema_descr();
        let names: Vec<String> = schema.columns().iter().map(|column| column.name().to_owned()).collect();
        let find = |name: &str| names.iter().position(|found| found == name);
        let missing = [TEXTS[0]].into_iter().filter(|name| find(name).is_none());
        if let Some(name) = missing.chain(sample::missing(|name| find(name).is_some())).next() {
            return Err(Place::of_file(path).refuse(name, "expected a column of this name, found none").into());
        }
        let known = |name: &String| TEXTS.contains(&name.as_str()) || COLUMNS.iter().any(|column| column.name == name);
        let unknown: Vec<String> = names.iter().filter(|name| !known(name)).cloned().collect();
        let numbers = COLUMNS.iter().filter_map(|column| Some((column, find(column.name)?))).collect();
        let mut opened = Self {
            path: path.to_owned(),
            runs: 0,
            group: 0,
            texts: TEXTS.map(find),
            numbers,
            line: line.cloned(),
            row: 0,
            warnings: recording::unknown_columns(path, &unknown).into_iter().collect(),
            ready: VecDeque::new(),
            open: None,
            reader,
        };
        let mut last: Option<String> = None;
        for group in 0..opened.reader.num_row_groups() {
            for run in opened.texts(group, 0)? {
                if last != run {
                    opened.runs += 1;
                    last = run;
                }
            }
        }
        Ok(opened)
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.runs
    }

    /// The next run; none after the last.
    ///
    /// # Errors
    /// [`ParquetError`] when the file is broken.
    pub fn next_run(&mut self) -> Result<Option<Recording>, ParquetError> {
        while self.ready.is_empty() && self.group < self.reader.num_row_groups() {
            self.read_group()?;
        }
        let Some(mut run) = self.ready.pop_front().or_else(|| self.open.take()) else {
            return Ok(None);
        };
        let has_location = self.numbers.iter().any(|(column, _)| column.name == LOCATION);
        run.warnings.append(&mut self.warnings);
        recording::locate(&self.path, &mut run.rows, has_location, self.line.as_ref(), &mut run.warnings)?;
        Ok(Some(run))
    }

    /// The fields of a column of texts; all missing where there is no such column.
    fn texts(&self, group: usize, column: usize) -> Result<Vec<Option<String>>, ParquetError> {
        let format = |source| ParquetError::format(&self.path, source);
        let group = self.reader.get_row_group(group).map_err(format)?;
        let Some(place) = self.texts[column] else {
            return Ok(vec![None; group.metadata().num_rows() as usize]);
        };
        let texts = columns::texts(group.as_ref(), place).map_err(format)?;
        texts.ok_or_else(|| self.refused(TEXTS[column], "texts"))
    }

    fn refused(&self, column: &str, expected: &str) -> ParquetError {
        let message = format!("expected {expected} in this column, found another type");
        Place::of_file(&self.path).refuse(column, message).into()
    }

    fn read_group(&mut self) -> Result<(), ParquetError> {
        let index = self.group;
        let [names, units, directions] = [self.texts(index, 0)?, self.texts(index, 1)?, self.texts(index, 2)?];
        let drivers = self.texts(index, 3)?;
        let format = |source| ParquetError::format(&self.path, source);
        let group = self.reader.get_row_group(index).map_err(format)?;
        let mut numbers = Vec::with_capacity(self.numbers.len());
        for &(column, place) in &self.numbers {
            let values = columns::numbers(group.as_ref(), place).map_err(format)?;
            numbers.push((column, values.ok_or_else(|| self.refused(column.name, "numbers"))?));
        }
        for (row, name) in names.iter().enumerate() {
            let name = name.clone().unwrap_or_default();
            if self.open.as_ref().is_some_and(|open| open.name != name) {
                self.ready.extend(self.open.take());
            }
            let open = self.open.get_or_insert_with(|| Recording {
                path: self.path.clone(),
                unit: units.get(row).cloned().flatten().unwrap_or_default(),
                direction: match directions.get(row).and_then(Option::as_deref) {
                    Some("down") => Direction::Down,
                    _ => Direction::Up,
                },
                name,
                driver: drivers.get(row).cloned().flatten().unwrap_or_default(),
                day: None,
                rows: Vec::new(),
                perturbed: None,
                warnings: Vec::new(),
            });
            self.row += 1;
            // A row without a time cannot be after the last: the estimator drops and counts it.
            let mut sample = Sample { line: self.row as u64, time_s: f64::NAN, ..Sample::default() };
            for (column, values) in &numbers {
                if let Some(value) = values.get(row).copied().flatten() {
                    (column.set)(&mut sample, value);
                }
            }
            open.rows.push(sample);
        }
        self.group += 1;
        Ok(())
    }
}

/// Writes runs as [`RunReader`] reads them, each call a group of rows.
#[derive(Debug)]
pub struct RunWriter(TableWriter);

impl RunWriter {
    /// A file that will be made with the first runs.
    pub fn new(path: &Path) -> Self {
        Self(TableWriter::new(path, run_columns()))
    }

    /// Adds runs.
    ///
    /// # Errors
    /// [`ParquetError`] when the file cannot be written.
    pub fn write<'a>(&mut self, runs: impl IntoIterator<Item = &'a Recording>) -> Result<(), ParquetError> {
        let rows = |run: &'a Recording| run.rows.iter().map(move |row| record(run, row));
        let records: Vec<Record> = runs.into_iter().flat_map(rows).collect();
        self.0.write(&records)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// As [`RunWriter::write`].
    pub fn close(self) -> Result<(), ParquetError> {
        self.0.close()
    }
}

fn record(run: &Recording, row: &Sample) -> Record {
    let direction = match run.direction {
        Direction::Up => "up",
        Direction::Down => "down",
    };
    let texts = TEXTS.into_iter().zip([run.name.as_str(), run.unit.as_str(), direction, run.driver.as_str()]);
    let texts = texts.map(|(name, text)| (name.to_owned(), Cell::from(text)));
    let numbers = COLUMNS.iter().map(|column| (column.name.to_owned(), Cell::from((column.get)(row))));
    texts.chain(numbers).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track_file::CentreLinePoint;

    /// Forty rows with a value in every column.
    fn recording(index: u32) -> Recording {
        let row = |i: u32| {
            let mut sample = Sample { line: u64::from(i) + 2, ..Sample::default() };
            for (k, column) in (0..).zip(&COLUMNS) {
                (column.set)(&mut sample, f64::from(10 * (i + index) + k));
            }
            sample
        };
        Recording {
            name: format!("run {index}"),
            path: "run.csv".into(),
            unit: "unit 7".to_owned(),
            direction: Direction::Up,
            driver: format!("driver {index}"),
            day: None,
            rows: (0..40).map(row).collect(),
            perturbed: None,
            warnings: Vec::new(),
        }
    }

    #[test]
    fn runs_come_back_as_they_were_whatever_the_groups() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.parquet");
        let mut runs: Vec<Recording> = (0..3).map(recording).collect();
        runs[1].rows[7].location_m = None;
        runs[2].rows.iter_mut().for_each(|row| row.effort_n_per_kg = None);
        runs[2].direction = Direction::Down;
        let mut writer = RunWriter::new(&path);
        writer.write(&runs[..2]).unwrap();
        writer.write(&runs[2..]).unwrap();
        writer.close().unwrap();
        let mut reader = RunReader::open(&path, None).unwrap();
        assert_eq!(reader.runs(), 3);
        for run in &runs {
            let found = reader.next_run().unwrap().unwrap();
            assert_eq!((&found.name, &found.unit, found.direction), (&run.name, &run.unit, run.direction));
            assert_eq!(found.driver, run.driver);
            assert_eq!(found.rows.len(), run.rows.len());
            for (a, b) in found.rows.iter().zip(&run.rows) {
                assert_eq!(*a, Sample { line: a.line, ..*b });
            }
        }
        assert!(reader.next_run().unwrap().is_none());
    }

    #[test]
    fn a_file_says_its_version_units_and_meanings_and_is_compressed_with_zstd() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.parquet");
        let mut writer = RunWriter::new(&path);
        writer.write([&recording(0)]).unwrap();
        writer.close().unwrap();
        let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
        let metadata = reader.metadata();
        let said = |key: &str| {
            let all = metadata.file_metadata().key_value_metadata().unwrap();
            all.iter().find(|pair| pair.key == key).unwrap().value.clone().unwrap()
        };
        assert_eq!(said(columns::VERSION), env!("CARGO_PKG_VERSION"));
        let described: serde_json::Value = serde_json::from_str(&said(columns::COLUMNS)).unwrap();
        assert_eq!(described["speed_kmh"]["unit"], "km/h");
        assert_eq!(described["effort_n_per_kg"]["null_when"], "there is no reading");
        for column in metadata.row_group(0).columns() {
            assert!(matches!(column.compression(), parquet::basic::Compression::ZSTD(_)), "{column:?}");
        }
    }

    /// A file of one row: `run` is `a`, the others are numbers.
    fn file(folder: &Path, numbers: &[(&str, f64)]) -> PathBuf {
        let path = folder.join("t.parquet");
        let about = numbers.iter().map(|(name, _)| About::new(name, Kind::Number, ""));
        let about = std::iter::once(About::new("run", Kind::Text, "")).chain(about).collect();
        let mut writer = TableWriter::new(&path, about);
        let numbers = numbers.iter().map(|(name, number)| ((*name).to_owned(), Cell::from(*number)));
        let row = [("run".to_owned(), Cell::from("a"))].into_iter().chain(numbers).collect();
        writer.write(&[row]).unwrap();
        writer.close().unwrap();
        path
    }

    #[test]
    fn what_is_missing_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = file(folder.path(), &[("time_s", 0.0)]);
        let error = RunReader::open(&path, None).unwrap_err().to_string();
        assert!(error.ends_with("t.parquet: location_m: expected a column of this name, found none"), "{error}");
        std::fs::write(&path, "no such format").unwrap();
        assert!(RunReader::open(&path, None).is_err());
    }

    #[test]
    fn coordinates_stand_for_the_location_and_unknown_columns_are_warned_of() {
        let folder = tempfile::tempdir().unwrap();
        let fix = [("time_s", 0.0), ("speed_kmh", 36.0), ("latitude_deg", 51.05), ("longitude_deg", 5.0), ("odd", 1.0)];
        let path = file(folder.path(), &fix);
        let point = |at_m, latitude_deg| CentreLinePoint { at_m, latitude_deg, longitude_deg: 5.0 };
        let line = CentreLine::new(&[point(0.0, 51.0), point(11_126.0, 51.1)]).unwrap();
        let run = RunReader::open(&path, Some(&line)).unwrap().next_run().unwrap().unwrap();
        assert_eq!(run.rows[0].location_m.map(f64::round), Some(5563.0));
        assert!(run.warnings[0].ends_with("t.parquet: expected no other columns, found odd; they are not used"));
        let error = RunReader::open(&path, None).unwrap().next_run().unwrap_err().to_string();
        assert!(error.contains("location_m: expected this column, or a track with a [[centre_line]]"), "{error}");
    }
}
