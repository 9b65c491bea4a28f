//! `docs/outputs.md`: every column and field of the files, out of the tables by which they are written.

use super::fields::{Field, owned};
use super::{coast_ahead, estimates, features, json, parameters};
use crate::import::account;
use crate::simulation::folder::{index_columns, truth_columns};
use crate::simulation::key;
use crate::study::experiments::{answer, catalogue};
use crate::study::figures::{brake, histograms, power, profiles, run, slope};
use crate::study::{fields, readings::outcome};
use crate::tune::surface;
use crate::{check_bench, checking, gap_bench, gradient_bench, perturbed_bench, study, tune};
use rundown::features::FeatureConfig;
use rundown_files::column::{About, about};
use rundown_files::folder;
use rundown_files::run_rows::run_columns;
use rundown_files::sample::COLUMNS;
use rundown_gap::answer::{json as gap_json, tables};
use std::collections::BTreeSet;

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
that is stopped leaves the old results or the new ones, and beside them what it had begun, `.NAME.rundown-new`, which
the next one removes. Where the folder also holds other files, or two folders cannot be exchanged at once (Windows, some
network file systems), results are moved into it one by one; a command that is killed while it does that is brought to
its end by the next one. Where several commands write into one folder, the manifest is that of the last one and keeps
the lists of the others under `earlier`: each command removes its own stale files, and never one that the list of
another, or no list, has. The manifest alone has times: all other files have the same bytes each time.

