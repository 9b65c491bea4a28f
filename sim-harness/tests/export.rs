//! Does another tool get what was learned? The files of `rundown export`, and back through a replay.

mod common;

use common::{Folder, RUN, Said, another, reference};
use quick_xml::events::Event;
use rundown_wire::link::serial;
use rundown_wire::{Body, Downlink};
use sim_harness::display::demo;
use sim_harness::link::record::{Log, Way};
use std::collections::HashMap;

const REPLAY: [&str; 6] = ["replay", "--train", "train.toml", "--track", "track.toml", "logs"];

/// A folder with three runs and their replay in `out`.
fn replayed(more: &[&str]) -> Folder {
    let folder = recorded();
    folder.done(&[&REPLAY[..], more].concat());
    folder
}

/// The runs alone.
fn recorded() -> Folder {
    let logs = ["logs/a.csv", "logs/b.csv", "logs/c.csv"];
    let logs = logs.into_iter().zip(0..);
    let folder = logs.fold(Folder::new(), |folder, (name, number)| folder.with(name, &another(number)));
    for name in ["train.toml", "track.toml"] {
        std::fs::copy(reference(name), folder.path(name)).unwrap();
    }
    folder
}

const EXPORT: [&str; 8] = ["export", "--sfera", "out", "--company", "0084", "--traction=1500V", "--max-speed", "140"];

fn exported(folder: &Folder, train: &str, more: &[&str]) -> Said {
    folder.rundown(&[&EXPORT[..], &["--train", train], more].concat())
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
    let Said { code, out, err } = exported(&folder, "train.toml", &[]);
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("Largest tractive effort") && out.contains("from 3 runs"), "{out}");

    // The vehicle after the last run, in the results and in the train file.
    let parameters = folder.read("out/parameters.csv");
    let last: Vec<f64> = parameters
        .lines()
        .next_back()
        .unwrap()
        .split(',')
        .skip(1)
        .take(3)
        .map(|field| field.parse().unwrap())
        .collect();
    let train: toml::Table = folder.read("learned/train.toml").parse().unwrap();
    let davis = |name: &str| train["davis"][name].as_float().unwrap();
    assert_eq!([davis("r0"), davis("r1"), davis("r2")], last[..]);
    assert!((last[0] / 7.38e-3 - 1.0).abs() > 1e-3, "it has learned: {last:?}");

    // The document states the same per stated rotating mass.
    let elements = elements(&folder.read("learned/sfera.xml"));
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
    folder.done(&again);
    let share = first(&folder.read("again/a.estimates.csv"), "r2") / davis("r2");
    assert!((share - 1.0).abs() < 1e-9, "{share}");
}

#[test]
fn what_has_learned_nothing_together_is_refused() {
    let Said { code, err, .. } = exported(&replayed(&["--no-carry"]), "train.toml", &[]);
    assert_eq!(code, Some(3));
    assert!(err.contains("--no-carry"), "{err}");
}

#[test]
fn a_resistance_that_is_not_yet_learned_is_refused() {
    let folder = recorded();
    // Gradients that nobody knows hide the resistance.
    let mut track: toml::Table = folder.read("track.toml").parse().unwrap();
    track.remove("gradient").unwrap();
    folder.write("track.toml", &track.to_string());
    folder.done(&REPLAY);
    let Said { code, err, .. } = exported(&folder, "train.toml", &[]);
    assert_eq!(code, Some(3), "{err}");
    assert!(err.contains("expected a resistance that would be published as learned, found `not_yet`"), "{err}");
    assert!(!folder.path("learned").exists());
}

#[test]
fn runs_that_were_set_aside_do_not_count() {
    let rows = RUN.lines().count();
    // Without readings for two of three parts.
    let aside: String = another(9)
        .lines()
        .enumerate()
        .map(|(index, line)| if 3 * index < rows { format!("{line}\n") } else { emptied(line) })
        .collect();
    let folder = recorded().with("logs/d.csv", &aside);
    let Said { code, err, .. } = folder.rundown(&REPLAY);
    assert_eq!(code, Some(1), "{err}");
    let used: Vec<bool> = folder.json("out/replay.json")["runs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| run["used"].as_bool().unwrap())
        .collect();
    assert_eq!(used, [true, true, true, false]);
    let Said { code, out, err } = exported(&folder, "train.toml", &[]);
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("from 3 runs"), "{out}");
}

