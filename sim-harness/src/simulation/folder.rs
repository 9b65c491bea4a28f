//! A simulated data set on disk.
//!
//! | path | what it holds |
//! |---|---|
//! | `runs/runNNN.csv` | the logs, as a recorder on board writes them |
//! | `runs/runs.csv` | index: file, departure_utc, unit, direction, driver |
//! | `track.toml`, `train.toml` | the descriptions as believed |
//! | `truth/truth.json` | what was true: effects, train, facts of each run (`key`) |
//! | `truth/runNNN.csv` | what was true at each sample |
//! | `truth/scenario.toml` | the scenario file |
//! | `manifest.json` | what belongs together ([`folder`]); it alone has times |
//!
//! Whoever looks for effects gets all but `truth/`.

use super::key::{self, departure_utc, file_name};
use super::scenario_file::Simulation;
use rayon::prelude::*;
use rundown_files::WriteError;
use rundown_files::column::{self, Column};
use rundown_files::folder::{self, MANIFEST, Provenance};
use rundown_files::run_set::INDEX;
use rundown_files::table::Cell;
use rundown_truth::facts::Facts;
use rundown_truth::plan::{RunPlan, plan};
use rundown_truth::scenario::{DriveError, Run, simulate_planned};
use rundown_truth::sensors::{SpeedReading, TruthSample};
use serde::Serialize;
use std::borrow::Borrow;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a data set was not written.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "said by the messages")]
pub enum FolderError {
    #[error("{}: expected an empty or new folder, found files in it; choose another folder or overwrite with --force", path.display())]
    NotEmpty { path: PathBuf },
    #[error("{}: expected a {MANIFEST} of `rundown simulate` beside the folder `runs`, found none: choose another folder or remove this one", path.display())]
    NoManifest { path: PathBuf },
    #[error("{}: cannot be written: {source}", folder::shown(path).display())]
    Io { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Drive(#[from] DriveError),
    #[error(transparent)]
    Write(#[from] WriteError),
}

fn io_at(path: &Path) -> impl FnOnce(io::Error) -> FolderError {
    let path = path.to_owned();
    move |source| FolderError::Io { path, source }
}

/// Drives all runs side by side and writes the data set. What is written depends on scenario and seed alone, not on the
/// number of threads. With `force` the data set takes the place of an earlier one.
pub fn write(
    simulation: &Simulation,
    folder: &Path,
    force: bool,
    done: impl Fn() + Sync,
) -> Result<Vec<Facts>, FolderError> {
    may_write(folder, force)?;
    folder::write("simulate", folder, &provenance(simulation), |folder| write_set(simulation, folder, done))
}

/// When the work begins, and what it reads.
fn provenance(simulation: &Simulation) -> Provenance {
    Provenance::begin(simulation.file.as_slice())
}

fn write_set(simulation: &Simulation, folder: &Path, done: impl Fn() + Sync) -> Result<Vec<Facts>, FolderError> {
    let (runs, truth) = (folder.join("runs"), folder.join("truth"));
    for path in [&runs, &truth] {
        std::fs::create_dir_all(path).map_err(io_at(path))?;
    }
    write_toml(&folder.join("track.toml"), &simulation.track)?;
    write_toml(&folder.join("train.toml"), &simulation.train)?;
    let scenario = truth.join("scenario.toml");
    std::fs::write(&scenario, &simulation.text).map_err(io_at(&scenario))?;

    let plans = plan(&simulation.scenario, simulation.runs, simulation.seed);
    let facts = plans
        .par_iter()
        // Where `done` unwinds, as for an interrupt, the other threads end, too.
        .panic_fuse()
        .map(|plan| {
            let run = simulate_planned(&simulation.scenario, plan)?;
            let name = file_name(plan.number, plans.len());
            write_csv(&runs.join(&name), |csv| write_log(csv, simulation, &run))?;
            write_truth(&truth.join(&name), &run)?;
            done();
            Ok(run.facts)
        })
        .collect::<Result<Vec<Facts>, FolderError>>()?;
    write_index(&runs.join(INDEX), simulation, &plans)?;
    let path = truth.join("truth.json");
    let json = format!("{:#}\n", key::value(simulation, &facts));
    std::fs::write(&path, json).map_err(io_at(&path))?;
    Ok(facts)
}

/// Refuses a folder with files unless forced, and logs that no manifest of a simulation lists, beside which shorter
/// data sets would lie.
fn may_write(folder: &Path, force: bool) -> Result<(), FolderError> {
    let path = folder.to_owned();
    let is_empty = |path: &Path| std::fs::read_dir(path).map_or(true, |mut entries| entries.next().is_none());
    if !force && !is_empty(folder) {
        return Err(FolderError::NotEmpty { path });
    }
    if folder.join("runs").is_dir() && folder::files_of("simulate", folder)?.is_none() {
        return Err(FolderError::NoManifest { path });
    }
    Ok(())
}

fn write_toml(path: &Path, value: &impl Serialize) -> Result<(), FolderError> {
    let text = toml::to_string(value).map_err(|error| io_at(path)(io::Error::other(error)))?;
    std::fs::write(path, text).map_err(io_at(path))
}

type Csv = csv::Writer<BufWriter<File>>;

fn write_csv(path: &Path, rows: impl FnOnce(&mut Csv) -> io::Result<()>) -> Result<(), FolderError> {
    let file = File::create(path).map_err(io_at(path))?;
    let mut csv = csv::Writer::from_writer(BufWriter::new(file));
    rows(&mut csv).and_then(|()| csv.flush()).map_err(io_at(path))
}

fn write_log(csv: &mut Csv, simulation: &Simulation, run: &Run) -> io::Result<()> {
    let (effort, temperature) = (simulation.effort_column, simulation.temperature_column);
    let mut header = vec!["time_s", "location_m", "speed_kmh"];
    header.extend(effort.then_some("effort_n_per_kg"));
    header.extend(temperature.then_some("ambient_temperature_c"));
    csv.write_record(&header)?;
    let digits = match simulation.scenario.sensors.speed {
        SpeedReading::Exact => 4,
        // As many as the quantum has.
        _ => (0..6)
            .find(|digits| {
                let scaled = simulation.scenario.sensors.speed_quantum_kmh * 10_f64.powi(*digits);
                (scaled - scaled.round()).abs() < 1e-6
            })
            .unwrap_or(6) as usize,
    };
    for sample in &run.samples {
        let mut row = vec![
            time(sample.time_s),
            sample.location_m.map_or(String::new(), |m| format!("{m:.2}")),
            sample.speed_kmh.map_or(String::new(), |kmh| format!("{kmh:.digits$}")),
        ];
        row.extend(effort.then(|| format!("{:.5}", sample.effort_n_per_kg)));
        row.extend(temperature.then(|| format!("{:.1}", sample.temperature_c)));
        csv.write_record(&row)?;
    }
    Ok(())
}

/// A sample of the truth, and the true rotating mass of its run.
#[derive(Clone, Copy, Debug)]
pub struct TrueRow {
    at: TruthSample,
    rotating_mass_kg: f64,
}

/// The columns of `truth/runNNN.csv`; per *true* rotating mass of the run where it says N/kg.
pub fn truth_columns() -> Vec<Column<TrueRow>> {
    // What is beyond the last digit is no truth: the simulation's steps are that coarse.
    let rounded = |name: &str, unit: &'static str, meaning: &str, digits: usize, value: fn(&TrueRow) -> f64| {
        Column::number(name, unit, meaning, move |row: &TrueRow| Cell::Text(format!("{:.digits$}", value(row))))
    };
    vec![
        Column::number("time_s", "s", "time of the sample", |row: &TrueRow| Cell::Text(time(row.at.time_s))),
        rounded("location_m", "m", "location of the front along the line", 3, |row| row.at.location_m),
        rounded("speed_mps", "m/s", "speed", 6, |row| row.at.speed_mps),
        Column::text("regime", "what the driver does", |row: &TrueRow| row.at.regime.as_str().to_owned()),
        rounded("effort_n_per_kg", "N/kg", "effort at the wheels, now", 7, |row| row.at.effort_n_per_kg),
        rounded("mean_effort_n_per_kg", "N/kg", "its mean since the row before", 7, |row| row.at.mean_effort_n_per_kg),
        rounded("effort_n", "N", "effort at the wheels, now", 1, |row| row.at.effort_n_per_kg * row.rotating_mass_kg),
        rounded("resistance_n_per_kg", "N/kg", "resistance with wind and effects, without gravity", 7, |row| {
            row.at.resistance_n_per_kg
        }),
        rounded("extra_n_per_kg", "N/kg", "what of it effects other than wind, mass and Davis cause", 7, |row| {
            row.at.extra_n_per_kg
        }),
        rounded("gravity_n_per_kg", "N/kg", "gravity along the track, uphill positive", 7, |row| {
            row.at.gravity_n_per_kg
        }),
        rounded("ambient_temperature_c", "°C", "ambient temperature", 3, |row| row.at.temperature_c),
    ]
}

fn write_truth(path: &Path, run: &Run) -> Result<(), FolderError> {
    let rotating_mass_kg = run.facts.train.rotating_mass_kg();
    let rows = run.truth.iter().map(|at| TrueRow { at: *at, rotating_mass_kg });
    write_table(path, &truth_columns(), rows)
}

/// A run of the index.
#[derive(Clone, Debug)]
pub struct IndexRow {
    file: String,
    departure_utc: String,
    unit: String,
    direction: &'static str,
    driver: String,
}

/// The columns of `runs/runs.csv`.
pub fn index_columns() -> Vec<Column<IndexRow>> {
    vec![
        Column::text("file", "name of the log", |row: &IndexRow| row.file.clone()),
        Column::text("departure_utc", "departure, ISO 8601", |row: &IndexRow| row.departure_utc.clone()),
        Column::text("unit", "unit whose vehicle is carried", |row: &IndexRow| row.unit.clone()),
        Column::text("direction", "`up` or `down`", |row: &IndexRow| row.direction.to_owned()),
        Column::text("driver", "who drove; a column of simulated runs", |row: &IndexRow| row.driver.clone())
            .empty_when("every run has another driver"),
    ]
}

fn write_index(path: &Path, simulation: &Simulation, plans: &[RunPlan]) -> Result<(), FolderError> {
    let row = |plan: &RunPlan| IndexRow {
        file: file_name(plan.number, plans.len()),
        departure_utc: departure_utc(plan),
        unit: simulation.unit.clone(),
        direction: plan.heading.as_str(),
        driver: plan.driver.map_or_else(String::new, |turn| turn.name()),
    };
    write_table(path, &index_columns(), plans.iter().map(row))
}

fn write_table<Row>(
    path: &Path,
    columns: &[Column<Row>],
    rows: impl IntoIterator<Item: Borrow<Row>>,
) -> Result<(), FolderError> {
    let file = File::create(path).map_err(io_at(path))?;
    column::write_csv(BufWriter::new(file), columns, rows).map_err(io_at(path))
}

/// To the millisecond, without needless zeros.
fn time(time_s: f64) -> String {
    let text = format!("{time_s:.3}");
    let text = text.trim_end_matches('0');
    let fraction = if text.ends_with('.') { "0" } else { "" };
    format!("{text}{fraction}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bytes_depend_on_scenario_and_seed_alone() {
        let text = "runs = 5\ndirections = \"both\"\n[wind]\nsd_mps = 2\n[[effect]]\nname = \"run_wind\"\nsd_mps = 1\n";
        let simulation = Simulation::parse(Path::new("s.toml"), text).unwrap();
        let written = |simulation: &Simulation, threads: usize| {
            let folder = tempfile::tempdir().unwrap();
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| write(simulation, folder.path(), false, || ())).unwrap();
            let mut files = Vec::new();
            for part in ["", "runs", "truth"] {
                for entry in std::fs::read_dir(folder.path().join(part)).unwrap() {
                    let path = entry.unwrap().path();
                    if path.is_file() && !path.ends_with(MANIFEST) {
                        let name = path.file_name().unwrap().to_owned();
                        files.push((part, name, std::fs::read(&path).unwrap()));
                    }
                }
            }
            files.sort();
            files
        };
        let one = written(&simulation, 1);
        assert_eq!(one.len(), 2 + 6 + 7);
        assert!(one == written(&simulation, 4));
        let other = Simulation { seed: 2, ..simulation };
        assert!(one != written(&other, 1));
    }

    #[test]
    fn a_folder_with_files_is_left_alone_unless_forced() {
        let simulation = Simulation::parse(Path::new("s.toml"), "runs = 2\n").unwrap();
        let folder = tempfile::tempdir().unwrap();
        write(&simulation, folder.path(), false, || ()).unwrap();
        let error = write(&simulation, folder.path(), false, || ()).unwrap_err();
        assert!(error.to_string().ends_with("overwrite with --force"), "{error}");
        let fewer = Simulation { runs: 1, ..simulation };
        write(&fewer, folder.path(), true, || ()).unwrap();
        assert!(!folder.path().join("runs/run002.csv").exists());
    }

    #[test]
    fn times_have_no_needless_digits() {
        assert_eq!([time(10.0), time(0.25), time(1.2)], ["10.0", "0.25", "1.2"]);
    }
}
