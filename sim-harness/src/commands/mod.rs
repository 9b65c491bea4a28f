//! The command `rundown`: arguments in, files and short tables out.
//!
//! Exit codes: see `AFTER_HELP`. Errors are one line each on stderr: what, where, what to do.

mod accuracy_bench;
mod check;
mod check_bench;
mod convert;
mod demo;
#[cfg(feature = "link")]
mod display;
mod doctor;
mod experiment;
mod export;
mod gap;
mod gap_bench;
mod help;
mod import;
#[cfg(feature = "link")]
mod link;
#[cfg(feature = "link")]
mod provision;
mod recorded;
mod replay;
mod screen;
mod simulate;
mod study;
mod talk;
mod tune;

use crate::{replaying::ReplayError, simulation::folder::FolderError, study::Refused};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use rundown::{estimator::config::Config, model::effects::EffectError, tick::bounds::ConfigError};
use rundown_files::refusal::ReadError;
use rundown_files::{WriteError, config_file};
use rundown_pages::numbers::counted;
use std::{ffi::OsString, path::Path, process::ExitCode};

/// What `--help` says about exit codes.
const AFTER_HELP: &str = "\
Exit codes:
  0  everything was done
  1  a run could not be used; the others were replayed and written. With --strict: something was to be warned of
  2  wrong arguments
  3  the train, the track, the configuration, a scenario, a recording, results of a replay, an index of runs, or a folder
     without runs was refused
  4  an output could not be written
  5  the board did not answer, or refused
  6  nothing usable came out: no run could be read or used, and nothing was written, but for the pages of check and study, which
     say why; or a replay learned nothing";

/// Everything was done, but for runs that could not be used.
const SOME_RUNS_FAILED: u8 = 1;
/// No run could be used, or nothing was learned from any.
const NOTHING_USABLE: u8 = 6;
/// The arguments are wrong, or contradict each other in a way that clap does not check.
const WRONG_ARGUMENTS: u8 = 2;
/// A description or the configuration was refused.
const DESCRIPTION_REFUSED: u8 = 3;
/// An output could not be written.
const NOT_WRITTEN: u8 = 4;
/// The board did not answer, or refused.
#[cfg(feature = "link")]
const BOARD: u8 = 5;

/// On-board train motion estimator: learns running resistance, regimes and limits of a train from location and speed.
#[derive(Debug, Parser)]
#[command(name = "rundown", version, after_help = AFTER_HELP, arg_required_else_help = true)]
struct Arguments {
    #[command(flatten)]
    talk: talk::Talk,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Replay recorded runs through the estimator of the board
    Replay(Box<replay::Arguments>),
    /// What the recorder of some logs did to speed, location and clock, with figures
    Check(check::Arguments),
    /// How near the estimator comes to the truth: resistance, regimes and features of fleets of several kinds
    AccuracyBench(accuracy_bench::Arguments),
    /// How often the diagnosis of logs finds an injected defect, and accuses nothing else
    CheckBench(check_bench::Arguments),
    /// Turn logs of any recorder into run logs: CSV, Excel, GPX, NMEA, JSON lines, Parquet
    Import(import::Arguments),
    /// Simulate runs with known truth, and with effects that the description does not have
    Simulate(simulate::Arguments),
    /// The paper's case study: its figures and claims on simulated or recorded runs, with the truth beside them
    Study(Box<study::Arguments>),
    /// Tune the paper's filter by its two criteria: likelihood, and coefficients that are not negative
    Tune(Box<tune::Arguments>),
    /// Play recorded runs to a board, real or emulated
    #[cfg(feature = "link")]
    Link(Box<link::Arguments>),
    /// Show what a board says, live: in a browser, in the terminal, or as lines
    #[cfg(feature = "link")]
    Display(Box<display::Arguments>),
    /// Find which effect a model lacks, add it, and show the gap shrink
    Gap(Box<gap::Arguments>),
    /// How often the gap workflow finds a hidden effect, and nothing else
    GapBench(Box<gap_bench::Arguments>),
    /// Write what was learned of a train for other tools
    Export(export::Arguments),
    /// Turn a train or track of SUMO, OSRD, TrainRuns, ALTRIOS or SFERA into train.toml or track.toml
    Convert(convert::Arguments),
    /// Make the record with a new key that a board is given
    #[cfg(feature = "link")]
    Provision(provision::Arguments),
    /// The case study in short: simulate its 67 runs, replay them, write the report; then find a hidden effect
    Demo(demo::Arguments),
    /// Say what this machine lacks for a board, and which command mends it
    ///
    /// Exit code 0 when runs can be replayed, whatever else is missing.
    Doctor,
    /// Print the completions of a shell
    ///
    /// Example: rundown completions bash > ~/.local/share/bash-completion/completions/rundown
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

#[derive(Debug)]
struct Failure {
    message: String,
    code: u8,
}

impl Failure {
    fn refused(error: impl std::fmt::Display) -> Self {
        Self { message: error.to_string(), code: DESCRIPTION_REFUSED }
    }

