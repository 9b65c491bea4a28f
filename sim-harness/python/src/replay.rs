//! `rundown.replay`.

use crate::error::{no_runs, not_replayed, refused};
use crate::figure::Figure;
use crate::paths;
use crate::progress::{Progress, Wanted};
use crate::said::{read_json, warn};
use crate::{resistance, runs, table::Table};
use pyo3::prelude::*;
use rundown::{filter::gaussian::Gaussian, model::state};
use rundown_files::column::{About, Column, Filled, Kind, filled};
use rundown_files::table::Cell;
use rundown_files::{replay::ReplayedRun, replay::Tick, run_log::BadRows};
use sim_harness::output::tables::Tables;
use sim_harness::output::{coast_ahead, estimates, features, parameters};
use sim_harness::replaying::{PERIOD, Replayed, Request, is_period};
use std::path::PathBuf;

/// So many times the fastest speed of the runs is far beyond what they say.
const BEYOND: f64 = 1.2;

/// What the board would have learned from some runs. `print(replay)` says what a person should know of it.
#[pyclass(frozen, module = "rundown")]
pub struct Replay {
    replayed: Replayed,
}

/// A speed, or several, m/s.
#[derive(FromPyObject)]
enum Speeds {
    One(f64),
    Several(Vec<f64>),
}

impl Replay {
    /// The run of this name; the last one without a name.
    fn index(&self, run: Option<&str>) -> PyResult<usize> {
        let runs = &self.replayed.runs;
        let Some(name) = run else { return Ok(runs.len() - 1) };
        let unknown = || refused(format!("run: expected the name of a run that was replayed, found {name:?}"));
        runs.iter().position(|run| run.name == name).ok_or_else(unknown)
    }

    /// The table of each run, with the run's name in the first column.
    fn by_run<R>(
        &self,
        run: Option<&str>,
        table: impl Fn(&ReplayedRun) -> (Vec<Column<R>>, Vec<R>),
    ) -> PyResult<Table> {
        let runs = match run {
            Some(_) => std::slice::from_ref(&self.replayed.runs[self.index(run)?]),
            None => &self.replayed.runs[..],
        };
        let named = |run: &ReplayedRun| -> Filled {
            let (columns, rows) = table(run);
            let about = About {
                name: "run".to_owned(),
                kind: Kind::Text,
                unit: "",
                meaning: "name of the run".to_owned(),
                empty: "",
            };
            let names = (about, vec![Cell::from(run.name.as_str()); rows.len()]);
            std::iter::once(names).chain(filled(columns, rows)).collect()
        };
        Table::of_parts(runs.iter().map(named).collect())
    }

    /// What a person should know, in the order of its weight: what was refused, what was found, what is the matter with rows.
    fn said(&self) -> Vec<String> {
        let (Replayed { failed, notes, .. }, warnings) = (&self.replayed, self.warnings());
        let all = |count: usize, what: &str, first: &str, all: &str| {
            format!("{count} {what}, the first: {first}; all in .{all}")
        };
        let refused = failed.first().map(|first| all(failed.len(), "logs refused", &first.error, "failed"));
        let of_rows = warnings.first().map(|first| all(warnings.len(), "warnings of logs", first, "warnings"));
        refused.into_iter().chain(notes.iter().cloned()).chain(of_rows).collect()
    }

    fn fastest_mps(&self) -> f64 {
        let estimates = self.replayed.runs.iter().flat_map(|run| &run.estimates);
        estimates.map(|estimate| estimate.belief.mean[state::SPEED]).fold(0.0, f64::max)
    }

    fn belief(&self, run: &ReplayedRun, of: &str) -> PyResult<Gaussian<3>> {
        let beliefs = [("vehicle", run.vehicle_after), ("run", run.summary.run_davis), ("before", run.vehicle_before)];
        paths::chosen("of", of, &beliefs)
    }
}

#[pymethods]
impl Replay {
    /// Names of the runs in their order.
    #[getter]
    fn runs(&self) -> Vec<&str> {
        self.replayed.runs.iter().map(|run| run.name.as_str()).collect()
    }

