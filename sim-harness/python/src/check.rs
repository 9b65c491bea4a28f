//! `rundown.check`.

use crate::error::{no_runs, refused, unread};
use crate::paths::Paths;
use crate::table::Table;
use pyo3::prelude::*;
use sim_harness::checking::{self, Described};
use sim_harness::logs::Failed;
use std::path::PathBuf;

/// What the recorder of some logs did to speed, location and clock. `print(check)` says it in a few lines.
#[pyclass(frozen, module = "rundown")]
pub struct Check {
    found: rundown_check::Check,
    failed: Vec<Failed>,
    notes: Vec<String>,
}

#[pymethods]
impl Check {
    /// What was found, recorder by recorder and run by run.
    #[getter]
    fn findings(&self) -> PyResult<Table> {
        Table::of(checking::findings(&self.found))
    }

    /// Logs that cannot be read, with the reason.
    #[getter]
    fn failed(&self) -> Vec<(PathBuf, String)> {
        self.failed.iter().map(|failed| (failed.file.clone(), failed.error.clone())).collect()
    }

    /// What a person may want to know about the order of the runs.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The whole diagnosis as `rundown check --json` prints it.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&self.found).map_err(refused)
    }

    fn __str__(&self) -> String {
        checking::words(&self.found)
    }

    fn __repr__(&self) -> String {
        format!("<rundown.Check: {} runs>", self.found.runs.len())
    }
}

/// Diagnoses run logs, or folders of run logs, as `rundown check` does.
///
/// >>> import rundown, tempfile
/// >>> made = rundown.simulate(tempfile.mkdtemp(), runs=3, seed=7, recorder="event_recorder")
/// >>> found = rundown.check(made.runs)
/// >>> "truncated_speed" in found.findings["kind"]
/// True
#[pyfunction]
#[pyo3(signature = (runs, *, track=None))]
pub fn check(py: Python<'_>, runs: Paths, track: Option<PathBuf>) -> PyResult<Check> {
    let runs: Vec<PathBuf> = runs.into();
    let checked =
        py.detach(|| checking::check(&runs, Described { track: track.as_deref(), train: None })).map_err(unread)?;
    let checking::Checked { found, failed, notes, warnings } = checked;
    let notes = [notes, warnings].concat();
    let message = "expected at least one run log that can be read, found none";
    let found = found.ok_or_else(|| no_runs(message, &failed))?;
    Ok(Check { found, failed, notes })
}
