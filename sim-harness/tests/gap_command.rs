//! Does `rundown gap` refuse what it cannot do, say what its names rest on, and write all or nothing?

mod common;

use common::{Folder, Said, TUNNEL};
use rundown::model::effects::{Effect, SteadyWind};
use rundown_gap::{
    answer::files::Files, answer::notes::NO_ROWS, answer::report::page, answer::story::story, answer::whole::Answer,
    config::GapConfig, input::Input, named::Named,
};
use serde_json::Value;
use std::fmt::Write as _;
use std::{path::Path, process::Command};

/// A folder with `set`: so many runs with an effort column.
fn simulated(runs: usize, effect: &str) -> Folder {
    Folder::simulated(&format!("name = \"set\"\nruns = {runs}\nseed = 3\n[effort]\ncolumn = true\n{effect}"))
}

/// `rundown gap` on runs with the model of `set`, results in `out`.
fn gap(folder: &Folder, runs: &str, more: &[&str]) -> Said {
    let model = ["gap", "--train", "set/train.toml", "--track", "set/track.toml", "--out", "out", "--runs", runs];
    folder.rundown(&[&model, more].concat())
}

fn caveats(json: &Value) -> Vec<&str> {
    let all = json["caveats"].as_array().unwrap();
    all.iter().map(|text| text.as_str().unwrap()).collect()
}

#[test]
fn holding_out_too_many_is_refused_with_the_largest_number() {
    let folder = simulated(8, "");
    let Said { code, err: words, .. } = gap(&folder, "set/runs", &["--hold-out", "4"]);
    assert_eq!(code, Some(2), "{words}");
    assert!(words.contains("at most 3 can be held out"), "{words}");
    assert!(!folder.path("out").exists());
    let Said { code, out: screen, err: words } = gap(&folder, "set/runs", &["--hold-out", "3"]);
    assert_eq!(code, Some(0), "{words}");
    assert!(screen.contains("3 hold-out runs"), "{screen}");
}

#[test]
fn few_runs_are_reported_everywhere() {
    let folder = simulated(5, "");
    let Said { code, out: screen, err: words } = gap(&folder, "set/runs", &[]);
    assert_eq!(code, Some(0), "{words}");
    let note = "5 runs at hand, none held out";
    assert!(screen.contains(note), "{screen}");
    let json = folder.json("out/gap.json");
    assert!(caveats(&json).iter().any(|c| c.starts_with(note)), "{json}");
    assert!(json["gap"]["before"].is_null(), "{json}");
    assert!(folder.read("out/report.html").contains(note));
}

#[test]
fn fewer_runs_than_an_analysis_needs_are_refused() {
    let folder = simulated(4, "");
    for more in [&[][..], &["--hold-out", "1"]] {
        let Said { code, err: words, .. } = gap(&folder, "set/runs", more);
        assert_eq!(code, Some(6), "{words}");
        assert!(words.contains("4 usable runs, expected at least 5"), "{words}");
        assert!(!words.contains("wheels") && !folder.path("out").exists(), "{words}");
    }
}

#[test]
fn an_effort_column_in_another_unit_or_with_the_other_sign_is_refused() {
    for (factor, words) in [
        (-1.0, Some("the other sign: turn it")),
        (9.81, Some("another unit: divide it by 9.")),
        (1.0 / 9.81, Some("another unit: divide it by 0.1")),
        (1.1, None),
    ] {
        let folder = simulated(6, "");
        for run in 1..=6 {
            let name = format!("set/runs/run{run:03}.csv");
            let changed = |row: &str| -> String {
                let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
                if let Ok(value) = fields[3].parse::<f64>() {
                    fields[3] = (factor * value).to_string();
                }
                fields.join(",") + "\n"
            };
            folder.write(&name, &folder.read(&name).lines().map(changed).collect::<String>());
        }
        let Said { code, err: said, .. } = gap(&folder, "set/runs", &[]);
        assert_eq!(code, Some(if words.is_some() { 6 } else { 0 }), "{factor}: {said}");
        assert!(words.is_none_or(|words| said.contains(words)), "{factor}: {said}");
    }
}

