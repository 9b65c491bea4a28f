//! `rundown.replay`.

use crate::error::{no_runs, not_replayed, refused};
use crate::figure::Figure;
use crate::paths;
use crate::progress::{Progress, Wanted};
use crate::said::{self, read_json, warn};
use crate::{resistance, runs, table::Table};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use rundown::{filter::gaussian::Gaussian, model::state};
use rundown_files::column::{About, Column, Filled, Kind, filled};
use rundown_files::table::Cell;
use rundown_files::{replay::ReplayedRun, replay::Tick, run_log::BadRows};
use rundown_pages::numbers::counted;
use sim_harness::exporting::Results;
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
fn speeds(argument: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let several = match argument.try_iter() {
        // What a generator raises is its own.
        Ok(all) => all.collect::<PyResult<Vec<_>>>()?,
        Err(_) => vec![argument.clone()],
    };
    several.iter().map(|speed| speed.extract()).collect::<PyResult<_>>().map_err(|_| {
        let found = argument.get_type();
        PyTypeError::new_err(format!("speeds_mps: expected a speed or several, m/s, found {found}"))
    })
}

impl Replay {
    /// For an export.
    pub fn results(&self) -> Results {
        self.replayed.results()
    }

    /// The run of this name.
    fn named(&self, name: &str) -> PyResult<usize> {
        let unknown = || refused(format!("run: expected the name of a run that was replayed, found {name:?}"));
        self.replayed.runs.iter().position(|run| run.name == name).ok_or_else(unknown)
    }

    /// The run of this name, or the last one of each unit; of all units without a name.
    fn chosen(&self, run: Option<&str>, unit: Option<&str>) -> PyResult<Vec<usize>> {
        let last_of = |unit: &str| self.replayed.runs.iter().rposition(|run| run.unit == unit);
        match (run, unit) {
            (Some(_), Some(_)) => Err(refused("run, unit: expected one of them, found both")),
            (Some(name), None) => Ok(vec![self.named(name)?]),
            (None, Some(unit)) => last_of(unit)
                .map(|index| vec![index])
                .ok_or_else(|| refused(format!("unit: expected one of {}, found {unit:?}", self.units().join(", ")))),
            (None, None) => Ok(self.units().into_iter().filter_map(last_of).collect()),
        }
    }

    /// The table of each run, with the run's name in the first column.
    fn by_run<R>(
        &self,
        run: Option<&str>,
        table: impl Fn(&ReplayedRun) -> (Vec<Column<R>>, Vec<R>),
    ) -> PyResult<Table> {
        let runs = match run {
            Some(name) => std::slice::from_ref(&self.replayed.runs[self.named(name)?]),
            None => &self.replayed.runs[..],
        };
        let named = |run: &ReplayedRun| -> Filled {
            let (columns, rows) = table(run);
            with_text("run", "name of the run", &run.name, filled(columns, rows))
        };
        Table::of_parts(runs.iter().map(named).collect())
    }