What is not on this page is no table: pages (`.html`, with their `.js`), pictures (`.svg`), descriptions and
configurations (`.toml`, in [formats.md](formats.md)), the files of other programs
([replay.md](replay.md#train-characteristics-for-other-tools)), a frame (`effect.frame`), and tables in words
(`.md`): those of the benches, and `claims.md`, `readings.md`, `slope.md` and `experiments.md` of `rundown study`, from
which documents quote.
";

const ABSENT: &str = "Where `null when` says `absent`, the key is not there.";

/// The page.
pub fn page() -> String {
    let mut text = BEGIN.to_owned();
    json_file(&mut text, "manifest.json", "", owned(folder::FIELDS));
    replay(&mut text);
    json_file(&mut text, "rundown check: check.json, --json", "", owned(checking::FIELDS));
    gap(&mut text);
    logs(&mut text);
    study_of_case(&mut text);
    study_beside(&mut text);
    tune(&mut text);
    benches(&mut text);
    #[cfg(feature = "link")]
    {
        let lines = "A line for each message, written as it comes.";
        table(&mut text, "rundown link, display: --record", lines, &about(crate::link::record::columns()));
    }
    text
}

fn logs(text: &mut String) {
    let columns: Vec<About> = COLUMNS.iter().map(|column| column.about()).collect();
    let rounded = "A row for each sample, with fixed decimals, as a recorder has them.\nColumns of sensors that the \
        scenario lacks are not there.";
    table(text, "rundown simulate: runs/<run>.csv", rounded, &columns);
    let index = about(index_columns());
    table(text, "rundown simulate: runs/runs.csv", "A row for each log.", &index);
    let truth = "What was true at each sample.";
    table(text, "rundown simulate: truth/<run>.csv", truth, &about(truth_columns()));
    json_file(text, "rundown simulate: truth/truth.json", "", owned(key::FIELDS));
    let sensors = "A row for each sample; columns that the source lacks are not there.";
    table(text, "rundown import: <run>.csv", sensors, &columns);
    table(text, "rundown import: runs.csv", "A row for each log.", &index[..4]);
    json_file(text, "rundown import: import.json", ABSENT, owned(account::FIELDS));
}

/// Of the case study: its tables, and the numbers of its pictures.
fn study_of_case(text: &mut String) {
    let runs = "A row for each run; both files hold the same.";
    table(text, "rundown study: runs.csv, runs.parquet", runs, &about(study::gather::columns()));
    table(text, "rundown study: claims.csv", "A row for each claim.", &about(study::claims::columns()));
    table(text, "rundown study: --keep-runs", "The runs themselves, a row for each sample.", &run_columns());
    let samples = "A row for each sample of the runs that are drawn.";
    table(text, "rundown study: fig2_speed_profiles.csv", samples, &about(profiles::columns()));
    let example = "A row for each sample of the run of the figure; `<mode>` is `paper` or `gated`.";
    table(text, "rundown study: fig3_run_<mode>.csv", example, &about(run::motion_columns()));
    let bins = "A row for each bin.";
    let histograms_of = "rundown study: fig4_davis_<mode>.csv, fig7_style_<mode>.csv";
    table(text, histograms_of, bins, &about(histograms::columns()));
    table(text, "rundown study: fig5_resistance_<mode>.csv", example, &about(run::term_columns()));
    table(text, "rundown study: fig6_regimes_<mode>.csv", example, &about(run::regime_columns()));
    let rates = "A row for each step, each run in a step, and each interval of braking.";
    table(text, "rundown study: fig8_brake_rates_<mode>.csv", rates, &about(brake::columns()));
    let intervals = "A row for each interval of the first acceleration.";
    table(text, "rundown study: fig9_power_<mode>.csv", intervals, &about(power::columns()));
    table(text, "rundown study: fig9_below_40_<mode>.csv", intervals, &about(power::low_columns()));
}

/// Of what the study answers beside the case study.
fn study_beside(text: &mut String) {
    json_file(text, "rundown study: --json", "Of the case study or recorded runs.", fields::case_study());
    let answers = "A row for each mode and number of runs.";
    table(text, "rundown study: slope.csv", answers, &about(study::slope::columns()));
    let vehicles = "A row for each mode and vehicle; `<runs>` is `1_run`, `10_runs`, ...";
    table(text, "rundown study: slope_after_<runs>.csv", vehicles, &about(slope::columns()));
    json_file(text, "rundown study: slope.json, --truth-slope --json", "", fields::slope());
    let readings =
        "A row for each combination of readings and recorder; of the crossed ones those that the second picture draws.";
    table(text, "rundown study: readings.csv, readings_crossed.csv", readings, &about(outcome::columns()));
    json_file(text, "rundown study: readings.json, --readings --json", "", owned(fields::READINGS));
    let tunnel = "A row for each stretch of 500 m, and for each tunnel.";
    table(text, "rundown study: tunnel.csv", tunnel, &about(study::tunnel::columns()));
    json_file(text, "rundown study: tunnel.json, --tunnel --json", "", owned(fields::TUNNEL));
    let rows =
        "A row for each set, variant and mode; of the measured columns, after `set`, each experiment has its own.";
    let mut columns = about(answer::columns(&catalogue::measured()));
    let mut seen = BTreeSet::new();
    columns.retain(|column| seen.insert(column.name.clone()));
    table(text, "rundown study: <experiment>.csv", rows, &columns);
    json_file(text, "rundown study: --experiment <experiment> --json", "", owned(fields::EXPERIMENT));
}

fn tune(text: &mut String) {
    let places = "A row for each value of each parameter.";
    table(text, "rundown tune: tune_profiles.csv", places, &about(surface::profile_columns()));
    let plane = "A row for each place of the plane.";
    table(text, "rundown tune: tune_plane.csv", plane, &about(surface::plane_columns()));
    json_file(text, "rundown tune: tune.json", "", tune::fields::fields());
}

/// What the benches keep beside their tables in words.
fn benches(text: &mut String) {
    json_file(text, "rundown check-bench: bench.json", "", owned(check_bench::FIELDS));
    json_file(text, "rundown check-bench: perturbed.json", "", owned(perturbed_bench::FIELDS));
    json_file(text, "rundown check-bench: gradients.json", "", owned(gradient_bench::FIELDS));
    json_file(text, "rundown gap-bench: sets.json", "", owned(gap_bench::fields::DRAWN));
    json_file(text, "rundown gap-bench --folder: sets.json", "", owned(gap_bench::fields::OF_FOLDER));
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
    json_file(text, "rundown replay: replay.json", "", owned(json::FIELDS));
}

fn gap(text: &mut String) {
    table(text, "rundown gap: residuals.csv", "A row for each interval.", &about(tables::residuals()));
    let powering = "A row for each interval of steady power while the train gains speed.";
    table(text, "rundown gap: powering.csv", powering, &about(tables::powering()));
    let compared = "A row for each sample of a hold-out run.";
    table(text, "rundown gap: before_after.csv", compared, &about(tables::before_after()));
    json_file(text, "rundown gap: gap.json", ABSENT, owned(gap_json::FIELDS));
}

fn table(text: &mut String, heading: &str, words: &str, columns: &[About]) {
    *text += &format!(
        "\n## `{heading}`\n\n{words}\n\n| column | kind | unit | meaning | empty when |\n|---|---|---|---|---|\n"
    );
    for About { name, kind, unit, meaning, empty } in columns {
        *text += &format!("| `{name}` | {} | {unit} | {meaning} | {empty} |\n", kind.name());
    }
}

fn json_file(text: &mut String, heading: &str, words: &str, fields: Vec<Field>) {
    *text += &format!("\n## `{heading}`\n\n`[]` is each value of a list, `*` each key of an object. {words}");
    *text = format!("{}\n\n| field | unit | meaning | null when |\n|---|---|---|---|\n", text.trim_end());
    for [path, unit, meaning, null] in fields {
        *text += &format!("| `{path}` | {unit} | {meaning} | {null} |\n");
    }
}
