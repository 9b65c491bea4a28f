//! What a person should know, as warnings of Python, and JSON as its dictionaries.

use crate::error::refused;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use std::ffi::CString;

/// More than so many warnings of one call are not read.
const MOST: usize = 10;

/// Warns with each of these, at the place of the call.
pub fn warn(py: Python<'_>, messages: &[String]) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    for message in messages.iter().take(MOST) {
        PyErr::warn(py, &category, &CString::new(message.as_str()).map_err(refused)?, 1)?;
    }
    Ok(())
}

/// JSON as `json.loads` reads it.
pub fn read_json<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}
