//! Does the command keep its promises? Exit codes, one-line errors, the files it writes.

mod common;

use common::{Folder, RUN, Said, another, reference};
use serde_json::Value;
use std::collections::HashMap;

#[test]
fn a_replay_writes_every_file_and_one_row_a_sample() {
    let folder = Folder::new().with("run01.csv", RUN);
    let output = folder.replay(&["run01.csv"]);
    assert_eq!(output.code, Some(0), "{}", output.err);
    assert_eq!(output.err, "");
    assert_eq!(folder.read("out/run01.estimates.csv").lines().count(), 117);
    assert_eq!(folder.read("out/features.csv").lines().count(), 2);
    assert!(folder.read("out/parameters.csv").starts_with("run,r0,r1,r2,sd_r0,sd_r1,sd_r2,run_r0,"));
    assert!(folder.read("out/switching_points.csv").starts_with("run,time_s,location_m,speed_mps,from,to\n"));
    assert!(folder.read("out/report.html").contains("<svg"));
    let json = folder.json("out/replay.json");
    assert_eq!(json["runs"][0]["steps"], 116);
}

#[test]
fn the_paper_mode_names_its_effort_and_prints_no_interval() {
    let folder = Folder::new().with("run01.csv", RUN).with("backward.toml", "[paper]\ndifference = \"backward\"\n");
    let said = folder.replay(&["--mode", "paper", "run01.csv"]).out;
    assert!(said.contains("mode: paper (effort forward)") && !said.contains('\u{b1}'), "{said}");
    assert!(said.contains("r(100 km/h) of the filter, no measure of the vehicle"), "{said}");
    let said = folder.replay(&["--mode", "paper", "--config", "backward.toml", "run01.csv"]).out;
    assert!(said.contains("mode: paper (effort backward)"), "{said}");
    assert!(folder.replay(&["run01.csv"]).out.contains('\u{b1}'), "the gated mode has its interval");
}

#[test]
fn the_same_logs_give_the_same_bytes() {
    let folder = Folder::new().with("a.csv", RUN).with("b.csv", &another(1));
    for mode in ["paper", "gated"] {
        let mut bytes = Vec::new();
        for _ in 0..2 {
            assert_eq!(folder.replay(&["--mode", mode, "a.csv", "b.csv"]).code, Some(0));
            bytes.push((
                folder.read("out/b.estimates.csv"),
                folder.read("out/parameters.csv"),
                folder.read("out/replay.json"),
            ));
        }
        assert_eq!(bytes[0], bytes[1]);
    }
}

#[test]
fn coast_ahead_has_a_row_a_tick_where_the_track_has_limits() {
    let folder = Folder::new().with("run.csv", RUN);
    assert_eq!(folder.replay(&["run.csv"]).code, Some(0));
    let table = folder.read("out/run.coast_ahead.csv");
    let mut lines = table.lines();
    assert_eq!(
        lines.next(),
        Some(
            "time_s,location_m,speed_mps,outcome,target_m,target_limit_mps,target_speed_mps,sd_target_speed_mps,target_time_s,sd_target_time_s,stop_m,sd_stop_m,published"
        )
    );
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), folder.read("out/run.estimates.csv").lines().count() - 1);
    let arrives: Vec<&Vec<&str>> = rows.iter().filter(|row| row[3] == "arrives").collect();
    assert!(arrives.len() > 30, "{}", arrives.len());
    // The limit of 40 km/h before the platform.
    assert!(arrives.iter().any(|row| row[4].parse::<f64>().unwrap() == 31_853.0));
    let published = rows.iter().filter(|row| row[12] == "1").count();
    assert!(0 < published && published < rows.len());
    let json = folder.json("out/replay.json");
    assert_eq!(json["runs"][0]["coast_ahead"], "run.coast_ahead.csv");

    // Without limits and stops there is nothing to coast to.
    let track = std::fs::read_to_string(reference("track.toml")).unwrap();
    let (mut bare, mut keep) = (String::new(), true);
    for line in track.lines() {
        if line.starts_with('[') {
            keep = !line.contains("speed_limit") && !line.contains("stop");
        }
        if keep {
            bare += line;
            bare += "\n";
        }
    }
    let folder = Folder::new().with("run.csv", RUN).with("bare.toml", &bare);
    assert_eq!(folder.replay_on("bare.toml", &["run.csv"]).code, Some(0));
    assert!(!folder.path("out/run.coast_ahead.csv").exists());
}

