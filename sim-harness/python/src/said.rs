//! What a person should know, as warnings of Python, and JSON as its dictionaries.

use crate::error::refused;
use crate::options::in_python;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use rundown_pages::numbers::counted;
use sim_harness::logs::Failed;
use std::ffi::CString;
use std::path::PathBuf;

/// More than so many warnings of one call are not read.
const MOST: usize = 10;

/// Warns with each of these, at the place of the call.
pub fn warn(py: Python<'_>, messages: &[String]) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    for message in messages.iter().take(MOST) {
        PyErr::warn(py, &category, &CString::new(in_python(message)).map_err(refused)?, 1)?;
    }
    Ok(())
}

/// Messages for people, with the words of Python.
pub fn messages<T: AsRef<str>>(texts: impl IntoIterator<Item = T>) -> Vec<String> {
    texts.into_iter().map(|text| in_python(text.as_ref())).collect()
}

/// Logs that could not be used, with the reason.
pub fn failed(failed: &[Failed]) -> Vec<(PathBuf, String)> {
    failed.iter().map(|failed| (failed.file.clone(), in_python(&failed.error))).collect()
}

/// How many there are and the first of them, where there is any; `attribute` has all.
pub fn first_of<T: AsRef<str>>(texts: &[T], [one, many]: [&str; 2], attribute: &str) -> Option<String> {
    let first = texts.first()?.as_ref();
    let text = format!("{}, the first: {first}; all in .{attribute}", counted(texts.len(), one, many));
    Some(in_python(&text))
}

/// The first of the logs that could not be used.
pub fn first_failed(failed: &[Failed]) -> Option<String> {
    let errors: Vec<&str> = failed.iter().map(|failed| failed.error.as_str()).collect();
    first_of(&errors, ["log refused", "logs refused"], "failed")
}

/// JSON as `json.loads` reads it.
pub fn read_json<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}
