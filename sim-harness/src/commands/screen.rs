//! What a person sees in the terminal: tables on stdout, messages and progress on stderr.

use super::talk::{quiet, say};
use crate::{
    alike::few,
    logs::Failed,
    output::json::mode_word,
    report::resistance::{Resistance, doubt},
    report::{regime_shares, shown_kmh, taught_mps},
};
use indicatif::{ProgressBar, ProgressStyle};
use rundown::estimator::config::{Config, Mode};
use rundown::{filter::gaussian::Gaussian, model::units::KmPerHour, tick::paper::Difference, tick::regime::Regime};
use rundown_check::gradients::SmallErrors;
use rundown_files::replay::ReplayedRun;
use rundown_pages::numbers::counted;
use std::fs::File;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

/// Fewer runs are done before a bar is read.
const FEW_RUNS: usize = 3;
/// Warnings that are printed of one run; `replay.json` has all.
const WARNINGS_PRINTED: usize = 5;
/// Runs that are printed; `parameters.csv` has all.
pub(super) const RUNS_PRINTED: usize = 20;

/// Why stdout took less than was printed.
static STDOUT_FAILED: OnceLock<String> = OnceLock::new();

/// Prints to stdout. What it could not take, [`stdout_failed`] says at the end: the files are written all the same.
pub(super) fn print(text: &str) {
    let mut stdout = io::stdout().lock();
    taken(stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()));
}

/// What a command found: its JSON and nothing else, or words and where the results are.
pub(super) fn results(as_json: bool, json: &str, words: &str, out: &Path) {
    if as_json {
        print(json);
    } else {
        print(&format!("{words}\nresults: {}\n", out.display()));
    }
}

/// What coasts say of gradients of which neither track nor configuration says how far they may be off: a paragraph.
pub(super) fn small_errors(found: Option<SmallErrors>) -> String {
    found.map_or_else(String::new, |found| format!("\n{found}\n"))
}

/// Prints a file to stdout, as [`print()`] does.
pub(super) fn print_file(path: &Path) -> io::Result<()> {
    let mut file = File::open(path)?;
    let mut stdout = io::stdout().lock();
    taken(io::copy(&mut file, &mut stdout).and_then(|_| stdout.flush()));
    Ok(())
}

/// A reader that closed its end (`| head`) wants no more: that is no failure.
fn taken(done: io::Result<()>) {
    if let Err(error) = done
        && error.kind() != io::ErrorKind::BrokenPipe
    {
        let _ = STDOUT_FAILED.set(error.to_string());
    }
}

/// Why stdout took less than was printed, as that of a full disk.
pub(super) fn stdout_failed() -> Option<&'static str> {
    STDOUT_FAILED.get().map(String::as_str)
}

/// An error, on stderr; one that lists several rows has a line for each.
pub(super) fn error(message: &str) {
    for line in message.lines() {
        say(format_args!("error: {line}"));
    }
}

/// Why logs cannot be used; the results have all of it.
pub(super) fn errors(failed: &[Failed]) {
    few(failed.iter().map(|failed| &failed.error)).iter().for_each(|text| error(text));
}

pub(super) fn note(message: &str) {
    if !quiet() {
        say(format_args!("note: {message}"));
    }
}

/// What is being done now, where no bar says it.
pub(super) fn step(name: &str) {
    if !quiet() {
        say(format_args!("step: {name}"));
    }
}

pub(super) fn warning(message: &str) {
    if !quiet() {
        say(format_args!("warning: {message}"));
    }
}

pub(super) fn warnings(runs: &[ReplayedRun]) {
    if quiet() {
        return;
    }
    for run in runs {
        for warning in run.warnings.iter().take(WARNINGS_PRINTED) {
            say(format_args!("warning: {warning}"));
        }
        let more = run.warnings.len().saturating_sub(WARNINGS_PRINTED);
        if more > 0 {
            let more = counted(more, "more warning", "more warnings");
            say(format_args!("warning: {}: {more}, all in replay.json", run.path.display()));
        }
    }
}

