//! `replay.json`, also what `--json` prints: all but the estimates, for machines. [`FIELDS`] says what stands in it.

use crate::logs::Failed;
use crate::output::tables::Tables;
use crate::output::{coast_ahead, estimates, features, parameters};
use rundown::estimator::StepError;
use rundown::estimator::config::{Config, Mode};
use rundown_check::gradients::Doubt;
use rundown_files::column::{Column, record};
use rundown_files::replay::{Dropped, ReplayedRun, Tick};
use rundown_files::table::to_json;
use rundown_files::train_file::TrainFile;
use serde_json::{Map, Value, json};
use std::io::{self, Write};

/// What stands in `replay.json`: path, unit, meaning, when it is null.
pub const FIELDS: &[[&str; 4]] = &[
    ["rundown", "", "version of the writer", ""],
    ["mode", "", "`paper`, `gated` or `measured`", ""],
    ["train", "", "name of the train", ""],
    ["described.*", "", "the train as its file described it, in the fields of that file", ""],
    ["track", "", "name of the track", ""],
    ["carried", "", "whether a unit's vehicle was carried from run to run", ""],
    ["tick_s", "s", "period of the ticks", "every sample is a tick"],
    ["runs[].run", "", "name of the run", ""],
    ["runs[].unit", "", "unit of the index `runs.csv`, empty without one", ""],
    ["runs[].file", "", "its log", ""],
    ["runs[].direction", "", "`up` or `down`", ""],
    ["runs[].rows", "", "rows of the log", ""],
    ["runs[].steps", "", "ticks with an estimate", ""],
    ["runs[].learning_steps", "", "ticks from which the resistance was learned", ""],
    [
        "runs[].learned_kmh[]",
        "km/h",
        "least and largest speed at which the resistance was learned",
        "nothing was learned in this run",
    ],
    ["runs[].used", "", "whether the vehicle was changed: it is not where more than half of the ticks are invalid", ""],
    [
        "runs[].speeds_put_right",
        "",
        "whether half a step was added to its speeds, because earlier runs showed that they are truncated",
        "",
    ],
    ["runs[].perturbed", "", "what outside the train held the run up", "nothing did, or nobody looked"],
    ["runs[].estimates", "", "file with the estimates", "`--no-estimates`"],
    [
        "runs[].coast_ahead",
        "",
        "file with what coasting leads to",
        "the track has no stops or speed limits, or `--no-estimates`",
    ],
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
    ["runs[].dropped[].reason", "", "`time_not_increasing`, `time_out_of_range` or `other`", ""],
    ["runs[].warnings[]", "", "what is to be said about its log", ""],
    ["failed[].file", "", "a log that could not be used", ""],
    ["failed[].errors[]", "", "why", ""],
    ["notes[]", "", "what a person should know about all runs", ""],
    ["gradient_doubt.better", "", "what the described gradients look like: `sign_turned`, `per_cent`, ...", NOT_WRONG],
    ["gradient_doubt.seen_by", "", "what shows it: `coasts` or measured `efforts`", NOT_WRONG],
    [
        "gradient_doubt.shift_m",
        "m",
        "the chainage of the runs plus this is that of the gradients",
        "it is another kind",
    ],
    ["gradient_doubt.times", "", "how many times as steep as described, by measured efforts", "it is another kind"],
    [
        "gradient_doubt.off_permille",
        "permille",
        "root mean square of what they are off by; by efforts twice that, for errors that follow the slopes do not average out",
        NOT_WRONG,
    ],
    [
        "gradient_doubt.sd_n_per_kg",
        "N/kg",
        "scatter of coasted stretches of 20 s if they were so; by efforts of accelerations over 10 s",
        NOT_WRONG,
    ],
    ["gradient_doubt.described_sd_n_per_kg", "N/kg", "the same as they are described", NOT_WRONG],
    [
        "gradient_doubt.log_likelihood",
        "",
        "log-likelihood ratio of the two",
        "they do not look wrong, or `better` is `by_place`, or it is seen by efforts",
    ],
    ["gradient_doubt.z", "", "standard errors over the places of the line by which it is better", NOT_WRONG],
    ["gradient_doubt.stretches", "", "coasted stretches; by efforts windows of 10 s", NOT_WRONG],
    GRADIENT_SD,
];

/// Also of `tune.json` and of `rundown study --json`.
pub const GRADIENT_SD: [&str; 4] = [
    "gradient_sd_permille",
    "permille",
    "how far gradients were taken to be off, standard deviation: by the track, the configuration, the coasts or measured efforts",
    "",
];

const NOT_WRONG: &str = "they do not look wrong: `gradient_doubt` is null";

/// What stands before the runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Head<'a> {
    pub config: &'a Config,
    pub train: &'a TrainFile,
    pub track: &'a str,
    pub carried: bool,
    pub tick: Tick,
    pub tables: Tables,
}

pub(crate) const fn mode_word(mode: Mode) -> &'static str {
    match mode {
        Mode::Paper => "paper",
        Mode::Gated => "gated",
        Mode::Measured => "measured",
    }
}