#[test]
fn slopes_of_the_whole_track_that_are_wrong_are_refused_with_what_is_wrong() {
    for column in [true, false] {
        let folder = Folder::simulated(&format!(
            "name = \"set\"\nruns = 12\nseed = 5\n[line]\nname = \"hilly\"\n[effort]\ncolumn = {column}\n"
        ));
        let right = folder.read("set/track.toml");
        let words = |measured: &'static str, coasts: &'static str| Some(if column { measured } else { coasts });
        for (factor, words) in [
            (1.0, None),
            (1.1, None),
            (2.0, words("times too steep", "half as steep they would explain the coasts")),
            (0.5, words("times too gentle", "twice as steep they would explain the coasts")),
            (-1.0, words("the sign is turned", "with the sign turned")),
        ] {
            let changed = |line: &str| match line.split_once('=') {
                Some((name, value)) if name.trim() == "permille" => {
                    format!("permille = {}\n", factor * value.trim().parse::<f64>().unwrap())
                }
                _ => format!("{line}\n"),
            };
            folder.write("set/track.toml", &right.lines().map(changed).collect::<String>());
            let Said { code, err: said, .. } = gap(&folder, "set/runs", &[]);
            assert_eq!(code, Some(if words.is_some() { 3 } else { 0 }), "{column}, {factor}: {said}");
            assert!(words.is_none_or(|words| said.contains(words)), "{column}, {factor}: {said}");
        }
    }
}

#[test]
fn runs_that_are_nowhere_are_named() {
    let folder = simulated(1, "");
    let Said { code, err: words, .. } = gap(&folder, "nowhere", &[]);
    assert_eq!(code, Some(6), "{words}");
    assert!(words.contains("nowhere: cannot be read") && words.contains("0 usable runs"), "{words}");
    assert!(!folder.path("out").exists());
}

/// A model found before is no part of the belief: it is reported, and not doubled.
#[test]
fn effects_that_were_described_are_replaced_and_reported() {
    let folder = simulated(24, TUNNEL);
    folder.write("set/track.toml", &format!("{}\n{TUNNEL}", folder.read("set/track.toml")));
    let Said { code, out: screen, err: words } = gap(&folder, "set/runs", &[]);
    assert_eq!(code, Some(0), "{words}");
    assert!(screen.contains("had effects already (1)"), "{screen}");
    let repaired = folder.read("out/model/track.toml");
    assert_eq!(repaired.matches("tunnel_drag").count(), 1, "{repaired}");
}

#[test]
fn where_a_folder_cannot_be_made_nothing_is_written() {
    let folder = simulated(8, "");
    folder.write("out/model", "a file");
    let Said { code, err: words, .. } = gap(&folder, "set/runs", &[]);
    assert_eq!(code, Some(4), "{words}");
    assert_eq!(std::fs::read_dir(folder.path("out")).unwrap().count(), 1);
}

/// Trains that power, keep their speed and brake, in logs without an effort column: nothing tells the resistance, nor
/// does the one that coasts, which is held out, tell what noise leaves.
#[test]
fn without_effort_and_coasting_no_resistance_is_judged_and_no_map_drawn() {
    let folder = simulated(1, "");
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
        folder.write(&format!("cruising/r{run}.csv"), &log);
    }
    let Said { code, out: screen, err: words } = gap(&folder, "cruising", &[]);
    assert_eq!(code, Some(0), "{words}");
    assert!(screen.contains(NO_ROWS) && !screen.contains("p-value"), "{screen}");
    let json = folder.json("out/gap.json");
    assert_eq!(caveats(&json)[0], NO_ROWS);
    assert!(json["p_value"].is_null() && json["gap"]["p_value_after"].is_null());
    assert!(json["gap"]["before"].is_null(), "{json}");
    assert!(json["running_time"]["why_not"].is_string(), "{json}");
    let page = folder.read("out/report.html");
    assert!(page.contains(&format!("<p class=\"lead\">{NO_ROWS}</p>")));
    assert!(!page.contains("Residual over location") && !page.contains("p-value"));
}

