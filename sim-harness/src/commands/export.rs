//! `rundown export`: the results of a replay or a board's recording in; the learned train as other tools take it out.

use super::{Failure, screen};
use crate::exchange::sfera;
use crate::exporting::{ExchangeFormat, ExportError, ExportOrder, Results, Traction};
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples, with what the replay in out/ has learned:
  For simulators:
    rundown replay --train train.toml --track track.toml --out out logs/
    rundown export --to sumo,trainruns,altrios out --train train.toml --max-speed 140 --out simulators
    rundown export --to osrd out --train train.toml --traction 1500V --max-speed 140 --out osrd
  For a DAS that speaks SFERA:
    rundown export --to sfera out --train train.toml --company 0084 --traction 1500V --max-speed 140 --out das
  What a board has learned, from what it said:
    rundown display --tcp 127.0.0.1:5475 --text --record run.frames
    rundown export --to sumo run.frames --train train.toml --max-speed 140 --out board

Files in the output folder:
  sfera.xml       TrainCharacteristics of the UIC's SFERA schema 3.00 (IRS 90940)
  sumo.add.xml    vehicle type of SUMO with carFollowModel=\"Rail\"
  sumo.table.add.xml   sumo-table: the same with tables of traction and resistance over speed
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
    /// Results of `rundown replay`, not made with --no-carry; or a board's recording, of `rundown display --record` or
    /// `rundown link --record`
    #[arg(value_name = "REPLAY")]
    replay: PathBuf,
    /// Formats to write, separated by commas
    #[arg(long, value_name = "FORMAT", value_delimiter = ',', required_unless_present = "sfera")]
    to: Vec<ExchangeFormat>,
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
    /// Folder for the files; files of other formats that an earlier export of the same results wrote there are kept
    #[arg(long, value_name = "DIR", default_value = "learned")]
    out: PathBuf,
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Argument { name, reason } => {
                Self::arguments(format_args!("--{}: {reason}", name.replace('_', "-")))
            }
            ExportError::Write(error) => error.into(),
            refused => Self::refused(refused),
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let mut formats = arguments.to.clone();
    formats.extend(arguments.sfera.then_some(ExchangeFormat::Sfera));
    let order = ExportOrder {
        replay: Results::At(arguments.replay.clone()),
        train: arguments.train.clone(),
        formats,
        unit: arguments.unit.clone(),
        company: arguments.company.clone(),
        traction: arguments.traction,
        max_speed_kmh: arguments.max_speed,
        id: arguments.id.clone(),
        tc_version: arguments.tc_version.clone(),
    };
    let exported = order.export(&arguments.out)?;
    screen::print(&exported.said);
    exported.notes.iter().for_each(|note| screen::note(note));
    Ok(ExitCode::SUCCESS)
}