/// A bar on stderr when that is a terminal and there is something to wait for.
pub(super) fn progress(runs: usize) -> ProgressBar {
    if quiet() || runs <= FEW_RUNS || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    styled(ProgressBar::new(runs as u64), "{bar:40} {pos}/{len} runs, {eta} left")
}

fn styled(bar: ProgressBar, template: &str) -> ProgressBar {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// What is being done and for how long, on stderr when that is a terminal.
pub(super) fn waiting() -> ProgressBar {
    if quiet() || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = styled(ProgressBar::new_spinner(), "{spinner} {elapsed} {msg}");
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// The mode, and of the paper's which change of speed gives the effort.
pub(super) fn mode_words(config: &Config) -> String {
    let word = mode_word(config.mode);
    match (config.mode, config.paper.difference) {
        (Mode::Paper, Difference::Forward) => format!("{word} (effort forward)"),
        (Mode::Paper, Difference::Backward) => format!("{word} (effort backward)"),
        (Mode::Gated | Mode::Measured, _) => word.to_owned(),
    }
}

/// One line a run: rows, steps, time in each regime, resistance of the vehicle after it at 100 km/h, or the fastest
/// speed that taught it. `all`: how many runs there are, of which these are the first. In the `paper` mode the interval
/// is the filter's and no measure of accuracy: it is left out.
pub(super) fn run_table(runs: &[ReplayedRun], all: usize, mode: Mode) -> String {
    let width = runs.iter().take(RUNS_PRINTED).map(|run| run.name.chars().count()).max().unwrap_or(0).max(3);
    let mut text = format!("{:width$}  {:>6} {:>6} {:>8}", "run", "rows", "steps", "dropped");
    for regime in Regime::ALL {
        text += &format!(" {:>10}", regime.as_str());
    }
    let (speed_kmh, whose) = match mode {
        Mode::Paper => (100.0, "the filter, no measure of the vehicle"),
        Mode::Gated | Mode::Measured => {
            (shown_kmh(taught_mps(runs).map(|speeds| speeds.end)), "the vehicle, 95 % interval")
        }
    };
    text += &format!("   r({speed_kmh} km/h) of {whose}\n");
    for run in runs.iter().take(RUNS_PRINTED) {
        text += &format!("{:width$}  {:>6} {:>6} {:>8}", run.name, run.rows, run.estimates.len(), run.dropped.len());
        for share in regime_shares(run).unwrap_or_default() {
            text += &format!(" {:>8.1} %", 100.0 * share);
        }
        let of_vehicle = match mode {
            Mode::Paper => mean_resistance(&run.vehicle_after, speed_kmh),
            Mode::Gated | Mode::Measured => resistance(&run.vehicle_after, speed_kmh),
        };
        text += &format!("   {of_vehicle}{}\n", doubt(run.learned));
    }
    let more = all.saturating_sub(RUNS_PRINTED);
    if more > 0 {
        text += &format!("... and {more} more runs, see the tables of parameters and features\n");
    }
    text
}

/// The first runs, as many as are printed.
pub(super) fn first(kept: &mut Vec<ReplayedRun>, runs: &[ReplayedRun]) {
    let room = RUNS_PRINTED.saturating_sub(kept.len());
    kept.extend(runs.iter().take(room).cloned());
}

/// `0.03125 N/kg`.
fn mean_resistance(davis: &Gaussian<3>, speed_kmh: f64) -> String {
    let found = Resistance::at(davis, KmPerHour(speed_kmh).to_mps());
    found.map_or_else(String::new, |found| format!("{:.5} N/kg", found.mean_n_per_kg))
}

/// `0.03125 ± 0.00042 N/kg (1.3 %)`, the 95 % interval.
pub(super) fn resistance(davis: &Gaussian<3>, speed_kmh: f64) -> String {
    let found = Resistance::at(davis, KmPerHour(speed_kmh).to_mps());
    found.map_or_else(String::new, |found| {
        let (mean, half) = (found.mean_n_per_kg, found.upper() - found.mean_n_per_kg);
        format!("{mean:.5} ± {half:.5} N/kg ({:.1} %)", 100.0 * half / mean)
    })
}
