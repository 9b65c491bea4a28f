//! `check`: run logs in, what their recorder did to them out. The command and the Python module do this.

mod page;
mod parts;
mod pictures;
mod run_page;
mod run_pictures;

pub use page::write;

use crate::logs::{self, Failed};
use crate::replaying::Runs;
use rayon::prelude::*;
use rundown_check::figure::Figure;
use rundown_check::finding::Finding;
use rundown_check::gradients::Coasts;
use rundown_check::limits;
use rundown_check::{Check, Known, RecorderCheck, check_beside};
use rundown_files::column::{Column, Filled, filled};
use rundown_files::map_matching::CentreLine;
use rundown_files::off_track::{BEYOND_M, OffTrack};
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::run_rows;
use rundown_files::run_set::{RunFile, RunSet};
use rundown_files::sample::Sample;
use rundown_files::{refusal::ReadError, run_log::BadRows, track_file::TrackFile, train_file::TrainFile};
use rundown_pages::numbers::counted;
use serde::Serialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What was found.
#[derive(Debug)]
pub struct Checked {
    /// Recorder by recorder and run by run; none where no log can be read.
    pub found: Option<Check>,
    /// Logs that cannot be read.
    pub failed: Vec<Failed>,
    /// What a person may want to know about the order of the runs.
    pub notes: Vec<String>,
    /// Rows of logs that could not be read and were left out, and other things that are wrong with their text.
    pub warnings: Vec<String>,
}

/// Warnings of one log that are kept.
const WARNINGS: usize = 3;
/// Logs that cannot be read and are named in the last line; each has its error beside it.
const NAMED: usize = 3;

/// The logs of a [`Check`], each in the place of its run.
#[derive(Debug)]
pub struct Logs {
    /// Rows as they were recorded.
    pub recorded: Vec<Vec<Sample>>,
    /// What was put right.
    pub right: Vec<Recording>,
    /// Files that were read.
    pub inputs: Vec<PathBuf>,
}

/// What the logs are compared with, where it is known.
#[derive(Clone, Copy, Debug, Default)]
pub struct Described<'a> {
    /// A track whose centre line gives the locations of logs that have coordinates only, and whose stops are stations.
    pub track: Option<&'a Path>,
    /// With a track: do its gradients explain how this train coasts?
    pub train: Option<&'a Path>,
}

/// Diagnoses run logs, folders of run logs, or a table in memory. `done` is called once for each log that was read.
///
/// # Errors
/// [`ReadError`] when a description, a folder, an index or the table cannot be read.
pub fn check(runs: Runs, described: Described<'_>, done: impl Fn() + Sync) -> Result<Checked, ReadError> {
    examined(runs, described, done, |_| Vec::new()).map(|(checked, _)| checked)
}

/// The same with the logs, before and after.
///
/// # Errors
/// As [`check`].
pub fn check_with_logs(runs: &[PathBuf], described: Described<'_>) -> Result<(Checked, Logs), ReadError> {
    let kept = |recordings: &[Recording]| recordings.iter().map(|recording| recording.rows.clone()).collect();
    examined(Runs::Paths(runs.to_vec()), described, || (), kept)
}

