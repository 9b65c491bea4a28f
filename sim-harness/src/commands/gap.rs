//! `rundown gap`: recorded runs and the believed model in; which effect is missing, and the model with it, out.

use super::{Failure, screen};
use clap::builder::PossibleValuesParser;
use rundown::estimator::Estimator;
use rundown::estimator::config::Config;
use rundown::model::effects::Effects;
use rundown_files::effect_file;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::run_set::RunSet;
use rundown_files::track_file::TrackFile;
use rundown_files::train_file::TrainFile;
use rundown_gap::answer::Answer;
use rundown_gap::explain::{self, explain};
use rundown_gap::files::{Files, repaired};
use rundown_gap::innovations::innovations;
use rundown_gap::load;
use rundown_gap::report;
use rundown_gap::rivals::rivals;
use rundown_gap::rows::Believed;
use rundown_gap::runs::Run;
use rundown_gap::story::story;
use rundown_gap::workflow::{LEAST_TRAINING, investigate, most_held_out};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  Where do these runs and the model disagree, and why?
    rundown gap --train train.toml --track track.toml --runs runs/ --out gap

  The same for a program; ten runs held out to judge the repaired model:
    rundown gap --train t.toml --track k.toml --runs runs/ --out gap --hold-out 10 --json

  What an effect is, what it looks like, and which data would tell:
    rundown gap --explain steady_wind

  A set with a hidden effect to try it on:
    rundown simulate --example hidden-effect > scenario.toml
    rundown simulate --scenario scenario.toml --out set
    rundown gap --train set/train.toml --track set/track.toml --runs set/runs --out gap

Files in the output folder:
  report.html           the same for a reader: verdict, map of the disagreement, laws over the data, rivals, before and after, caveats
  gap.json              verdict, effects with 95 % intervals and rivals, gap, running time and energy before and after, evidence, caveats
  model/train.toml      the believed train with the effects of the train
  model/track.toml      the believed track with the effects of the place
  effect.frame          the effects of all runs for a board; `rundown link --effects` sends them
  residuals.csv         each interval's residual with time, location, speed, effort, temperature, day
  pulls.csv             steady power while trains gain speed, as a share of the believed limit
  before_after.csv      simulated against measured speed on the held-out runs";

