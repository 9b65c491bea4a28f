//! `rundown export`: the results of a replay in; the learned train as other tools take it out.

use super::{Failure, WRONG_ARGUMENTS, screen};
use crate::exchange::sfera::{self, Identity, Traction};
use crate::exchange::{self, Format, provenance};
use crate::learned_train;
use crate::output::files;
use rundown_files::WriteError;
use rundown_files::folder::{self, Provenance};
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples, with what the replay in out/ has learned:
  For simulators:
    rundown replay --train train.toml --track track.toml --out out logs/
    rundown export --to sumo,trainruns,altrios out --train train.toml --max-speed 140
    rundown export --to osrd out --train train.toml --traction 1500V --max-speed 140
  For a DAS that speaks SFERA:
    rundown export --to sfera out --train train.toml --company 0084 --traction 1500V --max-speed 140

Files in the output folder:
  sfera.xml       TrainCharacteristics of the UIC's SFERA schema 3.00 (IRS 90940)
  sumo.add.xml    vehicle type of SUMO with carFollowModel=\"Rail\"
  osrd.json       rolling stock of OSRD, RailJSON 3.4
  trainruns.yaml  rolling stock of railtoolkit's schema 2022.05, for TrainRuns.jl
  altrios.yaml    rail vehicle of ALTRIOS; it has no place for effort and power
  train.toml      the same train as `rundown replay --train` takes it

The resistance is that of the vehicle after the unit's last run. Largest effort and power are the train's: as described,
or more where drivers used more; how much they used is in each file. Named effects of the train file are kept in
train.toml; the others have no place for them. docs/formats.md has every field.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Results of `rundown replay`, not made with --no-carry
    #[arg(value_name = "REPLAY")]
    replay: PathBuf,
    /// Formats to write, separated by commas
    #[arg(long, value_name = "FORMAT", value_delimiter = ',', required_unless_present = "sfera")]
    to: Vec<Format>,
    /// The same as --to sfera
    #[arg(long)]
    sfera: bool,
    /// Description of the train with which the replay was made
    #[arg(long, value_name = "T.toml")]
    train: PathBuf,
    /// SFERA: RICS code of the railway undertaking, four characters
    #[arg(long, value_name = "CODE", value_parser = sfera::company)]
    company: Option<String>,
    /// SFERA, OSRD: energy; diesel, battery, hydrogen, or voltage and frequency as 1500V or 15000V16.7Hz
    #[arg(long, value_name = "TYPE")]
    traction: Option<Traction>,
    /// Largest speed of the train, km/h
    #[arg(long, value_name = "KMH", value_parser = clap::value_parser!(u16).range(1..=600))]
    max_speed: u16,
    /// Unit, where the replay has several
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// SFERA: identifier of the train characteristics; without it the name of the train
    #[arg(long, value_name = "ID")]
    id: Option<String>,
    /// SFERA: major version of the train characteristics
    #[arg(long, value_name = "VERSION", default_value = "1")]
    tc_version: String,
    /// Folder for the files; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "learned")]
    out: PathBuf,
}

impl Arguments {
    /// What the formats need beside the train; an argument that none of them reads may be missing.
    fn identity(&self, formats: &[Format], name: &str) -> Result<Identity, Failure> {
        let missing = |argument: &str| Failure {
            message: format!("{argument}: expected for --to sfera and, but for --company, --to osrd; found none"),
            code: WRONG_ARGUMENTS,
        };
        let needs = |some: &[Format]| formats.iter().any(|format| some.contains(format));
        if needs(&[Format::Sfera]) && self.company.is_none() {
            return Err(missing("--company"));
        }
        if needs(&[Format::Sfera, Format::Osrd]) && self.traction.is_none() {
            return Err(missing("--traction"));
        }
        Ok(Identity {
            company: self.company.clone().unwrap_or_default(),
            id: self.id.clone().unwrap_or_else(|| name.to_owned()),
            version: self.tc_version.clone(),
            traction: self.traction.unwrap_or(Traction::Diesel),
            max_speed_kmh: self.max_speed,
        })
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let begun = Provenance::begin(&[arguments.replay.join("replay.json"), arguments.train.clone()]);
    let mut formats = arguments.to.clone();
    formats.extend(arguments.sfera.then_some(Format::Sfera));
    let learned = learned_train::read(&arguments.replay, &arguments.train, arguments.unit.as_deref())
        .map_err(Failure::refused)?;
    let train = &learned.train;
    let identity = arguments.identity(&formats, &train.name)?;
    let mut written = Vec::new();
    for format in formats {
        let content = exchange::write(format, &learned, &identity);
        let content = content.map_err(|why| Failure::refused(format!("{}: {why}", format.file_name())))?;
        written.push((format.file_name(), content));
    }
    written.push(("train.toml", toml::to_string(train).map_err(Failure::not_written)?.into_bytes()));
    let out = &arguments.out;
    folder::write("export", out, &begun, |folder| -> Result<(), WriteError> {
        let write = |(name, content): &(&str, Vec<u8>)| {
            files::file(&folder.join(name), |file| std::io::Write::write_all(file, content))
        };
        written.iter().try_for_each(write)
    })?;
    let said = provenance::sentences(&learned, train.mass_kg).join("\n");
    let [mass_t, factor] = [train.mass_kg / 1000.0, train.rotating_mass_factor];
    let names: Vec<&str> = written.iter().map(|(name, _)| *name).collect();
    let files = format!("files: {} in {}", names.join(", "), out.display());
    screen::print(&format!("train: {}, {mass_t:.0} t, rotating mass factor {factor}\n{said}\n{files}\n", train.name));
    if !train.effect.is_empty() {
        screen::note("the train has named effects, which only train.toml can hold");
    }
    Ok(ExitCode::SUCCESS)
}
