//! `rundown replay`: recorded runs, a train and a track in; estimates, features, parameters and a report out.

use super::screen;
use super::{Failure, NOTHING_USABLE, RunPagesChoice, SOME_RUNS_FAILED, Strict};
use crate::advice::foreseen::Foreseen;
use crate::logs::Failed;
use crate::output::tables::{Format, Tables};
use crate::replaying::{Opened, PERIOD, Request, Runs, StreamError, is_period};
use clap::ValueEnum;
use indicatif::ProgressBar;
use rundown::estimator::config::Mode;
use rundown_files::replay::{ReplayedRun, Tick};
use rundown_files::{recording::DirectionChoice, run_log::BadRows};
use rundown_pages::numbers::counted;
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  Replay a folder of logs of one unit, the vehicle carried from run to run:
    rundown replay --train train.toml --track track.toml --out out logs/

  A recorder with 1 s samples, replayed with the board's tick of 10 s:
    rundown replay --train train.toml --track track.toml --tick 10 --out out run1.csv run2.csv

  One log from another program, which writes CSV with a header:
    recorder --dump | rundown replay --train train.toml --track track.toml -

  The method of the paper, each run for itself, the summary for a program:
    rundown replay --train t.toml --track k.toml --mode paper --no-carry --json logs/ > all.json

  Ten thousand runs of a fleet, from Parquet to Parquet, a row for each run:
    rundown replay --train t.toml --track k.toml --format parquet --no-estimates --out out runs.parquet

Files in the output folder:
  <run>.estimates.csv    a row for each tick: state, covariance, effort, regime, innovation
  <run>.coast_ahead.csv  a row for each tick, where the track has stops or speed limits: speed and time there if the
                         train coasts from here on, with their standard deviations
  features.csv           a row for each run: limits, brake rates, cruise speed, final coast, energy
  switching_points.csv   a row for each change of regime
  parameters.csv         a row for each run: resistance of vehicle and run, counters by cause
  replay.json            the same for machines, with every warning
  report.html            what concerns all runs, to be opened in any browser
  report/run0001.html    pictures of a run, linked by report.html
  manifest.json          what belongs together: files read and written, with their digests

Tables are CSV, or Parquet with --format parquet. With --no-estimates the first two and the report are left out.

A folder stands for all its *.csv in the order of their names. An index runs.csv beside the
logs (columns file, departure_utc, unit, direction) gives their order, unit and direction.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Run logs or folders of them, or Parquet files of runs or folders of them; - is one log from stdin
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
    /// How tables are written
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// No row for each tick, and no report: only parameters, features, switching points and replay.json, in constant
    /// memory
    #[arg(long)]
    no_estimates: bool,
    #[command(flatten)]
    pages: RunPagesChoice,
    #[command(flatten)]
    strict: Strict,
    /// Print the summary of all runs as JSON to stdout, and nothing else
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ModeChoice {
    /// The paper: effort calculated from the change of speed over each step; paper.difference = "backward" takes the
    /// change before it
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
    let seconds = text.parse::<f64>().map_err(|_| PERIOD.to_owned())?;
    is_period(seconds).then_some(seconds).ok_or_else(|| PERIOD.to_owned())
}

impl Arguments {
    fn request(&self) -> Request {
        Request {
            runs: Runs::Paths(self.runs.clone()),
            train: self.train.clone(),
            track: self.track.clone(),
            config: self.config.clone(),
            mode: self.mode.map(Mode::from),
            tick: self.tick.map_or(Tick::EverySample, |seconds| Tick::Period { seconds }),
            direction: self.direction,
            carried: !self.no_carry,
            as_recorded: self.as_recorded,
            bad_rows: if self.skip_bad_rows { BadRows::LeaveOut } else { BadRows::Refuse },
            strict: self.strict.strict,
            run_pages: self.pages.run_pages,
            tables: Tables { format: self.format, each_tick: !self.no_estimates },
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let opened = arguments.request().open()?;
    let bar = screen::progress(opened.runs());
    if arguments.no_estimates {
        return stream(arguments, opened, &bar);
    }
    let replayed = opened.replay(|| bar.inc(1));
    bar.finish_and_clear();
    let replayed = replayed?;
    log::info!("replayed {}", counted(replayed.runs.len(), "run", "runs"));
    said(&replayed.notes, &replayed.failed);
    screen::warnings(&replayed.runs);
    if let Some(message) = replayed.nothing() {
        return Err(Failure::no_runs(message));
    }
    let warnings: usize = replayed.runs.iter().map(|run| run.warnings.len()).sum();
    arguments.strict.check(warnings + replayed.notes.len() + replayed.failed.len())?;
    let json = replayed.write(&arguments.out)?;
    if arguments.json {
        screen::print(&format!("{json:#}\n"));
    } else {
        let mut foreseen = Foreseen::default();
        foreseen.add(&replayed.runs);
        screen::print(&screen::run_table(&replayed.runs, replayed.runs.len(), replayed.config.mode));
        screen::print(&foreseen.lines(screen::RUNS_PRINTED));
        screen::print(&screen::small_errors(replayed.small_errors));
        let (runs, mode) = (replayed.runs.len(), screen::mode_words(&replayed.config));
        let report = arguments.out.join("report.html");
        let report = report.display();
        screen::print(&format!("\nruns: {runs}, mode: {mode}, report: {report}\n"));
    }
    let unused = replayed.runs.iter().filter(|run| !run.is_used).count();
    Ok(code(replayed.failed.len() + unused, replayed.learned()))
}

/// The same run by run, without estimates.
fn stream(arguments: &Arguments, opened: Opened, bar: &ProgressBar) -> Result<ExitCode, Failure> {
    let (mut first, mut foreseen) = (Vec::new(), Foreseen::default());
    let config = *opened.config();
    let mode = screen::mode_words(&config);
    let seen = |runs: &[ReplayedRun]| {
        bar.suspend(|| screen::warnings(runs));
        screen::first(&mut first, runs);
        foreseen.add(runs);
    };
    let streamed = opened.stream(&arguments.out, || bar.inc(1), seen);
    bar.finish_and_clear();
    let summary = match streamed {
        Ok(summary) => summary,
        Err(StreamError::Nothing(summary)) => {
            said(&summary.notes, &summary.failed);
            if summary.runs > 0 {
                arguments.strict.check(summary.said())?;
            }
            return Err(Failure::no_runs(summary.nothing()));
        }
        Err(StreamError::Replay(error)) => return Err(error.into()),
        Err(StreamError::Write(error)) => return Err(error.into()),
    };
    said(&summary.notes, &summary.failed);
    if arguments.json {
        screen::print_file(&arguments.out.join("replay.json")).map_err(Failure::not_written)?;
    } else {
        screen::print(&screen::run_table(&first, summary.runs, config.mode));
        screen::print(&foreseen.lines(screen::RUNS_PRINTED));
        screen::print(&screen::small_errors(summary.small_errors));
        let results = arguments.out.display();
        screen::print(&format!("\nruns: {}, mode: {mode}, results: {results}\n", summary.runs));
    }
    Ok(code(summary.failed.len() + summary.unused, summary.learned))
}

fn said(notes: &[String], failed: &[Failed]) {
    notes.iter().for_each(|text| screen::note(text));
    screen::errors(failed);
}

fn code(unused: usize, learned: bool) -> ExitCode {
    match (unused, learned) {
        (_, false) => ExitCode::from(NOTHING_USABLE),
        (0, true) => ExitCode::SUCCESS,
        (_, true) => ExitCode::from(SOME_RUNS_FAILED),
    }
}
