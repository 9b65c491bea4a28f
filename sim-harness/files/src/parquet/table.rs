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
        if records.is_empty() {
            return Ok(());
        }
        let values = |(index, about): (usize, &About)| column(records, index, about.kind);
        let columns: Vec<Values> = self.columns.iter().enumerate().map(values).collect();
        self.write_columns(&columns)
    }

    fn write_columns(&mut self, columns: &[Values]) -> Result<(), ParquetError> {
        let path = &self.path;
        let format = |source| ParquetError::format(path, source);
        let writer = match &mut self.writer {
            Some(writer) => writer,
            None => {
                let file = File::create(path).map_err(|source| ParquetError::io(path, source))?;
                let schema = columns::schema(&self.columns).map_err(format)?;
                let properties = columns::properties(&self.columns);
                let writer = SerializedFileWriter::new(file, schema, properties).map_err(format)?;
                self.writer.insert(writer)
            }
        };
        let mut group = writer.next_row_group().map_err(format)?;
        for values in columns {
            columns::write(&mut group, values).map_err(format)?;
        }
        group.close().map_err(format)?;
        Ok(())
    }

    /// Ends the file. Without a record there is none.
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

fn column(records: &[Record], index: usize, kind: Kind) -> Values {
    let cells = records.iter().map(|record| record.get(index).map(|(_, cell)| cell));
    match kind {
        Kind::Text => Values::Texts(
            cells.map(|cell| if let Some(Cell::Text(t)) = cell { Some(t.clone()) } else { None }).collect(),
        ),
        Kind::Count => {
            Values::Counts(cells.map(|cell| if let Some(Cell::Count(c)) = cell { Some(*c) } else { None }).collect())
        }
        Kind::Number => {
            Values::Numbers(cells.map(|cell| if let Some(Cell::Number(n)) = cell { Some(*n) } else { None }).collect())
        }
    }
}
