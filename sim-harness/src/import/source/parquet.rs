//! Parquet with flat columns; times become text or numbers as they are.

use super::row::{self, Each, Event, Header, RowField};
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::record::Field as Value;
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

fn instant(microseconds: i64) -> RowField {
    let instant = jiff::Timestamp::from_microsecond(microseconds);
    instant.map_or(RowField::Empty, |instant| RowField::Text(instant.to_string()))
}

fn field(value: &Value) -> RowField {
    let number = |number: f64| if number.is_finite() { RowField::Number(number) } else { RowField::Empty };
    match value {
        Value::Byte(n) => number((*n).into()),
        Value::Short(n) => number((*n).into()),
        Value::Int(n) => number((*n).into()),
        Value::Long(n) => number(*n as f64),
        Value::UByte(n) => number((*n).into()),
        Value::UShort(n) => number((*n).into()),
        Value::UInt(n) => number((*n).into()),
        Value::ULong(n) => number(*n as f64),
        Value::Float(n) => number((*n).into()),
        Value::Double(n) => number(*n),
        Value::Str(text) if !text.trim().is_empty() => RowField::Text(text.clone()),
        Value::TimestampMillis(n) => n.checked_mul(1000).map_or(RowField::Empty, instant),
        Value::TimestampMicros(n) => instant(*n),
        Value::Null => RowField::Empty,
        other => RowField::Text(other.to_string()),
    }
}

pub fn rows(path: &Path, each: &mut Each) -> Result<(), ReadError> {
    let reader = reader(path)?;
    let rows = reader.get_row_iter(None).map_err(|error| row::refused(path, error.to_string()))?;
    for (index, found) in rows.enumerate() {
        let number = index as u64 + 1;
        let goes_on = match found {
            Ok(found) => {
                let fields: Vec<RowField> = found.get_column_iter().map(|(_, value)| field(value)).collect();
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
