//! Logs that are mostly unusable or in wrong units: are they named, is the exit code theirs, and does the vehicle stay
//! as it was?

mod common;

use common::{Folder, RUN, another, reference};

/// The rows of the run, each by its time, location in m and speed in km/h.
fn run(row: impl Fn(usize, [f64; 3]) -> Option<String>) -> String {
    let mut text = "time_s,location_m,speed_kmh\n".to_owned();
    for (index, line) in RUN.lines().skip(1).enumerate() {
        let fields: Vec<f64> = line.split(',').take(3).map(|field| field.parse().unwrap()).collect();
        text.extend(row(index, [fields[0], fields[1], fields[2]]).map(|row| row + "\n"));
    }
    text
}

fn scaled(location: f64, speed: f64) -> String {
    run(|_, [t, s, v]| Some(format!("{t},{},{}", location * s, speed * v)))
}

/// Name and log of each injected defect.
fn defects() -> Vec<(&'static str, String)> {
    let rows = RUN.lines().skip(1).count();
    let there_and_back = run(|_, [t, s, v]| Some(format!("{t},{s},{v}")))
        + run(|i, [t, ..]| {
            let mirrored: Vec<f64> =
                RUN.lines().nth(rows - i)?.split(',').take(3).map(|field| field.parse().unwrap()).collect();
            Some(format!("{},{},{}", 1300.0 + t, mirrored[1], mirrored[2]))
        })
        .split_once('\n')
        .unwrap()
        .1;
    vec![
        ("speeds in m/s", scaled(1.0, 1.0 / 3.6)),
        ("speeds in mph", scaled(1.0, 1.0 / 1.609_344)),
        ("speeds in knots", scaled(1.0, 1.0 / 1.852)),
        ("locations in km", scaled(1e-3, 1.0)),
        ("locations in feet", scaled(1.0 / 0.3048, 1.0)),
        ("times in minutes", run(|_, [t, s, v]| Some(format!("{},{s},{v}", t / 60.0)))),
        ("there and back", there_and_back),
        ("no speeds", run(|_, [t, s, _]| Some(format!("{t},{s},")))),
        ("no readings", run(|_, [t, ..]| Some(format!("{t},,")))),
        (
            "neither in two of three parts",
            run(|i, [t, s, v]| Some(if 3 * i < rows { format!("{t},{s},{v}") } else { format!("{t},,") })),
        ),
        (
            "speeds of 400 km/h and more",
            run(|i, [t, s, v]| Some(format!("{t},{s},{}", if i % 7 < 4 { v + 400.0 } else { v }))),
        ),
        ("letters", run(|i, [t, s, v]| Some(if i == 5 { format!("{t},x,{v}") } else { format!("{t},{s},{v}") }))),
    ]
}

/// r0, r1, r2 and their deviations after the last run.
fn vehicle(folder: &Folder) -> Vec<String> {
    let table = folder.read("out/parameters.csv");
    table.lines().last().unwrap().split(',').skip(1).take(6).map(str::to_owned).collect()
}

#[test]
fn no_unusable_log_changes_the_vehicle_and_each_is_named() {
    let folder = Folder::new().with("a.csv", RUN).with("c.csv", &another(1));
    assert_eq!(folder.replay(&["a.csv", "c.csv"]).code, Some(0));
    let without = vehicle(&folder);
    for (name, log) in defects() {
        folder.write("b.csv", &log);
        for options in [&[][..], &["--no-estimates"]] {
            let said = folder.replay(&[options, &["a.csv", "b.csv", "c.csv"]].concat());
            assert_eq!(said.code, Some(1), "{name}: {}", said.err);
            assert!(said.err.contains("b.csv"), "{name}: {}", said.err);
            assert_eq!(vehicle(&folder), without, "{name}: {}", said.err);
        }
        let said = folder.replay(&["b.csv"]);
        assert_eq!(said.code, Some(6), "{name} alone: {}", said.err);
    }
}

