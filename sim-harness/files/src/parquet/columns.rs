//! One column of one group of rows, into and out of plain vectors. Every column may have missing values.

use crate::column::{About, Kind};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::RowGroupReader;
use parquet::file::writer::SerializedRowGroupWriter;
use parquet::schema::types::{Type, TypePtr};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// The values of a column; none where one is missing.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Texts(Vec<Option<String>>),
    Counts(Vec<Option<u64>>),
    Numbers(Vec<Option<f64>>),
}

pub(super) fn schema(columns: &[About]) -> Result<TypePtr> {
    let field = |column: &About| {
        let (physical, logical) = match column.kind {
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Count => (Physical::INT64, None),
            Kind::Number => (Physical::DOUBLE, None),
        };
        Type::primitive_type_builder(&column.name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build()
            .map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<Vec<_>>>()?;
    let message = Type::group_type_builder("rundown").with_fields(fields);
    Ok(Arc::new(message.build()?))
}

/// Name of the metadata with the version of the writer.
pub(super) const VERSION: &str = "rundown.version";
/// Name of the metadata with unit, meaning and rule for missing values of each column, as JSON by the names of the
/// columns.
pub(super) const COLUMNS: &str = "rundown.columns";

pub(super) fn properties(columns: &[About]) -> Arc<WriterProperties> {
    let about = |column: &About| {
        let value = json!({ "unit": column.unit, "meaning": column.meaning, "null_when": column.empty });
        (column.name.clone(), value)
    };
    let described: Map<String, Value> = columns.iter().map(about).collect();
    let metadata = vec![
        KeyValue::new(VERSION.to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        KeyValue::new(COLUMNS.to_owned(), Value::Object(described).to_string()),
    ];
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_created_by("rundown".to_owned())
        .set_key_value_metadata(Some(metadata));
    Arc::new(properties.build())
}

/// Writes the next column of a group.
pub(super) fn write(
    group: &mut SerializedRowGroupWriter<'_, impl std::io::Write + Send>,
    values: &Values,
) -> Result<()> {
    match values {
        Values::Texts(texts) => write_as::<ByteArrayType, _>(group, texts, |t| ByteArray::from(t.as_str())),
        // The format has no whole numbers without a sign of this width; no count of ours needs the last bit.
        Values::Counts(counts) => write_as::<Int64Type, _>(group, counts, |count| *count as i64),
        Values::Numbers(numbers) => write_as::<DoubleType, _>(group, numbers, |number| *number),
    }
}

fn write_as<T: DataType, V>(
    group: &mut SerializedRowGroupWriter<'_, impl std::io::Write + Send>,
    values: &[Option<V>],
    of: impl Fn(&V) -> T::T,
) -> Result<()> {
    let there: Vec<T::T> = values.iter().flatten().map(of).collect();
    let levels: Vec<i16> = values.iter().map(|value| value.is_some().into()).collect();
    if let Some(mut column) = group.next_column()? {
        let typed = column.typed::<T>();
        typed.write_batch(&there, Some(&levels), None)?;
        column.close()?;
    }
    Ok(())
}

/// Reads a column of a group as numbers, of whatever width they are; none when it holds something else.
pub(super) fn numbers(group: &dyn RowGroupReader, column: usize) -> Result<Option<Vec<Option<f64>>>> {
    let rows = group.metadata().num_rows() as usize;
    Ok(match group.get_column_reader(column)? {
        ColumnReader::DoubleColumnReader(reader) => Some(read(reader, rows, |v| *v)?),
        ColumnReader::FloatColumnReader(reader) => Some(read::<FloatType, _>(reader, rows, |v| f64::from(*v))?),
        ColumnReader::Int32ColumnReader(reader) => Some(read::<Int32Type, _>(reader, rows, |v| f64::from(*v))?),
        ColumnReader::Int64ColumnReader(reader) => Some(read::<Int64Type, _>(reader, rows, |v| *v as f64)?),
        _ => None,
    })
}

/// Reads a column of a group as texts; none when it holds something else.
pub(super) fn texts(group: &dyn RowGroupReader, column: usize) -> Result<Option<Vec<Option<String>>>> {
    let rows = group.metadata().num_rows() as usize;
    let text = |bytes: &ByteArray| String::from_utf8_lossy(bytes.data()).into_owned();
    Ok(match group.get_column_reader(column)? {
        ColumnReader::ByteArrayColumnReader(reader) => Some(read(reader, rows, text)?),
        _ => None,
    })
}

fn read<T: DataType, V>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    of: impl Fn(&T::T) -> V,
) -> Result<Vec<Option<V>>> {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    let mut read = 0;
    while read < rows {
        let (records, ..) = reader.read_records(rows - read, Some(&mut levels), None, &mut values)?;
        if records == 0 {
            break;
        }
        read += records;
    }
    if levels.is_empty() {
        // A column whose values may not be missing has no levels.
        return Ok(values.iter().map(|value| Some(of(value))).collect());
    }
    let mut values = values.iter();
    let there = |level: &i16| (*level > 0).then(|| values.next().map(&of)).flatten();
    Ok(levels.iter().map(there).collect())
}
