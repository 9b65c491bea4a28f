//! `rundown gap`: recorded runs and the believed model in; which effect is missing, and the model with it, out.

use super::{Failure, screen};
use crate::effect_file::{self, EffectEntry};
use crate::effect_frame;
use crate::gap::explain::{self, explain};
use crate::gap::innovations::innovations;
use crate::gap::load;
use crate::gap::report;
use crate::gap::rows::Believed;
use crate::gap::tables;
use crate::gap::workflow::{Investigation, investigate};
use crate::map_matching::CentreLine;
use crate::output::WriteError;
use crate::recording::{DirectionChoice, Recording};
use crate::run_log::{BadRows, RunLog};
use crate::run_set::{RunFile, RunSet};
use crate::track_file::TrackFile;
use crate::train_file::TrainFile;
use clap::builder::PossibleValuesParser;
use rundown::config::Config;
use rundown::effects::Effects;
use rundown::estimator::Estimator;
use serde_json::json;
use std::fs;
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

  A set with a hidden effect to try it on (take the # from the lines of an [[effect]] in the scenario):
    rundown simulate --example > scenario.toml
    rundown simulate --scenario scenario.toml --out set
    rundown gap --train set/train.toml --track set/track.toml --runs set/runs --out gap

Files in the output folder:
  report.html           the same for a reader: verdict, map of the disagreement, rivals, before and after, caveats
  gap.json              verdict, effects with 95 % intervals and rivals, gap before and after, evidence
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
    /// Number of runs held out to judge the repaired model; a fifth without it
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
    let set = RunSet::find(&arguments.runs).map_err(Failure::refused)?;
    let (runs, notes) = load::runs(&set, &track, arguments.direction);
    set.notes
        .iter()
        .chain(&notes)
        .for_each(|text| screen::note(text));
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
    let dataset = arguments
        .runs
        .iter()
        .map(|p| p.display().to_string())
        .collect::<Vec<_>>()
        .join(" ");
    let repaired = repaired(&found, &train, &track);
    let names: Vec<&str> = found
        .held_out
        .iter()
        .map(|i| runs[*i].name.as_str())
        .collect();
    let recordings = recordings_of(&names, &set, &track, arguments.direction);
    let estimator = Estimator::try_new(Config::default(), core_train, core_track.clone())
        .map_err(Failure::refused)?;
    let effects = |(train, track): (&TrainFile, &TrackFile), run: &str| {
        // The lists were checked when they were read; one that is too long is left out, as a board would.
        effect_file::effects(&track.effect, &train.effect, Some(run)).unwrap_or(Effects::NONE)
    };
    tell("the estimator's innovations with both models");
    let innovations = innovations(
        &estimator,
        &recordings,
        |run| effects((&train, &track), run),
        |run| effects((&repaired.0, &repaired.1), run),
    );
    bar.finish_and_clear();
    let mut json = found.json(&dataset);
    if let Some(found) = &innovations {
        json["innovations"] = json!({
            "what": "root mean square of the speed innovation of the estimator, held-out runs",
            "unit": "m/s",
            "before": found.before_mps,
            "after": found.after_mps,
        });
    }
    let page = report::page(&report::Page {
        dataset: &dataset,
        found: &found,
        believed,
        runs: &runs,
        innovations,
    });
    let texts = [("gap.json", format!("{json:#}\n")), ("report.html", page)];
    write(&arguments.out, &found, &repaired, &texts).map_err(Failure::not_written)?;
    if arguments.json {
        screen::print(&format!("{json:#}\n"));
    } else {
        screen::print(&story(&found));
        if let Some(found) = &innovations {
            screen::print(&format!(
                "innovations of the estimator's speed on the same runs: {:.3} m/s before, {:.3} after\n",
                found.before_mps, found.after_mps
            ));
        }
        screen::print(&format!("\nresults: {}\n", arguments.out.display()));
    }
    Ok(ExitCode::SUCCESS)
}

