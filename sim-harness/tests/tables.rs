//! Replays that write Parquet, or no row for each tick: the same numbers as the usual tables.

mod common;

use common::{Folder, RUN, another};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::fs::File;

/// A Parquet table as CSV has it: numbers with the digits that give the bits back.
fn parquet_as_csv(folder: &Folder, name: &str) -> String {
    let reader = SerializedFileReader::new(File::open(folder.path(name)).unwrap()).unwrap();
    let schema = reader.metadata().file_metadata().schema_descr();
    let names: Vec<&str> = schema.columns().iter().map(|column| column.name()).collect();
    let mut text = names.join(",") + "\n";
    for row in reader.get_row_iter(None).unwrap() {
        let fields = row.unwrap().into_columns().into_iter().map(|(_, field)| match field {
            Field::Null => String::new(),
            Field::Str(text) => text,
            Field::Long(count) => count.to_string(),
            Field::Double(number) => format!("{number:?}"),
            other => panic!("{other:?}"),
        });
        text += &(fields.collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

const BY_RUN: [&str; 3] = ["features", "parameters", "switching_points"];

#[test]
fn parquet_has_the_cells_of_csv_and_the_units_of_its_columns() {
    let folder = Folder::new().with("a.csv", RUN).with("b.csv", &another(1));
    assert_eq!(folder.replay(&["a.csv", "b.csv"]).code, Some(0));
    let of_run = ["a.estimates", "b.estimates", "a.coast_ahead"];
    let names = || BY_RUN.into_iter().chain(of_run);
    let csv: Vec<String> = names().map(|name| folder.read(&format!("out/{name}.csv"))).collect();
    assert_eq!(folder.replay(&["--format", "parquet", "a.csv", "b.csv"]).code, Some(0));
    for (name, csv) in names().zip(csv) {
        assert_eq!(parquet_as_csv(&folder, &format!("out/{name}.parquet")), csv, "{name}");
        assert!(!folder.path(&format!("out/{name}.csv")).exists(), "{name}");
    }
    assert_eq!(folder.json("out/replay.json")["runs"][0]["estimates"], "a.estimates.parquet");
    let reader = SerializedFileReader::new(File::open(folder.path("out/parameters.parquet")).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap();
    let columns = metadata.iter().find(|entry| entry.key == "rundown.columns").unwrap().value.clone().unwrap();
    let columns: serde_json::Value = serde_json::from_str(&columns).unwrap();
    assert_eq!(columns["r0"]["unit"], "N/kg");
}

#[test]
fn without_estimates_the_tables_of_runs_are_the_same_and_nothing_else_is_there() {
    let folder = Folder::new().with("a.csv", RUN).with("b.csv", &another(1));
    let names = ["out/features.csv", "out/parameters.csv", "out/switching_points.csv"];
    for mode in ["gated", "paper"] {
        assert_eq!(folder.replay(&["--mode", mode, "a.csv", "b.csv"]).code, Some(0));
        let usual = names.map(|name| folder.read(name));
        let mut json = folder.read("out/replay.json");
        let said = folder.replay(&["--mode", mode, "--no-estimates", "a.csv", "b.csv"]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        assert_eq!(names.map(|name| folder.read(name)), usual);
        for name in ["a.estimates", "a.coast_ahead", "b.estimates", "b.coast_ahead"] {
            json = json.replace(&format!("\"{name}.csv\""), "null");
        }
        assert!(folder.read("out/replay.json") == json);
        let left: Vec<_> = std::fs::read_dir(folder.path("out")).unwrap().collect();
        assert_eq!(left.len(), 3 + 2, "tables, replay.json and manifest.json: {left:?}");
    }
}

/// Runs in one Parquet file, as a study keeps them, are the runs of the logs.
#[test]
fn runs_of_a_parquet_file_are_those_of_the_logs() {
    let folder = Folder::new();
    folder.done(&["simulate", "--runs", "3", "--seed", "5", "--out", "set"]);
    let described = ["--train", "set/train.toml", "--track", "set/track.toml"];
    let kept = ["study", "--runs", "set/runs", "--as-recorded", "--keep-runs", "runs.parquet", "--out", "study"];
    folder.done(&[&kept[..], &described].concat());
    let replayed = |runs: &str, options: &[&str]| {
        folder.done(&[&["replay", "--out", "out", "--as-recorded", runs], &described[..], options].concat());
        BY_RUN.map(|name| folder.read(&format!("out/{name}.csv")))
    };
    let of_logs = replayed("set/runs", &[]);
    assert_eq!(replayed("runs.parquet", &[]), of_logs);
    assert_eq!(replayed("runs.parquet", &["--no-estimates"]), of_logs);
    let said = folder.rundown(&[&["replay", "runs.parquet", "set/runs"], &described[..]].concat());
    assert_eq!(said.code, Some(3));
    assert!(said.err.contains("set/runs: expected Parquet files, as the others are"), "{}", said.err);
}
