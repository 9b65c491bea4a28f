//! `rundown check`: run logs in; what their recorder did to them out.

use super::{Failure, SOME_RUNS_FAILED, screen};
use crate::logs::{self, Failed};
use crate::output::files;
use rayon::prelude::*;
use rundown_check::agreement::Figure;
use rundown_check::finding::Finding;
use rundown_check::{Check, RecorderCheck};
use rundown_files::map_matching::CentreLine;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::run_log::BadRows;
use rundown_files::run_set::RunSet;
use rundown_files::track_file::TrackFile;
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  What the recorder of these runs does to speed, location and clock:
    rundown check logs/

  The same for a program:
    rundown check --json logs/ > check.json

It needs neither train nor track (a track with a centre line, where the logs have coordinates only). Found are: the step
of the speed, rounded or truncated; offset and scale of the speed against the location, jointly; by how much the speed is
older than the location, run by run; clocks that jump or lose seconds; rows that are missing, standing and moving;
odometers that wrap or begin again; sensors that stand still; wrong units; there and back in one log. Each with a figure,
its 95 % interval where it has one, and what a replay does about it.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Run logs, or folders of run logs
    #[arg(value_name = "RUN.csv", required = true)]
    runs: Vec<PathBuf>,
    /// Track whose centre line gives the locations of logs that have coordinates only
    #[arg(long, value_name = "K.toml")]
    track: Option<PathBuf>,
    /// Print the whole diagnosis as JSON to stdout, and nothing else
    #[arg(long)]
    json: bool,
    /// Write the whole diagnosis as JSON to this file
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let set = RunSet::find(&arguments.runs)?;
    let track = arguments.track.as_deref().map(TrackFile::read).transpose()?;
    let line = track.and_then(|(track, _)| CentreLine::new(&track.centre_line));
    let read = |file| logs::read(file, BadRows::LeaveOut, line.as_ref(), DirectionChoice::Auto);
    let read: Vec<Result<Recording, Failed>> = set.files.par_iter().map(read).collect();
    let failed = read.iter().filter_map(|read| read.as_ref().err());
    failed.clone().for_each(|failed| screen::error(&failed.error));
    let failed = failed.count();
    let mut recordings: Vec<Recording> = read.into_iter().flatten().collect();
    set.notes.iter().for_each(|text| screen::note(text));
    if recordings.is_empty() {
        let message = format!("expected at least one run log that can be read, found none of {failed}");
        return Err(Failure { message, code: SOME_RUNS_FAILED });
    }
    let found = rundown_check::check(&mut recordings);
    let json = serde_json::to_string_pretty(&found).map_err(Failure::not_written)?;
    if let Some(path) = &arguments.out {
        files::text(path, &json)?;
    }
    screen::print(&if arguments.json { format!("{json}\n") } else { words(&found) });
    let unusable = found.refused().count();
    Ok(if failed + unusable == 0 { ExitCode::SUCCESS } else { ExitCode::from(SOME_RUNS_FAILED) })
}

/// A few lines: each recorder, then its runs in which something else was found.
fn words(found: &Check) -> String {
    let mut text = String::new();
    for recorder in &found.recorders {
        text += &of_recorder(recorder);
        for run in found.runs.iter().filter(|run| run.unit == recorder.unit) {
            for finding in &run.findings {
                text += &format!("  {}: {finding}\n", run.name);
            }
        }
    }
    let clean = found.runs.iter().filter(|run| run.findings.is_empty()).count();
    let refused = found.refused().count();
    text + &format!("{} runs, nothing found in {clean}, {refused} cannot be used\n", found.runs.len())
}

fn of_recorder(recorder: &RecorderCheck) -> String {
    let name = if recorder.unit.is_empty() { "recorder" } else { &recorder.unit };
    let mut text = format!("{name}: speed and location compared in {} of {} runs\n", recorder.compared, recorder.runs);
    let mut line = |what: &str, figure: Option<Figure>, unit: &str, decimals: usize| {
        if let Some(figure) = figure {
            let [low, high] = figure.interval();
            let value = figure.value;
            text += &format!("  {what:<32} {value:.decimals$} [{low:.decimals$}, {high:.decimals$}] {unit}\n");
        }
    };
    line("measured over true speed", recorder.scale, "", 4);
    line("true less read speed", recorder.offset_kmh, "km/h", 3);
    line("speed older than location", recorder.skew_s, "s, median over runs", 2);
    if let Some(spread_s) = recorder.skew_spread_s {
        text += &format!("  {:<32} {spread_s:.2} s\n", "... differs from run to run by");
    }
    let said = |finding: &Finding| format!("  {finding}\n");
    text + &recorder.findings.iter().map(said).collect::<String>()
}