/// The numbers of a bad outcome are put in place of those that were found: no data set is bad on purpose.
#[test]
fn a_repair_that_makes_things_worse_is_reported_everywhere() {
    let folder = simulated(8, "");
    let input = Input::of_set(&folder.path("set")).unwrap();
    let mut answer = rundown_gap::run(input, GapConfig::default(), None, |_| ()).unwrap();
    let told = |answer: &Answer| (answer.json(), story(answer), page(answer, false));
    let (json, screen, html) = told(&answer);
    assert_eq!(json["gap"]["worse_than_before"], false);
    assert!(!screen.contains("orse than before") && !html.contains("Worse than before"));
    answer.found.gap.after = 2.0 * answer.found.gap.before;
    let (json, screen, html) = told(&answer);
    assert_eq!(json["gap"]["worse_than_before"], true);
    let of_none = caveats(&json)[0];
    assert!(of_none.starts_with("Worse than before") && of_none.ends_with("the repaired model is the described one."));
    assert!(screen.contains("worse than before") && html.contains("Worse than before"));
    // Nine effects are more than a board takes: there is no frame, so there is no file.
    let wind = Named::plain(Effect::SteadyWind(SteadyWind { wind_mps: 1.0 }), Vec::new(), 9.0, 30.0);
    answer.found.named = vec![wind.clone()];
    assert!(caveats(&answer.json())[0].contains("Do not use the repaired model"));
    answer.found.named = vec![wind; 9];
    let error = Files::render(&answer, true).unwrap_err();
    assert!(error.to_string().starts_with("effect.frame: "), "{error}");
}

#[test]
fn each_run_has_a_page_unless_they_are_left_out() {
    let folder = simulated(8, TUNNEL);
    let done = gap(&folder, "set/runs", &[]);
    assert_eq!(done.code, Some(0), "{}", done.err);
    let read = |name: &str| std::fs::read_to_string(folder.path(name)).unwrap();
    let first = read("out/report.html");
    let mut held_out = 0;
    for number in 1..=8 {
        let (file, run) = (format!("report/run{number:04}.html"), format!("run{number:03}"));
        assert!(first.contains(&format!("<a href=\"{file}\">{run}</a>")), "{file}");
        let page = read(&format!("out/{file}"));
        assert!(page.contains(&format!("<h1>{run}</h1>")) && page.contains("Residual over location"), "{file}");
        // Only what was held out was simulated.
        let simulated = page.contains("Measured and simulated speed</h2>");
        assert_eq!(simulated, page.contains("It was held out"), "{file}");
        held_out += usize::from(simulated);
    }
    assert!(held_out > 0 && held_out < 8, "{held_out}");
    let bare = gap(&folder, "set/runs", &["--no-run-pages"]);
    assert_eq!(bare.code, Some(0), "{}", bare.err);
    assert!(!folder.path("out/report").exists() && !read("out/report.html").contains("report/run0001.html"));
}

