//! Does the page of outputs say what the files hold? It is made again and compared, and each JSON file is walked along
//! its table.

mod common;

use common::Folder;
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::Value;
use sim_harness::{output::document, simulation::folder, simulation::scenario_file::Simulation};
use std::collections::BTreeSet;
use std::path::Path;
use std::{ffi::OsString, process::ExitCode};

#[test]
fn the_page_of_outputs_is_made_from_the_tables() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/outputs.md");
    let made = document::page();
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap();
    let differs = found.lines().zip(made.lines()).find(|(found, made)| found != made);
    assert!(found == made, "docs/outputs.md is not what the tables say, BLESS=1 writes it: {differs:?}");
}

#[test]
fn every_column_has_a_unit_where_it_is_a_number_and_a_meaning() {
    let rows = |text: &str| -> Vec<Vec<String>> {
        let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect();
        text.lines().filter(|line| line.starts_with("| `")).map(cells).collect()
    };
    let page = document::page();
    let rows = rows(&page);
    assert!(rows.len() > 500, "{}", rows.len());
    for row in &rows {
        let is_column = ["text", "count", "number"].contains(&row[2].as_str());
        let meaning = if is_column { &row[4] } else { &row[3] };
        assert!(!meaning.is_empty(), "{row:?}");
        let is_free = row[1].starts_with("`P_") || row[1] == "`direction`" || row[1] == "`message`";
        assert!(row[2] != "number" || is_free || !row[3].is_empty(), "{row:?}");
    }
}

/// Paths of the leaves, list places as `[]`; what is null or empty ends with `!`.
fn leaves(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) if !map.is_empty() => {
            for (key, value) in map {
                let dot = if path.is_empty() { "" } else { "." };
                leaves(value, &format!("{path}{dot}{key}"), found);
            }
        }
        Value::Array(values) if !values.is_empty() => {
            values.iter().for_each(|value| leaves(value, &format!("{path}[]"), found));
        }
        Value::Object(_) | Value::Array(_) => drop(found.insert(format!("{path}[]!"))),
        Value::Null => drop(found.insert(format!("{path}!"))),
        _ => drop(found.insert(path.to_owned())),
    }
}

/// A leaf is what a path of the table says; one without values is any path below it.
fn says(table: &str, leaf: &str) -> bool {
    let below = |of: &str, from: &str| {
        of.strip_prefix(from).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    };
    if let Some(nothing) = leaf.strip_suffix('!') {
        let nothing = nothing.trim_end_matches("[]");
        return below(table, nothing) || table.strip_suffix(".*").is_some_and(|table| below(nothing, table));
    }
    table == leaf || table.strip_suffix(".*").is_some_and(|table| below(leaf, table) && leaf != table)
}

/// A row of a table of the page: path, unit, meaning, null rule.
type Field = [String; 4];

fn agree(name: &str, fields: &[Field], value: &Value) {
    let mut found = BTreeSet::new();
    leaves(value, "", &mut found);
    for leaf in &found {
        let lines: Vec<_> = fields.iter().filter(|[path, ..]| says(path, leaf)).collect();
        assert!(!lines.is_empty(), "{name}: {leaf} is not in the table");
        let is_null = leaf.ends_with('!') && !leaf.ends_with("[]!");
        assert!(!is_null || lines.iter().any(|[.., null]| !null.is_empty()), "{name}: {leaf} is null");
    }
    for [path, _, _, null] in fields {
        let is_there = found.iter().any(|leaf| says(path, leaf));
        let parent = path.rsplit_once("[]").map_or("", |(list, _)| list);
        let nobody = !parent.is_empty()
            && !found.iter().any(|leaf| leaf.starts_with(&format!("{parent}[]")) && !leaf.ends_with('!'));
        assert!(is_there || null.starts_with("absent") || nobody, "{name}: nothing has {path}");
    }
}

/// A table of the page.
struct Declared {
    commands: Vec<String>,
    /// Names of files, `<..>` for any.
    files: Vec<String>,
    is_json: bool,
    words: String,
    rows: Vec<Vec<String>>,
}

impl Declared {
    /// What stands below a heading of the page.
    fn of(section: &str) -> Self {
        let (heading, rest) = section.split_once('\n').unwrap();
        let heading = heading.trim_matches('`');
        let (commands, files) = heading.split_once(": ").unwrap_or(("", heading));
        let list = |text: &str| text.split(", ").map(String::from).collect::<Vec<String>>();
        let cells = |line: &str| line.split('|').map(|cell| cell.trim().trim_matches('`').to_owned()).collect();
        Self {
            commands: list(commands.trim_start_matches("rundown ")),
            files: list(files),
            is_json: rest.contains("| field |"),
            words: rest.trim().lines().take_while(|line| !line.is_empty()).collect::<Vec<&str>>().join(" "),
            rows: rest.lines().filter(|line| line.starts_with("| `")).map(cells).collect(),
        }
    }

