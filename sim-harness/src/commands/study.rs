//! `rundown study`: the paper's case study on simulated or recorded runs, and the self-test of learning.

mod case;
mod described;
mod readings;
mod self_test;
mod tunnel;
mod words;

pub(super) use case::of_case_study;

use super::Failure;
use super::experiment::{self, Choice};
use super::recorded::RecordedRuns;
use crate::simulation::scenario_file::Simulation;
use crate::study::case::{case_study, skewed_case_study};
use crate::study::claims::{Claim, markdown};
use crate::study::gather::Gathered;
use crate::study::slope::SlopeAnswer;
use crate::study::write;
use case::Part;
use rundown::estimator::config::Config;
use rundown::tick::paper::Difference;
use rundown_check::gradients::SmallErrors;
use rundown_files::folder::{self, Provenance};
use rundown_files::refusal::ReadError;
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  Every figure and table, of the case study over 20 sets of runs, of the experiments over 5:
    rundown study --all --seeds 20 --out paper

  The paper's 67 runs, simulated, with the truth beside every figure:
    rundown study --out study

  Recorded runs, folders of logs or of Parquet files:
    rundown study --runs logs/ --train train.toml --track track.toml --out study

  Runs of rundown simulate, whose truth lies beside them and is shown:
    rundown study --runs hidden --train hidden/train.toml --track hidden/track.toml --out study

  A scenario of your own, as for rundown simulate, and a fleet of it:
    rundown study --scenario scenario.toml --out study
    rundown study --count 10000 --out fleet

  Does the estimate follow the true resistance, how closely, and how closely could it?
    rundown study --truth-slope --out slope

  The claims over 20 sets of runs, each with the share of seeds in which it holds:
    rundown study --seeds 20 --out study

  Which reading of the text, with which recorder, gives the paper's figures? (--seeds 20: about four minutes)
    rundown study --readings --out readings
    rundown study --readings --runs logs/ --train train.toml --track track.toml --out readings

  Why did the paper see no tunnel?
    rundown study --tunnel --out tunnel

  What the paper leaves to future work, each question an experiment with a table and a figure
    rundown study --list-experiments
    rundown study --experiment sampling --out sampling
    rundown study --experiment wind --values 0,3,6 --out wind

Files in the output folder:
  report.html, report/  Table 1 and Figs. 1 to 9, each with the paper's statement, our value and the truth
  fig*.svg, fig*.csv    each picture, and the numbers it draws
  NAME.svg, NAME.csv    of an experiment, with a page; experiments/report.html of --all has every one
  slope_*.svg, *.csv    estimated over true deviation of the resistance; slope.csv has slopes and bounds
  claims.csv, .md       the paper's numeric claims: reproduced or not, and why
  readings.md           of --readings, its table, as docs/paper.md quotes it
  experiments.md        of --experiment all, their tables, as docs/after-the-paper.md has their figures
  slope.md              of --truth-slope, its table, as docs/study.md quotes it
  runs.csv, .parquet    a row for each run: both modes and the truth
  train.toml, track.toml  of simulated runs: what recorded ones bring with them";

const SEED: u64 = 1;

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    #[command(flatten)]
    recorded: RecordedRuns,
    /// Scenario of simulated runs, as for rundown simulate; without it the case study
    #[arg(long, value_name = "S.toml", conflicts_with = "runs")]
    scenario: Option<PathBuf>,
    /// Simulated runs; without it as many as the scenario says, of which each unit has as many
    #[arg(long, value_name = "N", conflicts_with = "runs")]
    count: Option<usize>,
    /// Seed of everything that is simulated; replaces that of the scenario
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Configuration of the estimator; what it leaves out keeps its default, its mode is not used
    #[arg(long, value_name = "C.toml")]
    config: Option<PathBuf>,
    /// Name of the run of Figs. 3, 5 and 6; without it the one that is nearest to the paper's by its largest speed, its
    /// brake and its regimes
    #[arg(long, value_name = "RUN")]
    example: Option<String>,
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/study")]
    out: PathBuf,
    /// Also write the runs themselves, as one Parquet file outside of --out that --runs takes
    #[arg(long, value_name = "FILE.parquet")]
    keep_runs: Option<PathBuf>,
    #[command(flatten)]
    pages: super::RunPagesChoice,
    /// Only the self-test of learning: vehicles with 0.7 to 1.3 of the described resistance
    #[arg(long, conflicts_with_all = ["runs", "scenario", "count", "example", "keep_runs"])]
    truth_slope: bool,
    /// Only the comparison of readings of the text: with many recorders on simulated runs, or on recorded ones (--runs)
    #[arg(long, conflicts_with_all = ["count", "example", "keep_runs", "truth_slope", "config"])]
    readings: bool,
    /// All of it: the case study with both efforts and by two recorders, its claims beside each other, the readings,
    /// the self-test of learning, the tunnel and the experiments (5 sets of runs at most), each in a folder of its own
    #[arg(long, conflicts_with_all = ["runs", "scenario", "count", "example", "keep_runs", "truth_slope", "readings", "tunnel", "config", "json"])]
    all: bool,
    /// Only the tunnel at Best: what the paper's mode and rundown gap make of it
    #[arg(long, conflicts_with_all = ["runs", "scenario", "example", "keep_runs", "truth_slope", "readings", "config"])]
    tunnel: bool,
    /// Only one of the experiments that the paper leaves to future work, or all; --seeds sets (5) of --count runs (20)
    #[arg(long, value_name = "NAME", value_parser = experiment::choices(), conflicts_with_all = ["runs", "scenario", "example", "keep_runs", "truth_slope", "readings", "config", "all", "tunnel"])]
    experiment: Option<Choice>,
    /// Values of your own for the experiment, in the unit of its axis, in place of its variants
    #[arg(long, value_name = "X,Y,...", requires = "experiment", value_delimiter = ',', allow_hyphen_values = true)]
    values: Vec<f64>,
    /// Print the names and questions of the experiments, and nothing else
    #[arg(long)]
    list_experiments: bool,
    /// Simulated sets of runs, each with a seed of its own: claims are judged on each (1), readings compared on all (5)
    #[arg(long, value_name = "N", conflicts_with_all = ["runs", "truth_slope", "tunnel"], value_parser = clap::value_parser!(u16).range(1..))]
    seeds: Option<u16>,
    /// Vehicles of the self-test
    #[arg(long, value_name = "N", default_value_t = 25, requires = "truth_slope", value_parser = clap::value_parser!(u16).range(3..))]
    vehicles: u16,
    /// Runs of each vehicle of the self-test
    #[arg(long, value_name = "N", default_value_t = 67, requires = "truth_slope", value_parser = clap::value_parser!(u16).range(1..))]
    vehicle_runs: u16,
    /// Print the results as JSON to stdout, and nothing else
    #[arg(long)]
    json: bool,
}

