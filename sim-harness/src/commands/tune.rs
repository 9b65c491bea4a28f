//! `rundown tune`: the paper's filter tuned by the two criteria of section 4.2.

use super::recorded::RecordedRuns;
use super::{Failure, SOME_RUNS_FAILED, screen};
use crate::study::case::{calm, case_study};
use crate::study::sensitivity::sensitivity;
use crate::study::slope::{Answer, Plan};
use crate::study::source::RunSource;
use crate::study::{description, slope, write};
use crate::tune::page::{TuningPage, page, short};
use crate::tune::parameters::{PARAMETERS, config, place, values};
use crate::tune::score::Bench;
use crate::tune::search::{Found, search};
use crate::tune::surface::{EVALUATIONS, plane, profiles};
use rundown::estimator::config::{Config, Mode};
use rundown::tick::paper::PaperConfig;
use rundown_files::config_file;
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  On simulated runs of the case study:
    rundown tune --out tune
    rundown replay --config tune/config.toml --train train.toml --track track.toml logs/

  On recorded runs:
    rundown tune --runs logs/ --train train.toml --track track.toml --out tune

Files in the output folder:
  config.toml            the optimum, in the paper's mode; rundown replay --config takes it
  report.html            Table 1 and optimum, the surface around it, the paper's remark on sensitivity
  tune_profiles, _plane  the surface as SVG and CSV
  tune.json              all of it for machines";

/// Vehicles on which the slope at the optimum is looked at.
const VEHICLES: usize = 15;

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    #[command(flatten)]
    recorded: RecordedRuns,
    /// Runs that are tuned on, at most
    #[arg(long, value_name = "N", default_value_t = 67, value_parser = clap::value_parser!(u16).range(1..=5000))]
    count: u16,
    /// Configurations that the search may try
    #[arg(long, value_name = "N", default_value_t = 1500, value_parser = clap::value_parser!(u32).range(50..))]
    evaluations: u32,
    /// Seed of simulated runs
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Configuration whose other settings are kept
    #[arg(long, value_name = "C.toml")]
    config: Option<PathBuf>,
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/tune")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let base = match &arguments.config {
        Some(path) => config_file::read(path).map_err(Failure::refused)?,
        None => Config::default(),
    };
    let (bench, source) = bench(arguments, base)?;
    let table1 = place(&PaperConfig::default());
    let bar = screen::progress(arguments.evaluations as usize + EVALUATIONS);
    let step = || bar.inc(1);
    let found = search(&bench, u64::from(arguments.evaluations), step).map_err(Failure::refused)?;
    let pictures = [profiles(&bench, &found.place, &table1, step), plane(&bench, &found.place, step)];
    bar.finish_and_clear();
    let no_filter = || Failure::refused("Table 1 is no filter on these runs");
    let score1 = bench.score(&table1).ok_or_else(no_filter)?;
    let score = bench.score(&found.place).ok_or_else(no_filter)?;
    let sensitivity = sensitivity(&base, bench.train, &bench.track, &bench.runs).map_err(Failure::refused)?;
    let tuned = config(&base, &found.place).map_err(Failure::refused)?;
    tuned.check().map_err(Failure::refused)?;
    let slopes = [Config::default(), tuned].map(|config| paper_slope(config, arguments.seed));
    let [of_table1, of_optimum] = slopes;
    let slopes = Some([of_table1?, of_optimum?]);

    let out = &arguments.out;
    let text = toml::to_string(&tuned).map_err(Failure::refused)?;
    let json = json!({
        "evaluations": found.evaluations,
        "table1": { "values": named(&table1), "score": score1 },
        "optimum": { "values": named(&found.place), "score": score },
        "sensitivity": sensitivity,
        "slope": slopes.as_ref().map(|[a, b]| json!({ "table1": a, "optimum": b })),
    });
    let html = page(&TuningPage {
        source: source.clone(),
        table1: (table1, score1),
        found,
        score,
        pictures: &pictures,
        sensitivity: &sensitivity,
        slopes: slopes.clone(),
    });
    let written = write::folder(out)
        .and_then(|()| write::text(&out.join("config.toml"), &text))
        .and_then(|()| write::pictures(out, &pictures))
        .and_then(|()| write::text(&out.join("tune.json"), &format!("{json:#}\n")))
        .and_then(|()| write::text(&out.join("report.html"), &html));
    written.map_err(Failure::not_written)?;

    let likelihoods = [score1.per_sample(), score.per_sample()];
    screen::print(&table(&source, &table1, &found, likelihoods));
    if let Some([table1, optimum]) = &slopes {
        let words = |answer: &Answer| answer.slope.map(|v| format!("{v:.2}")).join(" / ");
        screen::print(&format!(
            "slope of estimated on true deviation, 60/100/140 km/h: {} and {}: a likely filter is no true one\n",
            words(table1),
            words(optimum)
        ));
    }
    for s in &sensitivity {
        screen::print(&format!(
            "initial deviation x {:3} on {:10}  {} of {} runs with a negative coefficient\n",
            s.factor, s.which, s.negative_runs, s.runs
        ));
    }
    screen::print(&format!(
        "\nconfiguration: {}, report: {}\n",
        out.join("config.toml").display(),
        out.join("report.html").display()
    ));
    Ok(ExitCode::SUCCESS)
}