    fn has(&self, command: &str, path: &str) -> bool {
        let is_command = self.commands.iter().any(|of| of == command || of.is_empty());
        // With `--format parquet` a replay writes the same tables.
        let as_csv = path.replace(".parquet", ".csv");
        is_command && self.files.iter().any(|file| fits(file, path) || command == "replay" && fits(file, &as_csv))
    }

    /// A JSON text is what the table says, and what the tables say that it refers to.
    fn agrees(&self, command: &str, name: &str, text: &str) {
        assert!(self.is_json, "{name}");
        let value: Value = serde_json::from_str(text).unwrap();
        agree(&format!("{command}: {name}"), &self.fields(), &value);
        for [path, _, meaning, _] in self.fields() {
            if let Some(list) = path.strip_suffix("[].*").filter(|list| !list.contains(['.', '[']))
                && let Some(file) = meaning.split('`').nth(1).filter(|_| meaning.starts_with("the "))
            {
                refers(&format!("{command}: {name}: {list}"), file, value[list].as_array().unwrap());
            }
        }
    }

    fn fields(&self) -> Vec<Field> {
        self.rows.iter().map(|row| std::array::from_fn(|cell| row[cell + 1].clone())).collect()
    }

    /// Whether a CSV of this header is what the table says.
    fn is_header(&self, header: &csv::StringRecord) -> bool {
        let all: Vec<&str> = self.rows.iter().map(|row| row[1].as_str()).collect();
        let may_lack = self.words.contains("are not there") || self.words.contains("has its own");
        let rest = all.iter().filter(|name| header.iter().any(|of| of == **name));
        if may_lack { header.iter().all(|name| all.contains(&name)) && rest.count() > 0 } else { header == all }
    }
}

/// Objects that have the columns of a CSV file, or the fields of a JSON file, of the page.
fn refers(name: &str, file: &str, objects: &[Value]) {
    let tables = declared();
    let table = tables.iter().find(|table| table.files.iter().any(|of| of == file)).unwrap();
    for object in objects {
        if table.is_json {
            agree(name, &table.fields(), object);
        } else {
            let names: BTreeSet<&str> = object.as_object().unwrap().keys().map(String::as_str).collect();
            let columns = table.rows.iter().map(|row| row[1].as_str()).filter(|column| names.contains(column));
            let header = csv::StringRecord::from(columns.collect::<Vec<_>>());
            assert!(
                header.len() == names.len() && table.is_header(&header),
                "{name}: {names:?} are not those of {file}"
            );
        }
    }
}

/// `<..>` stands for anything but a folder.
fn fits(pattern: &str, path: &str) -> bool {
    match pattern.split_once('<') {
        None => pattern == path,
        Some((before, rest)) => {
            let after = rest.split_once('>').unwrap().1;
            let any = path.strip_prefix(before).and_then(|path| path.strip_suffix(after));
            any.is_some_and(|any| !any.is_empty() && !any.contains('/'))
        }
    }
}

fn declared() -> Vec<Declared> {
    let page = document::page();
    page.split("\n## ").skip(1).map(Declared::of).collect()
}

/// What the page says is no table.
const NO_TABLES: [&str; 6] = ["html", "js", "svg", "toml", "frame", "md"];

fn files(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { files(&path, found) } else { found.push(path) }
    }
}

fn parquet_header(path: &Path) -> csv::StringRecord {
    let reader = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
    let schema = reader.metadata().file_metadata().schema_descr();
    schema.columns().iter().map(|column| column.name()).collect()
}

/// Every file in a folder that a command wrote is on the page, with the very columns or fields; and those of `expected`
/// are there.
fn all_declared(command: &str, folder: &Path, expected: &[&str]) {
    let (tables, mut found) = (declared(), Vec::new());
    files(folder, &mut found);
    let mut names = BTreeSet::new();
    for path in found {
        let name = path.strip_prefix(folder).unwrap().to_str().unwrap().replace('\\', "/");
        let end = name.rsplit('.').next().unwrap();
        if NO_TABLES.contains(&end) {
            continue;
        }
        let tables: Vec<&Declared> = tables.iter().filter(|table| table.has(command, &name)).collect();
        assert!(!tables.is_empty(), "rundown {command} writes {name}, which no table of the page has");
        match end {
            "json" => tables[0].agrees(command, &name, &std::fs::read_to_string(&path).unwrap()),
            "csv" => {
                let header = csv::Reader::from_path(&path).unwrap().headers().unwrap().clone();
                let said = tables.iter().any(|table| table.is_header(&header));
                assert!(said, "rundown {command}: {name} has columns that its table does not have: {header:?}");
            }
            "parquet" => {
                let header = parquet_header(&path);
                assert!(tables.iter().any(|table| table.is_header(&header)), "rundown {command}: {name}: {header:?}");
            }
            _ => panic!("{name}: neither a table nor what the page says is none"),
        }
        names.insert(name);
    }
    let missing: Vec<_> = expected.iter().filter(|name| !names.contains(**name)).collect();
    assert!(missing.is_empty(), "rundown {command} did not write {missing:?}, but {names:?}");
}

