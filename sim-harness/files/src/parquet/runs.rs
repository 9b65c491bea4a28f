//! Run logs in one file: the rows of a run follow each other, runs one after the other.

use super::columns;
use super::{ParquetError, TableWriter};
use crate::recording::{Recording, Row};
use crate::table::{Cell, Record};
use parquet::file::reader::{FileReader, SerializedFileReader};
use rundown::model::direction::Direction;
use rundown::model::units::KmPerHour;
use rundown::tick::measurement::Measurement;
use std::collections::VecDeque;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Columns of numbers: which may be left out.
const NUMBERS: [(&str, bool); 4] =
    [("time_s", false), ("location_m", false), ("speed_kmh", false), ("effort_n_per_kg", true)];

/// Reads runs, holding one group of rows and one run at a time.
pub struct RunReader {
    path: PathBuf,
    reader: SerializedFileReader<File>,
    runs: usize,
    group: usize,
    places: Places,
    row: usize,
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

/// Where the columns stand.
#[derive(Clone, Copy, Debug)]
struct Places {
    run: usize,
    unit: Option<usize>,
    direction: Option<usize>,
    numbers: [Option<usize>; NUMBERS.len()],
}

impl RunReader {
    /// Opens a file and counts its runs.
    ///
    /// # Errors
    /// [`ParquetError`] when it cannot be read, or lacks a column that runs need.
    pub fn open(path: &Path) -> Result<Self, ParquetError> {
        let file = File::open(path).map_err(|source| ParquetError::io(path, source))?;
        let format = |source| ParquetError::format(path, source);
        let reader = SerializedFileReader::new(file).map_err(format)?;
        let places = places(path, &reader)?;
        let mut opened = Self {
            path: path.to_owned(),
            reader,
            runs: 0,
            group: 0,
            places,
            row: 0,
            ready: VecDeque::new(),
            open: None,
        };
        let mut last: Option<String> = None;
        for group in 0..opened.reader.num_row_groups() {
            for run in opened.texts(group, "run", places.run)? {
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
        Ok(self.ready.pop_front().or_else(|| self.open.take()))
    }

    fn texts(&self, group: usize, column: &'static str, place: usize) -> Result<Vec<Option<String>>, ParquetError> {
        let format = |source| ParquetError::format(&self.path, source);
        let group = self.reader.get_row_group(group).map_err(format)?;
        let texts = columns::texts(group.as_ref(), place).map_err(format)?;
        texts.ok_or_else(|| self.refused(column, "texts"))
    }

    fn refused(&self, column: &'static str, expected: &'static str) -> ParquetError {
        ParquetError::Column { path: self.path.clone(), column, expected, found: "another type".to_owned() }
    }

    fn read_group(&mut self) -> Result<(), ParquetError> {
        let index = self.group;
        let names = self.texts(index, "run", self.places.run)?;
        let optional = |place: Option<usize>, column| match place {
            Some(place) => self.texts(index, column, place),
            None => Ok(vec![None; names.len()]),
        };
        let units = optional(self.places.unit, "unit")?;
        let directions = optional(self.places.direction, "direction")?;
        let group = self.reader.get_row_group(index);
        let group = group.map_err(|source| ParquetError::format(&self.path, source))?;
        let mut numbers = Vec::with_capacity(NUMBERS.len());
        for ((name, _), place) in NUMBERS.into_iter().zip(self.places.numbers) {
            numbers.push(match place {
                None => vec![None; names.len()],
                Some(place) => columns::numbers(group.as_ref(), place)
                    .map_err(|source| ParquetError::format(&self.path, source))?
                    .ok_or_else(|| self.refused(name, "numbers"))?,
            });
        }
        let at = |column: usize, row: usize| numbers[column].get(row).copied().flatten();
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
                day: None,
                rows: Vec::new(),
                warnings: Vec::new(),
            });
            self.row += 1;
            open.rows.push(Row {
                line: self.row as u64,
                measurement: Measurement {
                    // A row without a time cannot be after the last: the estimator drops and counts it.
                    time_s: at(0, row).unwrap_or(f64::NAN),
                    location_m: at(1, row),
                    speed_mps: at(2, row).map(|kmh| KmPerHour(kmh).to_mps()),
                    effort_n_per_kg: at(3, row),
                },
                temperature_c: None,
            });
        }
        self.group += 1;
        Ok(())
    }
}

