//! The runs of a call: paths, or tables of another tool.
//!
//! In: whatever has Arrow's PyCapsule interface (`__arrow_c_stream__`): a table of pyarrow, a frame of polars or
//! pandas, a relation of DuckDB; several in a list, or with names in a dictionary. Out: their rows by the columns of
//! Parquet files of runs. A column of another type is refused by its name.

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
use arrow_schema::{ArrowError, DataType};
use pyo3::exceptions::{PyImportError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rundown_files::refusal::{Place, ReadError, Refusal};
use rundown_files::run_rows::{Batch, Places, RunTable, TEXTS};
use rundown_files::sample::{NumberColumn, TIME};
use sim_harness::replaying::Runs;
use std::path::PathBuf;

/// The interface of a table.
const STREAM: &str = "__arrow_c_stream__";

/// The argument `runs`.
pub fn of(argument: &Bound<'_, PyAny>) -> PyResult<Runs> {
    if argument.hasattr(STREAM)? {
        let one = Arrived { path: "runs".into(), run: Run::InColumn };
        return Ok(Runs::Tables(vec![one.table(argument)?]));
    }
    if let Ok(named) = argument.cast::<PyDict>() {
        return tables(named.iter().map(|(name, table)| {
            let arrived =
                Arrived { path: format!("runs[{}]", name.repr()?).into(), run: Run::Named(name.str()?.to_string()) };
            Ok((arrived, table))
        }));
    }
    if let Ok(paths) = argument.extract::<Paths>() {
        return Ok(Runs::Paths(paths.into()));
    }
    // What a generator raises is its own.
    let several = argument.try_iter().map_err(|_| unknown(argument))?.collect::<PyResult<Vec<_>>>()?;
    if several.first().is_some_and(|first| first.hasattr(STREAM).unwrap_or(false)) {
        return tables(several.into_iter().enumerate().map(|(index, table)| {
            let run = Run::InColumnOr(format!("table{}", index + 1));
            Ok((Arrived { path: format!("runs[{index}]").into(), run }, table))
        }));
    }
    let paths: PyResult<Vec<PathBuf>> = several.iter().map(|path| path.extract()).collect();
    paths.map(Runs::Paths).map_err(|_| unknown(argument))
}

fn unknown(argument: &Bound<'_, PyAny>) -> PyErr {
    let found = argument.get_type();
    let collect = if argument.hasattr("collect").unwrap_or(false) { ": call its collect()" } else { "" };
    let expected = "expected a path, several paths, or a table with Arrow's interface (polars, pandas from 2.2, pyarrow, DuckDB) or several";
    PyTypeError::new_err(format!("runs: {expected}, found {found}{collect}"))
}

/// Each with rows: one that was filtered to nothing is no run.
fn tables<'py>(several: impl Iterator<Item = PyResult<(Arrived, Bound<'py, PyAny>)>>) -> PyResult<Runs> {
    let one = |arrived: PyResult<(Arrived, Bound<'py, PyAny>)>| {
        let (arrived, argument) = arrived?;
        if !argument.hasattr(STREAM)? {
            let (path, found) = (arrived.path.display(), argument.get_type());
            return Err(PyTypeError::new_err(format!(
                "{path}: expected a table with Arrow's interface, found {found}"
            )));
        }
        let table = arrived.table(&argument)?;
        if table.batches.iter().all(|batch| batch.texts[0].is_empty()) {
            return Err(unread(Place::of_file(&arrived.path).refuse("", "expected rows, found none").into()));
        }
        Ok(table)
    };
    several.map(one).collect::<PyResult<Vec<RunTable>>>().map(Runs::Tables)
}

/// A table before it is read.
struct Arrived {
    /// What stands for the file in messages.
    path: PathBuf,
    run: Run,
}

/// How the runs of a table are named.
enum Run {
    /// By the column.
    InColumn,
    /// By the column, or without it all rows are one run of this name.
    InColumnOr(String),
    /// All rows are one run of this name; where there is a column it says the same.
    Named(String),
}

impl Arrived {
    fn table(&self, argument: &Bound<'_, PyAny>) -> PyResult<RunTable> {
        let reader = RecordBatchStreamReader::from_pyarrow_bound(argument);
        let reader = reader.map_err(|error| self.lacking(argument, error))?;
        let names: Vec<String> = reader.schema().fields().iter().map(|field| field.name().clone()).collect();
        self.read(reader, names).map_err(unread)
    }

