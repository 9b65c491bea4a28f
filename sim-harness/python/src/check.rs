//! `rundown.check`.

use crate::error::{no_runs, refused, unread};
use crate::options::in_python;
use crate::progress::{Progress, Wanted};
use crate::said;
use crate::{runs, table::Table};
use pyo3::prelude::*;
use rundown_files::run_set::RunSet;
use rundown_pages::numbers::counted;
use sim_harness::checking::{self, Described};
use sim_harness::logs::Failed;
use sim_harness::replaying::Runs;
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
        said::failed(&self.failed)
    }

    /// What a person may want to know about the order of the runs.
    #[getter]
    fn notes(&self) -> Vec<String> {
        said::messages(&self.notes)
    }

    /// What `to_json` has, as Python's dictionaries and lists.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        said::read_json(py, &self.to_json()?)
    }

    /// The whole diagnosis as `rundown check --json` prints it.
    fn to_json(&self) -> PyResult<String> {
        checking::json(&self.found, &self.failed).map_err(refused)
    }

    fn __str__(&self) -> String {
        in_python(&checking::words(&self.found, &self.failed))
    }

    fn __repr__(&self) -> String {
        format!("<rundown.Check: {}>", counted(self.found.runs.len(), "run", "runs"))
    }
}

/// Diagnoses recorded runs, as `rundown check` does. Logs that cannot be read, and notes, are warnings of Python, too.
///
/// `runs`: run logs, folders of run logs, or tables in memory as `replay` takes them. `track`: its centre line gives
/// the locations of logs that have coordinates only, its stops are stations. `train`: with a track, whether its
/// gradients explain how the train coasts. `progress`: a function of (done, total) logs that were read, or True for
/// lines on stderr; a table is read at once.
///
/// >>> import rundown, tempfile
/// >>> made = rundown.simulate(tempfile.mkdtemp(), runs=3, seed=7, recorder="event_recorder")
/// >>> found = rundown.check(made.runs)
/// >>> "truncated_speed" in found.findings["kind"]
/// True
#[pyfunction]
#[pyo3(signature = (runs, *, track=None, train=None, progress=None))]
pub fn check(
    py: Python<'_>,
    runs: &Bound<'_, PyAny>,
    track: Option<PathBuf>,
    train: Option<PathBuf>,
    progress: Option<Wanted>,
) -> PyResult<Check> {
    if train.is_some() && track.is_none() {
        return Err(refused("train: expected a track beside it, found none"));
    }
    let runs = runs::of(runs)?;
    let total = match &runs {
        Runs::Paths(paths) => py.detach(|| RunSet::find(paths)).map_err(unread)?.files.len(),
        Runs::Tables(_) => 0,
    };
    let told = Progress::new(progress, total);
    let described = Described { track: track.as_deref(), train: train.as_deref() };
    let checked = told.during(py, || checking::check(runs, described, || told.one_more()))?.map_err(unread)?;
    let checking::Checked { found, failed, notes, warnings } = checked;
    let notes = [notes, warnings].concat();
    let message = "expected at least one run log that can be read, found none";
    let found = found.ok_or_else(|| no_runs(message, &failed))?;
    said::warn(py, &said::first_failed(&failed).into_iter().chain(notes.iter().cloned()).collect::<Vec<_>>())?;
    Ok(Check { found, failed, notes })
}
