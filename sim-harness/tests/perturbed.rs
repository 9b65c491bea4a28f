//! Are runs with a red signal said, and set aside in studies; are wrong gradients said?

mod common;

use common::Folder;
use serde_json::Value;

/// Twelve runs, of which few meet a red signal at 14 km; with the names of those that did.
fn with_red_signal() -> (Folder, Vec<String>) {
    let folder = Folder::simulated(
        "name = \"set\"\nruns = 12\nseed = 4\n\n[red_signal]\nat_m = 14000.0\ndwell_s = 90.0\nshare = 0.12\n",
    );
    let truth = folder.json("set/truth/truth.json");
    let runs = truth["runs"].as_array().unwrap().iter().filter(|run| run["stops"].as_array().unwrap().len() > 1);
    let stopped: Vec<String> =
        runs.map(|run| run["file"].as_str().unwrap().trim_end_matches(".csv").to_owned()).collect();
    assert!((1..=2).contains(&stopped.len()), "{stopped:?}");
    (folder, stopped)
}

/// Rows of a table whose column `perturbed` is not empty.
fn perturbed(folder: &Folder, table: &str) -> Vec<String> {
    let mut reader = csv::Reader::from_path(folder.path(table)).unwrap();
    let column = reader.headers().unwrap().iter().position(|name| name == "perturbed").unwrap();
    let rows = reader.records().map(|row| row.unwrap());
    rows.filter(|row| !row[column].is_empty()).map(|row| row[0].to_owned()).collect()
}

#[test]
fn a_replay_says_which_runs_were_perturbed_and_a_study_sets_them_aside() {
    let (folder, stopped) = with_red_signal();
    let checked: Value = serde_json::from_str(&folder.done(&["check", "--json", "set"]).out).unwrap();
    let of_check =
        checked["runs"].as_array().unwrap().iter().filter(|run| run["perturbations"] != serde_json::json!([]));
    let named: Vec<&str> = of_check.map(|run| run["name"].as_str().unwrap()).collect();
    assert_eq!(named, stopped);
    let described = ["--train", "set/train.toml", "--track", "set/track.toml"];
    let said = folder.done(&[&["replay", "--out", "out", "set/runs"], &described[..]].concat());
    assert!(said.err.contains("perturbed runs: ") && said.err.contains("at km 14.0"), "{}", said.err);
    assert_eq!(perturbed(&folder, "out/features.csv"), stopped);
    let study = |out: &str, more: &[&str]| {
        let words = [&["study", "--json", "--out", out, "--runs", "set/runs"], &described[..], more].concat();
        let said = folder.done(&words);
        (serde_json::from_str::<Value>(&said.out).unwrap(), said.err)
    };
    let (json, err) = study("study", &[]);
    assert_eq!(json["set_aside"], stopped.len());
    assert_eq!(json["runs"], 12 - stopped.len());
    assert!(err.contains("--keep-perturbed"), "{err}");
    assert_eq!(perturbed(&folder, "study/runs.csv"), stopped);
    assert!(folder.read("study/report.html").contains("perturbed and set aside"));
    let (_, _) = study("shown", &["--example", &stopped[0]]);
    assert!(folder.read("shown/fig3_run_gated.csv").lines().count() > 50);
    assert!(folder.read("shown/report.html").contains("is one of the runs that were set aside ("));
    for of_all in ["fig4_davis_gated.csv", "fig8_brake_rates_paper.csv", "runs.csv"] {
        assert_eq!(folder.read(&format!("shown/{of_all}")), folder.read(&format!("study/{of_all}")), "{of_all}");
    }
    let wrong = [&["study", "--out", "none", "--runs", "set/runs", "--example", "nobody"], &described[..]].concat();
    let refused = folder.rundown(&wrong);
    assert_eq!(refused.code, Some(2));
    assert!(refused.err.contains("--example: expected the name of a run that could be used, found nobody"));
    let (json, _) = study("kept", &["--keep-perturbed"]);
    assert_eq!((&json["set_aside"], &json["runs"]), (&Value::from(0), &Value::from(12)));
}

#[test]
fn gradients_with_the_sign_turned_are_said_and_right_ones_are_not() {
    let folder = Folder::simulated("name = \"set\"\nruns = 12\nseed = 5\n");
    let track = folder.read("set/track.toml");
    let turned: Vec<String> = track
        .lines()
        .map(|line| match line.split_once('=') {
            Some((name, value)) if name.trim() == "permille" => {
                format!("permille = {}", -value.trim().parse::<f64>().unwrap())
            }
            _ => line.to_owned(),
        })
        .collect();
    folder.write("turned.toml", &turned.join("\n"));
    let replayed = |track: &str, more: &[&str]| {
        let words = ["replay", "--train", "set/train.toml", "--track", track, "--out", "out", "set/runs"];
        folder.rundown(&[&words[..], more].concat())
    };
    let said = replayed("turned.toml", &[]);
    assert!(said.err.contains("gradients look wrong: with the sign turned"), "{}", said.err);
    let json = folder.json("out/replay.json");
    assert!(json["notes"].as_array().unwrap().iter().any(|note| note.as_str().unwrap().contains("look wrong")));
    let doubt = json["gradient_doubt"].clone();
    assert_eq!(doubt["better"], "sign_turned");
    assert!(doubt["off_permille"].as_f64().unwrap() > 2.0, "{doubt}");
    // What is learned in spite of them is learned less surely, and not published.
    assert_eq!(json["runs"][11]["foresight"]["published"], "not_yet", "{}", json["runs"][11]["foresight"]);
    assert!(replayed("turned.toml", &["--no-estimates"]).err.contains("gradients look wrong: with the sign turned"));
    assert_eq!(replayed("turned.toml", &["--strict"]).code, Some(1));
    assert_eq!(folder.json("out/replay.json")["gradient_doubt"], doubt);
    assert!(!replayed("set/track.toml", &[]).err.contains("look wrong"));
    let json = folder.json("out/replay.json");
    assert_eq!(
        (&json["gradient_doubt"], &json["runs"][11]["foresight"]["published"]),
        (&Value::Null, &"learned".into())
    );
    let check = |track: &str| folder.rundown(&["check", "--train", "set/train.toml", "--track", track, "set/runs"]).out;
    assert!(check("turned.toml").contains("gradients look wrong: with the sign turned"), "{}", check("turned.toml"));
    assert!(!check("set/track.toml").contains("look wrong"));
}
