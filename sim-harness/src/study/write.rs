//! Files of a study: pictures as SVG, their numbers as CSV, a row for each run as CSV and Parquet, the page.

use super::{figures::Picture, gather};
use crate::output::files::{failed, file};
pub use crate::output::files::{records, text};
use rundown_files::column::{self, about};
use rundown_files::{WriteError, parquet::TableWriter, table::Record};
use rundown_pages::chart::standalone;
use std::path::{Path, PathBuf};
use std::{fs::File, io};

pub const RUNS: &str = "runs";

pub fn pictures(folder: &Path, pictures: &[Picture]) -> Result<(), WriteError> {
    for picture in pictures {
        text(&folder.join(format!("{}.svg", picture.name)), &standalone(&picture.drawing.to_svg()))?;
        let numbers = folder.join(format!("{}.csv", picture.name));
        file(&numbers, |file| column::write_filled(file, &picture.numbers))?;
    }
    Ok(())
}

/// The table of all runs, written as the runs come: `runs.csv` and `runs.parquet`.
#[derive(Debug)]
pub struct RunTable {
    csv_path: PathBuf,
    csv: csv::Writer<File>,
    has_header: bool,
    parquet: TableWriter,
}

impl RunTable {
    pub fn begin(folder: &Path) -> Result<Self, WriteError> {
        let csv_path = folder.join(format!("{RUNS}.csv"));
        let file = File::create(&csv_path).map_err(|source| failed(&csv_path, source))?;
        Ok(Self {
            csv_path,
            csv: csv::Writer::from_writer(file),
            has_header: false,
            parquet: TableWriter::new(&folder.join(format!("{RUNS}.parquet")), about(gather::columns())),
        })
    }

    pub fn add(&mut self, records: &[Record]) -> io::Result<()> {
        for record in records {
            if !self.has_header {
                self.csv.write_record(record.iter().map(|(name, _)| name))?;
                self.has_header = true;
            }
            self.csv.write_record(record.iter().map(|(_, cell)| cell.to_field()))?;
        }
        self.parquet.write(records).map_err(io::Error::other)
    }

    pub fn end(mut self) -> Result<(), WriteError> {
        self.csv.flush().map_err(|source| failed(&self.csv_path, source))?;
        let parquet = self.parquet.close().map_err(io::Error::other);
        parquet.map_err(|source| failed(&self.csv_path.with_extension("parquet"), source))
    }
}
