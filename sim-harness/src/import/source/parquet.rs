//! Parquet with flat columns; times become text or numbers as they are.

use super::row::{self, Each, Event, Header, RowField};
use ::parquet::basic::{LogicalType, TimeUnit};
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::record::Field as Value;
use ::parquet::schema::types::Type;
use jiff::tz::TimeZone;
use rundown_files::refusal::ReadError;
use std::fs::File;
use std::path::Path;

fn reader(path: &Path) -> Result<SerializedFileReader<File>, ReadError> {
    let file = File::open(path).map_err(|error| row::io(path, error))?;
    SerializedFileReader::new(file).map_err(|error| row::refused(path, error.to_string()))
}

pub fn headers(path: &Path) -> Result<Vec<Header>, ReadError> {
    let reader = reader(path)?;
    let fields = reader.metadata().file_metadata().schema().get_fields();
    Ok(fields.iter().map(|field| Header::new(field.name())).collect())
}

/// How the timestamps of a column count.
#[derive(Clone, Copy)]
struct Ticks {
    nanoseconds: i128,
    /// Since 1970 UTC; else they show the clock of a place, whose zone the file does not have.
    is_utc: bool,
}

impl Ticks {
    const fn utc(nanoseconds: i128) -> Self {
        Self { nanoseconds, is_utc: true }
    }

    fn of(column: &Type) -> Option<Self> {
        let Some(LogicalType::Timestamp(time)) = column.get_basic_info().logical_type_ref() else { return None };
        let nanoseconds = match time.unit {
            TimeUnit::MILLIS => 1_000_000,
            TimeUnit::MICROS => 1000,
            TimeUnit::NANOS => 1,
        };
        Some(Self { nanoseconds, is_utc: time.is_adjusted_to_u_t_c })
    }

    fn time(self, count: i64) -> RowField {
        let Ok(instant) = jiff::Timestamp::from_nanosecond(self.nanoseconds * i128::from(count)) else {
            return RowField::Empty;
        };
        let civil = || TimeZone::UTC.to_datetime(instant).to_string();
        RowField::Text(if self.is_utc { instant.to_string() } else { civil() })
    }
}

fn field(value: &Value, ticks: Option<Ticks>) -> RowField {
    // As a table of text has it: it is counted.
    let wrong = |number: f64| RowField::Text(number.to_string());
    let number = |number: f64| if number.is_finite() { RowField::Number(number) } else { wrong(number) };
    match value {
        Value::Byte(n) => number((*n).into()),
        Value::Short(n) => number((*n).into()),
        Value::Int(n) => number((*n).into()),
        Value::Long(n) => ticks.map_or_else(|| number(*n as f64), |ticks| ticks.time(*n)),
        Value::UByte(n) => number((*n).into()),
        Value::UShort(n) => number((*n).into()),
        Value::UInt(n) => number((*n).into()),
        Value::ULong(n) => number(*n as f64),
        Value::Float(n) => number((*n).into()),
        Value::Double(n) => number(*n),
        Value::Str(text) if !text.trim().is_empty() => RowField::Text(text.clone()),
        Value::TimestampMillis(n) => ticks.unwrap_or(Ticks::utc(1_000_000)).time(*n),
        Value::TimestampMicros(n) => ticks.unwrap_or(Ticks::utc(1000)).time(*n),
        Value::Null => RowField::Empty,
        other => RowField::Text(other.to_string()),
    }
}

pub fn rows(path: &Path, each: &mut Each) -> Result<(), ReadError> {
    let reader = reader(path)?;
    let schema = reader.metadata().file_metadata().schema();
    let ticks: Vec<Option<Ticks>> = schema.get_fields().iter().map(|column| Ticks::of(column)).collect();
    let rows = reader.get_row_iter(None).map_err(|error| row::refused(path, error.to_string()))?;
    for (index, found) in rows.enumerate() {
        let number = index as u64 + 1;
        let goes_on = match found {
            Ok(found) => {
                let columns = found.get_column_iter().zip(&ticks);
                let fields: Vec<RowField> = columns.map(|((_, value), ticks)| field(value, *ticks)).collect();
                each(Event::Row(number, &fields))
            }
            Err(error) => {
                each(Event::Bad(number, format!("expected a row, found: {error}; the rest of the file is lost")));
                false
            }
        };
        if !goes_on {
            break;
        }
    }
    Ok(())
}
