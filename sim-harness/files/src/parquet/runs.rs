//! Run logs in one file: the rows of a run follow each other, runs one after the other.

use super::columns;
use super::{ParquetError, TableWriter};
use crate::map_matching::CentreLine;
use crate::recording::Recording;
use crate::refusal::Place;
use crate::run_rows::{Batch, Places, Recordings, TEXTS, run_columns};
use crate::sample::{COLUMNS, Sample};
use crate::table::{Cell, Record};
use parquet::file::reader::{FileReader, SerializedFileReader};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Reads runs, holding one group of rows and one run at a time.
pub struct RunReader {
    path: PathBuf,
    reader: SerializedFileReader<File>,
    runs: usize,
    group: usize,
    places: Places,
    recordings: Recordings,
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
        let places = Places::find(path, &names)?;
        let recordings = Recordings::new(path, &places, line);
        let mut opened = Self { path: path.to_owned(), runs: 0, group: 0, places, recordings, reader };
        let mut last = None;
        for group in 0..opened.reader.num_row_groups() {
            for run in opened.texts(group, 0)?.into_iter().zip(opened.texts(group, 1)?) {
                if last.as_ref() != Some(&run) {
                    opened.runs += 1;
                    last = Some(run);
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
        while !self.recordings.is_ready() && self.group < self.reader.num_row_groups() {
            let batch = self.batch(self.group)?;
            self.recordings.add(&batch)?;
            self.group += 1;
        }
        let is_ended = !self.recordings.is_ready();
        Ok(self.recordings.next(is_ended)?)
    }

    /// The fields of a column of texts; all missing where there is no such column.
    fn texts(&self, group: usize, column: usize) -> Result<Vec<Option<String>>, ParquetError> {
        let format = |source| ParquetError::format(&self.path, source);
        let group = self.reader.get_row_group(group).map_err(format)?;
        let Some(place) = self.places.texts[column] else {
            return Ok(vec![None; group.metadata().num_rows() as usize]);
        };
        let texts = columns::texts(group.as_ref(), place).map_err(format)?;
        texts.ok_or_else(|| self.refused(TEXTS[column], "texts"))
    }

    fn refused(&self, column: &str, expected: &str) -> ParquetError {
        let message = format!("expected {expected} in this column, found another type");
        Place::of_file(&self.path).refuse(column, message).into()
    }

    fn batch(&self, index: usize) -> Result<Batch, ParquetError> {
        let texts = [self.texts(index, 0)?, self.texts(index, 1)?, self.texts(index, 2)?, self.texts(index, 3)?];
        let format = |source| ParquetError::format(&self.path, source);
        let group = self.reader.get_row_group(index).map_err(format)?;
        let mut numbers = Vec::with_capacity(self.places.numbers.len());
        for &(column, place) in &self.places.numbers {
            let values = columns::numbers(group.as_ref(), place).map_err(format)?;
            numbers.push((column, values.ok_or_else(|| self.refused(column.name, "numbers"))?));
        }
        Ok(Batch { texts, numbers })
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
    let texts = [run.name.as_str(), run.unit.as_str(), run.direction.as_str(), run.driver.as_str()];
    let texts = TEXTS.into_iter().zip(texts);
    let texts = texts.map(|(name, text)| (name.to_owned(), Cell::from(text)));
    let numbers = COLUMNS.iter().map(|column| (column.name.to_owned(), Cell::from((column.get)(row))));
    texts.chain(numbers).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::column::{About, Kind};
    use crate::track_file::CentreLinePoint;
    use rundown::model::direction::Direction;

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
            driver: format!("driver {index}"),
            rows: (0..40).map(row).collect(),
            ..Recording::default()
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
