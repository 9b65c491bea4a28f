//! Does a replay say what its results rest on: unknown gradients, a description in other units?

mod common;

use common::{Folder, reference};
use std::fmt::Write as _;

/// Simulated runs in `set`, with the track without its gradients in `bare.toml`.
fn simulated(runs: usize) -> Folder {
    let folder = Folder::simulated(&format!("name = \"set\"\nruns = {runs}\nseed = 5\n"));
    let track = folder.read("set/track.toml");
    let mut bare = String::new();
    let mut inside = false;
    for line in track.lines() {
        if line.starts_with("[[") {
            inside = line == "[[gradient]]";
        }
        if !inside {
            let _ = writeln!(bare, "{line}");
        }
    }
    folder.write("bare.toml", &bare);
    folder
}

fn replayed(folder: &Folder, train: &str, track: &str) -> (String, Vec<String>) {
    let said = folder.rundown(&["replay", "--train", train, "--track", track, "--out", "out", "set/runs"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let table = folder.read("out/parameters.csv");
    let mut lines = table.lines();
    let column = lines.next().unwrap().split(',').position(|name| name == "published").unwrap();
    let published = lines.map(|line| line.split(',').nth(column).unwrap().to_owned()).collect();
    (said.err, published)
}

#[test]
fn a_track_without_gradients_is_said_and_teaches_little() {
    let folder = simulated(6);
    let (said, published) = replayed(&folder, "set/train.toml", "bare.toml");
    assert!(said.contains("off by 5 permille"), "{said}");
    assert!(published.iter().all(|word| word == "not_yet"), "{published:?}");
    let (said, published) = replayed(&folder, "set/train.toml", "set/track.toml");
    assert!(!said.contains("permille"), "{said}");
    assert_eq!(published.last().unwrap(), "learned");
}

/// As if the configuration described them.
#[test]
fn speeds_in_larger_steps_than_described_are_read_in_these() {
    for (step_kmh, is_said) in [(2.0, true), (1.0, false), (0.1, false)] {
        let sensors = format!("[sensors]\nspeed_quantum_kmh = {step_kmh}\n");
        let folder = Folder::simulated(&format!("name = \"set\"\nruns = 3\nseed = 5\n{sensors}"));
        let (said, _) = replayed(&folder, "set/train.toml", "set/track.toml");
        assert_eq!(said.contains("speeds have steps of 2.000 km/h"), is_said, "{said}");
        let undescribed = folder.read("out/parameters.csv");
        folder.write("config.toml", "[sensor]\nspeed_quantum_kmh = 2.0\n");
        let with_config =
            ["replay", "--config", "config.toml", "--train", "set/train.toml", "--track", "set/track.toml"];
        let described = folder.rundown(&[&with_config[..], &["--out", "described", "set/runs"]].concat());
        assert!(!described.err.contains("speeds have steps"), "{}", described.err);
        assert_eq!(undescribed == folder.read("described/parameters.csv"), is_said, "{step_kmh} km/h");
    }
}

#[test]
fn a_line_that_is_said_to_be_flat_and_is_not_is_recognised() {
    let folder = simulated(20);
    folder.write("flat.toml", &format!("gradient_sd_permille = 0\n{}", folder.read("bare.toml")));
    let bits = || {
        let json = folder.json("out/replay.json");
        let runs = json["runs"].as_array().unwrap().iter();
        runs.map(|run| run["foresight"]["bits_100_kmh"].as_f64().unwrap_or(0.0)).sum::<f64>()
    };
    let (said, _) = replayed(&folder, "set/train.toml", "flat.toml");
    assert!(said.contains("come again at their places in other runs"), "{said}");
    // They said 0 already.
    assert!(!said.contains("write gradient_sd_permille = 0"), "{said}");
    let doubt = folder.json("out/replay.json")["gradient_doubt"].clone();
    assert_eq!((&doubt["better"], &doubt["log_likelihood"]), (&"by_place".into(), &serde_json::Value::Null));
    assert!((0.5..3.0).contains(&doubt["off_permille"].as_f64().unwrap()), "{doubt}");
    let doubted_bits = bits();
    // With the gradients, and where the doubt is described, nothing is said.
    let (said, published) = replayed(&folder, "set/train.toml", "set/track.toml");
    assert!(!said.contains("look wrong") && published.last().unwrap() == "learned", "{said}");
    assert!(bits() > doubted_bits + 1.0, "{} {doubted_bits}", bits());
    let (said, _) = replayed(&folder, "set/train.toml", "bare.toml");
    assert!(!said.contains("look wrong"), "{said}");
    let check = |track: &str| folder.rundown(&["check", "--train", "set/train.toml", "--track", track, "set/runs"]).out;
    assert!(check("flat.toml").contains("as coasts at each place have them"));
    assert!(!check("bare.toml").contains("look wrong"));
}

/// The track of a set with its gradients off by half a permille, up and down in turns.
fn off_by_half(track: &str) -> String {
    let mut signs = [0.5, 0.5, -0.5, -0.5].into_iter().cycle();
    let line = |line: &str| match line.strip_prefix("permille = ") {
        Some(permille) => {
            let off = permille.parse::<f64>().unwrap() + signs.next().unwrap();
            format!("permille = {off:.2}\n")
        }
        None => format!("{line}\n"),
    };
    track.lines().map(line).collect()
}

#[test]
fn small_errors_of_gradients_are_found_by_the_coasts_and_doubted() {
    let folder = simulated(20);
    folder.write("off.toml", &off_by_half(&folder.read("set/track.toml")));
    folder.write("exact.toml", &format!("gradient_sd_permille = 0\n{}", folder.read("off.toml")));
    let replay = |track: &str, more: &[&str]| {
        let of = ["replay", "--train", "set/train.toml", "--track", track, "--out", "out", "set/runs"];
        let said = folder.rundown(&[&of[..], more].concat());
        let json = folder.json("out/replay.json");
        let sd_r0 = json["runs"][19]["vehicle"]["sd_r0"].as_f64().unwrap();
        (said.out.contains("gradients are taken to be off by"), json["gradient_sd_permille"].as_f64().unwrap(), sd_r0)
    };
    let (is_said, permille, doubted_sd) = replay("off.toml", &[]);
    assert!(is_said && (0.2..0.8).contains(&permille), "{is_said} {permille}");
    assert_eq!(replay("off.toml", &["--no-estimates"]), (true, permille, doubted_sd));
    // Who says that they are exact is believed.
    let (is_said, permille, sd) = replay("exact.toml", &[]);
    assert!(!is_said && permille == 0.0 && sd < doubted_sd, "{is_said} {permille} {sd} {doubted_sd}");
    let (is_said, permille, _) = replay("set/track.toml", &[]);
    assert!(!is_said && permille == 0.0, "{is_said} {permille}");
}

/// The track with all slopes so many times as steep.
fn steeper(track: &str, times: f64) -> String {
    let line = |line: &str| match line.strip_prefix("permille = ") {
        Some(permille) => format!("permille = {:.3}\n", times * permille.parse::<f64>().unwrap()),
        None => format!("{line}\n"),
    };
    track.lines().map(line).collect()
}

#[test]
fn measured_efforts_say_how_many_times_as_steep_the_gradients_are_and_doubt_small_errors() {
    let folder = Folder::simulated("name = \"set\"\nruns = 12\nseed = 8\n[effort]\ncolumn = true\n");
    let track = folder.read("set/track.toml");
    let replay = |described: &str| {
        folder.write("track.toml", described);
        let of = ["replay", "--mode", "measured", "--train", "set/train.toml", "--track", "track.toml", "--out", "out"];
        let said = folder.rundown(&[&of[..], &["set/runs"]].concat());
        let json = folder.json("out/replay.json");
        (said, json["gradient_doubt"].clone(), json["gradient_sd_permille"].as_f64().unwrap())
    };
    let (_, doubt, right) = replay(&track);
    assert!(doubt.is_null() && right == 0.0, "{doubt} {right}");
    for times in [0.6, 1.6] {
        let (said, doubt, permille) = replay(&steeper(&track, times));
        assert_eq!((&doubt["better"], &doubt["log_likelihood"]), (&"times".into(), &serde_json::Value::Null));
        let found = doubt["times"].as_f64().unwrap();
        assert!((found * times - 1.0).abs() < 0.05, "{times}: {found}");
        assert!(said.err.contains(&format!("{found:.2} times as steep")), "{}", said.err);
        assert!((doubt["off_permille"].as_f64().unwrap() - permille).abs() < 1e-9, "{doubt} {permille}");
    }
    let (said, doubt, permille) = replay(&off_by_half(&track));
    assert!(doubt.is_null() && (0.2..0.8).contains(&permille), "{doubt} {permille}");
    assert!(said.out.contains("on which the accelerations beside the efforts of different runs"), "{}", said.out);
}

#[test]
fn a_study_and_a_tuning_ask_whether_the_gradients_are_right() {
    let folder = simulated(12);
    let turned =
        folder.read("set/track.toml").replace("permille = ", "permille = -").replace("permille = --", "permille = ");
    folder.write("turned.toml", &turned);
    let said = |command: &[&str], track: &str| {
        let described = ["--runs", "set/runs", "--train", "set/train.toml", "--track", track, "--out", "out"];
        folder.done(&[command, &described].concat()).err
    };
    let tune = ["tune", "--count", "4", "--evaluations", "50", "--no-run-pages"];
    for command in [&["study", "--no-run-pages"][..], &tune] {
        let text = said(command, "turned.toml");
        assert!(text.contains("gradients look wrong: with the sign turned"), "{text}");
        assert!(!said(command, "set/track.toml").contains("gradients look wrong"));
    }
}

#[test]
fn a_study_and_a_tuning_find_small_errors_of_gradients_as_a_replay_does() {
    let folder = simulated(20);
    folder.write("off.toml", &off_by_half(&folder.read("set/track.toml")));
    let done = |command: &[&str], runs: &[&str], track: &str| {
        let described = ["--train", "set/train.toml", "--track", track, "--out", "out"];
        folder.done(&[command, &described, runs].concat()).out
    };
    let is_said = |text: &str| text.contains("\ngradients are taken to be off by 0.");
    let permille = |json: &serde_json::Value| json["gradient_sd_permille"].as_f64().unwrap();
    let tune = ["tune", "--count", "4", "--evaluations", "50", "--no-run-pages"];
    let runs = ["--runs", "set/runs"];
    for track in ["off.toml", "set/track.toml"] {
        let is_off = track == "off.toml";
        assert_eq!(is_said(&done(&["replay", "--no-estimates"], &["set/runs"], track)), is_off);
        let replayed = permille(&folder.json("out/replay.json"));
        assert_eq!(is_said(&done(&["study", "--no-run-pages"], &runs, track)), is_off);
        let json = done(&["study", "--no-run-pages", "--json"], &runs, track);
        assert_eq!(permille(&serde_json::from_str(&json).unwrap()), replayed, "{track}");
        assert_eq!(is_said(&done(&tune, &runs, track)), is_off);
        assert_eq!(permille(&folder.json("out/tune.json")), replayed, "{track}");
    }
}

#[test]
fn a_gap_says_small_errors_of_gradients_and_names_nothing_for_them() {
    let folder = Folder::simulated("name = \"set\"\nruns = 20\nseed = 5\ndirections = \"both\"\n");
    folder.write("off.toml", &off_by_half(&folder.read("set/track.toml")));
    let gap = |track: &str| {
        folder.done(&["gap", "--train", "set/train.toml", "--track", track, "--runs", "set/runs", "--out", "gap"]);
        let json = folder.json("gap/gap.json");
        let caveats = json["caveats"].as_array().unwrap().clone();
        let says = caveats.iter().any(|one| one.as_str().unwrap().starts_with("The described gradients are off by"));
        (says, json["effects"].as_array().unwrap().len(), json)
    };
    let (is_said, names, json) = gap("off.toml");
    let permille = json["gradient_errors_permille"].as_f64().unwrap();
    assert!(is_said && names == 0 && json["verdict"] == "candidate", "{json}");
    assert!((0.25..1.0).contains(&permille) && json["p_value"].as_f64().unwrap() > 0.05, "{json}");
    let (is_said, names, json) = gap("set/track.toml");
    assert!(!is_said && names == 0 && json["verdict"] == "no_gap", "{json}");
    assert!(json["gradient_errors_permille"].is_null(), "{json}");
}

#[test]
fn what_is_not_published_is_marked_on_the_screen() {
    let folder = simulated(6);
    let said = |track: &str| {
        folder.done(&["replay", "--train", "set/train.toml", "--track", track, "--out", "out", "set/runs"]).out
    };
    assert_eq!(said("bare.toml").matches(", not published yet").count(), 6);
    assert!(said("set/track.toml").matches(", not published yet").count() < 6);
}

#[test]
fn a_gap_on_unknown_gradients_is_refused() {
    let folder = simulated(6);
    let said = folder.rundown(&[
        "gap",
        "--train",
        "set/train.toml",
        "--track",
        "bare.toml",
        "--out",
        "out",
        "--runs",
        "set/runs",
    ]);
    assert_eq!(said.code, Some(3), "{}", said.err);
    assert!(said.err.contains("gradients may be off by 5 permille"), "{}", said.err);
    assert!(!folder.path("out").exists());
}

#[test]
fn coefficients_per_kmh_are_recognised() {
    let folder = simulated(20);
    let train = folder.read("set/train.toml");
    let mut wrong = String::new();
    for line in train.lines() {
        let factor = match line.split('=').next().map(str::trim) {
            Some("r1") => 3.6,
            Some("r2") => 12.96,
            _ => 1.0,
        };
        match line.split_once('=').filter(|_| factor > 1.0) {
            Some((name, value)) => writeln!(wrong, "{name}= {:e}", value.trim().parse::<f64>().unwrap() / factor),
            None => writeln!(wrong, "{line}"),
        }
        .unwrap();
    }
    assert_ne!(wrong, train, "{}", reference("train.toml"));
    folder.write("wrong.toml", &wrong);
    let (said, published) = replayed(&folder, "wrong.toml", "set/track.toml");
    assert!(said.contains("looks wrong") && said.contains("r1 x 3.6, r2 x 12.96"), "{said}");
    assert_eq!(published.last().unwrap(), "out_of_bounds");
    let (said, _) = replayed(&folder, "set/train.toml", "set/track.toml");
    assert!(!said.contains("looks wrong"), "{said}");
}

#[test]
fn locations_off_the_track_are_the_first_that_is_said() {
    let folder = simulated(2);
    let text = folder.read("set/track.toml");
    folder.write("short.toml", &text.replace("length_m = 32103.0", "length_m = 20000.0"));
    for more in [None, Some("--no-estimates")] {
        let mut arguments =
            vec!["replay", "--train", "set/train.toml", "--track", "short.toml", "--out", "out", "set/runs"];
        arguments.extend(more);
        let said = folder.rundown(&arguments).err;
        assert!(said.contains("are not on the described track"), "{said}");
        let json = folder.json("out/replay.json");
        assert!(json["notes"][0].as_str().unwrap().contains("the track from 0 to 20000 m"), "{json}");
        if more.is_none() {
            assert!(said.lines().next().unwrap().contains("are not on the described track"), "{said}");
        }
    }
}

#[test]
fn the_step_of_an_effort_column_is_its_noise_or_it_is_left_out() {
    let mut sd_r0 = Vec::new();
    for step in [0.0, 0.006, 0.03] {
        let effort = format!("[effort]\ncolumn = true\nstep_n_per_kg = {step}\n");
        let folder = Folder::simulated(&format!("name = \"set\"\nruns = 2\nseed = 5\n{effort}"));
        let described = ["--train", "set/train.toml", "--track", "set/track.toml", "--out", "out", "set/runs"];
        let said = folder.rundown(&[&["replay", "--mode", "measured"], &described[..]].concat());
        let json = folder.json("out/replay.json");
        sd_r0.push(json["runs"][1]["vehicle"]["sd_r0"].as_f64().unwrap());
        let said_so = ["steps too large", "--mode gated", "nothing was learned"].map(|text| said.err.contains(text));
        assert_eq!(said_so, [step > 0.0125; 3], "{step}: {}", said.err);
        assert_eq!(said.err.contains("should they be cut off, not rounded"), step == 0.006, "{step}: {}", said.err);
    }
    assert!(sd_r0[1] > 1.1 * sd_r0[0] && sd_r0[2] > sd_r0[1], "{sd_r0:?}");
}

/// The zero of the efforts is off, and not put right.
#[test]
fn coasts_contradict_efforts_that_are_wrong_and_what_these_teach_is_not_published() {
    let folder = Folder::simulated("name = \"set\"\nruns = 12\nseed = 8\n[effort]\ncolumn = true\n");
    let last = || {
        let of = ["replay", "--mode", "measured", "--train", "set/train.toml", "--track", "set/track.toml"];
        let said = folder.rundown(&[&of[..], &["--as-recorded", "--out", "out", "set/runs"]].concat());
        let foresight = folder.json("out/replay.json")["runs"][11]["foresight"].clone();
        assert!(foresight["coasts"].as_u64().unwrap() > 0, "{foresight}");
        (said.out + &said.err, foresight)
    };
    let (said, right) = last();
    assert!(!said.contains("one of both is wrong") && right["published"] == "learned", "{said}");
    for run in 1..=12 {
        let name = format!("set/runs/run{run:03}.csv");
        let log = folder.read(&name);
        let header = log.lines().next().unwrap();
        let at = header.split(',').position(|column| column == "effort_n_per_kg").unwrap();
        let moved = |line: &str| {
            let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
            if let Ok(effort) = fields[at].parse::<f64>() {
                fields[at] = (effort + 0.008).to_string();
            }
            fields.join(",") + "\n"
        };
        folder.write(&name, &log.lines().map(moved).collect::<String>());
    }
    let (said, wrong) = last();
    assert!(said.contains("one of both is wrong, and r is not published"), "{said}");
    assert!(wrong["published"] != "learned", "{wrong}");
    let error = |foresight: &serde_json::Value| foresight["coast_error_kmh"].as_f64().unwrap();
    assert!(error(&wrong) > 3.0 * error(&right), "{wrong} {right}");
}