fn bench(arguments: &Arguments, base: Config) -> Result<(Bench, String), Failure> {
    let count = usize::from(arguments.count);
    let (train, track, mut source, words) = match arguments.recorded.open()? {
        Some(opened) => (opened.train, opened.track, opened.source, "recorded"),
        None => {
            let simulation = case_study().map_err(Failure::refused)?;
            let described = description::of(&simulation).map_err(Failure::refused)?;
            let source = RunSource::simulated(simulation, arguments.seed, count);
            (described.train, described.track, source, "simulated")
        }
    };
    let mut runs = Vec::new();
    while runs.len() < count
        && let Some(chunk) = source.next_chunk().map_err(Failure::refused)?
    {
        for case in chunk {
            match case {
                Ok(case) => runs.push(case.recording),
                Err(failed) => screen::error(&failed.error),
            }
        }
    }
    runs.truncate(count);
    if runs.is_empty() {
        return Err(Failure {
            message: "no run could be used; nothing was written".to_owned(),
            code: SOME_RUNS_FAILED,
        });
    }
    let words = format!("{} {words} runs", runs.len());
    let bench = Bench { base, train, track, runs };
    Ok((bench, words))
}

/// Slope of the paper's mode with a configuration, after one run.
fn paper_slope(config: Config, seed: u64) -> Result<Answer, Failure> {
    let plan = Plan { simulation: calm().map_err(Failure::refused)?, vehicles: VEHICLES, runs: 1, seed };
    let looks = slope::look(&plan, config, || ()).map_err(Failure::refused)?;
    let described = description::of(&plan.simulation).map_err(Failure::refused)?;
    let stated = described.train.davis();
    let answers = slope::answers(&plan, &looks, &stated).into_iter();
    let word = crate::output::json::mode_word(Mode::Paper);
    let mut of_paper = answers.filter(|answer| answer.mode == word);
    of_paper.next().ok_or_else(|| Failure::refused("the self-test has no answer for the paper's mode"))
}

fn named(place: &crate::tune::parameters::Place) -> serde_json::Value {
    let values = values(place);
    let pairs = PARAMETERS.iter().zip(values);
    pairs.map(|(parameter, value)| (parameter.name.to_owned(), json!(value))).collect::<serde_json::Map<_, _>>().into()
}

fn table(source: &str, table1: &crate::tune::parameters::Place, found: &Found, likelihoods: [f64; 2]) -> String {
    let mut text =
        format!("{source}, {} configurations\n\n{:22} {:>12} {:>12}\n", found.evaluations, "", "Table 1", "optimum");
    let (before, after) = (values(table1), values(&found.place));
    for (index, parameter) in PARAMETERS.iter().enumerate() {
        text += &format!(
            "{:22} {:>12} {:>12} {}\n",
            parameter.name,
            short(before[index]),
            short(after[index]),
            parameter.unit
        );
    }
    text += &format!("{:22} {:>12.3} {:>12.3}\n\n", "log-likelihood/sample", likelihoods[0], likelihoods[1]);
    text
}
