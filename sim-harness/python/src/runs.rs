//! The runs of a call: paths, or a table of another tool.
//!
//! In: whatever has Arrow's PyCapsule interface (`__arrow_c_stream__`): a table of pyarrow, a frame of polars or pandas, a relation of DuckDB.
//! Out: its rows by the columns of Parquet files of runs. A column of another type is refused by its name.

use crate::error::unread;
use crate::paths::Paths;
use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::RecordBatchStreamReader;
use arrow_array::types::{
    ArrowPrimitiveType, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, RecordBatch, RecordBatchReader};
use arrow_pyarrow::FromPyArrow;
use arrow_schema::DataType;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use rundown_files::refusal::{Place, Refusal};
use rundown_files::run_rows::{Batch, Places, RunTable, TEXTS};
use sim_harness::replaying::Runs;
use std::path::{Path, PathBuf};

/// What stands for the file in messages.
const NAME: &str = "runs";

/// The argument `runs`.
pub fn of(argument: &Bound<'_, PyAny>) -> PyResult<Runs> {
    if argument.hasattr("__arrow_c_stream__")? {
        return table(argument).map(Runs::Table);
    }
    if let Ok(paths) = argument.extract::<Paths>() {
        return Ok(Runs::Paths(paths.into()));
    }
    let several = argument.try_iter().and_then(|all| all.map(|path| path?.extract::<PathBuf>()).collect());
    several.map(Runs::Paths).map_err(|_| {
        let found = argument.get_type();
        let collect = if argument.hasattr("collect").unwrap_or(false) { ": call its collect()" } else { "" };
        let expected = "expected a path, several paths, or a table with Arrow's interface (polars, pandas from 2.2, pyarrow, DuckDB)";
        PyTypeError::new_err(format!("runs: {expected}, found {found}{collect}"))
    })
}

fn table(argument: &Bound<'_, PyAny>) -> PyResult<RunTable> {
    let reader = RecordBatchStreamReader::from_pyarrow_bound(argument)?;
    let names: Vec<String> = reader.schema().fields().iter().map(|field| field.name().clone()).collect();
    let places = Places::find(Path::new(NAME), &names).map_err(|refusal| unread(refusal.into()))?;
    let mut batches = Vec::new();
    for part in reader {
        let part = part.map_err(crate::error::refused)?;
        batches.push(batch(&places, &part).map_err(|refusal| unread(refusal.into()))?);
    }
    Ok(RunTable { path: NAME.into(), places, batches })
}

fn batch(places: &Places, part: &RecordBatch) -> Result<Batch, Refusal> {
    let text = |index: usize| match places.texts[index] {
        None => Ok(vec![None; part.num_rows()]),
        Some(place) => texts(part.column(place)).ok_or_else(|| refused(TEXTS[index], "texts", part.column(place))),
    };
    let number = |&(column, place): &(&'static _, usize)| {
        let column: &'static rundown_files::sample::NumberColumn = column;
        let values = numbers(part.column(place)).ok_or_else(|| refused(column.name, "numbers", part.column(place)))?;
        Ok((column, values))
    };
    let numbers = places.numbers.iter().map(number).collect::<Result<Vec<_>, Refusal>>()?;
    Ok(Batch { texts: [text(0)?, text(1)?, text(2)?, text(3)?], numbers })
}

fn refused(column: &str, expected: &str, found: &ArrayRef) -> Refusal {
    let message = format!("expected {expected} in this column, found {}", found.data_type());
    Place::of_file(NAME).refuse(column, message)
}

/// None where they are something else.
fn texts(array: &ArrayRef) -> Option<Vec<Option<String>>> {
    let owned = |text: Option<&str>| text.map(str::to_owned);
    Some(match array.data_type() {
        DataType::Utf8 => array.as_string::<i32>().iter().map(owned).collect(),
        DataType::LargeUtf8 => array.as_string::<i64>().iter().map(owned).collect(),
        DataType::Utf8View => array.as_string_view().iter().map(owned).collect(),
        DataType::Null => vec![None; array.len()],
        // Numbers of runs are names, too.
        kind if kind.is_integer() => numbers(array)?.into_iter().map(|number| Some(number?.to_string())).collect(),
        // Categories of pandas and polars, enumerations of DuckDB.
        DataType::Dictionary(..) => {
            let dictionary = array.as_any_dictionary_opt()?;
            let words = texts(dictionary.values())?;
            let word =
                |(row, key): (usize, usize)| dictionary.keys().is_valid(row).then(|| words.get(key).cloned())??;
            dictionary.normalized_keys().into_iter().enumerate().map(word).collect()
        }
        _ => return None,
    })
}

/// None where they are something else.
fn numbers(array: &ArrayRef) -> Option<Vec<Option<f64>>> {
    Some(match array.data_type() {
        DataType::Float64 => values::<Float64Type>(array, |value| value),
        DataType::Float32 => values::<Float32Type>(array, f64::from),
        DataType::Int8 => values::<Int8Type>(array, f64::from),
        DataType::Int16 => values::<Int16Type>(array, f64::from),
        DataType::Int32 => values::<Int32Type>(array, f64::from),
        DataType::Int64 => values::<Int64Type>(array, |value| value as f64),
        DataType::UInt8 => values::<UInt8Type>(array, f64::from),
        DataType::UInt16 => values::<UInt16Type>(array, f64::from),
        DataType::UInt32 => values::<UInt32Type>(array, f64::from),
        DataType::UInt64 => values::<UInt64Type>(array, |value| value as f64),
        DataType::Null => vec![None; array.len()],
        _ => return None,
    })
}

fn values<T: ArrowPrimitiveType>(array: &ArrayRef, of: impl Fn(T::Native) -> f64) -> Vec<Option<f64>> {
    array.as_primitive::<T>().iter().map(|value| value.map(&of)).collect()
}
