//! `rundown check-bench`: how often `rundown check` finds an injected defect, and accuses nothing else.

use super::{Failure, screen};
use crate::check_bench::{Clean, Defect, bench};
use crate::study::write;
use rundown_files::WriteError;
use rundown_files::folder::{self, Provenance};
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  The table of docs/check.md:
    rundown check-bench --sets 20 --out bench

  Other seeds, more sets:
    rundown check-bench --seed 7

Each defect is injected into sets of four simulated runs; as many sets of each of four clean recorders are diagnosed.

Files in the output folder:
  table.md      how often each defect was found, error of its figure, intervals that hold the truth
  bench.json    the same for machines, with every clean set that was accused";

/// Arguments of `rundown check-bench`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Sets of each defect and of each clean recorder
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    sets: u64,
    /// Seed of all draws
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/check-bench")]
    out: PathBuf,
}

/// Does what the arguments say.
pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin(&[]);
    let count = (Defect::ALL.len() + Clean::ALL.len()) as u64 * arguments.sets;
    let bar = screen::progress(count as usize);
    let found = bench(&Defect::ALL, arguments.sets, arguments.seed, || bar.inc(1)).map_err(Failure::refused)?;
    bar.finish_and_clear();
    let text = found.table();
    let json = serde_json::to_string_pretty(&found).map_err(Failure::not_written)?;
    folder::write("check-bench", &arguments.out, &provenance, |folder| -> Result<(), WriteError> {
        write::text(&folder.join("table.md"), &text)?;
        write::text(&folder.join("bench.json"), &(json + "\n"))
    })?;
    screen::print(&text);
    for accused in &found.accused {
        screen::print(&format!("accused: {accused}\n"));
    }
    screen::print(&format!("results: {}\n", arguments.out.display()));
    Ok(ExitCode::SUCCESS)
}
