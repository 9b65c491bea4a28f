//! Records of a table, group by group.

use super::ParquetError;
use super::columns::{self, Kind, Values};
use crate::table::{Cell, Record};
use parquet::file::writer::SerializedFileWriter;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Writes records of the same names as they come; each call is a group of rows.
#[derive(Debug)]
pub struct TableWriter {
    path: PathBuf,
    kinds: Vec<(String, Kind)>,
    writer: Option<SerializedFileWriter<File>>,
}

impl TableWriter {
    /// A file that will be made with the first records.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), kinds: Vec::new(), writer: None }
    }

    /// Adds records. The first ones say what the columns hold; one without any value holds numbers.
    ///
    /// # Errors
    /// [`ParquetError`] when the file cannot be written.
    pub fn write(&mut self, records: &[Record]) -> Result<(), ParquetError> {
        let Some(first) = records.first() else {
            return Ok(());
        };
        if self.writer.is_none() {
            let kind = |index: usize| {
                let cells = records.iter().filter_map(|record| record.get(index));
                let mut kinds = cells.filter_map(|(_, cell)| kind_of(cell));
                kinds.next().unwrap_or(Kind::Number)
            };
            let names = first.iter().enumerate();
            self.kinds = names.map(|(i, (name, _))| (name.clone(), kind(i))).collect();
        }
        let columns: Vec<Values> =
            (0..self.kinds.len()).map(|index| column(records, index, self.kinds[index].1)).collect();
        self.write_columns(&columns)
    }

    fn write_columns(&mut self, columns: &[Values]) -> Result<(), ParquetError> {
        let path = &self.path;
        let format = |source| ParquetError::format(path, source);
        let writer = match &mut self.writer {
            Some(writer) => writer,
            None => {
                let file = File::create(path).map_err(|source| ParquetError::io(path, source))?;
                let schema = columns::schema(&self.kinds).map_err(format)?;
                let properties = columns::properties();
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

fn kind_of(cell: &Cell) -> Option<Kind> {
    match cell {
        Cell::Text(_) => Some(Kind::Text),
        Cell::Count(_) => Some(Kind::Count),
        Cell::Number(_) => Some(Kind::Number),
        Cell::Missing => None,
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