/// Arguments of `rundown gap`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// The believed train
    #[arg(long, value_name = "T.toml", required_unless_present = "explain")]
    train: Option<PathBuf>,
    /// The believed track
    #[arg(long, value_name = "K.toml", required_unless_present = "explain")]
    track: Option<PathBuf>,
    /// Folder of run logs, or run logs
    #[arg(long, value_name = "DIR", required_unless_present = "explain", num_args = 1..)]
    runs: Vec<PathBuf>,
    /// Tell what an effect is, its law, what it can be confused with, and which data would tell
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(explain::NAMES), exclusive = true)]
    explain: Option<String>,
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "OUT", default_value = "gap")]
    out: PathBuf,
    /// Number of runs held out to judge the repaired model; a fifth without it, and at least five must be left
    #[arg(long, value_name = "N")]
    hold_out: Option<usize>,
    /// Direction of the runs that no index names
    #[arg(long, value_enum, default_value_t)]
    direction: DirectionChoice,
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
            out,
            hold_out: None,
            direction: DirectionChoice::default(),
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
    // Both are there: they are required unless a page is asked for.
    let path = |path: &Option<PathBuf>| path.clone().unwrap_or_default();
    let (train, core_train) = TrainFile::read(&path(&arguments.train)).map_err(Failure::refused)?;
    let (track, core_track) = TrackFile::read(&path(&arguments.track)).map_err(Failure::refused)?;
    if let Some(nowhere) = arguments.runs.iter().find(|path| !path.exists()) {
        return Err(Failure::refused(format!(
            "{}: expected a folder of run logs, or a run log; there is nothing of this name",
            nowhere.display()
        )));
    }
    // Refused before the work, not after it.
    if let Some(file) = arguments.out.ancestors().find(|path| path.is_file()) {
        return Err(Failure::refused(format!(
            "--out {}: expected a folder, or a name that is free; {} is a file",
            arguments.out.display(),
            file.display()
        )));
    }
    let set = RunSet::find(&arguments.runs).map_err(Failure::refused)?;
    let (read, notes) = load::with_recordings(&set, &track, arguments.direction);
    let (runs, recordings): (Vec<Run>, Vec<Recording>) = read.into_iter().unzip();
    set.notes.iter().chain(&notes).for_each(|text| screen::note(text));
    few_enough(arguments.hold_out, runs.len())?;
    let believed = Believed::new(&core_train, &core_track);
    let surroundings = load::surroundings(&track);
    let bar = screen::waiting();
    let tell = |text: &str| {
        if !arguments.json {
            bar.suspend(|| screen::note(text));
        }
        bar.set_message(text.to_owned());
    };
    let found = investigate(believed, &surroundings, &runs, arguments.hold_out, tell);
    let Some(found) = found else {
        bar.finish_and_clear();
        return Err(Failure {
            message: format!(
                "{} runs have too little to compare: expected moving samples with location and speed, and an effort column or long coasting; nothing was written",
                runs.len()
            ),
            code: super::SOME_RUNS_FAILED,
        });
    };
    tell("who else would explain it");
    let rivals = rivals(&found, believed, &surroundings);
    tell("the estimator's innovations with both models");
    let repaired = repaired(&found, &train, &track);
    let held_out: Vec<&Recording> = found.held_out.iter().map(|i| &recordings[*i]).collect();
    let estimator = Estimator::try_new(Config::default(), core_train, core_track.clone()).map_err(Failure::refused)?;
    let effects = |(train, track): (&TrainFile, &TrackFile), run: &str| {
        // The lists were checked when they were read; one that is too long is left out, as a board would.
        effect_file::effects(&track.effect, &train.effect, Some(run)).unwrap_or(Effects::NONE)
    };
    let innovations =
        innovations(&estimator, &held_out, |_| Effects::NONE, |run| effects((&repaired.0, &repaired.1), run));
    bar.finish_and_clear();
    let dataset: Vec<String> = arguments.runs.iter().map(|p| p.display().to_string()).collect();
    let about_track = load::about_track(&track, &runs);
    let answer = Answer {
        about_track: &about_track,
        dataset: &dataset.join(" "),
        runs: runs.len(),
        found: &found,
        rivals: &rivals,
        innovations,
        left_out: set.files.len() - runs.len(),
        described_effects: train.effect.len() + track.effect.len(),
        rotating_mass_kg: believed.train().rotating_mass_kg(),
    };
    let json = format!("{:#}\n", answer.json());
    let page = report::page(&report::Page { answer, found: &found, believed, runs: &runs });
    let texts = [("gap.json", json.clone()), ("report.html", page)];
    let files = Files::render(&found, &repaired, texts).map_err(Failure::not_written)?;
    files.write(&arguments.out).map_err(Failure::not_written)?;
    let done = if answer.left_out == 0 { ExitCode::SUCCESS } else { ExitCode::from(super::SOME_RUNS_FAILED) };
    if arguments.json {
        screen::print(&json);
        return Ok(done);
    }
    screen::print(&story(&answer));
    if let Some(found) = &innovations {
        screen::print(&format!(
            "innovations of the estimator's speed on the same runs: {:.3} m/s before, {:.3} after\n",
            found.before_mps, found.after_mps
        ));
    }
    screen::print(&format!("\nresults: {}\n", arguments.out.display()));
    Ok(done)
}

/// Refuses to hold out so many runs that too few are left to find an effect in.
fn few_enough(hold_out: Option<usize>, runs: usize) -> Result<(), Failure> {
    let most = most_held_out(runs);
    match hold_out {
        Some(asked) if asked > most => Err(Failure {
            message: format!(
                "--hold-out {asked}: an analysis needs {LEAST_TRAINING} runs and there are {runs}, so at most {most} can be held out; nothing was written"
            ),
            code: super::WRONG_ARGUMENTS,
        }),
        _ => Ok(()),
    }
}
