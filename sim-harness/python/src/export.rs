//! `rundown.export`.

use crate::error::{not_exported, refused};
use crate::options::in_python;
use crate::paths::chosen;
use crate::progress::Progress;
use crate::replay::Replay;
use crate::said;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use sim_harness::exporting::{self, ExchangeFormat, ExportOrder, Results, Traction};
use std::path::{Path, PathBuf};

/// A learned train in files for other tools. `print(exported)` says what its values are, as the command does.
#[pyclass(frozen, module = "rundown")]
pub struct Exported {
    folder: PathBuf,
    done: exporting::Exported,
}

#[pymethods]
impl Exported {
    /// The folder with the files.
    #[getter]
    fn folder(&self) -> &Path {
        &self.folder
    }

    /// The files that were written; the last is `train.toml`, the same train for `replay`.
    #[getter]
    fn files(&self) -> Vec<PathBuf> {
        self.done.files.iter().map(|name| self.folder.join(name)).collect()
    }

    /// What a person may want to know.
    #[getter]
    fn notes(&self) -> Vec<String> {
        said::messages(&self.done.notes)
    }

    fn __str__(&self) -> String {
        in_python(&self.done.said)
    }

    fn __repr__(&self) -> String {
        format!("<rundown.Exported: {} in {}>", self.done.files.join(", "), self.folder.display())
    }
}

/// A word, or a list of words.
#[derive(FromPyObject)]
pub enum Words {
    One(String),
    Several(Vec<String>),
}

/// Where the results are: a replay, the folder of one, or a board's recording.
fn results(argument: &Bound<'_, PyAny>) -> PyResult<Results> {
    if let Ok(replay) = argument.cast::<Replay>() {
        return Ok(replay.get().results());
    }
    argument.extract().map(Results::At).map_err(|_| {
        let found = argument.get_type();
        let expected = "expected a rundown.Replay, the folder of one, or a board's recording";
        PyTypeError::new_err(format!("replay: {expected}, found {found}"))
    })
}

/// Writes what was learned of a train into the folder `out` for other tools, as `rundown export` does.
///
/// `replay`: what `replay` has returned, or the folder of a replay, as `Replay.write` or the command makes it, or a
/// board's recording, of `rundown link --record` or `rundown display --record`. `train`: the description with which the
/// replay was made. `to`: one or several of "sfera", "sumo", "sumo-table", "osrd", "trainruns", "altrios". `max_speed`:
/// largest speed of the train, km/h. `traction`, for SFERA and OSRD: "diesel", "battery", "hydrogen", or voltage and
/// frequency as "1500V", "15000V16.7Hz". `company`, for SFERA: RICS code of the railway undertaking. `unit`: where the
/// replay has several. `id`, `tc_version`, for SFERA: identifier, without it the name of the train, and major version
/// of the train characteristics.
///
/// >>> import rundown, tempfile
/// >>> made = rundown.simulate(tempfile.mkdtemp(), runs=3, seed=7)
/// >>> learned = rundown.replay(made.runs, train=made.train, track=made.track)
/// >>> out = tempfile.mkdtemp()
/// >>> exported = rundown.export(learned, train=made.train, to=["sumo", "altrios"], max_speed=140, out=out)
/// >>> [path.name for path in exported.files]
/// ['sumo.add.xml', 'altrios.yaml', 'train.toml']
#[pyfunction]
#[pyo3(signature = (replay, *, train, to, max_speed, out, traction=None, company=None, unit=None, id=None, tc_version="1"))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub fn export(
    py: Python<'_>,
    replay: &Bound<'_, PyAny>,
    train: PathBuf,
    to: Words,
    max_speed: u16,
    out: PathBuf,
    traction: Option<&str>,
    company: Option<String>,
    unit: Option<String>,
    id: Option<String>,
    tc_version: &str,
) -> PyResult<Exported> {
    let known = ExchangeFormat::ALL.map(|format| (format.name(), format));
    let words = match to {
        Words::One(word) => vec![word],
        Words::Several(words) => words,
    };
    let formats = words.iter().map(|word| chosen("to", word, &known)).collect::<PyResult<Vec<ExchangeFormat>>>()?;
    let traction = traction.map(str::parse::<Traction>).transpose();
    let order = ExportOrder {
        replay: results(replay)?,
        train,
        formats,
        unit,
        company,
        traction: traction.map_err(|error| refused(format!("traction: {error}")))?,
        max_speed_kmh: max_speed,
        id,
        tc_version: tc_version.to_owned(),
    };
    let done = Progress::new(None, 0).during(py, || order.export(&out))?.map_err(not_exported)?;
    Ok(Exported { folder: out, done })
}