/// Each setting can be changed by a file; a name that is none is refused before the work.
#[test]
fn thresholds_are_printed_changed_and_refused() {
    let folder = simulated(8, TUNNEL);
    let Said { code, out: printed, err: words } = folder.rundown(&["gap", "--print-config"]);
    assert_eq!(code, Some(0), "{words}");
    assert!(printed.contains("[penalty]") && printed.contains("[prior.warm_up]"), "{printed}");
    let with = |text: &str| {
        folder.write("gap.toml", text);
        gap(&folder, "set/runs", &["--config", "gap.toml"])
    };
    let Said { code, err: words, .. } = with("[search]\nenough = 1000.0\n[prior.warm_up]\nleast = 0.01\n");
    assert_eq!(code, Some(0), "{words}");
    let json = folder.json("out/gap.json");
    assert_eq!(json["effects"].as_array().map(Vec::len), Some(0), "{json}");
    for wrong in ["[search]\nenuogh = 4.0\n", "[prior.ghost]\nleast = 1.0\n"] {
        let Said { code, err: words, .. } = with(wrong);
        assert_eq!(code, Some(3), "{words}");
        assert!(words.contains("gap.toml: "), "{words}");
    }
    let Said { code, err: words, .. } = with(&printed);
    assert_eq!(code, Some(0), "{words}");
    let json = folder.json("out/gap.json");
    assert_eq!(json["effects"][0]["name"], "tunnel_drag", "{json}");
}

/// The example of `gap --help` for a hidden effect, line by line.
#[test]
fn the_example_of_the_help_works_word_for_word() {
    let folder = Folder::new();
    let help = folder.done(&["gap", "--help"]).out;
    let after = help.split("A set with a hidden effect").nth(1).unwrap();
    let lines = after.lines().skip(1).map(str::trim);
    let lines: Vec<&str> = lines.take_while(|line| !line.is_empty()).collect();
    assert_eq!(lines.len(), 3, "{lines:?}");
    let bin = Path::new(env!("CARGO_BIN_EXE_rundown")).parent().unwrap();
    for line in lines {
        let mut shell = Command::new("sh");
        let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
        let shell = shell.current_dir(folder.path("")).env("PATH", path);
        let output = shell.args(["-c", line]).output().unwrap();
        assert!(output.status.success(), "{line}: {output:?}");
    }
    let json = folder.json("gap/gap.json");
    assert_eq!(json["effects"][0]["name"], "tunnel_drag", "{json}");
}

#[test]
fn a_copy_of_a_run_and_a_log_that_is_none_are_left_out_and_reported() {
    let folder = simulated(8, "");
    folder.write("set/runs/copy.csv", &folder.read("set/runs/run001.csv"));
    folder.write("set/runs/none.csv", "no log at all\n");
    let Said { code, out: screen, err: notes } = gap(&folder, "set/runs", &[]);
    assert_eq!(code, Some(1), "{notes}");
    assert!(notes.contains("holds the same rows"), "{notes}");
    assert!(screen.contains("2 of 10 logs could not be used"), "{screen}");
    let json = folder.json("out/gap.json");
    assert_eq!((json["runs"].as_u64(), json["runs_left_out"].as_u64()), (Some(8), Some(2)));
}

