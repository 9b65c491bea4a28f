//! The header of a run log: which column is where, and what that makes of a row.

use crate::refusal::{IMPORT_TIP, Place, Refusal};
use crate::sample::{self, COLUMNS, LOCATION, NumberColumn, Sample, TIME};
use csv::StringRecord;
use std::path::PathBuf;

/// Which column is where.
pub(super) struct Header {
    path: PathBuf,
    names: Vec<String>,
    /// The known columns that are there, in the order of [`COLUMNS`], with their positions in a row.
    columns: Vec<(&'static NumberColumn, usize)>,
}

impl Header {
    pub(super) fn read(path: &std::path::Path, record: &StringRecord, line: u64) -> Result<Self, Refusal> {
        let names: Vec<String> = record.iter().map(str::to_owned).collect();
        let mut header = Self { path: path.to_owned(), names, columns: Vec::new() };
        for column in &COLUMNS {
            let mut positions = header.names.iter().enumerate().filter(|(_, name)| *name == column.name);
            let Some((first, _)) = positions.next() else { continue };
            if let Some((second, _)) = positions.next() {
                let message = format!("expected each column once, found it also as column {}", first + 1);
                return Err(header.place(line, second).refuse(column.name, message));
            }
            header.columns.push((column, first));
        }
        let missing = sample::missing(|name| header.has(name));
        if missing.is_empty() {
            return Ok(header);
        }
        let found = shortened(&header.names.join(","));
        let hint = match header.names.as_slice() {
            [only] if only.contains(';') => "; the separator must be a comma, not a semicolon",
            [only] if only.contains('\t') => "; the separator must be a comma, not a tab",
            _ if missing == [LOCATION] => "; latitude_deg and longitude_deg together may stand for it",
            _ => "",
        };
        let missing = missing.join(" and ");
        let message = format!("expected a header with {missing}, found {found:?}{hint}; {IMPORT_TIP}");
        Err(Place::of_line(path, line).refuse("", message))
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(column, _)| column.name == name)
    }

    pub(super) fn other_columns(&self) -> Vec<String> {
        self.names.iter().filter(|name| !self.has(name)).cloned().collect()
    }

    fn place(&self, line: u64, position: usize) -> Place {
        Place { column: Some(position + 1), ..Place::of_line(&self.path, line) }
    }

    /// A row, and what can be read in it and looks wrong. `latest_s` is the largest time so far.
    pub(super) fn sample(
        &self,
        record: &StringRecord,
        line: u64,
        latest_s: f64,
    ) -> Result<(Sample, Vec<Refusal>), Refusal> {
        if record.len() != self.names.len() {
            let message = format!("expected {} fields as in the header, found {}", self.names.len(), record.len());
            return Err(Place::of_line(&self.path, line).refuse("", message));
        }
        let mut sample = Sample { line, ..Sample::default() };
        let mut doubts = Vec::new();
        for &(column, position) in &self.columns {
            let refuse = |message: String| self.place(line, position).refuse(column.name, message);
            let field = &record[position];
            let is_time = column.name == TIME;
            if field.is_empty() {
                if is_time {
                    return Err(refuse("expected a time, found an empty field".to_owned()));
                }
                continue;
            }
            let value: f64 = field.parse().map_err(|_| {
                let found = shortened(field);
                refuse(format!("expected a number, found {found:?} (an empty field is a missing sample)"))
            })?;
            (column.set)(&mut sample, value);
            match column.doubt(value) {
                Some(doubt) if is_time => return Err(refuse(doubt)),
                None if is_time && value <= latest_s => {
                    doubts.push(refuse(format!("expected a time after {latest_s}, found {value}")));
                }
                doubt => doubts.extend(doubt.map(refuse)),
            }
        }
        Ok((sample, doubts))
    }
}

/// The beginning of a text that may be a whole file.
fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}
