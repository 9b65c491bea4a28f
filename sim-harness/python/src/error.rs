//! Refusals as exceptions, with the place that the refusal names.

use crate::options::in_python;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use rundown_files::refusal::{ReadError, Refusal};
use sim_harness::exporting::ExportError;
use sim_harness::import::ImportError;
use sim_harness::logs::Failed;
use sim_harness::replaying::ReplayError;
use std::fmt::Display;

pyo3::create_exception!(
    rundown,
    RundownError,
    PyException,
    "A refusal. `str(error)` is the message of the command, with arguments in the place of its options: `file:line:column: field: expected X, found Y`.\n\n\
     Attributes: file, line, column, field, reason; each is None where it is not known. Lines and columns count from 1."
);

/// A refusal without a place.
pub fn refused(reason: impl Display) -> PyErr {
    with_place(&reason.to_string(), None)
}

/// A refusal of a file.
pub fn unread(error: ReadError) -> PyErr {
    with_place_of(&error.to_string(), &error)
}

/// A message with the place of a refused file.
fn with_place_of(text: &str, error: &ReadError) -> PyErr {
    match error {
        ReadError::Refused(refusal) => with_place(text, Some(refusal)),
        ReadError::BadRows { rows, .. } => with_place(text, rows.first()),
        ReadError::Io { path, .. } => {
            let place = rundown_files::refusal::Place::of_file(path);
            with_place(text, Some(&place.refuse("", error.to_string())))
        }
        _ => with_place(text, None),
    }
}

/// Why nothing was replayed.
pub fn not_replayed(error: ReplayError) -> PyErr {
    match error {
        ReplayError::Read(error) => unread(error),
        other => refused(other),
    }
}

/// None of the logs could be used: the place is that of the first.
pub fn no_runs(message: &str, failed: &[Failed]) -> PyErr {
    let first = failed.first();
    let text = first.map_or_else(|| message.to_owned(), |first| format!("{message}\n{}", first.error));
    with_place(&text, first.and_then(|first| first.refusal.as_deref()))
}

/// Why the gap workflow has no answer.
pub fn no_answer(refusal: rundown_gap::refusal::Refusal) -> PyErr {
    let text = refusal.to_string();
    match &refusal {
        rundown_gap::refusal::Refusal::Unread { place, .. } => with_place(&text, place.as_deref()),
        _ => with_place(&text, None),
    }
}

/// Why nothing was imported: the place is that of the first file.
pub fn not_imported(error: ImportError) -> PyErr {
    let text = error.to_string();
    match error {
        ImportError::Refused(error) => unread(error),
        ImportError::Nothing { first: Some(first), .. } => with_place_of(&text, &first),
        _ => refused(text),
    }
}

/// Why nothing was exported.
pub fn not_exported(error: ExportError) -> PyErr {
    match error {
        ExportError::Refused(error) => unread(error),
        other => refused(other),
    }
}

/// Where all refusals pass: here they get the words of Python.
fn with_place(text: &str, refusal: Option<&Refusal>) -> PyErr {
    let error = RundownError::new_err(in_python(text));
    let set = |py: Python<'_>| -> PyResult<()> {
        let value = error.value(py);
        let place = refusal.map(|refusal| &refusal.place);
        value.setattr("file", place.map(|place| &place.file))?;
        value.setattr("line", place.and_then(|place| place.line))?;
        value.setattr("column", place.and_then(|place| place.column))?;
        let field = refusal.map(|refusal| in_python(&refusal.field)).filter(|field| !field.is_empty());
        value.setattr("field", field)?;
        value.setattr("reason", in_python(refusal.map_or(text, |refusal| refusal.message.as_str())))
    };
    Python::attach(set).err().unwrap_or(error)
}
