//! Does `rundown gap` refuse what it cannot do, say what its names rest on, and write all or nothing?

mod common;

use common::{done, rundown};
use rundown::model::effects::{Effect, SteadyWind};
use rundown_gap::answer::{files::Files, notes::NO_ROWS, report::page, story::story, whole::Answer};
use rundown_gap::config::GapConfig;
use rundown_gap::input::Input;
use rundown_gap::named::Named;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

const TUNNEL: &str = r#"
[[effect]]
name = "tunnel_drag"
from_m = 18100.0
to_m = 21000.0
k = 1.2e-5
"#;

fn outcome(output: &Output) -> (Option<i32>, String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// A folder with `set`: so many runs with an effort column.
fn simulated(runs: usize, effect: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scenario = format!("name = \"set\"\nruns = {runs}\nseed = 3\n[effort]\ncolumn = true\n{effect}");
    std::fs::write(folder.path().join("s.toml"), scenario).unwrap();
    done(folder.path(), &["simulate", "--scenario", "s.toml", "--out", "set"]);
    folder
}

/// `rundown gap` on `set`, results in `out`.
fn gap(folder: &Path, more: &[&str]) -> (Option<i32>, String, String) {
    let mut all = vec!["gap", "--train", "set/train.toml", "--out", "out"];
    all.extend(["--track", "set/track.toml"]);
    all.extend(more);
    outcome(&rundown(folder, &all))
}

const RUNS: [&str; 2] = ["--runs", "set/runs"];

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join("out").join(name)).unwrap()
}

fn caveats(json: &Value) -> Vec<&str> {
    let all = json["caveats"].as_array().unwrap();
    all.iter().map(|text| text.as_str().unwrap()).collect()
}

#[test]
fn holding_out_too_many_is_refused_with_the_largest_number() {
    let folder = simulated(8, "");
    let (code, _, words) = gap(folder.path(), &["--runs", "set/runs", "--hold-out", "4"]);
    assert_eq!(code, Some(2), "{words}");
    assert!(words.contains("at most 3 can be held out"), "{words}");
    assert!(!folder.path().join("out").exists());
    let (code, screen, words) = gap(folder.path(), &["--runs", "set/runs", "--hold-out", "3"]);
    assert_eq!(code, Some(0), "{words}");
    assert!(screen.contains("3 held-out runs"), "{screen}");
}

#[test]
fn few_runs_are_reported_everywhere() {
    let folder = simulated(4, "");
    let (code, screen, words) = gap(folder.path(), &["--runs", "set/runs"]);
    assert_eq!(code, Some(0), "{words}");
    let note = "4 runs at hand, none held out";
    assert!(screen.contains(note), "{screen}");
    let json: Value = serde_json::from_str(&read(folder.path(), "gap.json")).unwrap();
    assert!(caveats(&json).iter().any(|c| c.starts_with(note)), "{json}");
    assert!(json["gap"]["before"].is_null(), "{json}");
    assert!(read(folder.path(), "report.html").contains(note));
}

#[test]
fn runs_that_are_nowhere_are_refused() {
    let folder = simulated(1, "");
    let (code, _, words) = gap(folder.path(), &["--runs", "nowhere"]);
    assert_eq!(code, Some(3), "{words}");
    assert!(words.contains("nowhere: expected a folder of run logs"));
    assert!(!folder.path().join("out").exists());
}

/// A model found before is no part of the belief: it is reported, and not doubled.
#[test]
fn effects_that_were_described_are_replaced_and_reported() {
    let folder = simulated(24, TUNNEL);
    let path = folder.path().join("set/track.toml");
    let track = std::fs::read_to_string(&path).unwrap();
    std::fs::write(path, format!("{track}{TUNNEL}")).unwrap();
    let (code, screen, words) = gap(folder.path(), &["--runs", "set/runs"]);
    assert_eq!(code, Some(0), "{words}");
    assert!(screen.contains("had effects already (1)"), "{screen}");
    let repaired = read(folder.path(), "model/track.toml");
    assert_eq!(repaired.matches("tunnel_drag").count(), 1, "{repaired}");
}