#[test]
fn the_vehicle_is_carried_unless_asked_not_to() {
    let folder = Folder::new().with("a.csv", RUN).with("b.csv", RUN);
    let vehicles = |arguments: &[&str]| -> Vec<String> {
        assert_eq!(folder.replay(arguments).code, Some(0));
        let parameters = folder.read("out/parameters.csv");
        let vehicle = |line: &str| line.split(',').skip(1).take(6).collect::<Vec<_>>().join(",");
        parameters.lines().skip(1).map(vehicle).collect()
    };
    // As recorded, the same log may be given twice.
    let carried = vehicles(&["--as-recorded", "--mode", "paper", "a.csv", "b.csv"]);
    assert_ne!(carried[0], carried[1]);
    let apart = vehicles(&["--as-recorded", "--mode", "paper", "--no-carry", "a.csv", "b.csv"]);
    assert_eq!(apart[0], apart[1]);
    assert_eq!(apart[0], carried[0]);
}

#[test]
fn json_is_all_that_stands_on_stdout() {
    let folder = Folder::new().with("logs/run01.csv", RUN).with("logs/bad.csv", "time_s,location_m,speed_kmh\n0,x,1\n");
    let output = folder.replay(&["--json", "--mode", "paper", "logs"]);
    assert_eq!(output.code, Some(1));
    let json: Value = serde_json::from_str(&output.out).unwrap();
    assert_eq!(json["mode"], "paper");
    assert_eq!(json["runs"].as_array().unwrap().len(), 1);
    assert_eq!(json["failed"].as_array().unwrap().len(), 1);
    let file = folder.json("out/replay.json");
    assert_eq!(json, file);
}

#[test]
fn a_bad_row_names_file_line_and_column_and_stops_only_its_run() {
    let bad = RUN.replacen("\n10.0,", "\n10.0,oops,", 1);
    let folder = Folder::new().with("good.csv", RUN).with("bad.csv", &bad);
    let Said { code, err, .. } = folder.replay(&["bad.csv", "good.csv", "nowhere.csv"]);
    assert_eq!(code, Some(1));
    assert!(err.starts_with("error: bad.csv:3: expected 3 fields as in the header, found 4\n"), "{err}");
    assert!(err.contains("error: nowhere.csv: cannot be read"), "{err}");
    assert!(folder.path("out/good.estimates.csv").exists());
    assert!(!folder.path("out/bad.estimates.csv").exists());

    let output = folder.replay(&["--skip-bad-rows", "bad.csv"]);
    assert_eq!(output.code, Some(0));
    assert_eq!(folder.read("out/bad.estimates.csv").lines().count(), 116);
}

/// A folder `logs` with one log whose name no text can hold.
#[cfg(unix)]
fn named_in_bytes(text: &str) -> Folder {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new().with("logs/read.me", "");
    std::fs::write(folder.path("logs").join(std::ffi::OsStr::from_bytes(b"l\xff\xfe.csv")), text).unwrap();
    folder
}

