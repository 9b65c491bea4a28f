//! `rundown replay`: recorded runs, a train and a track in; estimates, features, parameters and a report out.

use super::{Failure, SOME_RUNS_FAILED, screen};
use crate::logs::{self, Failed};
use crate::output::json::{self, mode_word};
use crate::report::{Report, RunView, write_report};
use crate::{advice::advice, output::write_tables};
use clap::ValueEnum;
use rayon::prelude::*;
use rundown::estimator::config::{Config, Mode};
use rundown::tick::sensor::Rounding;
use rundown::{estimator::Estimator, model::effects::Effect, model::train::Train};
use rundown_check::Known;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::replay::{ReplayedRun, Tick, replay_apart_by, replay_carried_by};
use rundown_files::{
    effect_file, map_matching::CentreLine, run_log::BadRows, run_set::RunSet, track_file::TrackFile,
    train_file::TrainFile,
};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::{collections::HashMap, process::ExitCode};

const EXAMPLES: &str = "\
Examples:
  Replay a folder of logs of one unit, the vehicle carried from run to run:
    rundown replay --train train.toml --track track.toml --out out logs/

  A recorder with 1 s samples, replayed with the board's tick of 10 s:
    rundown replay --train train.toml --track track.toml --tick 10 --out out run1.csv run2.csv

  The method of the paper, each run for itself, the summary for a program:
    rundown replay --train t.toml --track k.toml --mode paper --no-carry --json logs/ > all.json

Files in the output folder:
  <run>.estimates.csv   a row for each tick: state, covariance, effort, regime, innovation
  <run>.coast_ahead.csv a row for each tick, where the track has stops or speed limits: speed and time there if the
                        train coasts from here on, with their standard deviations
  features.csv          a row for each run: limits, brake rates, cruise speed, final coast, energy
  switching_points.csv  a row for each change of regime
  parameters.csv        a row for each run: resistance of vehicle and run, counters by cause
  replay.json           the same for machines, with every warning
  report.html           pictures, to be opened in any browser

A folder stands for all its *.csv in the order of their names. An index runs.csv beside the
logs (columns file, departure_utc, unit, direction) gives their order, unit and direction.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Run logs, or folders of run logs
    #[arg(value_name = "RUN.csv", required = true)]
    runs: Vec<PathBuf>,
    /// Description of the train
    #[arg(long, value_name = "T.toml")]
    train: PathBuf,
    /// Description of the track
    #[arg(long, value_name = "K.toml")]
    track: PathBuf,
    /// Configuration; what it leaves out keeps its default
    #[arg(long, value_name = "C.toml")]
    config: Option<PathBuf>,
    /// Where the effort comes from; replaces the mode of the configuration
    #[arg(long, value_enum)]
    mode: Option<ModeChoice>,
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Take the newest sample of each S seconds, as the board does; without it every sample is a step
    #[arg(long, value_name = "S", value_parser = period)]
    tick: Option<f64>,
    /// Direction of the runs that no index names
    #[arg(long, value_enum, default_value_t)]
    direction: DirectionChoice,
    /// Begin every run with the vehicle as its manufacturer describes it, and replay runs side by side
    #[arg(long)]
    no_carry: bool,
    /// Replay the logs as they are: what `rundown check` would put right is left as it is
    #[arg(long)]
    as_recorded: bool,
    /// Leave out rows that cannot be read, with a warning, instead of refusing their run
    #[arg(long)]
    skip_bad_rows: bool,
    /// Print the summary of all runs as JSON to stdout, and nothing else
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ModeChoice {
    /// The paper: effort calculated from the change of speed
    Paper,
    /// Effort known to be zero while coasting; learning only then
    Gated,
    /// Effort measured, in the column effort_n_per_kg, with a slowly learned gain
    Measured,
}

impl From<ModeChoice> for Mode {
    fn from(choice: ModeChoice) -> Self {
        match choice {
            ModeChoice::Paper => Self::Paper,
            ModeChoice::Gated => Self::Gated,
            ModeChoice::Measured => Self::Measured,
        }
    }
}

fn period(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        // After a longer pause the estimator restarts.
        Ok(seconds) if seconds > 0.0 && seconds <= 600.0 => Ok(seconds),
        _ => Err("expected a number of seconds above 0, at most 600".to_owned()),
    }
}

struct ReplaySetup {
    config: Config,
    train: TrainFile,
    core_train: Train,
    track: TrackFile,
    /// With the effects that act in all runs.
    estimator: Estimator,
}