/// What a person reads on the screen.
fn story(found: &Investigation) -> String {
    let gap = &found.gap;
    let mut text = format!(
        "verdict: {}   p-value of the residuals without a gap: {:.3}\n",
        found.verdict(),
        found.p_value
    );
    for one in &found.named {
        let json = one.json();
        text.push_str(&format!("  {}  {}", one.effect.name(), json["parameters"]));
        if let Some((from_m, to_m)) = one.effect.section_m() {
            text.push_str(&format!("  from {from_m:.0} to {to_m:.0} m"));
        }
        text.push_str(&format!("  confidence {:.2}", one.confidence));
        if !one.ambiguous_with.is_empty() {
            text.push_str(&format!(
                "  cannot be told from {}; would tell: {}",
                one.ambiguous_with.join(", "),
                one.would_separate.join(", ")
            ));
        }
        text.push('\n');
    }
    if found.compared.is_empty() {
        text.push_str(
            "no held-out run could be compared: too few runs, or too little to simulate in them\n",
        );
        return text;
    }
    let gone = match gap.removed() {
        Some(share) if gap.after_mps <= gap.before_mps => {
            format!("{:.0} % of the removable gap is gone", 100.0 * share)
        }
        Some(_) => "worse than before".to_owned(),
        None => "there was nothing to remove".to_owned(),
    };
    text.push_str(&format!(
        "simulated against measured speed, {} held-out runs: {:.3} m/s before, {:.3} after, noise floor {:.3}: {gone}\n",
        found.held_out.len(),
        gap.before_mps,
        gap.after_mps,
        gap.floor_mps,
    ));
    text
}

/// Train and track with what was found.
fn repaired(found: &Investigation, train: &TrainFile, track: &TrackFile) -> (TrainFile, TrackFile) {
    let (mut train, mut track) = (train.clone(), track.clone());
    for one in &found.named {
        let entry = EffectEntry {
            effect: one.effect.clone(),
            runs: (!one.runs.is_empty()).then(|| one.runs.clone()),
        };
        match one.effect.section_m() {
            Some(_) => track.effect.push(entry),
            None => train.effect.push(entry),
        }
    }
    (train, track)
}

/// The recordings of these runs.
fn recordings_of(
    names: &[&str],
    set: &RunSet,
    track: &TrackFile,
    direction: DirectionChoice,
) -> Vec<Recording> {
    let line = CentreLine::new(&track.centre_line);
    let read = |file: &RunFile| {
        let log = RunLog::read(&file.path, BadRows::LeaveOut).ok()?;
        Recording::new(file, &log, line.as_ref(), direction).ok()
    };
    // What could not be read was reported before, and is in no analysis.
    let read = set.files.iter().filter_map(read);
    read.filter(|r| names.contains(&r.name.as_str())).collect()
}

fn write(
    out: &Path,
    found: &Investigation,
    (train, track): &(TrainFile, TrackFile),
    texts: &[(&str, String)],
) -> Result<(), WriteError> {
    let model = out.join("model");
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source| WriteError { path, source }
    };
    fs::create_dir_all(&model).map_err(at(&model))?;
    let put = |path: PathBuf, text: &str| fs::write(&path, text).map_err(at(&path));
    for (name, text) in texts {
        put(out.join(name), text)?;
    }
    let path = model.join("train.toml");
    let text = toml::to_string(train).map_err(|e| at(&path)(std::io::Error::other(e)))?;
    put(path, &text)?;
    let path = model.join("track.toml");
    let text = toml::to_string(track).map_err(|e| at(&path)(std::io::Error::other(e)))?;
    put(path, &text)?;
    let path = out.join("effect.frame");
    let failed = |e: String| at(&path)(std::io::Error::other(e));
    let effects = effect_file::effects(&track.effect, &train.effect, None)
        .map_err(|e| failed(e.to_string()))?;
    let bytes = effect_frame::write(&effects).map_err(|e| failed(e.to_string()))?;
    fs::write(&path, bytes).map_err(at(&path))?;
    tables::residuals(&out.join("residuals.csv"), &found.findings.rows)?;
    tables::pulls(&out.join("pulls.csv"), &found.findings.pulls)?;
    tables::before_after(&out.join("before_after.csv"), found)
}
