//! `rundown tune`: the paper's filter tuned by the two criteria of section 4.2.

use super::recorded::RecordedRuns;
use super::{Failure, screen};
use crate::report::TruthView;
use crate::study::case::{Case, calm, case_study};
use crate::study::figures::run::truth_view;
use crate::study::slope::{SlopeAnswer, SlopePlan};
use crate::study::{description, slope, write};
use crate::tune::page::{Tuning, page, short};
use crate::tune::parameters::{PARAMETERS, Place, config, place, values};
use crate::tune::runs;
use crate::tune::surface::{EVALUATIONS, plane, profiles};
use crate::{study::source::RunSource, study::trials::sensitivity, tune::score::Bench, tune::search::search};
use rundown::estimator::config::{Config, Mode};
use rundown::tick::paper::PaperConfig;
use rundown_check::gradients::Answer;
use rundown_files::folder::{self, Provenance};
use rundown_files::recording::Recording;
use rundown_pages::numbers::{counted, number};
use serde_json::json;
use std::path::{Path, PathBuf};
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
  report.html, report/   Table 1 and optimum, the surface around it, the paper's remark on sensitivity, each run
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
    /// Configurations that the search may try; it ends before where it has settled
    #[arg(long, value_name = "N", default_value_t = 5000, value_parser = clap::value_parser!(u32).range(50..))]
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
    #[command(flatten)]
    pages: super::RunPagesChoice,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let base = super::config(arguments.config.as_deref())?;
    let TunedRuns { bench, truths, source, provenance, answer, gradient_sd_permille } = runs_of(arguments, base)?;
    let table1 = place(&PaperConfig::default());
    let bar = screen::progress(arguments.evaluations as usize + EVALUATIONS);
    let step = || bar.inc(1);
    let found = search(&bench, u64::from(arguments.evaluations), step).map_err(Failure::refused)?;
    let pictures = [profiles(&bench, &found.place, &table1, step), plane(&bench, &found.place, step)];
    bar.finish_and_clear();
    let score = |place| bench.score(place).ok_or_else(|| Failure::no_runs("Table 1 is no filter on these runs"));
    let scores = [score(&table1)?, score(&found.place)?];
    let sensitivity = sensitivity(&base, bench.train, &bench.track, &bench.runs)?;
    let tuned = config(&base, &found.place).map_err(Failure::refused)?;
    tuned.check()?;
    let slopes = [paper_slope(Config::default(), arguments.seed)?, paper_slope(tuned, arguments.seed)?];
    let has_run_pages = arguments.pages.run_pages;
    let runs = runs::scored(&bench, [&table1, &found.place]);
    let runs = runs.ok_or_else(|| Failure::no_runs("the optimum is no filter on these runs"))?;
    let tuning = Tuning { source, table1, found, scores, pictures, runs, has_run_pages, sensitivity, slopes };
    folder::write("tune", &arguments.out, &provenance, |folder| {
        if has_run_pages {
            runs::write_pages(folder, &bench, &truths, &tuned)?;
        }
        write_results(folder, &tuned, &tuning, gradient_sd_permille)
    })?;
    screen::print(&words(&tuning, &arguments.out));
    screen::print(&screen::small_errors(answer.small));
    if let Some(caveat) = tuning.found.caveat() {
        screen::note(&caveat);
    }
    Ok(ExitCode::SUCCESS)
}

fn write_results(out: &Path, tuned: &Config, tuning: &Tuning, gradient_sd_permille: f64) -> Result<(), Failure> {
    let Tuning { table1, found, scores, sensitivity, slopes, .. } = tuning;
    let json = json!({
        "evaluations": found.evaluations,
        "unsettled": found.unsettled,
        "table1": { "values": named(table1), "score": scores[0] },
        "optimum": { "values": named(&found.place), "score": scores[1] },
        "sensitivity": sensitivity,
        "slope": { "table1": slopes[0], "optimum": slopes[1] },
        "gradient_sd_permille": gradient_sd_permille,
    });
    write::text(&out.join("config.toml"), &toml::to_string(tuned).map_err(Failure::refused)?)?;
    write::pictures(out, &tuning.pictures)?;
    write::text(&out.join("tune.json"), &format!("{json:#}\n"))?;
    write::text(&out.join("report.html"), &page(tuning))?;
    Ok(())
}

struct TunedRuns {
    bench: Bench,
    /// Of each run, where it is known.
    truths: Vec<Option<TruthView>>,
    /// In words.
    source: String,
    /// The files that were read.
    provenance: Provenance,
    /// What the coasts say of the descriptions.
    answer: Answer,
    /// How far gradients are taken to be off; the paper's filter, which is tuned, knows no such doubt.
    gradient_sd_permille: f64,
}