/// A row with its time alone.
fn emptied(line: &str) -> String {
    let (time, rest) = line.split_once(',').unwrap();
    format!("{time}{}\n", ",".repeat(1 + rest.matches(',').count()))
}

#[test]
fn another_train_another_unit_and_no_replay_are_refused() {
    let folder = replayed(&[]);
    folder.write("other.toml", &folder.read("train.toml").replacen("name = \"", "name = \"another ", 1));
    let refused = |train: &str, more: &[&str], words: &str| {
        let Said { code, err, .. } = exported(&folder, train, more);
        assert_eq!(code, Some(3));
        assert!(err.contains(words), "{err}");
    };
    refused("other.toml", &[], "out/replay.json: train: expected `");
    refused("train.toml", &["--unit", "nobody"], "out/replay.json: unit: expected one of");
    std::fs::remove_file(folder.path("out/replay.json")).unwrap();
    refused("train.toml", &[], "out/replay.json: expected the folder that `rundown replay --out` makes");
    assert!(!folder.path("learned").exists());
}

#[test]
fn a_train_of_the_same_name_with_other_values_is_refused() {
    let folder = replayed(&[]);
    let heavier: String = folder
        .read("train.toml")
        .lines()
        .map(|line| {
            let is_mass = line.starts_with("mass_kg");
            if is_mass { "mass_kg = 400000.0\n".to_owned() } else { format!("{line}\n") }
        })
        .collect();
    folder.write("heavier.toml", &heavier);
    let Said { code, err, .. } = exported(&folder, "heavier.toml", &[]);
    assert_eq!(code, Some(3), "{err}");
    let expected = "out/replay.json: described: expected the train of the train file, found another one: mass_kg is ";
    assert!(err.contains(expected) && err.contains("and 400000.0 in the train file"), "{err}");
    assert!(!folder.path("learned").exists());
    // Results of a version that did not write the values.
    let mut json = folder.json("out/replay.json");
    json.as_object_mut().unwrap().remove("described").unwrap();
    folder.write("out/replay.json", &json.to_string());
    let Said { code, err, .. } = exported(&folder, "train.toml", &[]);
    assert!(code == Some(0) && err.contains("does not say which values the train had"), "{err}");
}

#[test]
fn files_of_an_export_of_other_results_are_not_mixed_with_its_own() {
    let folder = replayed(&[]);
    folder.done(&["replay", "--train", "train.toml", "--track", "track.toml", "--out", "one", "logs/a.csv"]);
    let export = |format, results| {
        folder.rundown(&["export", "--to", format, results, "--train", "train.toml", "--max-speed", "140"])
    };
    assert_eq!(export("sumo", "one").code, Some(0));
    let before = folder.read("learned/train.toml");
    let said = export("altrios", "out");
    assert_eq!(said.code, Some(4), "{said:?}");
    assert!(said.err.contains("sumo.add.xml there: of an export of other results"), "{said:?}");
    assert!(folder.read("learned/train.toml") == before && !folder.path("learned/altrios.yaml").exists());
    // Where all is written again nothing is mixed.
    assert_eq!(export("sumo,altrios", "out").code, Some(0));
}

const SIMULATORS: [&str; 8] =
    ["export", "--to", "sumo,sumo-table,osrd,trainruns,altrios", "out", "--train", "train.toml", "--max-speed", "140"];

/// All numbers of a train file, by their names.
fn numbers(toml: &str) -> HashMap<String, f64> {
    let table: toml::Table = toml.parse().unwrap();
    let davis = table["davis"].as_table().unwrap().iter();
    let all = table.iter().chain(davis).filter_map(|(name, value)| Some((name.clone(), value.as_float()?)));
    all.collect()
}

