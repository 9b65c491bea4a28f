//! `rundown.gap`.

use crate::error::{no_answer, refused};
use crate::figure::Figure;
use crate::options::in_python;
use crate::progress::{Progress, Wanted};
use crate::said::{self, read_json, warn};
use crate::{paths, runs, table::Table};
use pyo3::prelude::*;
use rundown_files::recording::DirectionChoice;
use rundown_gap::answer::{notes::notes, report, story::story, whole::Answer};
use rundown_gap::candidates::read_config;
use rundown_gap::config::GapConfig;
use rundown_gap::{input::Input, refusal::Refusal};
use rundown_pages::numbers::counted;
use sim_harness::replaying::Runs;
use std::path::PathBuf;

/// Where recorded runs and a model disagree, which effect is missing, and what remains of the gap with it. `print(gap)`
/// tells the story.
#[pyclass(frozen, module = "rundown")]
pub struct Gap {
    answer: Answer,
}

#[pymethods]
impl Gap {
    /// The verdict in one word: `explained`, `partly_explained`, `unknown` (a gap without a name), `candidate`
    /// (something may be missing that these runs cannot name) or `no_gap`.
    #[getter]
    fn verdict(&self) -> String {
        self.answer.found.verdict.name().to_owned()
    }

    /// What a person should know: of the logs, then of the answer.
    #[getter]
    fn notes(&self) -> Vec<String> {
        said::messages(self.answer.input.notes.iter().cloned().chain(notes(&self.answer)))
    }

    /// The effects that were named: name, confidence, rivals, parameters with their 95 % intervals, as `gap.json` has
    /// them.
    #[getter]
    fn effects<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.to_dict(py)?.get_item("effects")
    }

    /// The gap on the hold-out runs, before and after, as `gap.json` has it.
    #[getter]
    fn gap<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.to_dict(py)?.get_item("gap")
    }

    /// Each interval's residual, as in `residuals.csv`.
    #[getter]
    fn residuals(&self) -> PyResult<Table> {
        Table::of(self.answer.residuals())
    }

    /// Steady power while trains gain speed, as in `powering.csv`.
    #[getter]
    fn powering(&self) -> PyResult<Table> {
        Table::of(self.answer.powering())
    }

    /// Simulated beside measured speed of the hold-out runs, as in `before_after.csv`.
    #[getter]
    fn before_after(&self) -> PyResult<Table> {
        Table::of(self.answer.compared())
    }

    /// The whole answer as `gap.json` has it.
    fn to_json(&self) -> String {
        self.answer.json_text()
    }

    /// What `to_json` has, as Python's dictionaries and lists.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        read_json(py, &self.to_json())
    }

    /// Writes what `rundown gap --out` writes: report, tables, the model with the effects, the frame for a board.
    fn write(&self, py: Python<'_>, out: PathBuf) -> PyResult<()> {
        py.detach(|| self.answer.write(&out, true)).map_err(refused)
    }

    /// A picture of the report: `residual` over location, `coordinates`, the `law` of the effect, or the speed error
    /// `before_after`.
    #[pyo3(signature = (what="residual"))]
    fn plot(&self, what: &str) -> PyResult<Figure> {
        let known = report::PICTURES.map(|name| (name, name));
        let name = paths::chosen("what", what, &known)?;
        let svg = report::picture(&self.answer, name);
        svg.as_deref().map(Figure::of).ok_or_else(|| refused(format!("{name}: there is nothing to be drawn")))
    }

    fn __str__(&self) -> String {
        in_python(&story(&self.answer))
    }

    fn __repr__(&self) -> String {
        format!("<rundown.Gap: {} in {}>", self.verdict(), counted(self.answer.input.runs.len(), "run", "runs"))
    }
}

/// Finds which effect a model of train and track lacks, as `rundown gap` does.
///
/// `runs`: run logs, folders of run logs, or tables in memory as `replay` takes them, which say the directions
/// themselves. A table has no dates: what happens over the days is not looked for in it. `train`, `track`: the model,
/// as files. `config`: a file of thresholds and priors. `hold_out`: how many runs evaluate the repaired model; a fifth
/// without it, and at least five must be left. `direction`: of the runs that no index names, "up" or "down".
/// `as_recorded=True` takes the logs as they are, with what `check` would put right. `progress`: a function of the name
/// of each step, or True for lines on stderr.
///
/// >>> import rundown, tempfile
/// >>> made = rundown.simulate(tempfile.mkdtemp(), example="hidden_effect", runs=10)
/// >>> found = rundown.gap(made.runs, train=made.train, track=made.track)
/// >>> found.verdict
/// 'explained'
#[pyfunction]
#[pyo3(signature = (runs, *, train, track, config=None, hold_out=None, direction="auto", as_recorded=false, progress=None))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub fn gap(
    py: Python<'_>,
    runs: &Bound<'_, PyAny>,
    train: PathBuf,
    track: PathBuf,
    config: Option<PathBuf>,
    hold_out: Option<usize>,
    direction: &str,
    as_recorded: bool,
    progress: Option<Wanted>,
) -> PyResult<Gap> {
    let (runs, choice) = (runs::of(runs)?, paths::direction(direction)?);
    if matches!(runs, Runs::Tables(_)) && choice != DirectionChoice::Auto {
        return Err(refused(format!(
            "direction: expected auto for a table, which says it in a column, found {direction}"
        )));
    }
    let told = Progress::new(progress, 0);
    let work = || -> Result<Answer, Refusal> {
        let config = config.as_deref().map_or_else(|| Ok(GapConfig::default()), read_config)?;
        let input = match runs {
            Runs::Paths(paths) => Input::read(&train, &track, &paths, choice, as_recorded)?,
            Runs::Tables(tables) => Input::of_tables(&train, &track, tables, as_recorded)?,
        };
        rundown_gap::run(input, config, hold_out, |step| told.step(step))
    };
    let answer = told.during(py, work)?.map_err(no_answer)?;
    let gap = Gap { answer };
    warn(py, &gap.notes())?;
    Ok(gap)
}