    fn arguments(error: impl std::fmt::Display) -> Self {
        Self { message: error.to_string(), code: WRONG_ARGUMENTS }
    }

    /// Of all runs none could be used.
    fn no_runs(message: impl Into<String>) -> Self {
        Self { message: message.into(), code: NOTHING_USABLE }
    }

    #[cfg(feature = "link")]
    fn board(error: impl std::fmt::Display) -> Self {
        Self { message: error.to_string(), code: BOARD }
    }

    fn not_written(error: impl std::fmt::Display) -> Self {
        Self { message: error.to_string(), code: NOT_WRITTEN }
    }

    /// What was printed did not find a place, as on a full disk.
    fn not_printed(error: impl std::fmt::Display) -> Self {
        Self::not_written(format_args!("stdout: {error}: what was printed is not complete"))
    }
}

#[derive(Clone, Copy, Debug, clap::Args)]
struct Strict {
    /// Fail with exit code 1, and write nothing, where anything is to be warned of: a run refused, a row left out, a
    /// reading put right
    #[arg(long)]
    strict: bool,
}

impl Strict {
    /// `said`: how many warnings, notes and refused runs there are.
    fn check(self, said: usize) -> Result<(), Failure> {
        if self.strict && said > 0 {
            let said = counted(said, "warning", "warnings");
            let message = format!("--strict: expected nothing to be warned of, found {said}; nothing was written");
            return Err(Failure { message, code: SOME_RUNS_FAILED });
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, clap::Args)]
struct RunPagesChoice {
    /// No page for each run beside the report: they take 0.24 MB a run
    #[arg(long = "no-run-pages", action = clap::ArgAction::SetFalse)]
    run_pages: bool,
}

/// What each cause of a failure means for the exit code.
macro_rules! failures {
    ($($how:ident: $($error:ty),+;)+) => {$($(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::$how(error)
            }
        }
    )+)+};
}

failures! {
    refused: ReadError, ConfigError, EffectError, ReplayError, Refused;
    not_written: WriteError, FolderError;
}

/// The configuration of a file; without one, every default.
fn config(path: Option<&Path>) -> Result<Config, Failure> {
    path.map_or(Ok(Config::default()), |path| Ok(config_file::read(path)?))
}

/// Runs the command on the arguments of the process.
pub fn main() -> ExitCode {
    run(std::env::args_os())
}

/// Runs the command on these arguments, its name first. Ends the process where they are wrong, or help is asked for.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let matches = help::unbroken(Arguments::command()).try_get_matches_from(arguments);
    let matches = matches.unwrap_or_else(|error| help::exit(&error));
    let Arguments { talk, command } = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    talk.apply();
    let done = match command {
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::AccuracyBench(arguments) => accuracy_bench::run(&arguments),
        Command::CheckBench(arguments) => check_bench::run(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Study(arguments) => study::run(&arguments),
        Command::Tune(arguments) => tune::run(&arguments),
        #[cfg(feature = "link")]
        Command::Link(arguments) => link::run(&arguments),
        #[cfg(feature = "link")]
        Command::Display(arguments) => display::run(&arguments),
        Command::Gap(arguments) => gap::run(&arguments),
        Command::GapBench(arguments) => gap_bench::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        #[cfg(feature = "link")]
        Command::Provision(arguments) => provision::run(&arguments),
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Doctor => doctor::run(),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "rundown", &mut script);
            screen::print(&String::from_utf8_lossy(&script));
            Ok(ExitCode::SUCCESS)
        }
    };
    log::info!("done");
    let printed = |code| match screen::stdout_failed() {
        Some(error) => Err(Failure::not_printed(error)),
        None => Ok(code),
    };
    done.and_then(printed).unwrap_or_else(|failure| {
        screen::error(&failure.message);
        ExitCode::from(failure.code)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }
}