#[test]
fn every_simulator_gets_the_train_and_gives_it_back() {
    let folder = replayed(&[]);
    folder.done(&[&SIMULATORS[..], &["--traction", "diesel"]].concat());
    let expected = numbers(&folder.read("learned/train.toml"));
    let effort = format!("max_tractive_effort_n={}", expected["max_tractive_effort_n"]);
    let power = format!("max_power_w={}", expected["max_power_w"]);
    let lacking = ["--set", &effort, "--set", &power];
    for (file, more) in [
        ("sumo.add.xml", &[][..]),
        ("sumo.table.add.xml", &[]),
        ("osrd.json", &[]),
        ("trainruns.yaml", &[]),
        ("altrios.yaml", &lacking),
    ] {
        let file = format!("learned/{file}");
        let back = folder.done(&[&["convert", file.as_str()], more].concat());
        let found = numbers(&back.out);
        assert_eq!(found.len(), expected.len(), "{file}");
        for (name, value) in &expected {
            assert!((found[name] - value).abs() <= 3e-6 * value.abs(), "{file}: {name}: {} {value}", found[name]);
        }
    }
    assert!(folder.read("learned/osrd.json").contains("\"thermal\""));
}

#[test]
fn files_of_an_earlier_export_are_kept_and_named_and_the_speeds_of_learning_said() {
    let folder = replayed(&[]);
    let export =
        |format| folder.done(&["export", "--to", format, "out", "--train", "train.toml", "--max-speed", "140"]);
    let said = export("sumo");
    let line = said.out.lines().find(|line| line.starts_with("Learned at ")).unwrap();
    let speeds: Vec<f64> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
    assert!(speeds.len() == 2 && speeds[0] >= 40.0 && speeds[0] < speeds[1] && speeds[1] < 150.0, "{line}");
    assert!(!said.err.contains("earlier export"), "{said:?}");
    let before = folder.read("learned/sumo.add.xml");
    let said = export("altrios");
    assert!(said.err.contains("kept as an earlier export wrote them: sumo.add.xml"), "{said:?}");
    assert_eq!(folder.read("learned/sumo.add.xml"), before);
    let outputs = folder.json("learned/manifest.json")["outputs"].to_string();
    assert!(["sumo.add.xml", "altrios.yaml", "train.toml"].iter().all(|name| outputs.contains(name)), "{outputs}");
    // One that was taken away stays away, and is not asked for.
    std::fs::remove_file(folder.path("learned/sumo.add.xml")).unwrap();
    assert!(!export("altrios").err.contains("earlier export"));
}

#[test]
fn what_a_format_needs_or_lacks_is_asked_for_by_name() {
    let folder = replayed(&[]);
    let said = folder.rundown(&SIMULATORS);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("--traction: expected"), "{}", said.err);
    assert!(!folder.path("learned").exists());
    folder.done(&["export", "--to", "altrios", "out", "--train", "train.toml", "--max-speed", "140"]);
    let lacking = folder.rundown(&["convert", "learned/altrios.yaml", "--out", "back.toml"]);
    assert_eq!(lacking.code, Some(3));
    let expected = "learned/altrios.yaml: max_tractive_effort_n: expected a value, found none in this format";
    assert!(lacking.err.contains(expected), "{}", lacking.err);
    let wrong = folder.rundown(&["convert", "learned/altrios.yaml", "--set", "mass=3"]);
    assert_eq!(wrong.code, Some(2));
    // A file that is there stays as it is.
    let before = folder.read("train.toml");
    let set = ["--set", "max_tractive_effort_n=2e5", "--set", "max_power_w=2e6"];
    let kept = folder.rundown(&[&["convert", "learned/altrios.yaml", "--out", "train.toml"], &set[..]].concat());
    assert_eq!((kept.code, folder.read("train.toml")), (Some(4), before));
}

#[test]
fn a_running_path_becomes_a_track() {
    let path = "schema: https://railtoolkit.org/schema/running-path.json\npaths:\n  - id: hill\n    characteristic_sections:\n      \
                - {position: 0, speed: 80, resistance: 5}\n      - {position: 2000, speed: 60, resistance: 0}\n";
    let folder = Folder::new().with("path.yaml", path);
    let said = folder.done(&["convert", "path.yaml", "--out", "track.toml"]);
    assert!(said.err.contains("note: the resistance of the path is taken as gradient"), "{}", said.err);
    let track: toml::Table = folder.read("track.toml").parse().unwrap();
    assert_eq!(track["length_m"].as_float(), Some(2000.0));
    assert_eq!(track["gradient"][0]["permille"].as_float(), Some(5.0));
    let said = folder.rundown(&["convert", "path.yaml", "--set", "mass_kg=1000"]);
    assert!(said.code != Some(0) && said.err.contains("--set mass_kg: expected a train, found a running path"));
}

