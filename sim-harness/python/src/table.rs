//! A table for other tools: Arrow, handed over without a copy.
//!
//! In: columns as the writer of a file has them. Out: the PyCapsule interface (`__arrow_c_stream__`), which pandas,
//! polars, pyarrow and DuckDB read. Unit, meaning and rule for empty cells are metadata of each field.

use crate::error::refused;
use crate::table_html;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList, PyType};
use rundown_files::column::{About, Filled, Kind};
use rundown_files::table::Cell;
use std::collections::HashMap;
use std::sync::Arc;

/// A table. Take it whole with `pandas.DataFrame.from_arrow(table)`, `polars.DataFrame(table)`, `pyarrow.table(table)`
/// or DuckDB, or a column as a list with `table["r0"]`.
#[pyclass(frozen, module = "rundown")]
pub struct Table {
    schema: SchemaRef,
    parts: Vec<RecordBatch>,
}

impl Table {
    /// Of one part.
    ///
    /// # Errors
    /// None is known: the columns have the kinds that they declare.
    pub fn of(filled: Filled) -> PyResult<Self> {
        Self::of_parts(vec![filled])
    }

    /// Of parts with the same columns, at least one.
    ///
    /// # Errors
    /// As [`Table::of`].
    pub fn of_parts(parts: Vec<Filled>) -> PyResult<Self> {
        let fields: Vec<Field> =
            parts.first().map(|first| first.iter().map(|(about, _)| field(about)).collect()).unwrap_or_default();
        let schema = Arc::new(Schema::new(fields));
        let parts: Result<Vec<RecordBatch>, ArrowError> = parts.iter().map(|part| batch(&schema, part)).collect();
        Ok(Self { schema, parts: parts.map_err(refused)? })
    }

    fn index(&self, name: &str) -> PyResult<usize> {
        self.schema.index_of(name).map_err(|_| {
            let names = self.column_names().join(", ");
            PyKeyError::new_err(format!("expected a column of this table, found {name:?}; there are {names}"))
        })
    }

    fn rows(&self) -> usize {
        self.parts.iter().map(RecordBatch::num_rows).sum()
    }

    /// What the columns have under this key, by their names.
    fn said<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyDict>> {
        let said = PyDict::new(py);
        let of = |field: &Field| said.set_item(field.name(), field.metadata().get(key));
        self.schema.fields().iter().try_for_each(|field| of(field))?;
        Ok(said)
    }
}

/// A column as it is pickled: name, kind, what is said of it, values.
type Pickled<'py> = (String, &'static str, HashMap<String, String>, Bound<'py, PyList>);

/// The same as it comes back.
type Unpickled<'py> = (String, String, HashMap<String, String>, Bound<'py, PyAny>);

const TEXT: &str = "text";
const COUNT: &str = "count";
const NUMBER: &str = "number";

#[pymethods]
impl Table {
    /// Of the columns that `__reduce__` gives: for `pickle` alone.
    #[new]
    fn new(columns: Vec<Unpickled<'_>>) -> PyResult<Self> {
        let (mut fields, mut arrays) = (Vec::new(), Vec::new());
        for (name, kind, said, values) in columns {
            let array: ArrayRef = match kind.as_str() {
                TEXT => Arc::new(StringArray::from(values.extract::<Vec<Option<String>>>()?)),
                COUNT => Arc::new(Int64Array::from(values.extract::<Vec<Option<i64>>>()?)),
                NUMBER => Arc::new(Float64Array::from(values.extract::<Vec<Option<f64>>>()?)),
                other => return Err(refused(format!("kind: expected {TEXT}, {COUNT} or {NUMBER}, found {other:?}"))),
            };
            fields.push(Field::new(name, array.data_type().clone(), true).with_metadata(said));
            arrays.push(array);
        }
        let schema = Arc::new(Schema::new(fields));
        let part = RecordBatch::try_new(Arc::clone(&schema), arrays).map_err(refused)?;
        Ok(Self { schema, parts: vec![part] })
    }