#[test]
fn where_a_folder_cannot_be_made_nothing_is_written() {
    let folder = simulated(8, "");
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("model"), "a file").unwrap();
    let (code, _, words) = gap(folder.path(), &["--runs", "set/runs"]);
    assert_eq!(code, Some(4), "{words}");
    assert_eq!(std::fs::read_dir(out).unwrap().count(), 1);
}

/// Trains that pull, keep their speed and brake, in logs without an effort column: nothing tells the resistance, nor does the one that coasts, which is held out, tell what noise leaves.
#[test]
fn without_effort_and_coasting_no_resistance_is_judged_and_no_map_drawn() {
    let folder = simulated(1, "");
    let runs = folder.path().join("cruising");
    std::fs::create_dir(&runs).unwrap();
    for run in 0..6 {
        let mut log = "time_s,location_m,speed_kmh\n".to_owned();
        let cruise_mps = 25.0 + f64::from(run);
        let (mut location_m, mut speed) = (0.0, 0.0_f64);
        for i in 0..80 {
            let kmh = (3.6 * speed).round();
            writeln!(log, "{:.1},{location_m:.2},{kmh}", 10.0 * f64::from(i)).unwrap();
            let believed = 7.38e-3 + 1.6e-4 * speed + 2.8e-5 * speed * speed;
            let next = match i {
                71.. => (speed - 6.0).max(0.0),
                50.. if run == 3 => speed - 10.0 * believed,
                _ => (speed + 4.0).min(cruise_mps),
            };
            location_m += 5.0 * (speed + next);
            speed = next;
        }
        std::fs::write(runs.join(format!("r{run}.csv")), log).unwrap();
    }
    let (code, screen, words) = gap(folder.path(), &["--runs", "cruising"]);
    assert_eq!(code, Some(0), "{words}");
    assert!(screen.contains(NO_ROWS) && !screen.contains("p-value"), "{screen}");
    let json: Value = serde_json::from_str(&read(folder.path(), "gap.json")).unwrap();
    assert_eq!(caveats(&json)[0], NO_ROWS);
    assert!(json["p_value"].is_null() && json["gap"]["p_value_after"].is_null());
    assert!(json["gap"]["before"].is_null(), "{json}");
    assert!(json["running_time"]["why_not"].is_string(), "{json}");
    let page = read(folder.path(), "report.html");
    assert!(page.contains(&format!("<p class=\"lead\">{NO_ROWS}</p>")));
    assert!(!page.contains("Residual over location") && !page.contains("p-value"));
}

/// The numbers of a bad outcome are put in place of those that were found: no data set is bad on purpose.
#[test]
fn a_repair_that_makes_things_worse_is_reported_everywhere() {
    let folder = simulated(8, "");
    let input = Input::of_set(&folder.path().join("set")).unwrap();
    let mut answer = rundown_gap::run(input, GapConfig::default(), None, |_| ()).unwrap();
    let outcome = |answer: &Answer| (answer.json(), story(answer), page(answer));
    let (json, screen, html) = outcome(&answer);
    assert_eq!(json["gap"]["worse_than_before"], false);
    assert!(!screen.contains("orse than before") && !html.contains("Worse than before"));
    answer.found.gap.after = 2.0 * answer.found.gap.before;
    let (json, screen, html) = outcome(&answer);
    assert_eq!(json["gap"]["worse_than_before"], true);
    assert!(caveats(&json)[0].starts_with("Worse than before"));
    assert!(screen.contains("worse than before") && html.contains("Worse than before"));
    // Nine effects are more than a board takes: there is no frame, so there is no file.
    let wind = Named::plain(Effect::SteadyWind(SteadyWind { wind_mps: 1.0 }), Vec::new(), 9.0, 30.0);
    answer.found.named = vec![wind; 9];
    let error = Files::render(&answer).unwrap_err();
    assert!(error.to_string().starts_with("effect.frame: "), "{error}");
}

