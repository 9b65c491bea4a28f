//! Files of any kind as one thing: a header, then rows of fields. Text is streamed; sheets are held as a whole.

mod csv;
mod gpx;
mod json;
mod nmea;
mod parquet;
pub mod row;
mod sheet;

use row::{Each, Format, Header, Layout};
use rundown_files::refusal::ReadError;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A file whose layout is known.
#[derive(Clone, Debug)]
pub struct Source {
    pub path: PathBuf,
    pub layout: Layout,
    pub headers: Vec<Header>,
}

/// The kind of a file: by its name, else by its first bytes.
fn format_of(path: &Path) -> Result<Format, ReadError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let by_name = match extension.as_str() {
        "xlsx" | "xls" | "xlsm" | "xlsb" | "ods" => Some(Format::Sheet),
        "gpx" => Some(Format::Gpx),
        "nmea" | "nma" | "ubx" => Some(Format::Nmea),
        "jsonl" | "ndjson" | "json" => Some(Format::JsonLines),
        "parquet" | "pq" => Some(Format::Parquet),
        _ => None,
    };
    if let Some(format) = by_name {
        return Ok(format);
    }
    let mut head = Vec::new();
    let file = File::open(path).map_err(|error| row::io(path, error))?;
    file.take(512).read_to_end(&mut head).map_err(|error| row::io(path, error))?;
    let text = String::from_utf8_lossy(&head).into_owned();
    let text = text.trim_start_matches('\u{feff}').trim_start();
    Ok(match text {
        text if text.starts_with("PAR1") => Format::Parquet,
        text if text.starts_with("PK\u{3}\u{4}") || head.starts_with(&[0xd0, 0xcf, 0x11, 0xe0]) => Format::Sheet,
        text if text.contains("<gpx") => Format::Gpx,
        text if text.starts_with('{') => Format::JsonLines,
        text if ["$GP", "$GN", "$GL", "$GA"].iter().any(|talker| text.starts_with(talker)) => Format::Nmea,
        _ => Format::Csv,
    })
}

impl Source {
    /// Finds what the file does not say. `named` are columns that the mapping names.
    ///
    /// # Errors
    /// [`ReadError`] when the file cannot be read, or no header is found.
    pub fn open(path: &Path, wanted: &Layout, named: &[String]) -> Result<Self, ReadError> {
        log::info!("read {}", path.display());
        let format = wanted.format.map_or_else(|| format_of(path), Ok)?;
        let plain = Layout { format: Some(format), ..wanted.clone() };
        let (layout, headers) = match format {
            Format::Csv => csv::open(path, &plain, named)?,
            Format::Sheet => sheet::open(path, &plain, named)?,
            Format::Gpx => (plain, gpx::headers()),
            Format::Nmea => (plain, nmea::headers()),
            Format::JsonLines => (plain, json::headers(path)?),
            Format::Parquet => (plain, parquet::headers(path)?),
        };
        Ok(Self { path: path.to_owned(), layout, headers })
    }

    /// Every row, as long as `each` wants one.
    ///
    /// # Errors
    /// [`ReadError`] when the file cannot be read any further.
    pub fn rows(&self, each: &mut Each) -> Result<(), ReadError> {
        let path = &self.path;
        match self.layout.format.unwrap_or(Format::Csv) {
            Format::Csv => csv::rows(path, &self.layout, each),
            Format::Sheet => sheet::rows(path, &self.layout, each),
            Format::Gpx => gpx::rows(path, each),
            Format::Nmea => nmea::rows(path, each),
            Format::JsonLines => json::rows(path, &self.headers, each),
            Format::Parquet => parquet::rows(path, each),
        }
    }
}