#[test]
fn paths_are_compared_with_their_table() {
    assert!(says("a[].b", "a[].b") && says("a.*", "a.b[].c") && says("a[].b", "a[]!") && says("a.value", "a!"));
    assert!(!says("a.b", "a.c") && !says("a.*", "ab.c") && !says("a[].b", "b!") && !says("a.*", "a"));
}

/// What a command writes into its folder.
fn ran(arguments: &[&dyn AsRef<std::ffi::OsStr>]) {
    let all = std::iter::once(OsString::from("rundown")).chain(arguments.iter().map(|a| a.as_ref().to_owned()));
    assert_eq!(format!("{:?}", sim_harness::commands::run(all)), format!("{:?}", ExitCode::SUCCESS));
}

/// A data set of few runs with a hidden effect.
fn data_set(folder: &Path) {
    let text = sim_harness::simulation::scenario_file::HIDDEN_EFFECT;
    let mut simulation = Simulation::parse(Path::new("scenario"), text).unwrap();
    simulation.runs = 10;
    folder::write(&simulation, folder, false, || ()).unwrap();
}

#[test]
fn every_file_of_logs_and_answers_is_declared() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    data_set(&at("set"));
    all_declared("simulate", &at("set"), &["runs/run001.csv", "runs/runs.csv", "truth/truth.json", "truth/run001.csv"]);
    let (train, track, runs) = (at("set/train.toml"), at("set/track.toml"), at("set/runs"));
    let described: [&dyn AsRef<std::ffi::OsStr>; 4] = [&"--train", &train, &"--track", &track];
    let [a, b, c, d] = described;
    ran(&[&"replay", a, b, c, d, &"--out", &at("replay"), &runs]);
    all_declared(
        "replay",
        &at("replay"),
        &["replay.json", "parameters.csv", "run001.coast_ahead.csv", "manifest.json"],
    );
    ran(&[&"replay", a, b, c, d, &"--format", &"parquet", &"--out", &at("parquet"), &runs]);
    all_declared("replay", &at("parquet"), &["parameters.parquet", "run001.estimates.parquet"]);
    ran(&[&"check", &"--out", &at("check"), &runs]);
    all_declared("check", &at("check"), &["check.json"]);
    ran(&[&"gap", a, b, c, d, &"--runs", &runs, &"--out", &at("gap")]);
    all_declared("gap", &at("gap"), &["gap.json", "residuals.csv", "before_after.csv"]);
    ran(&[&"import", &"--out", &at("imported"), &runs.join("run001.csv"), &runs.join("run002.csv")]);
    all_declared("import", &at("imported"), &["import.json", "runs.csv"]);
}

#[test]
fn every_file_of_a_study_is_declared() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let study = |name: &str, more: &[&str], expected: &[&str]| {
        let out = at(name);
        let mut arguments: Vec<&dyn AsRef<std::ffi::OsStr>> = vec![&"study", &"--out", &out];
        arguments.extend(more.iter().map(|argument| argument as &dyn AsRef<std::ffi::OsStr>));
        ran(&arguments);
        all_declared("study", &out, expected);
    };
    study("case", &["--count", "6"], &["runs.csv", "runs.parquet", "fig6_regimes_gated.csv", "slope_after_1_run.csv"]);
    study("slope", &["--truth-slope", "--vehicles", "3", "--vehicle-runs", "2"], &["slope.json", "slope.csv"]);
    let scenario = at("few.toml");
    std::fs::write(&scenario, "runs = 2\n").unwrap();
    let scenario = scenario.to_str().unwrap();
    study(
        "readings",
        &["--readings", "--scenario", scenario, "--seeds", "1"],
        &["readings.csv", "readings_crossed.csv", "readings.json"],
    );
    ran(&[&"study", &"--experiment", &"all", &"--seeds", &"1", &"--count", &"3", &"--out", &at("all")]);
    for entry in std::fs::read_dir(at("all")).unwrap() {
        let path = entry.unwrap().path();
        if !path.is_dir() {
            // The page of all, and its manifest.
            continue;
        }
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        all_declared("study", &path, &[&format!("{name}.csv")]);
    }
    ran(&[&"study", &"--tunnel", &"--count", &"8", &"--out", &at("tunnel")]);
    all_declared("simulate", &at("tunnel/set"), &["truth/truth.json"]);
    std::fs::remove_dir_all(at("tunnel/set")).unwrap();
    all_declared("study", &at("tunnel"), &["tunnel.csv", "tunnel.json"]);
    ran(&[&"tune", &"--count", &"2", &"--evaluations", &"50", &"--out", &at("tune")]);
    all_declared("tune", &at("tune"), &["tune.json", "tune_plane.csv", "tune_profiles.csv"]);
}