/// Runs in winds that differ, once without and once with the column that measures them.
#[test]
fn a_wind_that_is_measured_is_none_to_be_found() {
    let folder = simulated(24, "[[effect]]\nname = \"run_wind\"\nsd_mps = 6.0\n");
    let investigated = || -> (Value, String) {
        let said = gap(&folder, "set/runs", &[]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        (folder.json("out/gap.json"), said.out)
    };
    let winds = |json: &Value| {
        let names = json["effects"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap().to_owned());
        names.filter(|name| name.ends_with("_wind")).collect::<Vec<_>>()
    };
    let (without, screen) = investigated();
    assert_eq!(winds(&without), ["run_wind"], "{without}");
    assert!(without["headwind"].is_null() && !screen.contains("headwind column"), "{without}");

    for run in folder.json("set/truth/truth.json")["runs"].as_array().unwrap() {
        let path = format!("set/runs/{}", run["file"].as_str().unwrap());
        let column = |(i, line): (usize, &str)| match i {
            0 => format!("{line},headwind_mps\n"),
            _ => format!("{line},{}\n", run["headwind_mps"]),
        };
        let text: String = folder.read(&path).lines().enumerate().map(column).collect();
        folder.write(&path, &text);
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
        let changed = |row: &str| -> String {
            let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
            if let Ok(value) = fields[column].parse::<f64>() {
                fields[column] = (factor * value).to_string();
            }
            fields.join(",") + "\n"
        };
        for run in 1..=6 {
            let name = format!("set/runs/run{run:03}.csv");
            folder.write(&name, &folder.read(&name).lines().map(changed).collect::<String>());
        }
        let Said { code, err: said, .. } = gap(&folder, "set/runs", &[]);
        assert_ne!(code, Some(0), "{said}");
        assert!(said.contains(words), "{words}: {said}");
        assert!(!folder.path("out").exists());
    }
}

#[test]
fn a_track_that_is_too_short_or_flat_is_reported() {
    let folder = simulated(8, "");
    let text = folder.read("set/track.toml");
    let shorter = text.replace("length_m = 32103.0", "length_m = 28000.0");
    assert_ne!(text, shorter);
    let flat: String = shorter
        .lines()
        .map(|line| match line.starts_with("permille") {
            true => "permille = 0.0\n".to_owned(),
            false => format!("{line}\n"),
        })
        .collect();
    let told = |track: &str| {
        folder.write("set/track.toml", track);
        gap(&folder, "set/runs", &[]);
        let json = folder.read("out/gap.json");
        caveats(&serde_json::from_str(&json).unwrap()).join(" ")
    };
    let as_it_is = told(&text);
    assert!(!as_it_is.contains("described"), "{as_it_is}");
    let wrong = told(&flat);
    let (share, _) = wrong.split_once(" locations of moving trains").unwrap();
    assert!(share.split(' ').count() == 3, "the first note: {wrong}");
    assert!(wrong.contains("the track from 0 to 28000 m"), "{wrong}");
    assert!(wrong.contains("without gradients"), "{wrong}");
    std::fs::remove_dir_all(folder.path("out")).unwrap();
    folder.write("set/track.toml", &flat.replace("28000.0", "20000.0"));
    let Said { code, err: said, .. } = gap(&folder, "set/runs", &[]);
    assert_eq!(code, Some(3), "{said}");
    assert!(said.contains("the track from 0 to 20000 m") && said.contains("--chainage align"), "{said}");
    assert!(!folder.path("out").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_folder_that_cannot_be_made_is_refused_before_the_work() {
    let folder = simulated(6, "");
    let model = ["--train", "set/train.toml", "--track", "set/track.toml", "--runs", "set/runs"];
    // Not even the administrator makes a folder there.
    let Said { code, err: said, .. } = folder.rundown(&[&["gap", "--out", "/proc/gap"][..], &model].concat());
    assert_eq!(code, Some(4), "{said}");
    assert!(said.contains("/proc/gap: cannot be written: ") && said.contains("another folder with --out"), "{said}");
    assert!(!said.contains("all runs"), "{said}");
}

#[test]
fn an_output_folder_that_is_a_file_is_refused_before_the_work() {
    let folder = simulated(6, "");
    folder.write("out", "mine");
    let Said { code, err: said, .. } = gap(&folder, "set/runs", &[]);
    assert_ne!(code, Some(0));
    assert!(said.contains("out is a file"), "{said}");
    assert!(!said.contains("all runs"), "{said}");
}

#[test]
fn an_effect_of_a_run_that_no_log_has_is_said() {
    let folder = simulated(5, "");
    let effect = "\n[[effect]]\nname = \"dragging_brake\"\ndrag_n_per_kg = 0.01\nruns = [\"nope\"]\n";
    folder.write("set/train.toml", &(folder.read("set/train.toml") + effect));
    let said = gap(&folder, "set/runs", &["--strict"]);
    let note = "train: effect[0].runs: expected names of runs, found \"nope\", which no log has";
    assert!(said.code == Some(1) && said.err.contains(note), "{said:?}");
}
