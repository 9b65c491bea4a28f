//! Tables for people and machines: the same records as CSV and as JSON.
//!
//! Numbers are written with as few digits as give the reader the very bits back. What is missing is an
//! empty field in CSV and `null` in JSON; a number that is not finite is missing.

use serde_json::{Map, Value};
use std::io::{self, Write};

/// One cell.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "named by what it holds")]
pub enum Cell {
    Text(String),
    Count(u64),
    Number(f64),
    Missing,
}

/// One row: names with their cells. All rows of a table have the same names.
pub type Record = Vec<(String, Cell)>;

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Option<&str>> for Cell {
    fn from(text: Option<&str>) -> Self {
        text.map_or(Self::Missing, Self::from)
    }
}

impl From<bool> for Cell {
    fn from(yes: bool) -> Self {
        Self::Count(u64::from(yes))
    }
}

impl From<u32> for Cell {
    fn from(count: u32) -> Self {
        Self::Count(u64::from(count))
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        if number.is_finite() { Self::Number(number) } else { Self::Missing }
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Missing, Self::from)
    }
}

impl Cell {
    /// As a field of CSV.
    pub fn to_field(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(number) => exact(*number),
            Self::Missing => String::new(),
        }
    }

    fn to_value(&self) -> Value {
        match self {
            Self::Text(text) => Value::from(text.as_str()),
            Self::Count(count) => Value::from(*count),
            Self::Number(number) => Value::from(*number),
            Self::Missing => Value::Null,
        }
    }
}

/// The fewest digits of which reading gives the same bits.
///
/// ```
/// assert_eq!(rundown_files::table::exact(0.1), "0.1");
/// assert_eq!(rundown_files::table::exact(0.1 + 0.2), "0.30000000000000004");
/// ```
pub fn exact(number: f64) -> String {
    format!("{number:?}")
}

/// Writes records of the same names, a header line first.
///
/// # Errors
/// Those of `writer`.
pub fn write_csv(writer: impl Write, records: &[Record]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    if let Some(first) = records.first() {
        csv.write_record(first.iter().map(|(name, _)| name))?;
    }
    for record in records {
        csv.write_record(record.iter().map(|(_, cell)| cell.to_field()))?;
    }
    csv.flush()
}

/// A record as a JSON object, its names in their order.
pub fn to_json(record: &Record) -> Value {
    let object: Map<String, Value> = record.iter().map(|(name, cell)| (name.clone(), cell.to_value())).collect();
    Value::Object(object)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_is_empty_and_null_never_nan() {
        let record: Record = vec![
            ("run".to_owned(), Cell::from("a,b")),
            ("count".to_owned(), Cell::from(3_u32)),
            ("mean".to_owned(), Cell::from(f64::NAN)),
            ("sd".to_owned(), Cell::from(Some(0.1))),
        ];
        let mut bytes = Vec::new();
        write_csv(&mut bytes, std::slice::from_ref(&record)).unwrap();
        assert_eq!(String::from_utf8(bytes).unwrap(), "run,count,mean,sd\n\"a,b\",3,,0.1\n");
        assert_eq!(to_json(&record).to_string(), r#"{"run":"a,b","count":3,"mean":null,"sd":0.1}"#);
    }

    #[test]
    fn the_fewest_digits_give_the_bits_back() {
        for number in [0.1, 1.0 / 3.0, 6.02e23, -1e-300, 0.0, f64::MAX] {
            assert_eq!(exact(number).parse::<f64>().unwrap().to_bits(), number.to_bits());
        }
    }
}