#[test]
fn strict_fails_where_anything_is_to_be_warned_of_and_leaves_what_is_there() {
    let back = format!("{}5.0,20,10\n", another(1));
    let folder = Folder::new().with("a.csv", RUN).with("back.csv", &back).with("bad.csv", &defects()[0].1);
    for options in [&[][..], &["--no-estimates"]] {
        let strict = |logs: &[&str]| folder.replay(&[&["--strict"], options, logs].concat());
        assert_eq!(strict(&["a.csv"]).code, Some(0));
        let before = folder.read("out/replay.json");
        for logs in [&["a.csv", "back.csv"], &["a.csv", "bad.csv"]] {
            let said = strict(logs);
            assert_eq!(said.code, Some(1), "{}", said.err);
            assert!(said.err.contains("--strict: expected nothing to be warned of, found 1 warning;"), "{}", said.err);
            assert_eq!(folder.read("out/replay.json"), before);
        }
    }
    let check = folder.rundown(&["check", "--strict", "a.csv", "bad.csv"]);
    assert_eq!(check.code, Some(1), "{}", check.out);
    for out in ["found", "found.json"] {
        let check = folder.rundown(&["check", "--strict", "--out", out, "a.csv", "bad.csv"]);
        assert_eq!(check.code, Some(1), "{}", check.out);
        assert!(check.err.contains("nothing was written") && !folder.path(out).exists(), "{}", check.err);
    }
    assert_eq!(folder.rundown(&["check", "bad.csv"]).code, Some(6));
    // An import counts what it left out.
    folder.done(&["import", "--strict", "a.csv", "--out", "clean"]);
    folder.write("a.csv", &format!("{RUN}not a row\n"));
    let said = folder.rundown(&["import", "--strict", "a.csv", "--out", "clean"]);
    assert_eq!(said.code, Some(1), "{}{}", said.out, said.err);
    assert!(said.err.contains("--strict") && folder.path("clean/a_01.csv").exists(), "{}", said.err);
}

#[test]
fn a_check_says_which_rows_it_left_out() {
    let folder = Folder::new().with("a.csv", &format!("{RUN}not a row\n")).with("b.csv", RUN);
    let check = folder.rundown(&["check", "a.csv"]);
    assert!(check.err.contains("a.csv:") && check.err.contains("the row was left out"), "{}", check.err);
    assert_eq!(folder.rundown(&["check", "--strict", "a.csv"]).code, Some(1));
    assert_eq!(folder.rundown(&["check", "b.csv"]).err, "");
}

#[test]
fn of_too_few_runs_the_first_that_is_left_out_is_named_and_no_row() {
    let folder = Folder::new().with("a.csv", &format!("{RUN}not a row\n")).with("b.csv", "no log\n");
    let (train, track) = (common::reference("train.toml"), common::reference("track.toml"));
    let said = folder.rundown(&["gap", "--train", &train, "--track", &track, "--runs", "a.csv", "b.csv"]);
    assert!(said.err.contains("1 usable runs (1 log was left out: b.csv:"), "{}", said.err);
}

#[test]
fn a_study_of_runs_that_teach_nothing_has_the_exit_code_of_a_replay() {
    let folder = Folder::new().with("a.csv", &RUN.lines().take(3).map(|line| format!("{line}\n")).collect::<String>());
    let (train, track) = (common::reference("train.toml"), common::reference("track.toml"));
    let words = ["study", "--train", &train, "--track", &track, "--out", "out", "--runs", "a.csv"];
    assert_eq!(folder.rundown(&words).code, Some(6));
}

/// A tuning on logs that say nothing of a moving train would be a filter for standing ones.
#[test]
fn logs_that_teach_nothing_are_nothing_to_tune_or_study() {
    let standing: String = (0..200).map(|i| format!("{i},100,0\n")).collect();
    let logs = [
        ("one.csv", "time_s,location_m,speed_kmh\n0,100,30\n".to_owned()),
        ("standing.csv", format!("time_s,location_m,speed_kmh\n{standing}")),
    ];
    for (name, text) in logs {
        let folder = Folder::new().with(name, &text);
        for (command, words) in [("tune", "rows of a moving train"), ("study", "nothing was learned")] {
            let [train, track] = ["train.toml", "track.toml"].map(reference);
            let run = [command, "--runs", name, "--train", &train, "--track", &track, "--out", "out"];
            let said = folder.rundown(&run);
            assert_eq!(said.code, Some(6), "{command} {name}: {}", said.err);
            assert!(said.err.contains(words), "{command} {name}: {}", said.err);
            assert!(command == "study" || !folder.path("out/tune.json").exists(), "{name}");
        }
    }
}

