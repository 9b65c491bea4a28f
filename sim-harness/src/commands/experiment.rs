//! `rundown study --experiment NAME`: what the paper leaves to future work.

use super::{Failure, screen};
use crate::study::experiments::answer::{Answer, to_json};
use crate::study::experiments::plan::Plan;
use crate::study::experiments::{Experiment, catalogue, markdown, page};
use crate::study::write;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use rundown_files::WriteError;
use rundown_files::folder::{self, Provenance};
use std::path::Path;
use std::process::ExitCode;

/// Every experiment.
const ALL: &str = "all";
/// The page of one experiment, and that of all.
const PAGE: &str = "report.html";
/// Sets of runs, and runs of each.
pub(super) const SETS: u16 = 5;
const RUNS: usize = 20;

/// How much is simulated, as the command line says.
pub(super) struct Extent<'a> {
    pub(super) sets: Option<u16>,
    pub(super) runs: Option<usize>,
    pub(super) seed: u64,
    /// In place of the experiment's own.
    pub(super) values: Option<&'a [f64]>,
}

/// What `--experiment` takes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Choice {
    All,
    One(&'static Experiment),
}

/// Every name, and [`ALL`].
pub(super) fn choices() -> impl TypedValueParser<Value = Choice> {
    let names = [ALL].into_iter().chain(catalogue::ALL.iter().map(|experiment| experiment.name));
    PossibleValuesParser::new(names).map(|name| catalogue::find(&name).map_or(Choice::All, Choice::One))
}

/// The names and questions of all experiments.
pub(super) fn list() -> ExitCode {
    for Experiment { name, place, question, .. } in &catalogue::ALL {
        screen::print(&format!("{name:16} {question} (section {place})\n"));
    }
    screen::print("\nThe tunnel at Best: rundown study --tunnel\n");
    ExitCode::SUCCESS
}

/// Every experiment, each in a folder of its own, and a page of all.
pub(super) fn all(extent: &Extent, out: &Path, as_json: bool) -> Result<ExitCode, Failure> {
    for (is_given, option) in [(as_json, "--json"), (extent.values.is_some(), "--values")] {
        if is_given {
            return Err(Failure::arguments(format_args!("{option}: expected one experiment, found all")));
        }
    }
    let answers = catalogue::ALL
        .iter()
        .map(|experiment| answered(experiment, extent, &out.join(experiment.name), false))
        .collect::<Result<Vec<Answer>, Failure>>()?;
    folder::write("study", out, &Provenance::begin(&[]), |folder| -> Result<(), WriteError> {
        write::text(&folder.join("experiments.md"), &markdown::markdown(&answers))?;
        write::text(&folder.join(PAGE), &page::page(&answers))
    })?;
    Ok(ExitCode::SUCCESS)
}

pub(super) fn run(experiment: &Experiment, extent: &Extent, out: &Path, as_json: bool) -> Result<ExitCode, Failure> {
    answered(experiment, extent, out, as_json).map(|_| ExitCode::SUCCESS)
}

fn answered(experiment: &Experiment, extent: &Extent, out: &Path, as_json: bool) -> Result<Answer, Failure> {
    let bar = screen::progress(0);
    let done = |all: usize| {
        bar.set_length(all as u64);
        bar.inc(1);
    };
    let (sets, runs) = (usize::from(extent.sets.unwrap_or(SETS)), extent.runs.unwrap_or(RUNS));
    let Experiment { name, question, .. } = *experiment;
    let plan = Plan { name, question, sets, runs, seed: extent.seed, done: &done };
    let answer: Answer = experiment.answer(&plan, extent.values)?.ok_or_else(|| no_values(name))?;
    bar.finish_and_clear();
    folder::write("study", out, &Provenance::begin(&[]), |folder| -> Result<(), WriteError> {
        write::pictures(folder, &[answer.picture()])?;
        write::text(&folder.join(PAGE), &page::page(std::slice::from_ref(&answer)))
    })?;
    screen::results(as_json, &format!("{:#}\n", to_json(&answer)), &answer.words(), out);
    Ok(answer)
}

fn no_values(name: &str) -> Failure {
    Failure::arguments(format_args!(
        "--values: expected an experiment whose variants are values, found {name}: its are kinds"
    ))
}