/// Each setting can be changed by a file; a name that is none is refused before the work.
#[test]
fn thresholds_are_printed_changed_and_refused() {
    let folder = simulated(8, TUNNEL);
    let (code, printed, words) = outcome(&rundown(folder.path(), &["gap", "--print-config"]));
    assert_eq!(code, Some(0), "{words}");
    assert!(printed.contains("[penalty]") && printed.contains("[prior.warm_up]"), "{printed}");
    let with = |text: &str| {
        std::fs::write(folder.path().join("gap.toml"), text).unwrap();
        gap(folder.path(), &["--runs", "set/runs", "--config", "gap.toml"])
    };
    let (code, _, words) = with("[search]\nenough = 1000.0\n[prior.warm_up]\nleast = 0.01\n");
    assert_eq!(code, Some(0), "{words}");
    let json: Value = serde_json::from_str(&read(folder.path(), "gap.json")).unwrap();
    assert_eq!(json["effects"].as_array().map(Vec::len), Some(0), "{json}");
    for wrong in ["[search]\nenuogh = 4.0\n", "[prior.ghost]\nleast = 1.0\n"] {
        let (code, _, words) = with(wrong);
        assert_eq!(code, Some(3), "{words}");
        assert!(words.contains("gap.toml: "), "{words}");
    }
    let (code, _, words) = with(&printed);
    assert_eq!(code, Some(0), "{words}");
    let json: Value = serde_json::from_str(&read(folder.path(), "gap.json")).unwrap();
    assert_eq!(json["effects"][0]["name"], "tunnel_drag", "{json}");
}

/// The example of `gap --help` for a hidden effect, line by line.
#[test]
fn the_example_of_the_help_works_word_for_word() {
    let folder = tempfile::tempdir().unwrap();
    let (code, help, _) = outcome(&rundown(folder.path(), &["gap", "--help"]));
    assert_eq!(code, Some(0));
    let after = help.split("A set with a hidden effect").nth(1).unwrap();
    let lines = after.lines().skip(1).map(str::trim);
    let lines: Vec<&str> = lines.take_while(|line| !line.is_empty()).collect();
    assert_eq!(lines.len(), 3, "{lines:?}");
    let bin = Path::new(env!("CARGO_BIN_EXE_rundown")).parent().unwrap();
    for line in lines {
        let mut shell = Command::new("sh");
        let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
        let shell = shell.current_dir(folder.path()).env("PATH", path);
        let output = shell.args(["-c", line]).output().unwrap();
        assert!(output.status.success(), "{line}: {output:?}");
    }
    let json = std::fs::read_to_string(folder.path().join("gap/gap.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["effects"][0]["name"], "tunnel_drag", "{json}");
}

#[test]
fn a_copy_of_a_run_and_a_log_that_is_none_are_left_out_and_reported() {
    let folder = simulated(8, "");
    let runs = folder.path().join("set/runs");
    std::fs::copy(runs.join("run001.csv"), runs.join("copy.csv")).unwrap();
    std::fs::write(runs.join("none.csv"), "no log at all\n").unwrap();
    let output = rundown(
        folder.path(),
        &["gap", "--train", "set/train.toml", "--track", "set/track.toml", "--runs", "set/runs", "--out", "gap"],
    );
    let (code, screen, notes) = outcome(&output);
    assert_eq!(code, Some(1), "{notes}");
    assert!(notes.contains("samples of another run"), "{notes}");
    assert!(screen.contains("2 of 10 logs could not be used"), "{screen}");
    let json: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("gap/gap.json")).unwrap()).unwrap();
    assert_eq!((json["runs"].as_u64(), json["runs_left_out"].as_u64()), (Some(8), Some(2)));
}