fn runs_of(arguments: &Arguments, base: Config) -> Result<TunedRuns, Failure> {
    let count = usize::from(arguments.count);
    let mut inputs: Vec<PathBuf> = arguments.config.iter().cloned().collect();
    let mut answer = Answer::default();
    let (train, track, mut source, words, base) = match arguments.recorded.open(&base)? {
        Some(opened) => {
            inputs.extend(opened.inputs);
            answer = opened.answer;
            (opened.train, opened.track, opened.source, "recorded", opened.config)
        }
        None => {
            let simulation = case_study()?;
            let described = description::of(&simulation)?;
            let source = RunSource::simulated(simulation, arguments.seed, count, true);
            (described.train, described.track, source, "simulated", base)
        }
    };
    let provenance = Provenance::begin(&inputs);
    let (mut cases, mut refused) = (Vec::new(), Vec::new());
    while cases.len() < count
        && let Some(chunk) = source.next_chunk()?
    {
        for case in chunk {
            match case {
                Ok(case) if source.sets_aside(&case) => (),
                Ok(case) => cases.push(case),
                Err(failed) => refused.push(failed),
            }
        }
    }
    screen::errors(&refused);
    cases.truncate(count);
    let notes = source.notes();
    notes.iter().for_each(|text| screen::note(text));
    arguments.recorded.strict.check(notes.len() + refused.len())?;
    if cases.is_empty() {
        return Err(Failure::no_runs("no run could be used; nothing was written"));
    }
    let moving = moving(cases)?.into_iter();
    let (runs, truths): (Vec<Recording>, Vec<_>) =
        moving.map(|case| (case.recording, case.truth.as_ref().map(truth_view))).unzip();
    let source = counted(runs.len(), &format!("{words} run"), &format!("{words} runs"));
    let mut doubted = base.track_doubt;
    answer.raise(&mut doubted);
    let gradient_sd_permille = doubted.gradient_sd_permille;
    let bench = Bench { base, train, track, runs };
    Ok(TunedRuns { bench, truths, source, provenance, answer, gradient_sd_permille })
}

/// The runs that say something of a filter; a refusal where none does.
fn moving(cases: Vec<Case>) -> Result<Vec<Case>, Failure> {
    let (all, least) = (cases.len(), runs::LEAST_MOVING_ROWS);
    let (moving, standing): (Vec<Case>, Vec<Case>) = cases.into_iter().partition(|case| runs::moves(&case.recording));
    if moving.is_empty() {
        let message = format!(
            "expected a run with {least} rows of a moving train, found none of {all}: no filter is tuned on these; nothing was written"
        );
        return Err(Failure::no_runs(message));
    }
    if !standing.is_empty() {
        let count = standing.len();
        screen::note(&format!("left out, with fewer than {least} rows of a moving train: {count} of {all} runs"));
    }
    Ok(moving)
}

/// Slope of the paper's mode with a configuration, after one run.
fn paper_slope(config: Config, seed: u64) -> Result<SlopeAnswer, Failure> {
    let plan = SlopePlan { simulation: calm()?, vehicles: VEHICLES, runs: 1, seed };
    let answers = slope::self_test(&plan, config, || ())?.answers.into_iter();
    let word = crate::output::json::mode_word(Mode::Paper);
    let mut of_paper = answers.filter(|answer| answer.mode == word);
    of_paper.next().ok_or_else(|| Failure::refused("the self-test has no answer for the paper's mode"))
}

fn named(place: &Place) -> serde_json::Value {
    let pairs = PARAMETERS.iter().zip(values(place));
    pairs.map(|(parameter, value)| (parameter.name.to_owned(), json!(value))).collect::<serde_json::Map<_, _>>().into()
}

fn words(tuning: &Tuning, out: &Path) -> String {
    let Tuning { source, table1, found, scores, sensitivity, slopes, .. } = tuning;
    let mut text =
        format!("{source}, {} configurations\n\n{:22} {:>12} {:>12}\n", found.evaluations, "", "Table 1", "optimum");
    for (parameter, (before, after)) in PARAMETERS.iter().zip(values(table1).into_iter().zip(values(&found.place))) {
        text += &format!("{:22} {:>12} {:>12} {}\n", parameter.name, short(before), short(after), parameter.unit);
    }
    let [before, after] = scores.map(|score| score.per_sample());
    text += &format!("{:22} {before:>12.3} {after:>12.3}\n\n", "log-likelihood/sample");
    let [before, after] = slopes.each_ref().map(|answer| answer.slope.map(|v| number(v, 2)).join(" / "));
    text += &format!(
        "slope of estimated on true deviation, 60/100/140 km/h: {before} and {after}: a likely filter is no true one\n"
    );
    for s in sensitivity {
        text += &format!(
            "initial deviation x {:3} on {:10}  {} of {} with a negative coefficient\n",
            s.factor,
            s.which,
            s.negative_runs,
            counted(s.runs, "run", "runs")
        );
    }
    let [config, report] = ["config.toml", "report.html"].map(|name| out.join(name));
    text + &format!("\nconfiguration: {}, report: {}\n", config.display(), report.display())
}
