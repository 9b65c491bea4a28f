//! `rundown convert`: a train or track of another tool in; the train or track file out.

use super::{Failure, screen};
use crate::converting;
use crate::exchange::draft;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  A train of SUMO, OSRD, TrainRuns, ALTRIOS or SFERA; the format is recognised by the content:
    rundown convert rolling-stock.json --out train.toml

  What the format has no place for is refused by name, and set:
    rundown convert altrios.yaml --set max_tractive_effort_n=200000 --set max_power_w=2e6 --out train.toml

  A running path of railtoolkit:
    rundown convert path.yaml --out track.toml

Nothing is guessed. Every field that is not kept, or read in a certain sense, is a note on stderr.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// File of another tool
    file: PathBuf,
    /// File to write, which must not exist; without it stdout
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    /// Value of a train that the file lacks, or that replaces the file's: mass_kg, rotating_mass_factor, length_m,
    /// max_tractive_effort_n, max_power_w, max_brake_mps2
    #[arg(long, value_name = "FIELD=VALUE", value_parser = setting)]
    set: Vec<(&'static str, f64)>,
}

fn setting(text: &str) -> Result<(&'static str, f64), String> {
    let expected = || format!("expected FIELD=VALUE with a field of {}", draft::FIELDS.join(", "));
    let (name, value) = text.split_once('=').ok_or_else(expected)?;
    let field = converting::field(name).map_err(|_| expected())?;
    let value = value.parse::<f64>().ok().filter(|value| value.is_finite());
    value.map(|value| (field, value)).ok_or_else(|| format!("expected a number after {field}="))
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let set: BTreeMap<&'static str, f64> = arguments.set.iter().copied().collect();
    let converted = converting::convert(&arguments.file, &set)?;
    converted.notes.iter().for_each(|note| screen::note(note));
    match &arguments.out {
        None => screen::print(&converted.text),
        Some(out) if out.exists() => {
            return Err(Failure::not_written(format!("{}: expected a new file, found one that exists", out.display())));
        }
        Some(out) => {
            converted.write(out)?;
            screen::print(&format!("written: {}\n", out.display()));
        }
    }
    Ok(ExitCode::SUCCESS)
}