/// The logs of a set, each line changed.
fn rewritten(set: &Path, change: impl Fn(&mut Vec<String>)) {
    for entry in std::fs::read_dir(set.join("runs")).unwrap() {
        let path = entry.unwrap().path();
        if path.file_name().unwrap() == "runs.csv" {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let (header, rows) = text.split_once('\n').unwrap();
        let mut out = format!("{header}\n");
        for row in rows.lines() {
            let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
            change(&mut fields);
            out += &(fields.join(",") + "\n");
        }
        std::fs::write(&path, out).unwrap();
    }
}

/// Runs in winds that differ, once without and once with the column that measures them.
#[test]
fn a_wind_that_is_measured_is_none_to_be_found() {
    let folder = simulated(24, "[[effect]]\nname = \"run_wind\"\nsd_mps = 6.0\n");
    let investigated = || -> (Value, String) {
        let (code, screen, words) = gap(folder.path(), &RUNS);
        assert_eq!(code, Some(0), "{words}");
        (serde_json::from_str(&read(folder.path(), "gap.json")).unwrap(), screen)
    };
    let winds = |json: &Value| {
        let names = json["effects"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap().to_owned());
        names.filter(|name| name.ends_with("_wind")).collect::<Vec<_>>()
    };
    let (without, screen) = investigated();
    assert_eq!(winds(&without), ["run_wind"], "{without}");
    assert!(without["headwind"].is_null() && !screen.contains("headwind column"), "{without}");

    let set = folder.path().join("set");
    let truth = std::fs::read_to_string(set.join("truth/truth.json")).unwrap();
    let truth: Value = serde_json::from_str(&truth).unwrap();
    for run in truth["runs"].as_array().unwrap() {
        let path = set.join("runs").join(run["file"].as_str().unwrap());
        let text = std::fs::read_to_string(&path).unwrap();
        let column = |(i, line): (usize, &str)| match i {
            0 => format!("{line},headwind_mps\n"),
            _ => format!("{line},{}\n", run["headwind_mps"]),
        };
        std::fs::write(&path, text.lines().enumerate().map(column).collect::<String>()).unwrap();
    }
    let (with, screen) = investigated();
    assert_eq!(winds(&with), [""; 0], "{with}");
    let wind = |name: &str| with["headwind"][name].as_f64().unwrap();
    assert!((wind("scale") - 1.0).abs() < 0.1, "{with}");
    assert_eq!(with["headwind"]["agrees"], true, "{with}");
    assert!(wind("after") < 0.8 * wind("before"), "{with}");
    assert!(screen.contains("they agree"), "{screen}");
}

#[test]
fn logs_in_other_units_are_refused_with_the_unit_that_they_seem_to_have() {
    for (column, factor, words) in [
        (0, 1000.0, "milliseconds"),
        (1, 0.001, "kilometres"),
        (2, 1.0 / 3.6, "a speed in m/s?"),
        (3, 170e3, "divided by the rotating mass"),
    ] {
        let folder = simulated(6, "");
        let set = folder.path().join("set");
        rewritten(&set, |fields| {
            if let Ok(value) = fields[column].parse::<f64>() {
                fields[column] = (factor * value).to_string();
            }
        });
        let (code, _, said) = gap(folder.path(), &RUNS);
        assert_ne!(code, Some(0), "{said}");
        assert!(said.contains(words), "{words}: {said}");
        assert!(!folder.path().join("out").exists());
    }
}

#[test]
fn a_track_that_is_too_short_or_flat_is_reported() {
    let folder = simulated(8, "");
    let path = folder.path().join("set/track.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let shorter = text.replace("length_m = 32103.0", "length_m = 20000.0");
    assert_ne!(text, shorter);
    let flat: String = shorter
        .lines()
        .map(|line| match line.starts_with("permille") {
            true => "permille = 0.0\n".to_owned(),
            false => format!("{line}\n"),
        })
        .collect();
    let outcome = |track: &str| {
        std::fs::write(&path, track).unwrap();
        gap(folder.path(), &RUNS);
        let json = read(folder.path(), "gap.json");
        caveats(&serde_json::from_str(&json).unwrap()).join(" ")
    };
    let as_it_is = outcome(&text);
    assert!(!as_it_is.contains("described"), "{as_it_is}");
    let wrong = outcome(&flat);
    assert!(wrong.contains("the track from 0 to 20000 m"), "{wrong}");
    assert!(wrong.contains("without gradients"), "{wrong}");
}

#[test]
fn an_output_folder_that_is_a_file_is_refused_before_the_work() {
    let folder = simulated(6, "");
    std::fs::write(folder.path().join("out"), "mine").unwrap();
    let (code, _, said) = gap(folder.path(), &RUNS);
    assert_ne!(code, Some(0));
    assert!(said.contains("out is a file"), "{said}");
    assert!(!said.contains("all runs"), "{said}");
}