    /// Frames of pandas become Arrow by another package, which pandas does not bring.
    fn lacking(&self, argument: &Bound<'_, PyAny>, error: PyErr) -> PyErr {
        let py = argument.py();
        if !error.is_instance_of::<PyImportError>(py) {
            return error;
        }
        let (path, found) = (self.path.display(), argument.get_type());
        let text = format!("{path}: expected a package that makes Arrow of {found}, found none: `pip install pyarrow`");
        let said = PyImportError::new_err(text);
        said.set_cause(py, Some(error));
        said
    }

    fn read(
        &self,
        parts: impl Iterator<Item = Result<RecordBatch, ArrowError>>,
        mut names: Vec<String>,
    ) -> Result<RunTable, ReadError> {
        let has_run = names.iter().any(|name| name == TEXTS[0]);
        if !has_run && self.run.name().is_none() {
            let message =
                "expected a column of this name, found none; in a list a table without it is a run: runs=[table]";
            return Err(self.refuse(TEXTS[0], message.to_owned()).into());
        }
        if !has_run {
            // Behind the others, where no part has a column.
            names.push(TEXTS[0].to_owned());
        }
        let places = Places::find(&self.path, &names)?;
        let mut batches = Vec::new();
        for part in parts {
            let part = part.map_err(|error| self.refuse("", error.to_string()))?;
            batches.push(self.batch(&places, &part)?);
        }
        if !has_run {
            self.check_one_run(&batches)?;
        }
        Ok(RunTable { path: self.path.clone(), places, batches })
    }

    fn batch(&self, places: &Places, part: &RecordBatch) -> Result<Batch, Refusal> {
        let refused = |column: &str, expected: &str, found: &ArrayRef| {
            let kind = found.data_type();
            let mend = if kind.is_temporal() { "; seconds are (t - t.min()).dt.total_seconds() in pandas" } else { "" };
            self.refuse(column, format!("expected {expected} in this column, found {kind}{mend}"))
        };
        let text = |index: usize| match places.texts[index].map(|place| part.columns().get(place)) {
            None => Ok(vec![None; part.num_rows()]),
            Some(None) => Ok(vec![self.run.name().map(str::to_owned); part.num_rows()]),
            Some(Some(column)) => texts(column).ok_or_else(|| refused(TEXTS[index], "texts or whole numbers", column)),
        };
        let number = |&(column, place): &(&'static _, usize)| {
            let column: &'static NumberColumn = column;
            let found = part.column(place);
            Ok((column, numbers(found).ok_or_else(|| refused(column.name, "numbers", found))?))
        };
        let numbers = places.numbers.iter().map(number).collect::<Result<Vec<_>, Refusal>>()?;
        let texts = [text(0)?, text(1)?, text(2)?, text(3)?];
        if let Run::Named(name) = &self.run
            && let Some(other) = texts[0].iter().find(|found| found.as_ref() != Some(name))
        {
            let found = other.as_deref().unwrap_or_default();
            return Err(self.refuse(TEXTS[0], format!("expected {name:?}, the name of the table, found {found:?}")));
        }
        Ok(Batch { texts, numbers })
    }

    /// Runs one after the other in a table that does not say so would be one, and all but the first be dropped as a
    /// clock that goes back.
    fn check_one_run(&self, batches: &[Batch]) -> Result<(), Refusal> {
        let of = |batch: &Batch| batch.numbers.iter().find(|(column, _)| column.name == TIME).map(|(_, t)| t.clone());
        let times = batches.iter().filter_map(of).flatten().flatten().filter(|time_s| time_s.is_finite());
        let mut last_s = f64::NEG_INFINITY;
        for time_s in times {
            if time_s < last_s {
                let message = format!(
                    "expected times that rise, as there is no column run, found {time_s} after {last_s}: name the runs in a column run"
                );
                return Err(self.refuse(TIME, message));
            }
            last_s = time_s;
        }
        Ok(())
    }

    fn refuse(&self, field: &str, message: String) -> Refusal {
        Place::of_file(&self.path).refuse(field, message)
    }
}

impl Run {
    fn name(&self) -> Option<&str> {
        match self {
            Self::InColumn => None,
            Self::InColumnOr(name) | Self::Named(name) => Some(name),
        }
    }
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
