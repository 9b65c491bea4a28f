//! `rundown accuracy-bench`: how near the estimator comes to the truth, on fleets of several kinds.

use super::{Failure, config, screen};
use crate::accuracy_bench::fleets::{Fleet, all};
use crate::accuracy_bench::{judge, table::tables};
use crate::study::write;
use clap::builder::PossibleValuesParser;
use rundown::estimator::config::Config;
use rundown_files::folder::{self, Provenance};
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  The tables of docs/measured.md, about two minutes on two cores:
    rundown accuracy-bench --out bench

  Metros and trams alone, with settings of your own:
    rundown accuracy-bench --fleet metro --fleet tram --vehicles 4 --runs 20 --config my.toml

Each vehicle is off its description by up to 35 %, each coefficient by a part of its own. The runs are the simulator's; the estimator is the board's.

Files in the output folder:
  tables.md     errors of r(v), intervals that hold the truth, regimes, features";

/// Arguments of `rundown accuracy-bench`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Fleets; all without it
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(all().iter().map(|fleet| fleet.name)))]
    fleet: Vec<String>,
    /// Vehicles of a fleet
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=1000))]
    vehicles: u16,
    /// Runs of a vehicle
    #[arg(long, value_name = "N", default_value_t = 67, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: u16,
    /// Seed of all runs
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Settings of the estimator; its mode is the fleet's
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/accuracy-bench")]
    out: PathBuf,
}

/// Does what the arguments say.
pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin(arguments.config.as_slice());
    let settings = config(arguments.config.as_deref())?;
    let wanted = |fleet: &Fleet| arguments.fleet.is_empty() || arguments.fleet.iter().any(|name| name == fleet.name);
    let fleets: Vec<Fleet> = all().into_iter().filter(wanted).collect();
    let (vehicles, runs) = (usize::from(arguments.vehicles), usize::from(arguments.runs));
    let bar = screen::progress(fleets.len() * vehicles);
    let mut judged = Vec::new();
    for fleet in fleets {
        let config = Config { mode: fleet.mode, ..settings };
        let table = judge(&fleet, config, vehicles, runs, arguments.seed, || bar.inc(1)).map_err(Failure::refused)?;
        judged.push((fleet, table));
    }
    bar.finish_and_clear();
    let text = tables(&judged);
    folder::write("accuracy-bench", &arguments.out, &provenance, |folder| {
        write::text(&folder.join("tables.md"), &text)
    })?;
    screen::print(&text);
    screen::print(&format!("results: {}\n", arguments.out.display()));
    Ok(ExitCode::SUCCESS)
}