/// What a board says of three runs, as its display and its desk record it, and as the bytes of its line.
#[test]
fn what_a_board_has_learned_goes_out_from_its_recording() {
    let (train, _) = demo::described().unwrap();
    let folder = Folder::new().with("train.toml", &toml::to_string(&train).unwrap());
    let (mut heard, mut bytes) = (Vec::new(), Vec::new());
    demo::play_runs(3, |message| {
        bytes.extend_from_slice(&serial::encode(message).unwrap());
        heard.push(message.to_vec());
    })
    .unwrap();
    let text = |heard: &[Vec<u8>]| {
        let mut file = Vec::new();
        let mut log = Log::new(&mut file).unwrap();
        heard.iter().for_each(|message| log.write(0, Way::Received, message));
        log.finish().unwrap();
        String::from_utf8(file).unwrap()
    };
    std::fs::write(folder.path("run.frames"), &bytes).unwrap();
    folder.write("run.csv", &text(&heard));
    let last = heard.iter().rev().find_map(|message| match Downlink::decode(message).unwrap().body {
        Body::RunSummary(summary) => Some(summary),
        _ => None,
    });
    let last = last.unwrap();

    let of = |recording: &str, out: &str, train: &str| {
        folder.rundown(&["export", "--to", "sumo", recording, "--train", train, "--max-speed", "140", "--out", out])
    };
    let Said { code, out, err } = of("run.frames", "a", "train.toml");
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("learned by Rundown from 3 runs"), "{out}");
    assert!(err.contains("does not say which train was described"), "{err}");
    assert_eq!(of("run.csv", "b", "train.toml").code, Some(0));
    let learned: toml::Table = folder.read("a/train.toml").parse().unwrap();
    let r0 = learned["davis"]["r0"].as_float().unwrap();
    assert_eq!(r0 as f32, last.vehicle_davis[0].value);
    assert_ne!(r0, train.davis.r0);
    assert_eq!(folder.read("a/sumo.add.xml"), folder.read("b/sumo.add.xml"));

    // Cut off in mid-line and in mid-frame, behind the end of the last run or before it.
    let whole = text(&heard);
    for (torn, file, said) in [
        (
            whole.as_bytes()[..whole.len() - 6].to_vec(),
            "torn.csv",
            format!("of line {} were left out", heard.len() + 1),
        ),
        (bytes[..bytes.len() - 3].to_vec(), "torn.frames", "of a frame were left out".to_owned()),
    ] {
        std::fs::write(folder.path(file), torn).unwrap();
        let Said { code, out, err } = of(file, "torn", "train.toml");
        assert_eq!(code, Some(0), "{file}: {err}");
        assert!(err.contains("it is cut off, the last ") && err.contains(&said), "{file}: {err}");
        assert!(out.contains("learned by Rundown from ") && out.contains(" runs"), "{out}");
    }

    // Each run numbers its frames from 0 on: that a whole one is missing only the numbers of the runs say.
    let frames: Vec<Downlink> = heard.iter().map(|message| Downlink::decode(message).unwrap()).collect();
    let places = |of: fn(&Downlink) -> bool| (0..frames.len()).filter(|at| of(&frames[*at])).collect::<Vec<_>>();
    let ends = places(|frame| matches!(frame.body, Body::RunSummary(_)));
    let begins = places(|frame| frame.sequence == 0);
    let [second, third] = [0, 1].map(|end| *begins.iter().find(|begin| **begin > ends[end]).unwrap());
    let second = second..third;
    let without: Vec<Vec<u8>> =
        (0..heard.len()).filter(|at| !second.contains(at)).map(|at| heard[at].clone()).collect();
    folder.write("without.csv", &text(&without));
    let Said { code, out, err } = of("without.csv", "without", "train.toml");
    assert!(code == Some(0) && out.contains("learned by Rundown from 2 runs"), "{out}{err}");
    assert!(err.contains("without.csv: without the end of the board's run 2: "), "{err}");
    assert!(!err.contains("lost, damaged or unknown"), "{err}");

    // Torn off before its first run ended, and a file that is none.
    folder.write("none.csv", &text(&heard[..20]));
    for (file, found) in [("none.csv", "found none in 20 frames"), ("train.toml", "found none in 0 frames")] {
        let said = of(file, "c", "train.toml");
        assert!(said.code == Some(3) && said.err.contains(found) && !folder.path("c").exists(), "{}", said.err);
    }
}
