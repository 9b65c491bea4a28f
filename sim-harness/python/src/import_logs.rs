//! `rundown.import_logs`, and the look before it, `rundown.preview_logs`.

use crate::error::{not_imported, unread};
use crate::figure::Figure;
use crate::options::in_python;
use crate::paths::{Paths, chosen};
use crate::progress::Progress;
use crate::said;
use pyo3::prelude::*;
use rundown_pages::numbers::counted;
use sim_harness::import::{ImportError, ImportOrder, Method};
use std::path::{Path, PathBuf};

/// Run logs that an import wrote. `print(imported)` says what was done, as the command does.
#[pyclass(frozen, module = "rundown")]
pub struct Imported {
    folder: PathBuf,
    done: sim_harness::import::Imported,
}

#[pymethods]
impl Imported {
    /// The folder with the run logs, their index, `import.toml` that repeats the import, and `import.json`, an account
    /// of it.
    #[getter]
    fn folder(&self) -> &Path {
        &self.folder
    }

    /// Files that cannot be read or need an answer in `import.toml`, while others were imported: the messages, with
    /// their place.
    #[getter]
    fn failed(&self) -> Vec<String> {
        said::messages(self.done.errors.iter().map(ToString::to_string))
    }

    /// What a person may want to know, as the evidence for units and clocks.
    #[getter]
    fn notes(&self) -> Vec<String> {
        said::messages(&self.done.notes)
    }

    /// What was left out or changed.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        said::messages(&self.done.warnings)
    }

    /// Run logs that were written.
    fn __len__(&self) -> usize {
        self.done.runs
    }

    fn __str__(&self) -> String {
        in_python(&self.done.words(&self.folder))
    }

    fn __repr__(&self) -> String {
        format!("<rundown.Imported: {} in {}>", counted(self.done.runs, "run", "runs"), self.folder.display())
    }
}

/// Turns logs of any recorder into run logs in the folder `out`, as `rundown import` does: CSV, Excel, GPX, NMEA, JSON
/// lines, Parquet.
///
/// `files`: a file, a folder of files, or a list of them; None for those that the mapping names. `mapping`: an
/// `import.toml` that says what the files do not, or that of an earlier import. `chainage`: how the runs come onto one
/// chainage, "as-is", "stops", "line" or "align"; found from what is there without it. `track`: a track whose centre
/// line gives the chainage of positions. `track_out`: where a track to begin with is written. `strict`: refuse where
/// anything is to be warned of, and write nothing. Files that were not imported, and the first of the warnings, are
/// warnings of Python, too.
///
/// >>> import pathlib, rundown, tempfile
/// >>> folder = pathlib.Path(tempfile.mkdtemp())
/// >>> rows = [f"{second};{12.0 * second};43.2" for second in range(200)]
/// >>> _ = (folder / "export.csv").write_text("\n".join(["time [s];location [m];speed [km/h]", *rows]))
/// >>> imported = rundown.import_logs(folder / "export.csv", out=folder / "runs")
/// >>> len(imported)
/// 1
/// >>> sorted(path.name for path in imported.folder.iterdir())
/// ['export_01.csv', 'import.json', 'import.toml', 'manifest.json', 'runs.csv']
#[pyfunction]
#[pyo3(signature = (files=None, *, out, mapping=None, chainage=None, track=None, track_out=None, strict=false))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub fn import_logs(
    py: Python<'_>,
    files: Option<Paths>,
    out: PathBuf,
    mapping: Option<PathBuf>,
    chainage: Option<&str>,
    track: Option<PathBuf>,
    track_out: Option<PathBuf>,
    strict: bool,
) -> PyResult<Imported> {
    let methods = Method::ALL.map(|method| (method.name(), method));
    let method = chainage.map(|name| chosen("chainage", name, &methods)).transpose()?;
    let files = files.map_or_else(Vec::new, Vec::from);
    let mut order = ImportOrder::new(files, mapping, out.clone()).map_err(unread)?;
    order.place_by(method, track);
    order.track_out = track_out;
    order.strict = strict;
    let done: Result<_, ImportError> = Progress::new(None, 0).during(py, || order.import())?;
    let imported = Imported { folder: out, done: done.map_err(not_imported)? };
    let failed = said::first_of(&imported.failed(), ["file not imported", "files not imported"], "failed");
    let warnings = said::first_of(&imported.warnings(), ["warning", "warnings"], "warnings");
    said::warn(py, &failed.into_iter().chain(warnings).collect::<Vec<_>>())?;
    Ok(imported)
}

/// What an import would do. `print(preview)` says columns with meaning and unit, and the first rows.
#[pyclass(frozen, module = "rundown")]
pub struct Preview {
    done: sim_harness::import::Preview,
}

#[pymethods]
impl Preview {
    /// Files that cannot be read or need an answer in `import.toml`: the messages, with their place.
    #[getter]
    fn failed(&self) -> Vec<String> {
        said::messages(self.done.found.errors.iter().map(ToString::to_string))
    }

    /// What a person may want to know, as the evidence for units and clocks.
    #[getter]
    fn notes(&self) -> Vec<String> {
        said::messages(&self.done.found.notes)
    }

    /// The speeds as they would be imported.
    fn plot(&self) -> Figure {
        Figure::whole(self.done.picture())
    }

    fn __str__(&self) -> String {
        in_python(&self.done.found.lines.join("\n"))
    }

    fn __repr__(&self) -> String {
        format!(
            "<rundown.Preview: {}, {}>",
            counted(self.done.found.lines.len(), "kind of files", "kinds of files"),
            counted(self.done.found.errors.len(), "question", "questions")
        )
    }
}

/// Says what `import_logs` would do with files, as `rundown import --preview` does, also where a question is still
/// open. Writes nothing.
///
/// `files`, `mapping`: as of `import_logs`.
///
/// >>> import pathlib, rundown, tempfile
/// >>> log = pathlib.Path(tempfile.mkdtemp()) / "export.csv"
/// >>> rows = [f"{second};{12.0 * second};43.2" for second in range(200)]
/// >>> _ = log.write_text("\n".join(["time [s];location [m];speed [km/h]", *rows]))
/// >>> preview = rundown.preview_logs(log)
/// >>> preview.failed, "km/h" in str(preview)
/// ([], True)
#[pyfunction]
#[pyo3(signature = (files=None, *, mapping=None))]
pub fn preview_logs(py: Python<'_>, files: Option<Paths>, mapping: Option<PathBuf>) -> PyResult<Preview> {
    let files = files.map_or_else(Vec::new, Vec::from);
    // The folder is that of an import, which this is not.
    let order = ImportOrder::new(files, mapping, PathBuf::new()).map_err(unread)?;
    let done = py.detach(|| order.preview()).map_err(not_imported)?;
    Ok(Preview { done })
}