fn examined(
    runs: Runs,
    described: Described<'_>,
    done: impl Fn() + Sync,
    kept: impl FnOnce(&[Recording]) -> Vec<Vec<Sample>>,
) -> Result<(Checked, Logs), ReadError> {
    let (track, core_track) = described.track.map(TrackFile::read).transpose()?.unzip();
    let train = described.train.map(TrainFile::read).transpose()?.map(|(_, train)| train);
    let line = track.as_ref().and_then(|track| CentreLine::new(&track.centre_line));
    let stops_m = track.as_ref().map_or_else(Vec::new, TrackFile::stops_m);
    let limits = limits::Described::of(train, track.as_ref());
    let known = Known { stops_m, limits, track: core_track.clone(), moves_locations: true, ..Known::default() };
    let one = |file: &RunFile| {
        let read = logs::read(file, BadRows::LeaveOut, line.as_ref(), DirectionChoice::Auto);
        done();
        read
    };
    let (read, inputs, mut notes): (Vec<Result<Recording, Failed>>, _, _) = match runs {
        Runs::Tables(tables) => {
            let recordings = run_rows::recordings(tables, line.as_ref())?;
            (recordings.into_iter().map(Ok).collect(), Vec::new(), Vec::new())
        }
        Runs::Paths(paths) => {
            let set = RunSet::find(&paths)?;
            // Where `done` unwinds, as for an interrupt, the other threads end, too.
            (set.files.par_iter().panic_fuse().map(one).collect(), set.paths(), set.notes)
        }
    };
    let (mut recordings, mut failed) = (Vec::new(), Vec::new());
    for result in read {
        match result {
            Ok(recording) => recordings.push(recording),
            Err(failure) => failed.push(failure),
        }
    }
    let warnings = recordings.iter().flat_map(first_warnings).collect();
    let lacking = recordings.iter().filter(|recording| recording.rows_left_out > 0).count();
    if lacking > 0 {
        notes.push(format!(
            "{lacking} of {} logs have rows that cannot be read, and are diagnosed without these; a replay uses such a run with \
             --skip-bad-rows only",
            recordings.len()
        ));
    }
    let recorded = kept(&recordings);
    let mut found = (!recordings.is_empty()).then(|| check_beside(&mut recordings, &known));
    if let (Some(found), Some(track)) = (&mut found, &track) {
        let usable = recordings.iter().zip(&found.runs).filter(|(_, run)| run.is_usable());
        let usable = usable.map(|(recording, _)| recording);
        let mut off = OffTrack::new(track, BEYOND_M);
        usable.clone().for_each(|recording| off.add(&recording.rows));
        found.off_track = off.any();
        if let (Some(train), Some(core)) = (train, core_track) {
            let mut coasts = Coasts::default();
            usable.for_each(|recording| coasts.add(std::slice::from_ref(recording), &train));
            (found.gradients, found.resistance) = coasts.doubts(&train, &core, track.gradient_sd_permille());
        }
    }
    Ok((Checked { found, failed, notes, warnings }, Logs { recorded, right: recordings, inputs }))
}

fn first_warnings(recording: &Recording) -> Vec<String> {
    let all = &recording.warnings;
    let mut warnings: Vec<String> = all.iter().take(WARNINGS).cloned().collect();
    if let Some(more) = all.len().checked_sub(WARNINGS).filter(|more| *more > 0) {
        warnings.push(format!("{}: {}", recording.path.display(), counted(more, "more warning", "more warnings")));
    }
    warnings
}

/// A finding of a run, or of all runs of a recorder.
#[derive(Clone, Debug)]
pub struct Found {
    run: Option<String>,
    recorder: String,
    finding: Finding,
    /// As a sentence, with its evidence.
    text: String,
}

/// The columns of the findings.
pub fn columns() -> Vec<Column<Found>> {
    let side = |at: usize| move |f: &Found| (f.finding.figure.sd > 0.0).then(|| f.finding.figure.interval()[at]);
    vec![
        Column::text("run", "name of the run", |f: &Found| f.run.as_deref().map(str::to_owned).unwrap_or_default())
            .empty_when("it is found in all runs of a recorder"),
        Column::text("recorder", "unit of the index `runs.csv`", |f: &Found| f.recorder.clone())
            .empty_when("no index names one"),
        Column::text("kind", "what is the matter", |f: &Found| word(&f.finding.kind)),
        Column::number("value", "", "how much, in the unit beside it", |f: &Found| f.finding.figure.value),
        Column::number("low", "", "lower end of its 95 % interval", side(0)).empty_when("it has none"),
        Column::number("high", "", "upper end of its 95 % interval", side(1)).empty_when("it has none"),
        Column::text("unit", "unit of the value", |f: &Found| f.finding.unit.to_owned()).empty_when("it has none"),
        Column::count("count", "times that it was seen, or rows", |f: &Found| f.finding.count),
        Column::count("line", "first line of the log where it is seen, 0: the whole log", |f: &Found| {
            f.finding.line as usize
        }),
        Column::text("done", "`put_right`, `left_out`, `said` or `refused`", |f: &Found| word(&f.finding.done)),
        Column::text("text", "the same as a sentence", |f: &Found| f.text.clone()),
    ]
}

/// The whole diagnosis, with the logs that cannot be read.
#[derive(Serialize)]
struct Whole<'a> {
    #[serde(flatten)]
    found: &'a Check,
    failed: Vec<Value>,
}

/// What `rundown check --json` prints.
///
/// # Errors
/// None is known: a diagnosis has no keys but texts.
pub fn json(found: &Check, failed: &[Failed]) -> serde_json::Result<String> {
    serde_json::to_string_pretty(&Whole { found, failed: failed.iter().map(Failed::json).collect() })
}