fn places(path: &Path, reader: &SerializedFileReader<File>) -> Result<Places, ParquetError> {
    let schema = reader.metadata().file_metadata().schema_descr();
    let columns = schema.columns();
    let find = |name: &str| columns.iter().position(|column| column.name() == name);
    let needed = |name: &'static str, expected| {
        find(name).ok_or_else(|| ParquetError::Column {
            path: path.to_owned(),
            column: name,
            expected,
            found: "none of this name".to_owned(),
        })
    };
    let mut numbers = [None; NUMBERS.len()];
    for (place, (name, may_lack)) in numbers.iter_mut().zip(NUMBERS) {
        *place = match may_lack {
            true => find(name),
            false => Some(needed(name, "numbers")?),
        };
    }
    Ok(Places { run: needed("run", "texts")?, unit: find("unit"), direction: find("direction"), numbers })
}

/// Writes runs as [`RunReader`] reads them, each call a group of rows.
#[derive(Debug)]
pub struct RunWriter(TableWriter);

impl RunWriter {
    /// A file that will be made with the first runs.
    pub fn new(path: &Path) -> Self {
        Self(TableWriter::new(path))
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

fn record(run: &Recording, row: &Row) -> Record {
    let m = &row.measurement;
    let direction = match run.direction {
        Direction::Up => "up",
        Direction::Down => "down",
    };
    // Readings are km/h with a few decimals; the way through m/s must not leave crumbs.
    let kmh = |mps: f64| (3.6e6 * mps).round() / 1e6;
    vec![
        ("run".to_owned(), Cell::from(run.name.as_str())),
        ("unit".to_owned(), Cell::from(run.unit.as_str())),
        ("direction".to_owned(), Cell::from(direction)),
        ("time_s".to_owned(), Cell::from(m.time_s)),
        ("location_m".to_owned(), Cell::from(m.location_m)),
        ("speed_kmh".to_owned(), Cell::from(m.speed_mps.map(kmh))),
        ("effort_n_per_kg".to_owned(), Cell::from(m.effort_n_per_kg)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forty rows of a train that brakes.
    fn recording(index: u32) -> Recording {
        let row = |i: u32| Row {
            line: u64::from(i) + 2,
            measurement: Measurement {
                time_s: f64::from(10 * i),
                location_m: Some(300.0 * f64::from(i + index)),
                speed_mps: Some(30.0 - 0.7 * f64::from(i)),
                effort_n_per_kg: None,
            },
            temperature_c: None,
        };
        Recording {
            name: format!("run {index}"),
            path: "run.csv".into(),
            unit: "unit 7".to_owned(),
            direction: Direction::Up,
            day: None,
            rows: (0..40).map(row).collect(),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn runs_come_back_as_they_were_whatever_the_groups() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.parquet");
        let mut runs: Vec<Recording> = (0..3).map(recording).collect();
        runs[1].rows[7].measurement.location_m = None;
        runs[2].direction = Direction::Down;
        let mut writer = RunWriter::new(&path);
        writer.write(&runs[..2]).unwrap();
        writer.write(&runs[2..]).unwrap();
        writer.close().unwrap();
        let mut reader = RunReader::open(&path).unwrap();
        assert_eq!(reader.runs(), 3);
        for run in &runs {
            let found = reader.next_run().unwrap().unwrap();
            assert_eq!((&found.name, &found.unit, found.direction), (&run.name, &run.unit, run.direction));
            assert_eq!(found.rows.len(), run.rows.len());
            for (a, b) in found.rows.iter().zip(&run.rows) {
                assert_eq!(a.measurement, b.measurement);
            }
        }
        assert!(reader.next_run().unwrap().is_none());
    }

    #[test]
    fn what_is_missing_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.parquet");
        let mut writer = TableWriter::new(&path);
        let row = vec![("run".to_owned(), Cell::from("a")), ("time_s".to_owned(), Cell::from(0.0))];
        writer.write(&[row]).unwrap();
        writer.close().unwrap();
        let error = RunReader::open(&path).unwrap_err().to_string();
        assert!(
            error.ends_with("t.parquet: expected a column location_m of numbers, found none of this name"),
            "{error}"
        );
        std::fs::write(&path, "no such format").unwrap();
        assert!(RunReader::open(&path).is_err());
    }
}