/// What `rundown study` prints with `--json` is what the table of this heading says. Out: the text.
fn printed(folder: &Folder, heading: &str, arguments: &[&str]) -> String {
    let text = folder.done(&[&["study", "--json"], arguments].concat()).out;
    let tables = declared();
    let table = tables.iter().find(|table| table.has("study", heading));
    table.unwrap_or_else(|| panic!("no table of the page has {heading}")).agrees("study", heading, &text);
    text
}

#[test]
fn everything_that_a_study_prints_as_json_is_declared() {
    let folder = Folder::new().with("few.toml", "runs = 2\n");
    data_set(&folder.path("set"));
    printed(&folder, "--json", &["--count", "3", "--seeds", "2", "--out", "case"]);
    let recorded = ["--train", "set/train.toml", "--track", "set/track.toml", "--runs", "set/runs"];
    let text = printed(&folder, "--json", &[&recorded[..], &["--out", "recorded"]].concat());
    let value: Value = serde_json::from_str(&text).unwrap();
    for list in ["diagnosis", "claims", "truth_slope"] {
        assert!(!value[list].as_array().unwrap().is_empty(), "{list}");
    }
    let experiment = ["--experiment", "sampling", "--seeds", "1", "--count", "3", "--out", "sampling"];
    printed(&folder, "--experiment sampling --json", &experiment);
    let parts: [(&str, &[&str]); 3] = [
        ("slope", &["--truth-slope", "--vehicles", "3", "--vehicle-runs", "2"]),
        ("readings", &["--readings", "--scenario", "few.toml", "--seeds", "1"]),
        ("tunnel", &["--tunnel", "--count", "8"]),
    ];
    for (name, arguments) in parts {
        let text = printed(&folder, &format!("{} --json", arguments[0]), &[arguments, &["--out", name]].concat());
        assert_eq!(text, folder.read(&format!("{name}/{name}.json")));
    }
}

#[test]
fn every_file_of_a_bench_is_declared() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    ran(&[&"accuracy-bench", &"--fleet", &"metro", &"--vehicles", &"1", &"--runs", &"2", &"--out", &at("accuracy")]);
    all_declared("accuracy-bench", &at("accuracy"), &["manifest.json"]);
    ran(&[&"check-bench", &"--sets", &"1", &"--out", &at("check")]);
    all_declared("check-bench", &at("check"), &["bench.json", "perturbed.json", "gradients.json"]);
    let few: [&dyn AsRef<std::ffi::OsStr>; 9] =
        [&"gap-bench", &"--none", &"0", &"--pairs", &"0", &"--effort", &"with", &"--size", &"clear"];
    let drawn: [&dyn AsRef<std::ffi::OsStr>; 8] =
        [&"--kind", &"mass_error", &"--nuisance", &"effort-gain", &"--runs", &"12", &"--out", &at("gap")];
    ran(&[&few[..], &drawn[..]].concat());
    all_declared("gap-bench", &at("gap"), &["sets.json"]);
    data_set(&at("theirs/set"));
    std::fs::create_dir(at("theirs/keys")).unwrap();
    std::fs::write(at("theirs/keys/set.json"), r#"{"effects": [{"name": "tunnel_drag"}]}"#).unwrap();
    ran(&[&"gap-bench", &"--effort", &"with", &"--folder", &at("theirs"), &"--out", &at("judged")]);
    all_declared("gap-bench --folder", &at("judged"), &["sets.json"]);
}

#[test]
fn a_file_that_no_table_has_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("claims.csv"), "place,kind\n").unwrap();
    let noticed = |command: &'static str| {
        let path = folder.path().to_owned();
        std::panic::catch_unwind(move || all_declared(command, &path, &[])).is_err()
    };
    assert!(noticed("study"), "columns are missing");
    assert!(noticed("gap"), "gap has no such file");
    assert!(fits("a_<x>.csv", "a_b.csv") && !fits("a_<x>.csv", "a_.csv") && !fits("<x>.csv", "a/b.csv"));
}
