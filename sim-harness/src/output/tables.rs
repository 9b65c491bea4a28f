//! Tables of a replay, written as their rows come.

use super::files;
use rundown_files::WriteError;
use rundown_files::column::{self, Column};
use rundown_files::parquet::TableWriter;
use std::borrow::Borrow;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// How tables are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Comma-separated values
    #[default]
    Csv,
    /// Parquet with units and meanings in its metadata
    Parquet,
}

impl Format {
    /// The end of the names of its files.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }
}

/// Which tables a replay writes, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tables {
    /// How.
    pub format: Format,
    /// With a row for each tick; without, there are no such tables, and no report.
    pub each_tick: bool,
}

impl Default for Tables {
    fn default() -> Self {
        Self { format: Format::Csv, each_tick: true }
    }
}

/// A table that is being written.
pub struct Table<Row> {
    path: PathBuf,
    columns: Vec<Column<Row>>,
    to: To,
}

enum To {
    Csv(Box<csv::Writer<BufWriter<File>>>),
    Parquet(Box<TableWriter>),
}

impl<Row> Table<Row> {
    /// A table with its header. `name`: without its end.
    pub fn begin(folder: &Path, name: &str, columns: Vec<Column<Row>>, format: Format) -> Result<Self, WriteError> {
        let path = folder.join(format!("{name}.{}", format.extension()));
        let failed = |source: io::Error| files::failed(&path, source);
        let to = match format {
            Format::Csv => {
                let mut csv = csv::Writer::from_writer(BufWriter::new(File::create(&path).map_err(failed)?));
                let header = csv.write_record(columns.iter().map(|column| &column.about.name));
                header.map_err(io::Error::from).map_err(failed)?;
                To::Csv(Box::new(csv))
            }
            Format::Parquet => {
                let about = columns.iter().map(|column| column.about.clone()).collect();
                let mut writer = TableWriter::new(&path, about);
                writer.begin().map_err(io::Error::other).map_err(failed)?;
                To::Parquet(Box::new(writer))
            }
        };
        Ok(Self { path, columns, to })
    }

    /// Adds rows.
    pub fn add(&mut self, rows: impl IntoIterator<Item: Borrow<Row>>) -> Result<(), WriteError> {
        let added = match &mut self.to {
            To::Csv(csv) => rows.into_iter().try_for_each(|row| {
                let fields = self.columns.iter().map(|column| column.cell(row.borrow()).to_field());
                csv.write_record(fields).map_err(io::Error::from)
            }),
            To::Parquet(parquet) => parquet.add(column::cells(&self.columns, rows)).map_err(io::Error::other),
        };
        added.map_err(|source| files::failed(&self.path, source))
    }

    /// Ends the file.
    pub fn end(self) -> Result<(), WriteError> {
        let ended = match self.to {
            To::Csv(mut csv) => csv.flush(),
            To::Parquet(parquet) => parquet.close().map_err(io::Error::other),
        };
        ended.map_err(|source| files::failed(&self.path, source))
    }
}

/// A table of rows that are there.
pub fn whole<Row>(
    folder: &Path,
    name: &str,
    columns: Vec<Column<Row>>,
    format: Format,
    rows: impl IntoIterator<Item: Borrow<Row>>,
) -> Result<(), WriteError> {
    let mut table = Table::begin(folder, name, columns, format)?;
    table.add(rows)?;
    table.end()
}
