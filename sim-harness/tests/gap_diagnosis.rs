//! Does `rundown gap` begin with the diagnosis of its logs: put right what a recorder did, say so everywhere, name no
//! effect for it, and leave out what cannot be used?

mod common;

use common::{Folder, Said};
use serde_json::Value;

/// A folder with `set`: eight runs of a recorder that truncates, 1 s, and a wheel of this scale.
fn truncated(scale: f64) -> Folder {
    Folder::simulated(&format!(
        "runs = 8\nseed = 5\n[sensors]\nspeed = \"truncated\"\nsampling_s = 1.0\n[effort]\ncolumn = true\n[[effect]]\nname = \"speed_scale\"\nmeasured_over_true = {scale}\n"
    ))
}

fn gap(folder: &Folder, more: &[&str]) -> Said {
    let model = ["gap", "--train", "set/train.toml", "--track", "set/track.toml", "--out", "out", "--runs", "set/runs"];
    let said = folder.rundown(&[&model, more].concat());
    assert!(said.code.is_some_and(|code| code < 2), "{}", said.err);
    said
}

fn names(json: &Value) -> Vec<&str> {
    json["effects"].as_array().unwrap().iter().map(|effect| effect["name"].as_str().unwrap()).collect()
}

/// Kinds of what was found in all runs of the only recorder, with what was done.
fn findings(json: &Value) -> Vec<(&str, &str)> {
    let found = json["diagnosis"]["recorders"][0]["findings"].as_array().unwrap();
    found.iter().map(|found| (found["kind"].as_str().unwrap(), found["done"].as_str().unwrap())).collect()
}

#[test]
fn truncated_speeds_are_put_right_said_and_named_no_wheel() {
    let folder = truncated(1.0);
    let Said { out: screen, err, .. } = gap(&folder, &[]);
    let words = "speeds are truncated to the step below: 1.000 km/h; put right";
    assert!(err.contains(words), "{err}");
    let json = folder.json("out/gap.json");
    assert_eq!(findings(&json), [("truncated_speed", "put_right")]);
    assert!(!names(&json).contains(&"speed_scale"), "{screen}");
    assert!(folder.read("out/report.html").contains(words));

    let Said { err, .. } = gap(&folder, &["--as-recorded"]);
    assert!(!err.contains("truncated"), "{err}");
    assert!(folder.json("out/gap.json")["diagnosis"].is_null());
    assert!(folder.read("out/report.html").contains("taken as recorded"));
}

#[test]
fn a_wheel_is_put_right_and_reported_once() {
    let folder = truncated(1.013);
    let Said { out: screen, err, .. } = gap(&folder, &[]);
    assert!(err.contains("the speed is off by a factor: read over true: 1.01"), "{err}");
    let json = folder.json("out/gap.json");
    assert_eq!(findings(&json), [("truncated_speed", "put_right"), ("speed_scale", "put_right")]);
    let wheels: Vec<&Value> =
        json["effects"].as_array().unwrap().iter().filter(|effect| effect["name"] == "speed_scale").collect();
    let [wheel] = wheels[..] else { panic!("{screen}") };
    let value = wheel["parameters"]["measured_over_true"].as_f64().unwrap();
    assert!((value - 1.013).abs() < 0.002, "{value}");
    // A replay with the model that was found must not put the wheel right a second time.
    let model = ["replay", "--train", "out/model/train.toml", "--track", "out/model/track.toml", "--out", "replayed"];
    let said = folder.done(&[&model[..], &["set/runs"]].concat());
    let said_of_wheel = said.err.lines().find(|line| line.contains("off by a factor"));
    assert!(said_of_wheel.is_none_or(|line| !line.contains("put right")), "{}", said.err);
}

#[test]
fn locations_that_are_off_are_reported_without_an_effort_column() {
    let folder = Folder::simulated(
        "name = \"set\"\nruns = 24\nseed = 6\ndirections = \"both\"\n[line]\nname = \"hilly\"\n[sensors]\nlocation_offset_m = 60.0\n",
    );
    let Said { out: screen, .. } = gap(&folder, &[]);
    let json = folder.json("out/gap.json");
    assert!(names(&json).is_empty(), "{screen}");
    let [offset] = &json["nuisances"].as_array().unwrap()[..] else { panic!("{}", json["nuisances"]) };
    assert_eq!((&offset["name"], &offset["told"]), (&"location_offset".into(), &true.into()), "{offset}");
    let [value, sd] = ["value", "sd"].map(|name| offset[name].as_f64().unwrap());
    assert!((value - 60.0).abs() < 3.0 * sd && sd < 10.0, "{offset}");
}

#[test]
fn a_run_that_cannot_be_used_is_left_out_with_the_reason() {
    let folder = truncated(1.0);
    let log = folder.read("set/runs/run002.csv");
    let (header, rows) = log.split_once('\n').unwrap();
    let rows: Vec<&str> = rows.lines().collect();
    // There and back: the same rows in the other order, at later times.
    let end_s: f64 = rows[rows.len() - 1].split(',').next().unwrap().parse().unwrap();
    let back = rows.iter().rev().enumerate().map(|(i, row)| {
        let (_, readings) = row.split_once(',').unwrap();
        format!("{},{readings}", end_s + 60.0 + i as f64)
    });
    let text: Vec<String> =
        [header.to_owned()].into_iter().chain(rows.iter().map(|row| (*row).to_owned())).chain(back).collect();
    folder.write("set/runs/run002.csv", &(text.join("\n") + "\n"));
    let Said { code, err, .. } = gap(&folder, &[]);
    assert_eq!(code, Some(1), "{err}");
    assert!(err.contains("there and back in one log") && err.contains("run002.csv"), "{err}");
    assert_eq!(folder.json("out/gap.json")["runs_left_out"], 1);
}