    /// What a person should know, in the order of its weight: what was refused, what was found, what is the matter with
    /// rows.
    fn said(&self) -> Vec<String> {
        let refused = said::first_failed(&self.replayed.failed);
        let of_rows = said::first_of(&self.warnings(), ["warning of a log", "warnings of logs"], "warnings");
        refused.into_iter().chain(self.notes()).chain(of_rows).collect()
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

/// The same text in all rows of a first column.
fn with_text(name: &str, meaning: &str, text: &str, filled: Filled) -> Filled {
    let about = About { name: name.to_owned(), kind: Kind::Text, unit: "", meaning: meaning.to_owned(), empty: "" };
    let rows = filled.first().map_or(0, |(_, cells)| cells.len());
    std::iter::once((about, vec![Cell::from(text); rows])).chain(filled).collect()
}

#[pymethods]
impl Replay {
    /// Names of the runs in their order.
    #[getter]
    fn runs(&self) -> Vec<&str> {
        self.replayed.runs.iter().map(|run| run.name.as_str()).collect()
    }

    /// Names of the units that made the runs, each once; an empty text where a log names none.
    #[getter]
    fn units(&self) -> Vec<&str> {
        let mut units: Vec<&str> = Vec::new();
        for run in &self.replayed.runs {
            if !units.contains(&run.unit.as_str()) {
                units.push(&run.unit);
            }
        }
        units
    }

    /// Logs that could not be used, with the reason.
    #[getter]
    fn failed(&self) -> Vec<(PathBuf, String)> {
        said::failed(&self.replayed.failed)
    }

    /// What a person should know about all runs.
    #[getter]
    fn notes(&self) -> Vec<String> {
        said::messages(&self.replayed.notes)
    }

    /// Warnings of single rows.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        said::messages(self.replayed.runs.iter().flat_map(|run| &run.warnings))
    }

    /// A row for each tick of a run, or of all runs, as in `<run>.estimates.csv`.
    #[pyo3(signature = (run=None))]
    fn estimates(&self, run: Option<&str>) -> PyResult<Table> {
        self.by_run(run, |run| (estimates::columns(), estimates::rows(run).collect()))
    }

    /// What coasting from each tick on leads to, as in `<run>.coast_ahead.csv`; no rows where the track has no stops or
    /// speed limits.
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
    /// `of`: "vehicle" after the run, "run" for the train of that run alone, with wind and load of the day, or "before"
    /// for the vehicle before the run. Without `run` it is the last one of the `unit`, or of each unit: of several
    /// units the first column is `unit`. Beyond the speeds of the runs r(v) is extrapolated; far beyond a warning says
    /// so.
    #[pyo3(signature = (speeds_mps, run=None, *, unit=None, of="vehicle"))]
    fn resistance(
        &self,
        py: Python<'_>,
        speeds_mps: &Bound<'_, PyAny>,
        run: Option<&str>,
        unit: Option<&str>,
        of: &str,
    ) -> PyResult<Table> {
        let chosen = self.chosen(run, unit)?;
        let speeds_mps = speeds(speeds_mps)?;
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
        let table = |index: &usize| -> PyResult<Filled> {
            let run = &self.replayed.runs[*index];
            let table = resistance::table(&self.belief(run, of)?, &speeds_mps);
            Ok(if chosen.len() > 1 { with_text("unit", "the unit that it is of", &run.unit, table) } else { table })
        };
        Table::of_parts(chosen.iter().map(table).collect::<PyResult<_>>()?)
    }

    /// A picture of the report: `resistance` over speed with its band, its `history` over the runs; of a run `motion`,
    /// `terms`, `regimes`, `innovations`. Without `run` it is the last one, of the `unit` where there are several.
    #[pyo3(signature = (what="resistance", run=None, *, unit=None))]
    fn plot(&self, what: &str, run: Option<&str>, unit: Option<&str>) -> PyResult<Figure> {
        let known = Replayed::PICTURES.map(|name| (name, name));
        let name = paths::chosen("what", what, &known)?;
        let [index] = self.chosen(run, unit)?[..] else {
            let units = self.units().join(", ");
            return Err(refused(format!("unit: expected one of {units}: a picture is of one unit, or of one run")));
        };
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

    /// A replay is what its runs and descriptions made it: its tables travel between processes, and it does not.
    fn __reduce__(&self) -> PyResult<()> {
        let message = "cannot pickle a rundown.Replay: hand on its tables, as learned.parameters or learned.estimates(), or write(folder)";
        Err(PyTypeError::new_err(message))
    }

    fn __str__(&self) -> String {
        std::iter::once(self.__repr__()).chain(self.said()).collect::<Vec<_>>().join("\n")
    }

    fn __repr__(&self) -> String {
        let (runs, refused) = (self.replayed.runs.len(), self.replayed.failed.len());
        let refused =
            if refused > 0 { format!(", {} refused", counted(refused, "log", "logs")) } else { String::new() };
        format!(
            "<rundown.Replay: {}{refused}, up to {:.0} km/h>",
            counted(runs, "run", "runs"),
            3.6 * self.fastest_mps()
        )
    }
}

/// Replays recorded runs through the estimator of the board, as `rundown replay` does; the numbers are the same to the
/// last bit.
///
/// `runs`: run logs, folders of run logs, Parquet files of runs; or a table in memory that has Arrow's PyCapsule
/// interface (pyarrow, polars, pandas, DuckDB), with the columns `run`, `time_s`, `location_m`, `speed_kmh`, and if
/// known `unit`, `direction` and the others of a Parquet file of runs. The rows of a run follow each other. In a list
/// of tables one without the column `run` is a run: `table1`, `table2`; in a dictionary it has the name of its key.
/// `train`, `track`, `config`: the descriptions and the configuration, as files.
///
/// `mode`: "gated" learns while the train coasts, "measured" from the column `effort_n_per_kg`, "paper" from the effort
/// calculated at each step; without it that of the configuration, else "gated". `tick`: seconds; without it every
/// sample is a step. `direction`: of the runs that no index names, "up" or "down". `carry=False` begins every run with
/// the vehicle as its manufacturer describes it. `as_recorded=True` leaves as it is what `check` would put right.
/// `skip_bad_rows=True` leaves out rows that cannot be read, with a warning, instead of refusing their run. `progress`:
/// a function of (done, total), or True for lines on stderr. Logs that are refused, notes and the first of the warnings
/// are warnings of Python, too.
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
