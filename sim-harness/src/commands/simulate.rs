//! `rundown simulate`: a scenario in; run logs, descriptions and, apart from them, the truth out.

use super::{Failure, screen};
use crate::simulation::folder;
use crate::simulation::scenario_file::{EXAMPLE, HIDDEN_EFFECT, Simulation};
use clap::builder::PossibleValuesParser;
use rundown_pages::numbers::counted;
use rundown_truth::{facts::Facts, recorders::Recorder};
use std::path::{Path, PathBuf};
use std::{process::ExitCode, time::Instant};

const EXAMPLES: &str = "\
Examples:
  The case study, 67 runs, and what the estimator makes of them:
    rundown simulate --out study
    rundown replay --train study/train.toml --track study/track.toml --out out study/runs

  A scenario of your own: start from the commented example, add an effect, simulate:
    rundown simulate --example > scenario.toml
    rundown simulate --scenario scenario.toml --out hidden --seed 7 --runs 100

  The logs of a locomotive's event recorder: speeds cut off, late and without rows while standing:
    rundown simulate --recorder event_recorder --out loco

  Runs with an effect that the description does not have, for `rundown gap`:
    rundown simulate --example hidden-effect > scenario.toml

Files in the output folder:
  runs/runNNN.csv        logs, as a recorder on board writes them
  runs/runs.csv          index: departure, unit, direction
  track.toml train.toml  the descriptions as believed
  truth/truth.json       what was true: effects, train, wind, load, phases of each run
  truth/runNNN.csv       what was true at each sample
  truth/scenario.toml    the scenario

Whoever looks for an effect gets all but truth/. The same scenario and seed give the same bytes.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Scenario; without it, and for every field it leaves out, the case study in still air with the described load
    #[arg(long, value_name = "S.toml")]
    scenario: Option<PathBuf>,
    /// Folder for the data set; made when it does not exist
    #[arg(long, value_name = "DIR", required_unless_present = "example")]
    out: Option<PathBuf>,
    /// Seed of all draws; replaces that of the scenario
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Number of runs; replaces that of the scenario
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    runs: Option<u32>,
    /// Recorder of the logs; what the scenario says of single properties of the sensors stays
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(Recorder::ALL.map(Recorder::name)))]
    recorder: Option<String>,
    /// Write into a folder that has files, in place of the data set there
    #[arg(long)]
    force: bool,
    /// Print a commented scenario file, and do nothing else
    #[arg(long, value_name = "WHICH", value_enum, num_args = 0..=1, default_missing_value = "case-study")]
    #[arg(conflicts_with_all = ["scenario", "out", "seed", "runs", "recorder", "force"])]
    example: Option<ExampleScenario>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ExampleScenario {
    /// The case study with the loads and winds of everyday; every field there is
    #[value(alias = "case_study")]
    CaseStudy,
    /// Runs on a line with an undescribed tunnel, for `rundown gap`
    #[value(alias = "hidden_effect")]
    HiddenEffect,
}

impl ExampleScenario {
    fn text(self) -> &'static str {
        match self {
            Self::CaseStudy => EXAMPLE,
            Self::HiddenEffect => HIDDEN_EFFECT,
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let out = match (&arguments.out, arguments.example) {
        (Some(out), None) => out,
        (_, example) => {
            screen::print(example.unwrap_or(ExampleScenario::CaseStudy).text());
            return Ok(ExitCode::SUCCESS);
        }
    };
    let named = |name: &String| Recorder::ALL.into_iter().find(|recorder| recorder.name() == name);
    let recorder = arguments.recorder.as_ref().and_then(named);
    let mut simulation = match &arguments.scenario {
        Some(path) => Simulation::read_with(path, recorder),
        None => Simulation::parse_with(Path::new("scenario"), "", recorder),
    }?;
    if let Some(seed) = arguments.seed {
        simulation.seed = seed;
    }
    if let Some(runs) = arguments.runs {
        simulation.runs = runs as usize;
    }
    let begun = Instant::now();
    let bar = screen::progress(simulation.runs);
    let facts = folder::write(&simulation, out, arguments.force, || bar.inc(1));
    bar.finish_and_clear();
    let facts = facts?;
    screen::print(&summary(&simulation, &facts, begun.elapsed().as_secs_f64()));
    let out = out.display();
    screen::print(&format!("logs: {out}/runs, truth: {out}/truth\n"));
    Ok(ExitCode::SUCCESS)
}

fn summary(simulation: &Simulation, facts: &[Facts], took_s: f64) -> String {
    let hours = facts.iter().map(|f| f.stop.time_s).sum::<f64>() / 3600.0;
    let mut text = format!(
        "{}, seed {}: {}, {hours:.1} h of driving in {took_s:.1} s\n",
        simulation.name,
        simulation.seed,
        counted(facts.len(), "run", "runs")
    );
    for (index, effect) in simulation.scenario.effects.iter().enumerate() {
        let count = facts.iter().filter(|f| f.plan.acting[index]).count();
        text += &format!("  hides {} in {}\n", effect.name(), counted(count, "run", "runs"));
    }
    text
}
