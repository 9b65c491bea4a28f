//! What every source gives: a header, then rows of fields.

use crate::import::meaning::Meaning;
use crate::import::number;
use crate::import::units::{self, Unit};
use rundown_files::refusal::{Place, ReadError};
use serde::{Deserialize, Serialize};
use std::path::Path;

#[derive(Clone, Debug, Default, PartialEq)]
pub enum RowField {
    #[default]
    Empty,
    Text(String),
    Number(f64),
}

impl RowField {
    /// As a text; none where there is nothing in it.
    pub fn text(&self) -> Option<String> {
        match self {
            Self::Empty => None,
            Self::Text(text) => Some(text.trim().to_owned()).filter(|text| !text.is_empty()),
            Self::Number(number) => Some(number.to_string()),
        }
    }

    /// As a number, whatever the decimal sign.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Empty => None,
            Self::Number(number) => Some(*number),
            Self::Text(text) => {
                number::parse(text, if text.contains(',') { ',' } else { '.' }).map(|(number, _)| number)
            }
        }
    }
}

/// What comes out of a file, line by line.
#[derive(Debug)]
pub enum Event<'a> {
    Row(u64, &'a [RowField]),
    /// Something that is no row: line, what was expected and found.
    Bad(u64, String),
    /// A value that is left out: line, why, what was expected and found.
    LeftOut(u64, &'static str, String),
    /// The row that comes next has fewer or more fields than the header: line, how many the header and it have.
    Ragged(u64, (usize, usize)),
    /// The rows of another sheet begin.
    Sheet(&'a str),
}

/// Takes one event after the other; false: no more, please.
pub type Each<'e> = dyn FnMut(Event) -> bool + 'e;

/// The kinds of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SourceFormat {
    Csv,
    Sheet,
    Gpx,
    Nmea,
    JsonLines,
    Parquet,
}

/// How a file is laid out; what is not said is found.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layout {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub format: Option<SourceFormat>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encoding: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delimiter: Option<char>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decimal: Option<char>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub header_line: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sheet: Option<String>,
    /// Columns of a table that has one signal in each row: its name, and its value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signal: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<String>,
}

/// A name of a column and its unit, as the header has them.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Header {
    /// As it stands.
    pub written: String,
    /// Without the unit.
    pub name: String,
    pub unit: Option<String>,
}

impl Header {
    pub fn new(written: &str) -> Self {
        let (name, unit) = units::split(written);
        Self { written: written.trim().trim_start_matches('\u{feff}').to_owned(), name, unit }
    }

    /// It is one of those of a mapping.
    pub fn is_among(&self, named: &[String]) -> bool {
        named.iter().any(|name| name.trim() == self.written)
    }

    /// The unit of this kind that it names, whatever else: `Geschw. [km/h]`, `tempo_kmh`.
    pub fn unit_of(&self, meaning: Meaning) -> Option<Unit> {
        // Times are in ms, forces in kN.
        let ambiguous = |unit: &str| unit == "ms" || unit != "kn" && unit.eq_ignore_ascii_case("kn");
        let known = |unit: &str| units::by_name(meaning, unit).filter(|_| !ambiguous(unit.trim()));
        let behind = self.written.match_indices('_').map(|(at, _)| self.written[at + 1..].replace('_', " "));
        self.unit.iter().cloned().chain(behind).find_map(|unit| known(&unit))
    }
}

pub fn io(path: &Path, source: std::io::Error) -> ReadError {
    ReadError::Io { path: path.to_owned(), source }
}

pub fn refused(path: &Path, message: impl Into<String>) -> ReadError {
    Place::of_file(path).refuse("", message).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_of_speed_is_seen_behind_any_name() {
        for (header, unit) in [
            ("Geschw. [km/h]", Some("km/h")),
            ("Tempo (km/h)", Some("km/h")),
            ("snelheid_m_s", Some("m/s")),
            ("Fart [kn]", Some("knots")),
            ("Z [kN]", None),
            ("Latency [ms]", None),
            ("Snelheid", None),
        ] {
            assert_eq!(Header::new(header).unit_of(Meaning::Speed).map(|unit| unit.name), unit, "{header}");
        }
    }
}