pub(super) struct Study {
    pub(super) gathered: Gathered,
    pub(super) claims: Vec<Claim>,
    pub(super) answers: Vec<SlopeAnswer>,
    /// The gradients of recorded runs are off by little.
    pub(super) small_errors: Option<SmallErrors>,
    /// How far the estimator takes gradients to be off, permille.
    pub(super) gradient_sd_permille: f64,
}

impl Arguments {
    fn seed(&self) -> u64 {
        self.seed.unwrap_or(SEED)
    }

    /// What is simulated where no recorded runs are given.
    fn simulation(&self) -> Result<Simulation, ReadError> {
        self.scenario.as_deref().map_or_else(case_study, Simulation::read)
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let config = super::config(arguments.config.as_deref())?;
    if arguments.list_experiments {
        return Ok(experiment::list());
    }
    if let Some(choice) = arguments.experiment {
        let values = (!arguments.values.is_empty()).then_some(arguments.values.as_slice());
        let extent =
            experiment::Extent { sets: arguments.seeds, runs: arguments.count, seed: arguments.seed(), values };
        return match choice {
            Choice::All => experiment::all(&extent, &arguments.out, arguments.json),
            Choice::One(one) => experiment::run(one, &extent, &arguments.out, arguments.json),
        };
    }
    if arguments.all {
        return all(arguments, config);
    }
    if arguments.truth_slope {
        return self_test::run(arguments, config, &arguments.out);
    }
    if arguments.readings {
        return readings::compare(arguments, &arguments.out);
    }
    if arguments.tunnel {
        return tunnel::run(arguments, &arguments.out).map(|_| ExitCode::SUCCESS);
    }
    let (simulation, as_recorded) = (arguments.simulation()?, arguments.recorded.as_recorded);
    let part = Part { config, simulation, as_recorded, last: None };
    Ok(case::study_part(arguments, part, &arguments.out)?.0)
}

/// Every figure and table, each part in a folder of its own.
fn all(arguments: &Arguments, config: Config) -> Result<ExitCode, Failure> {
    let part = |name: &str| arguments.out.join(name);
    let mut backward = config;
    backward.paper.difference = Difference::Backward;
    let cases = [
        ("backward", backward, case_study()?, false),
        ("study", config, case_study()?, false),
        ("skewed", config, skewed_case_study()?, true),
        ("skewed_put_right", config, skewed_case_study()?, false),
    ];
    let tunnel = tunnel::run(arguments, &part("tunnel"))?;
    let (mut codes, mut compared) = (Vec::new(), Vec::new());
    for ((folder, config, simulation, as_recorded), name) in cases.into_iter().zip(markdown::READINGS) {
        let last = (folder == "study").then_some(&tunnel);
        let of_case = Part { config, simulation, as_recorded, last };
        let (code, claims) = case::study_part(arguments, of_case, &part(folder))?;
        codes.push(code);
        compared.push((name, claims));
    }
    folder::write("study", &part("claims"), &Provenance::begin(&[]), |folder| {
        write::text(&folder.join("claims.md"), &markdown::compared(&compared))
    })?;
    codes.push(readings::compare(arguments, &part("readings"))?);
    codes.push(self_test::run(arguments, config, &part("slope"))?);
    // More sets than an experiment's own would take longer than all the rest.
    let sets = Some(arguments.seeds.unwrap_or(experiment::SETS).min(experiment::SETS));
    let extent = experiment::Extent { sets, runs: None, seed: arguments.seed(), values: None };
    codes.push(experiment::all(&extent, &part("experiments"), false)?);
    Ok(codes.into_iter().find(|code| *code != ExitCode::SUCCESS).unwrap_or(ExitCode::SUCCESS))
}
