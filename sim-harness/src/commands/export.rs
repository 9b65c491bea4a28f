//! `rundown export`: the results of a replay in; the learned train as other tools take it out.

use super::{Failure, screen};
use crate::learned_train::{self, LearnedTrain, Origin};
use crate::output::files;
use crate::sfera::{self, Identity, Traction};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Example: what the replay in out/ has learned, for a DAS that speaks SFERA:
    rundown replay --train train.toml --track track.toml --out out logs/
    rundown export --sfera out --train train.toml --company 0084 --traction 1500V --max-speed 140 --out learned

Files in the output folder:
  sfera.xml    the element TrainCharacteristics of the UIC's SFERA schema 3.00 (IRS 90940): weight, length, rollout
               coefficients A, B, C in N, N s/m, N s2/m2, traction force curve, rotating mass factor
  train.toml   the same train as `rundown replay --train` takes it

The resistance is that of the vehicle after the unit's last run. Largest effort and power are medians over the runs, and
what the drivers asked for; below three runs they stay as described. Named effects of the train file are kept in
train.toml; sfera.xml has no place for them.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Results of `rundown replay`, not made with --no-carry
    #[arg(value_name = "REPLAY")]
    replay: PathBuf,
    /// Write train characteristics in the form of SFERA
    #[arg(long, required = true)]
    sfera: bool,
    /// Description of the train with which the replay was made
    #[arg(long, value_name = "T.toml")]
    train: PathBuf,
    /// RICS code of the railway undertaking, four characters
    #[arg(long, value_name = "CODE", value_parser = sfera::company)]
    company: String,
    /// Energy: diesel, battery, hydrogen, or voltage and frequency as 1500V or 15000V16.7Hz
    #[arg(long, value_name = "TYPE")]
    traction: Traction,
    /// Largest speed of the train, km/h
    #[arg(long, value_name = "KMH", value_parser = clap::value_parser!(u16).range(1..=600))]
    max_speed: u16,
    /// Unit, where the replay has several
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Identifier of the train characteristics; without it the name of the train
    #[arg(long, value_name = "ID")]
    id: Option<String>,
    /// Major version of the train characteristics
    #[arg(long, value_name = "VERSION", default_value = "1")]
    tc_version: String,
    /// Folder for the files; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "learned")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let learned = learned_train::read(&arguments.replay, &arguments.train, arguments.unit.as_deref())
        .map_err(Failure::refused)?;
    let train = &learned.train;
    let identity = Identity {
        company: arguments.company.clone(),
        id: arguments.id.clone().unwrap_or_else(|| train.name.clone()),
        version: arguments.tc_version.clone(),
        traction: arguments.traction,
        max_speed_kmh: arguments.max_speed,
    };
    let toml = toml::to_string(train).map_err(Failure::not_written)?;
    let out = &arguments.out;
    files::folder(out)
        .and_then(|()| files::file(&out.join("sfera.xml"), |file| sfera::write(file, train, &identity)))
        .and_then(|()| files::text(&out.join("train.toml"), &toml))?;
    screen::print(&summary(&learned, &arguments.out));
    if !train.effect.is_empty() {
        screen::note("the train has named effects, which sfera.xml cannot hold; train.toml has them");
    }
    Ok(ExitCode::SUCCESS)
}

fn summary(learned: &LearnedTrain, folder: &Path) -> String {
    let train = &learned.train;
    let mass_kg = sfera::stated_mass_kg(train);
    let rotating_mass_kg = train.rotating_mass_factor * mass_kg;
    let sd = learned.davis_sd.map(|sd| rotating_mass_kg * sd);
    let rows = sfera::rollout_coefficients(train)
        .iter()
        .zip(sd)
        .zip([("A", "N"), ("B", "N s/m"), ("C", "N s2/m2")])
        .map(|((value, sd), (name, unit))| format!("{name} = {value:.6} {unit}, s.d. {sd:.6}\n"))
        .collect::<String>();
    let source = |source: Origin| match source {
        Origin::Learned { runs } => format!("learned in {runs} runs"),
        Origin::Described => "as described".to_owned(),
    };
    format!(
        "train: {}, {:.0} t, rotating mass factor {}, {} runs\n{rows}largest effort {:.0} N, {}\nlargest power {:.0} W, {}\nfiles: {}\n",
        train.name,
        mass_kg / 1000.0,
        train.rotating_mass_factor,
        learned.runs,
        train.max_tractive_effort_n,
        source(learned.effort),
        train.max_power_w,
        source(learned.power),
        folder.display(),
    )
}