/// The same rows under another name, and by another clock.
#[test]
fn a_log_that_is_given_twice_counts_once_in_every_command() {
    let later = run(|_, [t, s, v]| Some(format!("{},{s},{v}", t + 3600.0)));
    let plain = run(|_, [t, s, v]| Some(format!("{t},{s},{v}")));
    let folder = Folder::new().with("logs/a.csv", &plain).with("logs/b.csv", &plain).with("logs/c.csv", &later);
    let [train, track] = ["train.toml", "track.toml"].map(reference);
    let described = ["--train", &train, "--track", &track];
    let replayed = folder.rundown(&[&["replay", "logs", "--out", "out"], &described[..]].concat());
    assert_eq!(replayed.code, Some(1), "{}", replayed.err);
    assert_eq!(folder.json("out/replay.json")["runs"].as_array().unwrap().len(), 1);
    let check = folder.rundown(&["check", "logs"]);
    let tune = ["tune", "--runs", "logs", "--evaluations", "50", "--out", "tuned"];
    let tuned = folder.rundown(&[&tune, &described[..]].concat());
    let study = folder.rundown(&[&["study", "--runs", "logs", "--out", "studied"], &described[..]].concat());
    assert!(tuned.out.contains("1 recorded run, "), "{}", tuned.out);
    for said in [replayed.err, check.out, tuned.err, study.err] {
        for name in ["b.csv", "c.csv"] {
            let run = format!("  {}: ", name.trim_end_matches(".csv"));
            let mut lines = said.lines().filter(|line| line.contains("holds the same rows"));
            assert!(lines.any(|line| line.contains(name) || line.starts_with(&run)), "{name}: {said}");
        }
        assert!(said.contains("those of a.csv"), "{said}");
    }
}

#[test]
fn many_errors_of_one_kind_are_a_few_lines_and_all_in_the_results() {
    let folder = Folder::new().with("logs/a.csv", RUN);
    (0..40).for_each(|i| folder.write(&format!("logs/z{i}.csv"), "a,b\n1,2\n"));
    let said = folder.replay(&["logs"]);
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert_eq!(said.err.matches("error: ").count(), 4, "{}", said.err);
    assert!(said.err.contains("error: and 37 more like this: expected a header with time_s"), "{}", said.err);
    assert_eq!(folder.json("out/replay.json")["failed"].as_array().unwrap().len(), 40);
    let said = folder.rundown(&["import", "logs", "--out", "imported"]);
    assert!(said.err.matches("error: ").count() < 6, "{}", said.err);
}

#[test]
fn what_is_not_there_and_what_is_empty_have_one_exit_code_in_all_commands() {
    let folder = Folder::new().with("logs/a.csv", RUN);
    std::fs::create_dir(folder.path("empty")).unwrap();
    let (train, track) = (reference("train.toml"), reference("track.toml"));
    let described = ["--train", &train, "--track", &track];
    let commands: [(&[&str], &[&str]); 6] = [
        (&["check"], &[]),
        (&["replay"], &described),
        (&["gap", "--runs"], &described),
        (&["study", "--runs"], &described),
        (&["tune", "--runs"], &described),
        (&["import"], &[]),
    ];
    for (command, more) in commands {
        for (runs, expected) in [("nosuch.csv", 6), ("nosuch", 6), ("empty", 3)] {
            let said = folder.rundown(&[command, &[runs], more].concat());
            assert_eq!(said.code, Some(expected), "{command:?} {runs}: {}", said.err);
            assert!(said.err.contains(runs), "{command:?} {runs}: {}", said.err);
        }
    }
    assert_eq!(folder.rundown(&["import"]).code, Some(2));
    assert_eq!(folder.rundown(&["display", "--file", "empty"]).code, Some(3));
}