    /// Logs that could not be used, with the reason.
    #[getter]
    fn failed(&self) -> Vec<(PathBuf, String)> {
        self.replayed.failed.iter().map(|failed| (failed.file.clone(), failed.error.clone())).collect()
    }

    /// What a person should know about all runs.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.replayed.notes.clone()
    }

    /// Warnings of single rows.
    #[getter]
    fn warnings(&self) -> Vec<&str> {
        self.replayed.runs.iter().flat_map(|run| &run.warnings).map(String::as_str).collect()
    }

    /// A row for each tick of a run, or of all runs, as in `<run>.estimates.csv`.
    #[pyo3(signature = (run=None))]
    fn estimates(&self, run: Option<&str>) -> PyResult<Table> {
        self.by_run(run, |run| (estimates::columns(), estimates::rows(run).collect()))
    }

    /// What coasting from each tick on leads to, as in `<run>.coast_ahead.csv`; no rows where the track has no stops or speed limits.
    #[pyo3(signature = (run=None))]
    fn coast_ahead(&self, run: Option<&str>) -> PyResult<Table> {
        let config = &self.replayed.config.coast;
        self.by_run(run, |run| (coast_ahead::columns(), coast_ahead::rows(run, config).collect()))
    }

    /// A row for each run: limits, brake rates, cruise speed, final coast, energy, as in `features.csv`.
    #[getter]
    fn features(&self) -> PyResult<Table> {
        Table::of(filled(features::columns(&self.replayed.config.features), &self.replayed.runs))
    }

    /// A row for each run: resistance of vehicle and run, counters by cause, as in `parameters.csv`.
    #[getter]
    fn parameters(&self) -> PyResult<Table> {
        Table::of(filled(parameters::columns(), &self.replayed.runs))
    }

    /// A row for each change of regime, as in `switching_points.csv`.
    #[getter]
    fn switching_points(&self) -> PyResult<Table> {
        let rows = self.replayed.runs.iter().flat_map(features::switches);
        Table::of(filled(features::switch_columns(), rows))
    }

    /// Running resistance at a speed or several, m/s, with its 95 % interval: a row for each.
    ///
    /// `of`: "vehicle" after the run, "run" for the train of that run alone, with wind and load of the day, or "before" for the vehicle before the run.
    /// Without `run` it is the last one. Beyond the speeds of the runs r(v) is extrapolated; far beyond a warning says so.
    #[pyo3(signature = (speeds_mps, run=None, *, of="vehicle"))]
    fn resistance(&self, py: Python<'_>, speeds_mps: Speeds, run: Option<&str>, of: &str) -> PyResult<Table> {
        let speeds_mps = match speeds_mps {
            Speeds::One(speed_mps) => vec![speed_mps],
            Speeds::Several(speeds_mps) => speeds_mps,
        };
        if let Some(speed_mps) = speeds_mps.iter().find(|speed_mps| !speed_mps.is_finite() || **speed_mps < 0.0) {
            return Err(refused(format!("speeds_mps: expected speeds from 0 m/s on, found {speed_mps}")));
        }
        let (fastest, seen) = (speeds_mps.iter().copied().fold(0.0, f64::max), self.fastest_mps());
        if fastest > BEYOND * seen {
            let warning = format!(
                "speeds_mps: {fastest} m/s is beyond the speeds of the runs, which reach {seen:.0} m/s ({:.0} km/h): r(v) is extrapolated there",
                3.6 * seen
            );
            warn(py, &[warning])?;
        }
        let belief = self.belief(&self.replayed.runs[self.index(run)?], of)?;
        Table::of(resistance::table(&belief, &speeds_mps))
    }

    /// A picture of the report: `resistance` over speed with its band, its `history` over the runs; of a run `motion`, `terms`, `regimes`,
    /// `innovations`.
    #[pyo3(signature = (what="resistance", run=None))]
    fn plot(&self, what: &str, run: Option<&str>) -> PyResult<Figure> {
        let known = Replayed::PICTURES.map(|name| (name, name));
        let (name, index) = (paths::chosen("what", what, &known)?, self.index(run)?);
        let svg = self.replayed.picture(name, index);
        svg.as_deref().map(Figure::of).ok_or_else(|| refused(format!("{name}: there is nothing to be drawn")))
    }

    /// What `rundown replay --json` prints.
    fn to_json(&self) -> String {
        format!("{:#}\n", self.replayed.json())
    }

    /// Writes what `rundown replay --out` writes: tables, `replay.json`, `report.html`.
    fn write(&self, py: Python<'_>, out: PathBuf) -> PyResult<()> {
        py.detach(|| self.replayed.write(&out)).map(drop).map_err(refused)
    }

    /// What `to_json` has, as Python's dictionaries and lists.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        read_json(py, &self.to_json())
    }

    fn __str__(&self) -> String {
        std::iter::once(self.__repr__()).chain(self.said()).collect::<Vec<_>>().join("\n")
    }

    fn __repr__(&self) -> String {
        let (runs, refused) = (self.replayed.runs.len(), self.replayed.failed.len());
        let refused = if refused > 0 { format!(", {refused} logs refused") } else { String::new() };
        format!("<rundown.Replay: {runs} runs{refused}, up to {:.0} km/h>", 3.6 * self.fastest_mps())
    }
}