/// What stands behind the runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End<'a> {
    pub failed: &'a [Failed],
    pub notes: &'a [String],
    pub gradient_doubt: Option<&'a Doubt>,
    pub gradient_sd_permille: f64,
}

/// All of it.
pub(crate) fn value(head: &Head<'_>, runs: &[ReplayedRun], end: &End<'_>) -> Value {
    let mut all = head.fields();
    let runs = runs.iter().map(|run| of_run(run, head.config, head.tables)).collect();
    all.insert("runs".to_owned(), Value::Array(runs));
    all.extend(end.fields().map(|(name, value)| (name.to_owned(), value)));
    Value::Object(all)
}

impl End<'_> {
    fn fields(&self) -> [(&'static str, Value); 4] {
        [
            ("failed", self.failed.iter().map(Failed::json).collect()),
            ("notes", json!(self.notes)),
            ("gradient_doubt", self.gradient_doubt.map_or(Value::Null, gradient_doubt)),
            ("gradient_sd_permille", json!(self.gradient_sd_permille)),
        ]
    }
}

fn gradient_doubt(doubt: &Doubt) -> Value {
    json!({
        "better": doubt.better.word(),
        "seen_by": doubt.seen_by,
        "shift_m": doubt.better.shift_m(),
        "times": doubt.better.times(),
        "off_permille": doubt.off_permille,
        "sd_n_per_kg": doubt.sd_n_per_kg,
        "described_sd_n_per_kg": doubt.described_sd_n_per_kg,
        "log_likelihood": doubt.log_likelihood,
        "z": doubt.z,
        "stretches": doubt.stretches,
    })
}

impl Head<'_> {
    fn fields(&self) -> Map<String, Value> {
        let tick_s = match self.tick {
            Tick::EverySample => None,
            Tick::Period { seconds } => Some(seconds),
        };
        let fields = [
            ("rundown", json!(env!("CARGO_PKG_VERSION"))),
            ("mode", json!(mode_word(self.config.mode))),
            ("train", json!(self.train.name)),
            ("described", json!(self.train)),
            ("track", json!(self.track)),
            ("carried", json!(self.carried)),
            ("tick_s", json!(tick_s)),
        ];
        fields.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }
}

/// The same bytes, written run by run.
pub(crate) struct Stream<W> {
    writer: W,
    config: Config,
    tables: Tables,
    is_first: bool,
}

impl<W: Write> Stream<W> {
    pub(crate) fn begin(mut writer: W, head: &Head<'_>) -> io::Result<Self> {
        let fields = serde_json::to_string_pretty(&head.fields())?;
        write!(writer, "{},\n  \"runs\": [", fields.trim_end_matches("\n}"))?;
        Ok(Self { writer, config: *head.config, tables: head.tables, is_first: true })
    }

    pub(crate) fn runs(&mut self, runs: &[ReplayedRun]) -> io::Result<()> {
        for run in runs {
            let text = indented(&of_run(run, &self.config, self.tables), "    ")?;
            let comma = if self.is_first { "" } else { "," };
            write!(self.writer, "{comma}\n    {text}")?;
            self.is_first = false;
        }
        Ok(())
    }

    pub(crate) fn end(mut self, end: &End<'_>) -> io::Result<()> {
        write!(self.writer, "{}", if self.is_first { "]" } else { "\n  ]" })?;
        for (name, value) in end.fields() {
            write!(self.writer, ",\n  \"{name}\": {}", indented(&value, "  ")?)?;
        }
        write!(self.writer, "\n}}\n")?;
        self.writer.flush()
    }
}

/// Lines behind the first are moved to the right; within texts there are no ends of lines.
fn indented(value: &Value, by: &str) -> serde_json::Result<String> {
    Ok(serde_json::to_string_pretty(value)?.replace('\n', &format!("\n{by}")))
}

fn object<Row>(columns: &[Column<Row>], row: &Row) -> Value {
    to_json(&record(columns, row))
}

fn of_run(run: &ReplayedRun, config: &Config, tables: Tables) -> Value {
    let end = tables.format.extension();
    let file = |stem: String, is_there: bool| (tables.each_tick && is_there).then(|| format!("{stem}.{end}"));
    let of_switch = features::switch_columns();
    let points: Vec<Value> = features::switches(run).map(|switch| object(&of_switch[1..], &switch)).collect();
    let davis = parameters::coefficients("", "");
    json!({
        "run": run.name,
        "unit": run.unit,
        "file": run.path.to_string_lossy(),
        "direction": run.direction.as_str(),
        "rows": run.rows,
        "steps": run.estimates.len(),
        "learning_steps": parameters::learning_steps(run),
        "learned_kmh": parameters::learned_kmh(run),
        "used": run.is_used,
        "speeds_put_right": run.speeds_put_right,
        "perturbed": run.perturbed,
        "estimates": file(estimates::stem(run), true),
        "coast_ahead": file(coast_ahead::stem(run), !run.coast_ahead.is_empty()),
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
        StepError::TimeOutOfRange { .. } => "time_out_of_range",
        _ => "other",
    };
    json!({ "line": dropped.line, "time_s": dropped.time_s, "reason": reason })
}
