//! Does the page of outputs say what the files hold? It is made again and compared, and each JSON file is walked along its table.

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
    assert!(rows.len() > 250, "{}", rows.len());
    for row in &rows {
        let is_column = ["text", "count", "number"].contains(&row[2].as_str());
        let meaning = if is_column { &row[4] } else { &row[3] };
        assert!(!meaning.is_empty(), "{row:?}");
        let is_free = row[1].starts_with("`P_") || row[1] == "`direction`";
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

fn agree(name: &str, fields: &[[&str; 4]], value: &Value) {
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

#[test]
fn json_files_have_the_fields_of_their_tables() {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().join("set");
    let text = sim_harness::simulation::scenario_file::HIDDEN_EFFECT;
    let mut simulation = Simulation::parse(Path::new("scenario"), text).unwrap();
    simulation.runs = 10;
    folder::write(&simulation, &set, false, || ()).unwrap();
    let (train, track, runs) = (set.join("train.toml"), set.join("track.toml"), set.join("runs"));
    let at = |name: &str| folder.path().join(name);
    let read = |path: &str| serde_json::from_str(&std::fs::read_to_string(at(path)).unwrap()).unwrap();
    ran(&[&"replay", &"--train", &train, &"--track", &track, &"--out", &at("replay"), &runs]);
    agree("manifest.json", rundown_files::folder::FIELDS, &read("replay/manifest.json"));
    agree("replay.json", sim_harness::output::json::FIELDS, &read("replay/replay.json"));
    ran(&[&"check", &"--out", &at("check.json"), &runs]);
    agree("check --json", sim_harness::checking::FIELDS, &read("check.json"));
    ran(&[&"gap", &"--train", &train, &"--track", &track, &"--runs", &runs, &"--out", &at("gap")]);
    agree("gap.json", rundown_gap::answer::json::FIELDS, &read("gap/gap.json"));
}
