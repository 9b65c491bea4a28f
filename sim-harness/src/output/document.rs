//! `docs/outputs.md`: every column and field of the files, out of the tables by which they are written.

use super::{coast_ahead, estimates, features, json, parameters};
use crate::simulation::folder::{index_columns, truth_columns};
use crate::{checking, study};
use rundown::features::FeatureConfig;
use rundown_files::column::{About, about};
use rundown_files::folder;
use rundown_files::run_rows::run_columns;
use rundown_files::sample::COLUMNS;
use rundown_gap::answer::{json as gap_json, tables};

const BEGIN: &str = "\
# What Rundown writes

Every column of the tables and every field of the JSON files, with unit, meaning and when there is no value. This page
is made from the tables by which the files are written; a test compares both, and
`BLESS=1 cargo test -p sim-harness --test outputs` writes it.

In CSV an empty field is a missing value, in JSON `null`, in Parquet a null. Numbers have as few digits as give the very
bits back. A count of 0 or 1 may answer yes or no. Parquet has the same in its metadata: `rundown.columns` is JSON with
`unit`, `meaning` and `null_when` by column, `rundown.version` the version of the writer.

All commands that write into a folder (`replay`, `check`, `study`, `gap`, `tune`, `simulate`, `import`, `export` and the
benches) write their results beside the folder that `--out` names, which then takes the place of the old one: a command
that is stopped leaves the old results or the new ones. Where the folder also holds other files, or two folders cannot
be exchanged at once (Windows, some network file systems), results are moved into it one by one; a command that is
killed while it does that is brought to its end by the next one. Where several commands write into one folder, the
manifest is that of the last one and keeps the lists of the others under `earlier`: each command removes its own stale
files, and never one that the list of another, or no list, has. The manifest alone has times: all other files have the
same bytes each time.

Not on this page: the numbers behind single pictures of `study` and `tune` (a CSV beside each SVG, with the units in
its names), `slope.json`, `tune.json`, `truth.json`, the record of `rundown link` and the account of `rundown import`.
";

/// The page.
pub fn page() -> String {
    let mut text = BEGIN.to_owned();
    json_file(&mut text, "manifest.json", "", folder::FIELDS);
    replay(&mut text);
    json_file(&mut text, "rundown check: --json", "", checking::FIELDS);
    gap(&mut text);
    let set = "What `rundown simulate` writes; a log may lack the columns of sensors that it has not.";
    let log: Vec<About> = COLUMNS.iter().map(|column| column.about()).collect();
    table(&mut text, "rundown simulate, import: runs/<run>.csv", set, &log);
    table(&mut text, "rundown simulate, import: runs/runs.csv", "A row for each log.", &about(index_columns()));
    table(&mut text, "rundown simulate: truth/<run>.csv", "What was true at each sample.", &about(truth_columns()));
    let runs = "A row for each run; both files hold the same.";
    table(&mut text, "rundown study: runs.csv, runs.parquet", runs, &about(study::gather::columns()));
    table(&mut text, "rundown study: claims.csv", "A row for each claim.", &about(study::claims::columns()));
    let slope = "A row for each mode and number of runs.";
    table(&mut text, "rundown study: slope.csv", slope, &about(study::slope::columns()));
    table(&mut text, "rundown study: --keep-runs", "The runs themselves, a row for each sample.", &run_columns());
    text
}

fn replay(text: &mut String) {
    let config = FeatureConfig::default();
    table(text, "rundown replay: <run>.estimates.csv", "A row for each tick.", &about(estimates::columns()));
    let ahead = "A row for each tick, where the track has stops or speed limits.";
    table(text, "rundown replay: <run>.coast_ahead.csv", ahead, &about(coast_ahead::columns()));
    let steps = "A row for each run. Windows and brake steps are those of the configuration, here the default.";
    table(text, "rundown replay: features.csv", steps, &about(features::columns(&config)));
    table(text, "rundown replay: parameters.csv", "A row for each run.", &about(parameters::columns()));
    let switches = "A row for each change of regime.";
    table(text, "rundown replay: switching_points.csv", switches, &about(features::switch_columns()));
    json_file(text, "rundown replay: replay.json", "", json::FIELDS);
}

fn gap(text: &mut String) {
    table(text, "rundown gap: residuals.csv", "A row for each interval.", &about(tables::residuals()));
    let powering = "A row for each interval of steady power while the train gains speed.";
    table(text, "rundown gap: pulls.csv", powering, &about(tables::powering()));
    let compared = "A row for each sample of a hold-out run.";
    table(text, "rundown gap: before_after.csv", compared, &about(tables::before_after()));
    let absent = "Where `null when` says `absent`, the key is not there.";
    json_file(text, "rundown gap: gap.json", absent, gap_json::FIELDS);
}

fn table(text: &mut String, heading: &str, words: &str, columns: &[About]) {
    *text += &format!(
        "\n## `{heading}`\n\n{words}\n\n| column | kind | unit | meaning | empty when |\n|---|---|---|---|---|\n"
    );
    for About { name, kind, unit, meaning, empty } in columns {
        *text += &format!("| `{name}` | {} | {unit} | {meaning} | {empty} |\n", kind.name());
    }
}

fn json_file(text: &mut String, heading: &str, words: &str, fields: &[[&str; 4]]) {
    *text += &format!("\n## `{heading}`\n\n`[]` is each value of a list, `*` each key of an object. {words}");
    *text = format!("{}\n\n| field | unit | meaning | null when |\n|---|---|---|---|\n", text.trim_end());
    for [path, unit, meaning, null] in fields {
        *text += &format!("| `{path}` | {unit} | {meaning} | {null} |\n");
    }
}