struct Results {
    runs: Vec<ReplayedRun>,
    failed: Vec<Failed>,
    notes: Vec<String>,
    carried: bool,
    tick: Tick,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let setup = setup(arguments)?;
    let results = replay(arguments, &setup)?;
    screen::warnings(&results.runs);
    results.notes.iter().for_each(|text| screen::note(text));
    results.failed.iter().for_each(|failed| screen::error(&failed.error));
    if results.runs.is_empty() {
        let message = match results.failed.len() {
            0 => "expected at least one run log, found none; nothing was written".to_owned(),
            failed => format!("none of {failed} run logs could be used; nothing was written"),
        };
        return Err(Failure::no_runs(message));
    }
    let json = write(&arguments.out, &setup, &results)?;
    if arguments.json {
        screen::print(&format!("{json:#}\n"));
    } else {
        screen::print(&screen::run_table(&results.runs));
        screen::print(&screen::foresight(&results.runs));
        let (runs, mode) = (results.runs.len(), mode_word(setup.config.mode));
        let report = arguments.out.join("report.html");
        let report = report.display();
        screen::print(&format!("\nruns: {runs}, mode: {mode}, report: {report}\n"));
    }
    Ok(if results.failed.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(SOME_RUNS_FAILED) })
}

fn setup(arguments: &Arguments) -> Result<ReplaySetup, Failure> {
    let (train, core_train) = TrainFile::read(&arguments.train)?;
    let (track, core_track) = TrackFile::read(&arguments.track)?;
    let mut config = super::config(arguments.config.as_deref())?;
    if let Some(mode) = arguments.mode {
        config.mode = mode.into();
    }
    let config = track.doubted(config);
    let effects = effect_file::effects(&track.effect, &train.effect, None)?;
    let estimator = Estimator::try_new(config, core_train, core_track)?.with_effects(effects);
    Ok(ReplaySetup { config, train, core_train, track, estimator })
}

fn replay(arguments: &Arguments, setup: &ReplaySetup) -> Result<Results, Failure> {
    let set = RunSet::find(&arguments.runs)?;
    let line = CentreLine::new(&setup.track.centre_line);
    let bad_rows = if arguments.skip_bad_rows { BadRows::LeaveOut } else { BadRows::Refuse };
    let read: Vec<Result<Recording, Failed>> =
        set.files.par_iter().map(|file| logs::read(file, bad_rows, line.as_ref(), arguments.direction)).collect();
    let (mut recordings, mut failed) = (Vec::new(), Vec::new());
    for result in read {
        match result {
            Ok(recording) => recordings.push(recording),
            Err(failure) => failed.push(failure),
        }
    }
    let mut notes = set.notes;
    if !arguments.as_recorded {
        // A wheel of some runs counts, too: it must not be put right twice.
        let effects = setup.train.effect.iter().chain(&setup.track.effect);
        let known = Known {
            truncates: setup.config.sensor.rounding == Rounding::Truncated,
            scale: effects.into_iter().any(|entry| matches!(entry.effect, Effect::SpeedScale(_))),
        };
        let (used, refused, found) = logs::diagnosed(recordings, known);
        recordings = used;
        failed.extend(refused);
        notes.extend(found.notes());
    }
    let tick = arguments.tick.map_or(Tick::EverySample, |seconds| Tick::Period { seconds });
    let bar = screen::progress(recordings.len());
    let done = || bar.inc(1);
    let own = own_estimators(setup, &recordings)?;
    let model = |recording: &Recording| own.get(&recording.name).unwrap_or(&setup.estimator);
    let runs = if arguments.no_carry {
        replay_apart_by(&model, &recordings, tick, done)
    } else {
        replay_carried_by(&model, &recordings, tick, done)
    };
    bar.finish_and_clear();
    notes.extend(advice(&setup.estimator, &runs));
    Ok(Results { runs, failed, notes, carried: !arguments.no_carry, tick })
}

/// The estimators of the runs in which not the same effects act as in all.
fn own_estimators(setup: &ReplaySetup, recordings: &[Recording]) -> Result<HashMap<String, Estimator>, Failure> {
    let mut own = HashMap::new();
    for recording in recordings {
        let effects = effect_file::effects(&setup.track.effect, &setup.train.effect, Some(&recording.name))?;
        if effects != *setup.estimator.effects() {
            let estimator = setup.estimator.clone().with_effects(effects);
            own.insert(recording.name.clone(), estimator);
        }
    }
    Ok(own)
}

/// Writes the tables and the report; returns what `--json` prints.
fn write(folder: &Path, setup: &ReplaySetup, results: &Results) -> Result<Value, Failure> {
    let json = json::value(&json::Replay {
        config: &setup.config,
        train: &setup.train.name,
        track: &setup.track.name,
        carried: results.carried,
        tick: results.tick,
        runs: &results.runs,
        failed: &results.failed,
        notes: &results.notes,
    });
    write_tables(folder, &results.runs, &setup.config, &json)?;
    write_report(&folder.join("report.html"), &report(setup, results))?;
    Ok(json)
}

fn report<'a>(setup: &'a ReplaySetup, results: &'a Results) -> Report<'a> {
    let view = |run: &'a ReplayedRun| RunView::of(run, None);
    let vehicle = |run: &ReplayedRun| (run.name.clone(), run.vehicle_after);
    Report {
        title: format!("{} on {}", setup.train.name, setup.track.name),
        train: &setup.core_train,
        runs: results.runs.iter().map(view).collect(),
        mode: mode_word(setup.config.mode),
        features: setup.config.features,
        vehicle: results.runs.iter().map(vehicle).collect(),
    }
}
