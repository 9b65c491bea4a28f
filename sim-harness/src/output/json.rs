//! `replay.json`, also what `--json` prints: all but the estimates, for machines. [`FIELDS`] says what stands in it.

use crate::logs::Failed;
use crate::output::{coast_ahead, estimates, features, parameters};
use rundown::estimator::StepError;
use rundown::estimator::config::{Config, Mode};
use rundown_files::column::{Column, record};
use rundown_files::replay::{Dropped, ReplayedRun, Tick};
use rundown_files::table::to_json;
use serde_json::{Value, json};

/// What stands in `replay.json`: path, unit, meaning, when it is null.
pub const FIELDS: &[[&str; 4]] = &[
    ["rundown", "", "version of the writer", ""],
    ["mode", "", "`paper`, `gated` or `measured`", ""],
    ["train", "", "name of the train", ""],
    ["track", "", "name of the track", ""],
    ["carried", "", "whether a unit's vehicle was carried from run to run", ""],
    ["tick_s", "s", "period of the ticks", "every sample is a tick"],
    ["runs[].run", "", "name of the run", ""],
    ["runs[].unit", "", "unit of the index `runs.csv`, empty without one", ""],
    ["runs[].file", "", "its log", ""],
    ["runs[].direction", "", "`up` or `down`", ""],
    ["runs[].rows", "", "rows of the log", ""],
    ["runs[].steps", "", "ticks with an estimate", ""],
    ["runs[].estimates", "", "file with the estimates", ""],
    ["runs[].coast_ahead", "", "file with what coasting leads to", "the track has no stops or speed limits"],
    ["runs[].vehicle.*", "", "the vehicle after the run: `r0` to `sd_r2` of `parameters.csv`", ""],
    [
        "runs[].foresight.*",
        "",
        "from `published` to `bits_140_kmh` as in `parameters.csv`",
        "as the cell there is empty",
    ],
    ["runs[].this_run.*", "", "the train of this run alone: `run_r0` to `run_sd_r2` there, without the `run_`", ""],
    ["runs[].features.*", "", "from `max_effort_count` on as in `features.csv`", "as the cell there is empty"],
    ["runs[].switching_points[].*", "", "as in `switching_points.csv`, without the run", ""],
    ["runs[].counters.*", "", "from `time_not_increasing` on as in `parameters.csv`", ""],
    ["runs[].dropped[].line", "", "line of a row that gave no estimate", ""],
    ["runs[].dropped[].time_s", "s", "its time", ""],
    ["runs[].dropped[].reason", "", "`time_not_increasing` or `other`", ""],
    ["runs[].warnings[]", "", "what is to be said about its log", ""],
    ["failed[].file", "", "a log that could not be used", ""],
    ["failed[].errors[]", "", "why", ""],
    ["notes[]", "", "what a person should know about all runs", ""],
];

#[derive(Clone, Debug)]
pub(crate) struct Replay<'a> {
    pub config: &'a Config,
    pub train: &'a str,
    pub track: &'a str,
    pub carried: bool,
    pub tick: Tick,
    pub runs: &'a [ReplayedRun],
    pub failed: &'a [Failed],
    /// What a person should know about all of them: [`crate::advice`], and their order.
    pub notes: &'a [String],
}

pub(crate) const fn mode_word(mode: Mode) -> &'static str {
    match mode {
        Mode::Paper => "paper",
        Mode::Gated => "gated",
        Mode::Measured => "measured",
    }
}

pub(crate) fn value(replay: &Replay<'_>) -> Value {
    let tick_s = match replay.tick {
        Tick::EverySample => None,
        Tick::Period { seconds } => Some(seconds),
    };
    let one = |run: &ReplayedRun| of_run(run, replay.config);
    json!({
        "rundown": env!("CARGO_PKG_VERSION"),
        "mode": mode_word(replay.config.mode),
        "train": replay.train,
        "track": replay.track,
        "carried": replay.carried,
        "tick_s": tick_s,
        "runs": replay.runs.iter().map(one).collect::<Vec<Value>>(),
        "failed": replay.failed.iter().map(failed).collect::<Vec<Value>>(),
        "notes": replay.notes,
    })
}

fn object<Row>(columns: &[Column<Row>], row: &Row) -> Value {
    to_json(&record(columns, row))
}

fn of_run(run: &ReplayedRun, config: &Config) -> Value {
    let of_switch = features::switch_columns();
    let points: Vec<Value> = features::switches(run).map(|switch| object(&of_switch[1..], &switch)).collect();
    let davis = parameters::coefficients("", "");
    json!({
        "run": run.name,
        "unit": run.unit,
        "file": run.path,
        "direction": parameters::direction_word(run.direction),
        "rows": run.rows,
        "steps": run.estimates.len(),
        "estimates": estimates::file_name(run),
        "coast_ahead": (!run.coast_ahead.is_empty()).then(|| coast_ahead::file_name(run)),
        "vehicle": object(&davis, &run.vehicle_after),
        "foresight": object(&parameters::foresight(), run),
        "this_run": object(&davis, &run.summary.run_davis),
        "features": object(&features::of_run(&config.features), &run.summary.features),
        "switching_points": points,
        "counters": object(&parameters::counters(), &run.summary.counters),
        "dropped": run.dropped.iter().map(dropped).collect::<Vec<Value>>(),
        "warnings": run.warnings,
    })
}

fn dropped(dropped: &Dropped) -> Value {
    let reason = match dropped.reason {
        StepError::TimeNotIncreasing { .. } => "time_not_increasing",
        _ => "other",
    };
    json!({ "line": dropped.line, "time_s": dropped.time_s, "reason": reason })
}

fn failed(failed: &Failed) -> Value {
    json!({ "file": failed.file, "errors": failed.error.lines().collect::<Vec<&str>>() })
}
