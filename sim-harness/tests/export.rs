//! Does another tool get what was learned? The files of `rundown export`, and back through a replay.

mod common;

use common::{RUN, code, done, reference, rundown, stderr};
use quick_xml::events::Event;
use std::collections::HashMap;
use std::path::Path;
use std::process::Output;

/// A folder with three runs and their replay in `out`.
fn replayed(more: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::copy(reference("train.toml"), at.join("train.toml")).unwrap();
    std::fs::copy(reference("track.toml"), at.join("track.toml")).unwrap();
    std::fs::create_dir(at.join("logs")).unwrap();
    for name in ["a.csv", "b.csv", "c.csv"] {
        std::fs::write(at.join("logs").join(name), RUN).unwrap();
    }
    let described = ["replay", "--train", "train.toml", "--track", "track.toml"];
    done(at, &[&described, more, &["logs"]].concat());
    folder
}

const EXPORT: [&str; 8] = ["export", "--sfera", "out", "--company", "0084", "--traction=1500V", "--max-speed", "140"];

fn exported(folder: &Path, more: &[&str]) -> Output {
    rundown(folder, &[&EXPORT[..], &["--train", "train.toml"], more].concat())
}

/// Names and attributes of all elements, in their order.
fn elements(xml: &str) -> Vec<(String, HashMap<String, String>)> {
    let mut reader = quick_xml::Reader::from_str(xml);
    let mut found = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Start(start) | Event::Empty(start) => {
                let name = String::from_utf8(start.name().as_ref().to_vec()).unwrap();
                let attributes = start.attributes().map(|attribute| {
                    let attribute = attribute.unwrap();
                    let key = String::from_utf8(attribute.key.as_ref().to_vec()).unwrap();
                    (key, attribute.unescape_value().unwrap().into_owned())
                });
                found.push((name, attributes.collect()));
            }
            Event::Eof => return found,
            _ => {}
        }
    }
}

/// A column of the first row of a table.
fn first(csv: &str, name: &str) -> f64 {
    let mut lines = csv.lines().map(|line| line.split(','));
    let column = lines.next().unwrap().position(|n| n == name).unwrap();
    lines.next().unwrap().nth(column).unwrap().parse().unwrap()
}

#[test]
fn what_was_learned_goes_out_and_comes_back() {
    let folder = replayed(&[]);
    let at = folder.path();
    let output = exported(at, &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("largest effort") && said.contains("3 runs"), "{said}");

    // The vehicle after the last run, in the results and in the train file.
    let parameters = std::fs::read_to_string(at.join("out/parameters.csv")).unwrap();
    let last: Vec<f64> = parameters
        .lines()
        .next_back()
        .unwrap()
        .split(',')
        .skip(1)
        .take(3)
        .map(|field| field.parse().unwrap())
        .collect();
    let train = std::fs::read_to_string(at.join("learned/train.toml")).unwrap();
    let train: toml::Table = train.parse().unwrap();
    let davis = |name: &str| train["davis"][name].as_float().unwrap();
    assert_eq!([davis("r0"), davis("r1"), davis("r2")], last[..]);
    assert!((last[0] / 7.38e-3 - 1.0).abs() > 1e-3, "it has learned: {last:?}");

    // The document states the same per stated rotating mass.
    let xml = std::fs::read_to_string(at.join("learned/sfera.xml")).unwrap();
    let elements = elements(&xml);
    let (name, features) = &elements[2];
    assert_eq!(name, "TC_Features");
    let value = |name: &str| features[name].parse::<f64>().unwrap();
    let rotating_mass_kg = 1000.0 * value("trainWeight") * value("rotatingMassFactor");
    for (name, learned) in ["A", "B", "C"].iter().zip(&last) {
        let stated = value(&format!("rolloutCoefficient{name}")) / rotating_mass_kg;
        assert!((stated / learned - 1.0).abs() < 1e-6, "{name}: {stated} {learned}");
    }
    let names: Vec<&str> = elements.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names[..4], ["TrainCharacteristics", "TC_RU_ID", "TC_Features", "TractionForceCurve"]);
    assert_eq!(names[names.len() - 2..], ["TFC_TractionType", "Electrical"]);
    let points: Vec<(f64, f64)> = elements
        .iter()
        .filter(|(name, _)| name == "TractionForceCurveDataPoint")
        .map(|(_, point)| {
            let value = |name: &str| point[name].parse::<f64>().unwrap();
            (value("speed"), value("tractionForce"))
        })
        .collect();
    assert!(points.is_sorted_by(|a, b| a.0 < b.0 && a.1 >= b.1), "{points:?}");
    assert_eq!(points.last().unwrap().0, 140.0);

    // A replay begins with it.
    let again = ["replay", "--train", "learned/train.toml", "--track", "track.toml", "--out", "again", "logs/a.csv"];
    let output = rundown(at, &again);
    assert!(output.status.success(), "{}", stderr(&output));
    let estimates = std::fs::read_to_string(at.join("again/a.estimates.csv")).unwrap();
    let share = first(&estimates, "r2") / davis("r2");
    assert!((share - 1.0).abs() < 1e-9, "{share}");
}

#[test]
fn what_has_learned_nothing_together_is_refused() {
    let folder = replayed(&["--no-carry"]);
    let output = exported(folder.path(), &[]);
    assert_eq!(code(&output), Some(3));
    assert!(stderr(&output).contains("--no-carry"), "{}", stderr(&output));
}

#[test]
fn another_train_another_unit_and_no_replay_are_refused() {
    let folder = replayed(&[]);
    let at = folder.path();
    let train = std::fs::read_to_string(at.join("train.toml")).unwrap();
    let other = train.replacen("name = \"", "name = \"another ", 1);
    std::fs::write(at.join("other.toml"), other).unwrap();
    let output = rundown(at, &[&EXPORT[..], &["--train", "other.toml"]].concat());
    assert_eq!(code(&output), Some(3));
    assert!(stderr(&output).contains("expected that of the train file"), "{}", stderr(&output));
    assert_eq!(code(&exported(at, &["--unit", "nobody"])), Some(3));
    std::fs::remove_file(at.join("out/replay.json")).unwrap();
    let output = exported(at, &[]);
    assert_eq!(code(&output), Some(3));
    assert!(stderr(&output).contains("replay.json"), "{}", stderr(&output));
    assert!(!at.join("learned").exists());
}