#[test]
#[cfg(unix)]
fn a_log_whose_name_is_no_utf8_is_read_like_any_other() {
    let folder = named_in_bytes(RUN);
    let described = ["--train", &reference("train.toml"), "--track", &reference("track.toml")];
    let run = |command: &str, inputs: &[&str]| {
        let said = folder.rundown(&[&[command, "--out", command], &described[..], inputs].concat());
        assert!(said.code == Some(0) && !said.err.contains("panicked"), "{command}: {said:?}");
        said
    };
    let file = "logs/l\u{fffd}\u{fffd}.csv";
    run("replay", &["logs"]);
    assert_eq!(folder.json("replay/replay.json")["runs"][0]["file"], file);
    run("check", &["logs"]);
    run("study", &["--runs", "logs"]);
    let said = folder.rundown(&["import", "--out", "import", "logs"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let note = format!("{file}: its name is no UTF-8; import.toml has it as shown here, so name the file to repeat");
    assert!(said.err.contains(&note), "{said:?}");
    assert!(folder.read("import/import.toml").contains(file));
    let again = folder.rundown(&["import", "--mapping", "import/import.toml", "--out", "again", "logs"]);
    assert_eq!(again.code, Some(0), "{again:?}");
    assert_eq!(folder.read("again/import.json"), folder.read("import/import.json"));
    // One run is too few for a gap: what is wrong with it is said.
    let few = folder.rundown(&[&["gap", "--out", "gap"], &described[..], &["--runs", "logs"]].concat());
    assert!(few.err.contains("expected at least 5") && !few.err.contains("panicked"), "{few:?}");
}

#[test]
#[cfg(unix)]
fn a_log_that_cannot_be_used_and_whose_name_is_no_utf8_is_named() {
    let folder = named_in_bytes("time_s,location_m\n0,x\n");
    folder.write("logs/run01.csv", RUN);
    let said = folder.replay(&["logs"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert_eq!(folder.json("out/replay.json")["failed"][0]["file"], "logs/l\u{fffd}\u{fffd}.csv");
}

#[test]
fn a_row_back_in_time_is_warned_of_and_counted() {
    let folder = Folder::new().with("run.csv", &format!("{RUN}5.0,20,10\n"));
    let output = folder.replay(&["run.csv"]);
    assert_eq!(output.code, Some(0));
    assert_eq!(output.err, "warning: run.csv:118:1: time_s: expected a time after 1150, found 5\n");
    let json = folder.json("out/replay.json");
    assert_eq!(json["runs"][0]["counters"]["time_not_increasing"], 1);
    assert_eq!(json["runs"][0]["dropped"][0]["line"], 118);
    assert_eq!(json["runs"][0]["steps"], 116);
}

#[test]
fn what_spoils_a_whole_replay_is_said_aloud() {
    let folder = Folder::new()
        .with("run.csv", RUN)
        .with("short.toml", "name = \"km for m\"\nlength_m = 32\ngradient_sd_permille = 0\n");
    let notes = |output: &Said| {
        let code = if output.err.contains("nothing was learned") { 6 } else { 0 };
        assert_eq!(output.code, Some(code), "{}", output.err);
        let json = folder.json("out/replay.json");
        let of_json = json["notes"].as_array().unwrap().iter();
        let of_json: String = of_json.map(|note| format!("note: {}\n", note.as_str().unwrap())).collect();
        let warned = json["runs"][0]["warnings"].as_array().unwrap().iter();
        let warned: String = warned.map(|text| format!("warning: {}\n", text.as_str().unwrap())).collect();
        // What spoils all of it comes before what is the matter with rows.
        assert_eq!(of_json.clone() + &warned, output.err);
        of_json
    };
    assert_eq!(notes(&folder.replay(&["run.csv"])), "");
    assert_eq!(
        notes(&folder.replay(&["--mode", "measured", "run.csv"])),
        "note: run: no effort_n_per_kg that can be used, without which the measured mode learns from the coasts of short hops alone; --mode gated learns from all coasts\n\
         note: nothing was learned about the resistance: it takes 60 s of known effort without braking in one piece; \
         after a hop of at most 300 s no effort teaches, but 16 s of coasting above 50 km/h\n"
    );
    let paper = notes(&folder.replay(&["--mode", "paper", "run.csv"]));
    assert!(paper.contains("does not follow the true resistance"));
    assert_eq!(
        notes(&folder.replay_on("short.toml", &["run.csv"])),
        "note: 109 of 112 locations of moving trains (97 %) are not on the described track: they go from 41 to 32080 m, the track from 0 to 32 m. \
         Nothing is known of gradients there: a replay leaves them out, but for runs that are mostly there; bring the runs onto its chainage with `rundown import --chainage align`, \
         or describe the track from where their locations count, with its whole length_m\n\
         note: nothing was learned about the resistance: it takes 60 s of coasting above 50 km/h in one piece, \
         or 16 s of coasting above 50 km/h after a hop of at most 300 s; the fastest of these runs reached 136 km/h\n"
    );
}

#[test]
fn a_log_without_any_speed_is_named_and_one_that_cannot_be_read_is_no_reason_for_advice() {
    let folder = Folder::new()
        .with("run.csv", "time_s,location_m,speed_kmh\n0,0,\n10,5,\n")
        .with("bad.csv", "time_s,location_m,speed_kmh\n0,0,x\n");
    let found = folder.replay(&["run.csv"]).err;
    let expected = "note: run: no speed_kmh in any row, without which nothing is known of the train\n";
    assert!(found.contains(expected), "{found}");
    let found = folder.replay(&["bad.csv"]).err;
    assert!(found.starts_with("error: bad.csv:2"), "{found}");
    assert!(!found.contains("note: "), "{found}");
}

/// From the command line to the reference: configuration by file, results from the file that a user reads.
#[test]
fn the_tables_of_the_reference_come_out_of_the_command() {
    let [backward, alpha_1] = ["backward.toml", "alpha_1.toml"].map(reference);
    for (options, name) in [
        (["--mode", "paper"], "A_run01_forward.csv"),
        (["--config", backward.as_str()], "A_run01.csv"),
        (["--config", alpha_1.as_str()], "D_run01.csv"),
    ] {
        let folder = Folder::new().with("run.csv", RUN);
        let output = folder.replay(&[&options[..], &["run.csv"]].concat());
        assert_eq!(output.code, Some(0), "{}", output.err);
        let found = columns(&folder.read("out/run.estimates.csv"));
        let expected = columns(&std::fs::read_to_string(reference(name)).unwrap());
        let number = |field: &String| field.parse::<f64>().unwrap();
        let near = |ours: &str, theirs: &str, scale: &dyn Fn(usize) -> f64, limit: f64| {
            for (row, (a, b)) in found[ours].iter().zip(&expected[theirs]).enumerate() {
                let off = (number(a) - number(b)).abs() / scale(row);
                assert!(off < limit, "{name}, row {row}, {ours}: {a} for {b}");
            }
        };
        let state = ["location_m", "speed_mps", "r0", "r1", "r2"];
        for (i, ours) in state.into_iter().enumerate() {
            let theirs = format!("x_{i}");
            let largest = expected[&theirs].iter().map(|x| number(x).abs());
            let largest = largest.fold(0.0, f64::max);
            near(ours, &theirs, &|_| largest, 1e-9);
            for j in i..5 {
                let sd = |k: usize, row: usize| number(&expected[&format!("P_{k}{k}")][row]).sqrt();
                let both = |row: usize| sd(i, row) * sd(j, row);
                near(&format!("P_{i}{j}"), &format!("P_{i}{j}"), &both, 1e-9);
            }
        }
        near("effort_n_per_kg", "u_k", &|_| 1.0, 1e-9);
        assert_eq!(found["regime"], expected["regime"]);
    }
}

/// Columns of a table by name.
fn columns(text: &str) -> HashMap<String, Vec<String>> {
    let mut lines = text.lines().map(|line| line.split(','));
    let names: Vec<String> = lines.next().unwrap().map(str::to_owned).collect();
    let mut columns: HashMap<String, Vec<String>> = HashMap::new();
    for line in lines {
        for (name, field) in names.iter().zip(line) {
            columns.entry(name.clone()).or_default().push(field.to_owned());
        }
    }
    columns
}

#[test]
fn a_tick_takes_the_newest_sample_of_each_period() {
    let folder = Folder::new().with("run.csv", RUN);
    assert_eq!(folder.replay(&["--tick", "20", "run.csv"]).code, Some(0));
    let estimates = folder.read("out/run.estimates.csv");
    let times: Vec<&str> = estimates.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(times.len(), 59);
    assert_eq!(times[1], "20.0");
}

#[test]
fn refused_descriptions_have_their_own_exit_code() {
    let folder = Folder::new().with("run.csv", RUN).with("c.toml", "[sensor]\nlocation_sd_m = -1\n");
    let output = folder.replay(&["--config", "c.toml", "run.csv"]);
    assert_eq!(output.code, Some(3));
    assert!(output.err.starts_with("error: c.toml:2:17: sensor.location_sd_m: expected"), "{}", output.err);
    assert_eq!(folder.replay(&["--mode", "none", "run.csv"]).code, Some(2));
    for tick in ["0", "601", "inf", "x"] {
        assert_eq!(folder.replay(&["--tick", tick, "run.csv"]).code, Some(2));
    }
}

#[test]
fn an_output_that_cannot_be_written_has_its_own_exit_code() {
    let folder = Folder::new().with("run.csv", RUN).with("out", "a file where the folder should be");
    let output = folder.replay(&["run.csv"]);
    assert_eq!(output.code, Some(4));
    assert!(output.err.ends_with("choose another folder with --out\n"), "{}", output.err);
}

#[test]
fn help_and_completions_are_there() {
    let folder = Folder::new();
    let help = folder.rundown(&["replay", "--help"]).out;
    for word in ["Examples:", "Exit codes:", "--skip-bad-rows", "parameters.csv"] {
        assert!(help.contains(word), "{word}");
    }
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(folder.rundown(&["completions", shell]).out.contains("rundown"), "{shell}");
    }
}

#[test]
fn the_demo_says_what_it_saw_and_where_the_report_lies() {
    let folder = Folder::new();
    let output = folder.rundown(&["demo"]);
    assert_eq!(output.code, Some(0), "{}", output.err);
    let text = output.out;
    for word in ["67 simulated runs", "final coast", "final brake", "at 60 km/h", "at 140 km/h", "out/demo/report.html"]
    {
        assert!(text.contains(word), "{word} in {text}");
    }
    // What it does comes first, what to open last.
    assert!(text.starts_with("The paper's 67 runs are simulated and replayed"), "{text}");
    let last: Vec<&str> = text.trim_end().lines().rev().take(3).collect();
    for (line, page) in last[1..].iter().zip(["out/demo/gap/report.html", "out/demo/report.html"]) {
        assert!(line.starts_with(&format!("open {page}: ")), "{line}");
        assert!(folder.path(page).exists());
    }
    assert!(last[0].starts_with("your own logs: "), "{last:?}");
    readme_shows(&text);
}

/// README.md shows lines of the demo, in their order and to the last digit; `(...)` stands for what it leaves out of a
/// line.
fn readme_shows(text: &str) {
    let readme = include_str!("../../README.md");
    let (_, shown) = readme.split_once("shortened:\n\n```text\n").unwrap();
    let (shown, _) = shown.split_once("```").unwrap();
    assert!(shown.lines().count() > 4, "{shown}");
    let mut printed = text.lines();
    for line in shown.lines() {
        let is_it = |printed: &str| match line.split_once("(...)") {
            None => printed == line,
            Some((begin, end)) => printed.starts_with(begin.trim_end()) && printed.ends_with(end),
        };
        assert!(
            printed.any(is_it),
            "README.md shows a line that the demo does not print, or not here:\n{line}\n\n{text}"
        );
    }
}

#[test]
fn an_effect_is_explained_without_any_data() {
    let explain = |name| Folder::new().rundown(&["gap", "--explain", name]);
    let explained = explain("steady_wind");
    assert_eq!(explained.code, Some(0), "{explained:?}");
    assert!(explained.out.contains("headwind"));
    assert_eq!(explain("no_such_effect").code, Some(2));
}

#[test]
fn an_example_is_printed_and_what_it_would_not_use_is_refused() {
    let folder = Folder::new();
    let words = ["hidden-effect", "hidden_effect"].map(|which| folder.done(&["simulate", "--example", which]).out);
    assert!(words[0] == words[1] && words[0].contains("tunnel_drag"), "{}", words[0]);
    let said = folder.rundown(&["simulate", "--example", "hidden-effect", "--out", "set"]);
    assert!(said.code == Some(2) && said.err.contains("cannot be used with"), "{}", said.err);
}

#[test]
fn an_effect_of_a_run_that_no_log_has_is_said() {
    let effect = |runs: &str| format!("[[effect]]\nname = \"steady_wind\"\nwind_mps = 2.0\nruns = [{runs}]\n");
    let track = |runs: &str| std::fs::read_to_string(reference("track.toml")).unwrap() + "\n" + &effect(runs);
    let folder = Folder::new().with("run01.csv", RUN);
    folder.write("track.toml", &track("\"run01\", \"run1\", \"nope\""));
    let said = folder.replay_on("track.toml", &["run01.csv"]).err;
    let note = "track: effect[0].runs: expected names of runs, found \"run1\", \"nope\", which no log has";
    assert!(said.contains(note), "{said}");
    let said = folder.replay_on("track.toml", &["--no-estimates", "run01.csv"]).err;
    assert!(said.contains(note), "{said}");
    folder.write("track.toml", &track("\"run01.csv\""));
    assert_eq!(folder.replay_on("track.toml", &["run01.csv"]).err, "");
}
