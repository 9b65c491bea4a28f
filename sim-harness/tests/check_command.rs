//! Does `rundown check` say what it finds, on the screen and as JSON, and refuse what cannot be used?

mod common;

use common::Folder;
use serde_json::Value;
use std::fmt::Write;

fn log(reading: impl Fn(f64) -> f64) -> String {
    log_from(0.0, reading)
}

/// A log that begins at another place.
fn log_from(from_m: f64, reading: impl Fn(f64) -> f64) -> String {
    let mut text = String::from("time_s,location_m,speed_kmh\n");
    for i in 0..2000 {
        let t = f64::from(i);
        let (location_m, speed) = (from_m + 20.0 * t - 3000.0 * (t / 200.0).sin(), 20.0 - 15.0 * (t / 200.0).cos());
        writeln!(text, "{t},{location_m:.1},{}", reading(3.6 * speed)).unwrap();
    }
    text
}

#[test]
fn a_truncating_recorder_is_named() {
    let folder = Folder::new().with("run.csv", &log(f64::floor));
    let said = folder.rundown(&["check", "run.csv"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.out.contains("speeds are truncated to the step below: 1.000 km/h; put right"), "{}", said.out);
    let said = folder.rundown(&["check", "--json", "run.csv"]);
    let found: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(found["recorders"][0]["findings"][0]["kind"], "truncated_speed");
}

#[test]
fn rounded_speeds_are_no_defect_and_truncated_ones_are() {
    let folder = Folder::new().with("rounded.csv", &log(f64::round)).with("truncated.csv", &log(f64::floor));
    let said = folder.rundown(&["check", "--strict", "rounded.csv"]);
    assert!(said.out.contains("speeds are rounded to the nearest step"), "{}", said.out);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    assert_eq!(folder.rundown(&["check", "--strict", "truncated.csv"]).code, Some(1));
}

#[test]
fn speeds_in_other_units_are_refused() {
    let folder = Folder::new().with("run.csv", &log(|kmh| kmh / 3.6));
    let said = folder.rundown(&["check", "run.csv"]);
    assert_eq!(said.code, Some(6), "{}", said.out);
    assert!(said.out.contains("another unit") && said.out.contains("3.6"), "{}", said.out);
    assert!(said.out.contains("`rundown import` does with a --mapping"), "{}", said.out);
}

#[test]
fn a_folder_gets_a_page_for_each_run_and_a_name_in_json_the_diagnosis_alone() {
    let whole = log(f64::floor);
    // A log that is given twice counts once.
    let folder = Folder::new().with("a.csv", &whole).with("b.csv", &log_from(0.4, f64::floor));
    folder.done(&["check", "--out", "found", "a.csv", "b.csv"]);
    assert_eq!(folder.json("found/check.json")["runs"].as_array().unwrap().len(), 2);
    let page = folder.read("found/report.html");
    for word in
        ["speeds are truncated to the step below", "put right", "href=\"report/run0002.html\">b<", "offset 0.50 km/h"]
    {
        assert!(page.contains(word), "{word}");
    }
    let run = folder.read("found/report/run0002.html");
    assert!(run.contains("src=\"pages.js\"") && run.contains("before: a") && run.contains("<svg"));
    assert!(folder.path("found/report/pages.js").exists());
    folder.done(&["check", "--out", "alone.json", "a.csv"]);
    assert_eq!(folder.json("alone.json")["runs"][0]["name"], "a");
    // The same logs, the same bytes.
    folder.done(&["check", "--out", "again", "a.csv", "b.csv"]);
    assert_eq!(folder.read("again/report.html"), page);
    assert_eq!(folder.read("again/report/run0002.html"), run);
}

#[test]
fn where_no_log_can_be_read_or_used_page_and_json_say_why_and_that_nothing_could_be_judged() {
    let unread = [("logs/a.csv", "a,b\n1,2\n"), ("logs/b.csv", "")];
    let folder = unread.iter().fold(Folder::new(), |folder, (name, text)| folder.with(name, text));
    let folder = folder.with("unit.csv", &log(|kmh| kmh / 3.6));
    let said = folder.rundown(&["check", "--json", "logs", "--out", "found"]);
    assert_eq!(said.code, Some(6), "{}", said.err);
    let printed: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(printed, folder.json("found/check.json"));
    let failed = printed["failed"].as_array().unwrap();
    let of = |at: usize| (failed[at]["file"].as_str().unwrap(), failed[at]["errors"][0].as_str().unwrap());
    assert!(of(0).0 == "logs/a.csv" && of(0).1.contains("expected a header"), "{printed}");
    assert!(of(1).0 == "logs/b.csv" && printed["runs"].as_array().unwrap().is_empty(), "{printed}");
    assert_eq!(folder.rundown(&["check", "unit.csv", "--out", "refused"]).code, Some(6));
    for page in ["found/report.html", "refused/report.html"] {
        let page = folder.read(page);
        assert!(page.contains("Nothing could be judged") && !page.contains("Nothing was found"), "{page:.3000}");
    }
    assert!(folder.rundown(&["check", "logs"]).out.starts_with("nothing could be judged: no log can be used\n"));
}

#[test]
fn screen_and_page_count_the_same_runs_and_both_have_the_reasons() {
    // Seven runs with a stop of two minutes in one, and one in another unit.
    let mut folder = Folder::new().with("logs/unit.csv", &log(|kmh| kmh / 3.6));
    for i in 0..8 {
        let text = log_from(0.3 * f64::from(i), f64::round);
        folder = folder.with(&format!("logs/{i}.csv"), &if i == 3 { held_up(&text) } else { text });
    }
    let said = folder.rundown(&["check", "logs", "--out", "found"]);
    let page = folder.read("found/report.html");
    let found = folder.json("found/check.json");
    let held_up = found["runs"].as_array().unwrap().iter().filter(|run| run["perturbations"] != serde_json::json!([]));
    assert_eq!(held_up.count(), 1, "{}", said.out);
    let screen = said.out.lines().last().unwrap();
    let count = screen.split("nothing found in ").nth(1).unwrap().split(',').next().unwrap();
    assert!(page.contains(&format!("in {count} nothing of their own was found")), "{screen}: {page:.3000}");
    let why = said.out.lines().find(|line| line.contains("another unit")).unwrap();
    assert!(page.contains(why.split(": ").nth(1).unwrap()) && page.contains("does with a --mapping"), "{why}");
}

/// The same run, with a stop in its middle.
fn held_up(text: &str) -> String {
    let (mut made, mut stood_s) = (String::new(), 0.0);
    for (at, line) in text.lines().enumerate() {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        if at > 0 {
            let time_s: f64 = fields[0].parse().unwrap();
            fields[0] = (time_s + stood_s).to_string();
            if at == 1000 {
                for second in 0..120 {
                    writeln!(made, "{},{},0", time_s + f64::from(second), fields[1]).unwrap();
                }
                stood_s = 120.0;
                fields[0] = (time_s + stood_s).to_string();
            }
        }
        made += &(fields.join(",") + "\n");
    }
    made
}

#[test]
fn a_row_that_cannot_be_read_costs_a_replay_its_run_which_is_said() {
    let folder =
        Folder::new().with("a.csv", &log(f64::floor)).with("b.csv", &log(f64::floor).replace("\n9,", "\nnine,"));
    let said = folder.rundown(&["check", "a.csv", "b.csv"]);
    assert!(
        said.err.contains("1 of 2 logs have rows that cannot be read, and are diagnosed without these"),
        "{said:?}"
    );
    assert!(!folder.rundown(&["check", "a.csv"]).err.contains("cannot be read"));
}

#[test]
fn a_log_that_cannot_be_read_is_counted_and_named_on_the_screen_in_json_and_on_the_page() {
    let folder = Folder::new().with("logs/a.csv", &log(f64::floor)).with("logs/none.csv", "a,b\n1,2\n");
    let said = folder.rundown(&["check", "logs", "--out", "found"]);
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert!(said.err.contains("none.csv:1: expected a header"), "{}", said.err);
    assert!(said.out.contains("1 of 2 logs cannot be read: logs/none.csv\n"), "{}", said.out);
    let json = folder.json("found/check.json");
    assert_eq!((json["runs"].as_array().unwrap().len(), &json["failed"][0]["file"]), (1, &"logs/none.csv".into()));
    assert!(json["failed"][0]["errors"][0].as_str().unwrap().contains("expected a header"), "{json}");
    let page = folder.read("found/report.html");
    assert!(page.contains("Of 2 logs <a href=\"#unread\">1 cannot be read</a>."), "{page:.2000}");
    assert!(page.contains("<th scope=\"row\">logs/none.csv</th><td class=\"text\"><div>logs/none.csv:1: expected"));
    // Where all can be read, nothing is said of others.
    let said = folder.done(&["check", "logs/a.csv", "--out", "found"]);
    assert!(!said.out.contains("cannot be read") && !folder.read("found/report.html").contains("unread"));
    assert_eq!(folder.json("found/check.json")["failed"], Value::Array(Vec::new()));
}

/// As of odometers that count on through the day.
#[test]
fn locations_beyond_the_described_line_are_said_with_their_number_as_by_a_replay() {
    let track = "name = \"line\"\nlength_m = 25000.0\ngradient_sd_permille = 0.0\n";
    let folder = Folder::new().with("run.csv", &log(f64::round)).with("track.toml", track);
    let said = folder.rundown(&["check", "--track", "track.toml", "run.csv", "--out", "found"]);
    let off = "locations of moving trains (36 %) are not on the described track: they go from 0 to ";
    assert!(said.out.contains(off), "{}", said.out);
    assert!(folder.read("found/report.html").contains(off));
    let json = folder.json("found/check.json");
    assert!(json["off_track"]["off"].as_u64().unwrap() > 700 && json["off_track"]["length_m"] == 25_000.0, "{json}");
    assert_eq!(folder.rundown(&["check", "--strict", "--track", "track.toml", "run.csv"]).code, Some(1));
    folder.write("track.toml", &track.replace("25000", "41500"));
    let said = folder.done(&["check", "--strict", "--track", "track.toml", "run.csv"]);
    assert!(!said.out.contains("not on the described track"), "{}", said.out);
    assert_eq!(folder.json("found/check.json")["recorders"][0]["findings"][0]["kind"], "rounded_speed");
}
