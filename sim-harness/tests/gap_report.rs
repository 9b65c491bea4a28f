//! Does the page of `rundown gap` say what the workflow found, and need nothing else?

use serde_json::Value;
use std::path::Path;
use std::process::Command;

const SCENARIO: &str = r#"
name = "set"
runs = 24
seed = 3
[effort]
column = true
"#;

const TUNNEL: &str = r#"
[[effect]]
name = "tunnel_drag"
from_m = 18100.0
to_m = 21000.0
k = 1.2e-5
"#;

fn rundown(folder: &Path, arguments: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rundown"));
    let output = command.current_dir(folder).args(arguments).output();
    let output = output.unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{words}");
}

/// `gap.json` and `report.html` of a simulated set.
fn investigated(effect: &str) -> (Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("s.toml"), format!("{SCENARIO}{effect}")).unwrap();
    rundown(path, &["simulate", "--scenario", "s.toml", "--out", "set"]);
    let model = ["--train", "set/train.toml", "--track", "set/track.toml"];
    let gap = [
        "gap",
        "--runs",
        "set/runs",
        "--out",
        "out",
        "--hold-out",
        "6",
    ];
    rundown(path, &[gap.as_slice(), &model].concat());
    let read = |name: &str| std::fs::read_to_string(path.join("out").join(name)).unwrap();
    let json = serde_json::from_str(&read("gap.json")).unwrap();
    (json, read("report.html"))
}

fn stands_alone(page: &str) {
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    for outside in [
        "http:", "https:", "src=", "href=", "<script", "<link", "@import", "url(",
    ] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(!page.contains("NaN") && !page.contains("could not be drawn"));
}

#[test]
fn the_page_tells_the_tunnel_and_what_it_takes_away() {
    let (json, page) = investigated(TUNNEL);
    stands_alone(&page);
    assert_eq!(json["effects"][0]["name"], "tunnel_drag", "{json}");
    assert!(page.contains("Tunnel drag from km 18."), "verdict");
    assert!(page.contains("section found"), "map");
    let verdict = json["verdict"].as_str().unwrap();
    assert!(page.contains(&format!("<code>{verdict}</code>")));
    // The numbers of the file are those of the page.
    for name in ["before", "after", "noise_floor"] {
        let value = json["gap"][name].as_f64().unwrap();
        assert!(page.contains(&format!("<td>{value:.3}</td>")), "{name}");
    }
    assert!(page.contains("removable gap is gone on 6 held-out runs"));
}

#[test]
fn without_an_effect_the_page_says_that_there_is_no_gap() {
    let (json, page) = investigated("");
    stands_alone(&page);
    assert_eq!(json["verdict"], "no_gap", "{json}");
    assert!(page.contains("No gap: ") && page.contains("Nothing was added to the model."));
    assert!(!page.contains("section found"));
}