    /// For `pickle`: a table goes to another process with its units and meanings.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyType>, (Vec<Pickled<'py>>,))> {
        let table = slf.get();
        let column = |field: &Arc<Field>| -> PyResult<Pickled<'py>> {
            let kind = match field.data_type() {
                DataType::Utf8 => TEXT,
                DataType::Int64 => COUNT,
                _ => NUMBER,
            };
            let values = table.__getitem__(slf.py(), field.name())?;
            Ok((field.name().clone(), kind, field.metadata().clone().into(), values))
        };
        let columns = table.schema.fields().iter().map(column).collect::<PyResult<_>>()?;
        Ok((slf.get_type(), (columns,)))
    }

    /// Names of the columns.
    #[getter]
    fn column_names(&self) -> Vec<&str> {
        self.schema.fields().iter().map(|field| field.name().as_str()).collect()
    }

    /// Units by the names of their columns; an empty text where there is none.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.said(py, UNIT)
    }

    /// What the columns say, by their names.
    #[getter]
    fn meanings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.said(py, MEANING)
    }

    /// A column as a list; None where a cell is empty.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyList>> {
        let (index, list) = (self.index(name)?, PyList::empty(py));
        for part in &self.parts {
            values(part.column(index), &list)?;
        }
        Ok(list)
    }

    /// All columns as lists, by their names.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        self.column_names().into_iter().try_for_each(|name| columns.set_item(name, self.__getitem__(py, name)?))?;
        Ok(columns)
    }

    /// A frame of pandas, of whatever version is installed.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pandas")?.call_method1("DataFrame", (self.to_dict(py)?,))
    }

    fn __len__(&self) -> usize {
        self.rows()
    }

    fn __repr__(&self) -> String {
        format!(
            "<rundown.Table: {} rows, {} columns: {}>",
            self.rows(),
            self.schema.fields().len(),
            self.column_names().join(", ")
        )
    }

    /// For notebooks: the first and the last rows, each column with its unit and, under the cursor, its meaning.
    fn _repr_html_(&self) -> String {
        let said = |field: &Arc<Field>| {
            let of = |key: &str| field.metadata().get(key).cloned().unwrap_or_default();
            [field.name().clone(), of(UNIT), of(MEANING)]
        };
        table_html::page(&self.schema.fields().iter().map(said).collect::<Vec<_>>(), &self.parts)
    }

    /// The Arrow PyCapsule interface. A schema that is asked for is not needed to be followed, and is not.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        let parts = self.parts.clone().into_iter().map(Ok);
        let reader = RecordBatchIterator::new(parts, Arc::clone(&self.schema));
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    /// The Arrow PyCapsule interface: the schema alone.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.schema.as_ref()).map_err(refused)?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }
}

const UNIT: &str = "unit";
const MEANING: &str = "meaning";

fn field(about: &About) -> Field {
    let kind = match about.kind {
        Kind::Text => DataType::Utf8,
        Kind::Count => DataType::Int64,
        Kind::Number => DataType::Float64,
    };
    let metadata = [(UNIT, about.unit), (MEANING, &about.meaning), ("empty_when", about.empty)];
    let metadata: HashMap<String, String> = metadata.map(|(key, text)| (key.to_owned(), text.to_owned())).into();
    Field::new(&about.name, kind, true).with_metadata(metadata)
}

fn batch(schema: &SchemaRef, filled: &Filled) -> Result<RecordBatch, ArrowError> {
    let columns = filled.iter().map(|(about, cells)| array(about.kind, cells)).collect();
    RecordBatch::try_new(Arc::clone(schema), columns)
}

fn array(kind: Kind, cells: &[Cell]) -> ArrayRef {
    match kind {
        // An empty field of CSV is a missing one, whatever it is called here.
        Kind::Text => Arc::new(StringArray::from_iter(cells.iter().map(|cell| match cell {
            Cell::Text(text) if !text.is_empty() => Some(text.as_str()),
            _ => None,
        }))),
        Kind::Count => Arc::new(Int64Array::from_iter(cells.iter().map(|cell| match cell {
            Cell::Count(count) => i64::try_from(*count).ok(),
            _ => None,
        }))),
        Kind::Number => Arc::new(Float64Array::from_iter(cells.iter().map(|cell| match cell {
            Cell::Number(number) => Some(*number),
            _ => None,
        }))),
    }
}

/// Adds the values of an array to a list.
fn values(array: &ArrayRef, list: &Bound<'_, PyList>) -> PyResult<()> {
    let py = list.py();
    let any = array.as_any();
    if let Some(texts) = any.downcast_ref::<StringArray>() {
        return texts.iter().try_for_each(|text| list.append(text.into_bound_py_any(py)?));
    }
    if let Some(counts) = any.downcast_ref::<Int64Array>() {
        return counts.iter().try_for_each(|count| list.append(count.into_bound_py_any(py)?));
    }
    if let Some(numbers) = any.downcast_ref::<Float64Array>() {
        return numbers.iter().try_for_each(|number| list.append(number.into_bound_py_any(py)?));
    }
    Ok(())
}