/// What `rundown check --json` prints: path, unit, meaning, when it is null.
pub const FIELDS: &[[&str; 4]] = &[
    ["recorders[].unit", "", "unit of the index `runs.csv`, empty without one", ""],
    ["recorders[].compared", "", "runs that moved long enough to compare speed and location", ""],
    ["recorders[].runs", "", "runs", ""],
    ["recorders[].speed_step_kmh", "km/h", "step of the speeds", "they have none"],
    ["recorders[].location_step_m", "m", "step of the locations", "they have none"],
    ["recorders[].effort_step_n_per_kg", "N/kg", "step of the efforts", "they have none"],
    ["recorders[].scale.*", "1", "measured over true speed: `value` and `sd`", "nothing was compared"],
    ["recorders[].offset_kmh.*", "km/h", "true less read speed: `value` and `sd`", "nothing was compared"],
    [
        "recorders[].skew_s.*",
        "s",
        "age of the speed against the location, median over runs: `value` and `sd`",
        "nothing was compared",
    ],
    ["recorders[].skew_spread_s", "s", "how much that differs from run to run", "nothing was compared"],
    [
        "recorders[].lost_second_sd_s",
        "s",
        "how surely it is known that no wheel hides lost seconds: standard deviation of the height of their steps",
        "nothing was compared",
    ],
    ["recorders[].correction.offset_mps", "m/s", "what is added to each speed above 0", ""],
    ["recorders[].correction.scale", "1", "by what the sum is divided", ""],
    ["recorders[].findings[].*", "", "what was found in all runs: as below", ""],
    ["recorders[].evidence.*", "", "what says so, by the kind of the finding", "absent: the figure says it all"],
    ["runs[].name", "", "name of the run", ""],
    ["runs[].unit", "", "unit of the index `runs.csv`, empty without one", ""],
    ["runs[].rows", "", "rows of the log", ""],
    ["runs[].step_s", "s", "usual time between rows", ""],
    ["runs[].skew_s.*", "s", "age of the speed against the location: `value` and `sd`", "too little moves"],
    ["runs[].location_noise_m", "m", "standard deviation of the white noise of the locations", "nothing was compared"],
    ["runs[].scale.*", "1", "measured over true speed of this run alone: `value` and `sd`", "nothing was compared"],
    ["runs[].perturbations[].cause", "", "`unscheduled_stop` or `held_back`", ""],
    ["runs[].perturbations[].from_m", "m", "lowest location of the place", ""],
    ["runs[].perturbations[].to_m", "m", "highest location of the place", ""],
    ["runs[].perturbations[].duration_s", "s", "time at a stand, or lost against the other runs", ""],
    ["runs[].perturbations[].speed_kmh", "km/h", "lowest speed there", ""],
    [
        "runs[].perturbations[].others_kmh",
        "km/h",
        "what three quarters of the other runs exceed there",
        "the run stopped",
    ],
    ["runs[].perturbations[].others_stopping", "", "other runs that stop there, too", ""],
    ["runs[].perturbations[].others", "", "other runs that pass", ""],
    ["runs[].evidence.*", "", "what says so, by the kind of the finding", "absent: the figure says it all"],
    ["runs[].findings[].kind", "", "what is the matter", ""],
    ["runs[].findings[].figure.value", "as `unit`", "how much", ""],
    ["runs[].findings[].figure.sd", "as `unit`", "its standard deviation, 0 where there is none", ""],
    ["runs[].findings[].unit", "", "unit of the figure, empty where it has none", ""],
    ["runs[].findings[].count", "", "times that it was seen, or rows", ""],
    ["runs[].findings[].line", "", "first line of the log where it is seen, 0: the whole log", ""],
    ["runs[].findings[].done", "", "`put_right`, `left_out`, `said` or `refused`", ""],
    ["not_compared", "", "runs among which perturbed ones cannot be recognised", ""],
    ["off_track.off", "", "locations of moving trains that are not on the described track", ON_TRACK],
    ["off_track.locations", "", "locations of moving trains", ON_TRACK],
    ["off_track.least_m", "m", "the least of them", ON_TRACK],
    ["off_track.most_m", "m", "the largest of them", ON_TRACK],
    ["off_track.length_m", "m", "length of the track", ON_TRACK],
    [
        "gradients.*",
        "",
        "as `gradient_doubt` of `replay.json`, without `shift_m`",
        "they do not look wrong, or train and track were not given: `gradients` is null",
    ],
    [
        "resistance.conversion",
        "",
        "what the described Davis coefficients look like, and what makes them right",
        NO_UNITS,
    ],
    ["resistance.ratio", "", "mean resistance of the coasted stretches over the described one", NO_UNITS],
    ["resistance.sd_n_per_kg", "N/kg", "scatter of coasted stretches of 20 s if it is so", NO_UNITS],
    ["resistance.log_likelihood", "", "its log-likelihood less that of the description", NO_UNITS],
    ["resistance.z", "", "standard errors over the places of the line by which it is better", NO_UNITS],
    ["resistance.stretches", "", "coasted stretches", NO_UNITS],
    ["failed[].file", "", "a log that cannot be read", ""],
    ["failed[].errors[]", "", "why", ""],
];

