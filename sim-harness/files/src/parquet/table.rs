//! Records of a table, group by group.

use super::ParquetError;
use super::columns::{self, Values};
use crate::column::{About, Kind};
use crate::table::{Cell, Record};
use parquet::file::writer::SerializedFileWriter;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Writes records as they come; each call is a group of rows.
#[derive(Debug)]
pub struct TableWriter {
    path: PathBuf,
    columns: Vec<About>,
    writer: Option<SerializedFileWriter<File>>,
}

impl TableWriter {
    /// A file with these columns, which will be made with the first records.
    pub fn new(path: &Path, columns: Vec<About>) -> Self {
        Self { path: path.to_owned(), columns, writer: None }
    }

    /// Adds records with the cells of the columns. A cell of another kind than its column's is a missing value.
    ///
    /// # Errors
    /// [`ParquetError`] when the file cannot be written.
    pub fn write(&mut self, records: &[Record]) -> Result<(), ParquetError> {
        let of_column = |index: usize| -> Vec<Cell> {
            let cell = |record: &Record| record.get(index).map_or(Cell::Missing, |(_, cell)| cell.clone());
            records.iter().map(cell).collect()
        };
        self.add((0..self.columns.len()).map(of_column).collect())
    }

    /// Adds rows, given column by column; the same.
    ///
    /// # Errors
    /// As [`TableWriter::write`].
    pub fn add(&mut self, cells: Vec<Vec<Cell>>) -> Result<(), ParquetError> {
        if cells.first().is_none_or(Vec::is_empty) {
            return Ok(());
        }
        self.begin()?;
        let format = |source| ParquetError::format(&self.path, source);
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let mut group = writer.next_row_group().map_err(format)?;
        for (about, cells) in self.columns.iter().zip(cells) {
            columns::write(&mut group, &values(about.kind, cells)).map_err(format)?;
        }
        group.close().map_err(format)?;
        Ok(())
    }

    /// Makes the file, which else is made with the first record.
    ///
    /// # Errors
    /// As [`TableWriter::write`].
    pub fn begin(&mut self) -> Result<(), ParquetError> {
        if self.writer.is_some() {
            return Ok(());
        }
        let format = |source| ParquetError::format(&self.path, source);
        let file = File::create(&self.path).map_err(|source| ParquetError::io(&self.path, source))?;
        let schema = columns::schema(&self.columns).map_err(format)?;
        let writer = SerializedFileWriter::new(file, schema, columns::properties(&self.columns)).map_err(format)?;
        self.writer = Some(writer);
        Ok(())
    }

    /// Ends the file. Without a record, and not begun, there is none.
    ///
    /// # Errors
    /// As [`TableWriter::write`].
    pub fn close(mut self) -> Result<(), ParquetError> {
        if let Some(writer) = self.writer.take() {
            let path = self.path;
            writer.close().map_err(|source| ParquetError::format(&path, source))?;
        }
        Ok(())
    }
}

fn values(kind: Kind, cells: Vec<Cell>) -> Values {
    let cells = cells.into_iter();
    match kind {
        Kind::Text => Values::Texts(cells.map(|cell| if let Cell::Text(t) = cell { Some(t) } else { None }).collect()),
        Kind::Count => {
            Values::Counts(cells.map(|cell| if let Cell::Count(c) = cell { Some(c) } else { None }).collect())
        }
        Kind::Number => {
            Values::Numbers(cells.map(|cell| if let Cell::Number(n) = cell { Some(n) } else { None }).collect())
        }
    }
}
