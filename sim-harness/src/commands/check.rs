//! `rundown check`: run logs in; what their recorder did to them out.

use super::{Failure, SOME_RUNS_FAILED, Strict, screen};
use crate::checking::{self, Checked, Described, words};
use crate::output::files;
use crate::replaying::Runs;
use rundown_files::folder::{self, Provenance};
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  What the recorder of these runs does to speed, location and clock:
    rundown check logs/

  The same as pages to explore, one for each run, and as JSON:
    rundown check --out check logs/

  The same for a program:
    rundown check --json logs/ > check.json

  Whether the described gradients explain how the train coasts:
    rundown check --train train.toml --track track.toml logs/

It needs neither train nor track (a track with a centre line, where the logs have coordinates only). Found are: the step
of the speed, rounded or truncated; offset and scale of the speed against the location, jointly; by how much the speed is
older than the location, run by run; clocks that jump or lose seconds; rows that are missing, standing and moving;
odometers that wrap or begin again; sensors that stand still, hold old values or read zero at low speed; wrong units;
there and back in one log; a log that is given twice; runs on another chainage; with a train and a track, what exceeds
their limits. Each with a figure, its 95 % interval where it has one, and what a replay does about it. Beside at least
five others, runs that a red signal or a restriction held up are named, too.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Run logs, or folders of run logs
    #[arg(value_name = "RUN.csv", required = true)]
    runs: Vec<PathBuf>,
    /// Track whose centre line gives the locations of logs that have coordinates only, and whose stops are stations
    #[arg(long, value_name = "K.toml")]
    track: Option<PathBuf>,
    /// Description of the train: with a track, whether its gradients explain how the train coasts
    #[arg(long, value_name = "T.toml", requires = "track")]
    train: Option<PathBuf>,
    #[command(flatten)]
    strict: Strict,
    /// Print the whole diagnosis as JSON to stdout, and nothing else
    #[arg(long)]
    json: bool,
    /// Write the diagnosis into this folder, as a page to explore and as JSON; as JSON alone where the name ends in
    /// .json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let runs = &arguments.runs;
    let described = Described { track: arguments.track.as_deref(), train: arguments.train.as_deref() };
    let out = arguments.out.as_deref().filter(|out| out.extension().is_none_or(|extension| extension != "json"));
    let (Checked { found, failed, notes, warnings }, logs) = match out {
        Some(_) => checking::check_with_logs(runs, described).map(|(checked, logs)| (checked, Some(logs)))?,
        None => (checking::check(Runs::Paths(runs.clone()), described, || ())?, None),
    };
    screen::errors(&failed);
    notes.iter().for_each(|text| screen::note(text));
    warnings.iter().for_each(|text| screen::warning(text));
    let is_any_read = found.is_some();
    let found = found.unwrap_or_default();
    let json = checking::json(&found, &failed).map_err(Failure::not_written)?;
    screen::print(&if arguments.json { format!("{json}\n") } else { words(&found, &failed) });
    let of_recorders = found.recorders.iter().flat_map(|recorder| &recorder.findings);
    let all = of_recorders.chain(found.runs.iter().flat_map(|run| &run.findings));
    let findings = all.filter(|finding| finding.is_defect()).count();
    let perturbed = found.runs.iter().filter(|run| !run.perturbations.is_empty()).count();
    let described = [found.gradients.is_some(), found.resistance.is_some(), found.off_track.is_some()];
    let described = described.into_iter().filter(|is_doubted| *is_doubted).count();
    arguments.strict.check(findings + perturbed + failed.len() + warnings.len() + described)?;
    match (&arguments.out, logs) {
        (Some(out), Some(logs)) => folder::write("check", out, &Provenance::begin(&logs.inputs), |folder| {
            checking::write(folder, &found, &logs, &failed, &[notes, warnings].concat())?;
            files::text(&folder.join("check.json"), &json)
        })?,
        (Some(file), None) => files::whole(file, &json)?,
        (None, _) => (),
    }
    if !is_any_read {
        let message = format!("expected at least one run log that can be read, found none of {}", failed.len());
        return Err(Failure::no_runs(message));
    }
    let unusable = found.refused().count();
    if unusable == found.runs.len() {
        return Err(Failure::no_runs(format!("none of {} run logs can be used", failed.len() + unusable)));
    }
    let is_clean = failed.is_empty() && unusable == 0;
    Ok(if is_clean { ExitCode::SUCCESS } else { ExitCode::from(SOME_RUNS_FAILED) })
}
