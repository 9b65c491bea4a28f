//! `rundown check-bench`: how often `rundown check` finds an injected defect, and accuses nothing else.

use super::{Failure, screen};
use crate::check_bench::{Clean, Defect, bench};
use crate::{gradient_bench, perturbed_bench, study::write};
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

Each defect is injected into sets of four or eight simulated runs; as many sets of each of five clean kinds are diagnosed.
On each of six lines as many sets of 40 runs are compared, of which a seventh is perturbed, and as many sets of 20 runs
are diagnosed with gradients that are described in twelve ways, three of them right; and ten times as many of trains
that hop and hold speeds with the right ones.

Files in the output folder:
  table.md         how often each defect was found, error of its figure, intervals that hold the truth; perturbed runs; wrong gradients
  bench.json       the same for machines, with every clean set that was accused
  perturbed.json   perturbed runs, with every calm one that was accused
  gradients.json   wrong gradients, with what was said of each set";

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
    let bar = screen::progress(
        (count + perturbed_bench::steps(arguments.sets) + gradient_bench::steps(arguments.sets)) as usize,
    );
    let step = || bar.inc(1);
    let found = bench(&Defect::ALL, arguments.sets, arguments.seed, step).map_err(Failure::refused)?;
    let perturbed = perturbed_bench::bench(arguments.sets, arguments.seed, step).map_err(Failure::refused)?;
    let gradients = gradient_bench::bench(arguments.sets, arguments.seed, step).map_err(Failure::refused)?;
    bar.finish_and_clear();
    let text = format!("{}\n{}\n{}", found.table(), perturbed.table(), gradient_bench::table(&gradients));
    let json = serde_json::to_string_pretty(&found).map_err(Failure::not_written)?;
    let perturbed_json = serde_json::to_string_pretty(&perturbed).map_err(Failure::not_written)?;
    let gradients_json = serde_json::to_string_pretty(&gradients).map_err(Failure::not_written)?;
    folder::write("check-bench", &arguments.out, &provenance, |folder| -> Result<(), WriteError> {
        write::text(&folder.join("table.md"), &text)?;
        write::text(&folder.join("bench.json"), &(json + "\n"))?;
        write::text(&folder.join("perturbed.json"), &(perturbed_json + "\n"))?;
        write::text(&folder.join("gradients.json"), &(gradients_json + "\n"))
    })?;
    screen::print(&text);
    let calm = perturbed.lines.iter().flat_map(|line| line.accused.iter());
    let right = gradients.iter().filter(|row| row.is_right).flat_map(|row| row.said.iter());
    for accused in found.accused.iter().chain(calm).chain(right) {
        screen::print(&format!("accused: {accused}\n"));
    }
    screen::print(&format!("results: {}\n", arguments.out.display()));
    Ok(ExitCode::SUCCESS)
}
