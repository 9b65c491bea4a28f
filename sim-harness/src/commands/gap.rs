//! `rundown gap`: recorded runs and the believed model in; which effect is missing, and the model with it, out.

use super::{Failure, RunPagesChoice, Strict, screen};
use crate::alike::few;
use clap::builder::PossibleValuesParser;
use rundown::model::effects::EffectKind;
use rundown_files::{folder, recording::DirectionChoice};
use rundown_gap::answer::{files::AnswerError, story::story};
use rundown_gap::candidates::{explain, printed_config, read_config};
use rundown_gap::config::GapConfig;
use rundown_gap::input::Input;
use rundown_gap::refusal::Refusal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  Where do these runs and the model disagree, and why?
    rundown gap --train train.toml --track track.toml --runs runs/ --out gap

  The same for a program; ten runs held out to judge the repaired model:
    rundown gap --train t.toml --track k.toml --runs runs/ --out gap --hold-out 10 --json

  What an effect is, what it looks like, and which data would separate it:
    rundown gap --explain steady_wind

  All thresholds and priors with their units and sources, to be changed and given back with --config:
    rundown gap --print-config > gap.toml

  A set with a hidden effect to try it on:
    rundown simulate --example hidden-effect > scenario.toml
    rundown simulate --scenario scenario.toml --out set
    rundown gap --train set/train.toml --track set/track.toml --runs set/runs --out gap

Files in the output folder:
  gap.json              verdict, effects with 95 % intervals and rivals, gap, running time and energy before and after, evidence, caveats
  report.html, report/  the same for a reader: verdict, map of the disagreement, laws over the data, rivals, before and after, caveats
  model/train.toml      the believed train with the effects of the train
  model/track.toml      the believed track with the effects of the place
  effect.frame          the effects of all runs for a board; `rundown link --effects` sends them
  residuals.csv         each interval's residual with time, location, speed, effort, temperature, day
  powering.csv          steady power while trains gain speed, as a share of the believed limit
  before_after.csv      simulated against measured speed on the hold-out runs";

/// Arguments of `rundown gap`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// The believed train
    #[arg(long, value_name = "T.toml", required_unless_present_any = ["explain", "print_config"])]
    train: Option<PathBuf>,
    /// The believed track
    #[arg(long, value_name = "K.toml", required_unless_present_any = ["explain", "print_config"])]
    track: Option<PathBuf>,
    /// Folder of run logs, or run logs
    #[arg(long, value_name = "DIR", required_unless_present_any = ["explain", "print_config"], num_args = 1..)]
    runs: Vec<PathBuf>,
    /// Say what an effect is, its law, what it is confounded with, and which data would separate it
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(EffectKind::ALL.map(EffectKind::name)), exclusive = true)]
    explain: Option<String>,
    /// Thresholds and priors, as --print-config prints them; what a file leaves out stays as it is
    #[arg(long, value_name = "GAP.toml")]
    config: Option<PathBuf>,
    /// Print all thresholds and priors, each with its unit and source
    #[arg(long, exclusive = true)]
    print_config: bool,
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "OUT", default_value = "gap")]
    out: PathBuf,
    /// Number of runs held out to judge the repaired model; a fifth without it, and at least five must be left
    #[arg(long, value_name = "N")]
    hold_out: Option<usize>,
    /// Direction of the runs that no index names
    #[arg(long, value_enum, default_value_t)]
    direction: DirectionChoice,
    /// Take the logs as they are: what `rundown check` would put right is left as it is
    #[arg(long)]
    as_recorded: bool,
    #[command(flatten)]
    pages: RunPagesChoice,
    #[command(flatten)]
    strict: Strict,
    /// Print gap.json to stdout, and nothing else
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Of a folder as `rundown simulate` writes it.
    pub(super) fn of_set(set: &Path, out: PathBuf) -> Self {
        Self {
            train: Some(set.join("train.toml")),
            track: Some(set.join("track.toml")),
            runs: vec![set.join("runs")],
            explain: None,
            config: None,
            print_config: false,
            out,
            hold_out: None,
            direction: DirectionChoice::default(),
            as_recorded: false,
            pages: RunPagesChoice { run_pages: true },
            strict: Strict { strict: false },
            json: false,
        }
    }
}

/// Does what the arguments say.
pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    if let Some(text) = arguments.explain.as_deref().and_then(explain) {
        screen::print(&text);
        return Ok(ExitCode::SUCCESS);
    }
    if arguments.print_config {
        screen::print(&printed_config());
        return Ok(ExitCode::SUCCESS);
    }
    let config = arguments.config.as_deref().map_or_else(|| Ok(GapConfig::default()), read_config).map_err(failed)?;
    // Both are there: they are required unless a page is asked for.
    let path = |path: &Option<PathBuf>| path.clone().unwrap_or_default();
    let (train, track) = (path(&arguments.train), path(&arguments.track));
    let input =
        Input::read(&train, &track, &arguments.runs, arguments.direction, arguments.as_recorded).map_err(failed)?;
    // Refused before the work, not after it.
    folder::try_place("gap", &arguments.out)?;
    few(&input.notes).iter().for_each(|text| screen::note(text));
    arguments.strict.check(input.notes.len())?;
    let bar = screen::waiting();
    let tell = |text: &str| {
        if !arguments.json {
            bar.suspend(|| screen::step(text));
        }
        bar.set_message(text.to_owned());
    };
    let answer = rundown_gap::run(input, config, arguments.hold_out, tell);
    bar.finish_and_clear();
    let answer = answer.map_err(failed)?;
    answer.write(&arguments.out, arguments.pages.run_pages).map_err(|error| match error {
        AnswerError::Render(error) => Failure::not_written(error),
        AnswerError::Write(error) => Failure::not_written(error),
    })?;
    let done = if answer.input.left_out == 0 { ExitCode::SUCCESS } else { ExitCode::from(super::SOME_RUNS_FAILED) };
    if arguments.json {
        screen::print(&answer.json_text());
        return Ok(done);
    }
    screen::print(&story(&answer));
    if let Some(found) = &answer.innovations {
        screen::print(&format!(
            "innovations of the estimator's speed on the same runs: {:.3} m/s before, {:.3} after\n",
            found.before_mps, found.after_mps
        ));
    }
    screen::print(&format!("\nresults: {}\n", arguments.out.display()));
    Ok(done)
}

fn failed(refusal: Refusal) -> Failure {
    let code = match refusal {
        Refusal::HoldOut { .. } => super::WRONG_ARGUMENTS,
        Refusal::TooLittle { .. } | Refusal::TooFew { .. } | Refusal::EffortColumn { .. } => super::NOTHING_USABLE,
        Refusal::Effects(_) => super::NOTHING_USABLE,
        // The others are of what was given: a file, a folder, the track.
        _ => super::DESCRIPTION_REFUSED,
    };
    Failure { message: refusal.to_string(), code }
}
