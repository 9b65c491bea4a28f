//! `replay.json`, also what `--json` prints: all but the estimates, for machines.
//!
//! ```text
//! { "rundown", "mode", "train", "track", "carried", "tick_s",
//!   "runs": [ { "run", "unit", "file", "direction", "rows", "steps", "estimates", "coast_ahead",
//!               "vehicle": { r0 .. sd_r2 }, "this_run": { r0 .. sd_r2 },
//!               "features": { as in features.csv }, "switching_points": [ ... ], "counters": { cause: count },
//!               "dropped": [ { "line", "time_s", "reason" } ], "warnings": [ ... ] } ],
//!   "failed": [ { "file", "errors": [ ... ] } ], "notes": [ ... ] }
//! ```

use crate::logs::Failed;
use crate::output::{coast_ahead, estimates, features, parameters};
use rundown::estimator::StepError;
use rundown::estimator::config::{Config, Mode};
use rundown_files::column::{Column, record};
use rundown_files::replay::{Dropped, ReplayedRun, Tick};
use rundown_files::table::to_json;
use serde_json::{Value, json};

#[derive(Clone, Debug)]
pub struct Replay<'a> {
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

pub const fn mode_word(mode: Mode) -> &'static str {
    match mode {
        Mode::Paper => "paper",
        Mode::Gated => "gated",
        Mode::Measured => "measured",
    }
}

pub fn value(replay: &Replay<'_>) -> Value {
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