/// Replays recorded runs through the estimator of the board, as `rundown replay` does; the numbers are the same to the last bit.
///
/// `runs`: run logs, folders of run logs, Parquet files of runs; or a table in memory that has Arrow's PyCapsule interface (pyarrow, polars, pandas,
/// DuckDB), with the columns `run`, `time_s`, `location_m`, `speed_kmh`, and if known `unit`, `direction` and the others of a Parquet file of runs.
/// The rows of a run follow each other. `tick`: seconds; without it every sample is a step. `carry=False` begins every run with the vehicle as its
/// manufacturer describes it. Logs that are refused, notes and the first of the warnings are warnings of Python, too. `progress`: a function of (done, total), or True for lines on stderr.
///
/// >>> import rundown, tempfile
/// >>> made = rundown.simulate(tempfile.mkdtemp(), runs=2, seed=7)
/// >>> learned = rundown.replay(made.runs, train=made.train, track=made.track)
/// >>> learned.runs
/// ['run001', 'run002']
/// >>> 0.02 < learned.resistance(100 / 3.6)["resistance_n_per_kg"][0] < 0.05
/// True
#[pyfunction]
#[pyo3(signature = (runs, *, train, track, config=None, mode=None, tick=None, direction="auto", carry=true, as_recorded=false, skip_bad_rows=false,
    progress=None))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub fn replay(
    py: Python<'_>,
    runs: &Bound<'_, PyAny>,
    train: PathBuf,
    track: PathBuf,
    config: Option<PathBuf>,
    mode: Option<&str>,
    tick: Option<f64>,
    direction: &str,
    carry: bool,
    as_recorded: bool,
    skip_bad_rows: bool,
    progress: Option<Wanted>,
) -> PyResult<Replay> {
    let tick = match tick {
        None => Tick::EverySample,
        Some(seconds) if is_period(seconds) => Tick::Period { seconds },
        Some(other) => return Err(refused(format!("tick: {PERIOD}, found {other}"))),
    };
    let request = Request {
        runs: runs::of(runs)?,
        train,
        track,
        config,
        mode: mode.map(paths::mode).transpose()?,
        tick,
        direction: paths::direction(direction)?,
        carried: carry,
        as_recorded,
        bad_rows: if skip_bad_rows { BadRows::LeaveOut } else { BadRows::Refuse },
        tables: Tables::default(),
        run_pages: true,
        strict: false,
    };
    let opened = py.detach(|| request.open()).map_err(not_replayed)?;
    let said = Progress::new(progress, opened.runs());
    let replayed = said.during(py, || opened.replay(|| said.one_more()))?.map_err(not_replayed)?;
    match replayed.nothing() {
        Some(message) => Err(no_runs(&message, &replayed.failed)),
        None => {
            let replay = Replay { replayed };
            warn(py, &replay.said())?;
            Ok(replay)
        }
    }
}