const ON_TRACK: &str = "all are on it, or no track was given: `off_track` is null";
const NO_UNITS: &str = "they do not look as if in other units, or train and track were not given: `resistance` is null";

/// The word of JSON.
fn word(value: &impl Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
}

/// The findings as a table: those of recorders, then those of runs.
pub fn findings(found: &Check) -> Filled {
    let of_recorders = found.recorders.iter().flat_map(|recorder| {
        let one = |finding: &Finding| Found {
            run: None,
            recorder: recorder.unit.clone(),
            finding: finding.clone(),
            text: recorder.said(finding),
        };
        recorder.findings.iter().map(one)
    });
    let of_runs = found.runs.iter().flat_map(|run| {
        let name = || Some(run.name.clone());
        let one =
            move |f: &Finding| Found { run: name(), recorder: run.unit.clone(), finding: f.clone(), text: run.said(f) };
        run.findings.iter().map(one)
    });
    filled(columns(), of_recorders.chain(of_runs))
}

/// A few lines: each recorder, then its runs in which something else was found; how many logs there are, and which
/// cannot be read.
pub fn words(found: &Check, failed: &[Failed]) -> String {
    let mut text = String::new();
    for recorder in &found.recorders {
        text += &of_recorder(recorder);
        for run in found.runs.iter().filter(|run| run.unit == recorder.unit) {
            for finding in &run.findings {
                text += &format!("  {}: {}\n", run.name, run.said(finding));
            }
            for perturbation in &run.perturbations {
                text += &format!("  {}: {perturbation}\n", run.name);
            }
        }
    }
    text.extend(of_all(found).map(|line| format!("{line}\n")));
    let clean = found.clean();
    let refused = found.refused().count();
    let runs = found.runs.len();
    if refused == runs {
        text += "nothing could be judged: no log can be used\n";
    }
    let also = if failed.is_empty() { String::new() } else { format!("; {}", unread(failed, runs + failed.len())) };
    text + &format!("{}, nothing found in {clean}, {refused} cannot be used{also}\n", counted(runs, "run", "runs"))
}

/// What is to be said of all runs together.
fn of_all(found: &Check) -> impl Iterator<Item = String> {
    let (count, all) = (found.not_compared, found.runs.len());
    let not_compared =
        || format!("{count} of {all} runs: perturbed ones not recognised, as fewer than 5 others pass or most differ");
    let off = found.off_track.map(|off| off.to_string());
    let doubts = [found.gradients.map(|doubt| doubt.to_string()), found.resistance.map(|doubt| doubt.to_string())];
    off.into_iter().chain((count > 0).then(not_compared)).chain(doubts.into_iter().flatten())
}

/// How many of all logs cannot be read, and the first of them.
fn unread(failed: &[Failed], all: usize) -> String {
    let names: Vec<String> = failed.iter().take(NAMED).map(|failed| failed.file.display().to_string()).collect();
    let more = if failed.len() > NAMED { ", ..." } else { "" };
    format!("{} of {all} logs cannot be read: {}{more}", failed.len(), names.join(", "))
}

fn of_recorder(recorder: &RecorderCheck) -> String {
    let name = if recorder.unit.is_empty() { "recorder" } else { &recorder.unit };
    let mut text = format!("{name}: speed and location compared in {} of {} runs\n", recorder.compared, recorder.runs);
    let mut line = |what: &str, figure: Option<Figure>, unit: &str, decimals: usize| {
        if let Some(figure) = figure {
            let [low, high] = figure.interval();
            let value = figure.value;
            text += &format!("  {what:<32} {value:.decimals$} [{low:.decimals$}, {high:.decimals$}] {unit}\n");
        }
    };
    line("measured over true speed", recorder.scale, "", 4);
    line("true less read speed", recorder.offset_kmh, "km/h", 3);
    line("speed older than location", recorder.skew_s, "s, median over runs", 2);
    if let Some(spread_s) = recorder.skew_spread_s {
        text += &format!("  {:<32} {spread_s:.2} s\n", "... differs from run to run by");
    }
    if let Some(sd_s) = recorder.lost_second_sd_s.filter(|_| recorder.hides_lost_seconds()) {
        text += &format!(
            "  whether the clock loses seconds, and a wheel makes up for them, is hidden by the noise of the locations: a step of the clock is known to {sd_s:.2} s only\n"
        );
    }
    let said = |finding: &Finding| format!("  {}\n", recorder.said(finding));
    text + &recorder.findings.iter().map(said).collect::<String>()
}
