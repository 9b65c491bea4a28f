//! Does the page of `rundown gap` say what the workflow found, and need nothing else?

mod common;

use common::{Folder, TUNNEL};
use rundown_pages::assets::SCRIPT;
use serde_json::Value;

/// `gap.json` and `report.html` of a simulated set.
fn investigated(effect: &str) -> (Value, String) {
    let effort = if effect.contains("[effort]") { "" } else { "[effort]\ncolumn = true\n" };
    let folder = Folder::simulated(&format!("name = \"set\"\nruns = 24\nseed = 3\n{effort}{effect}"));
    let model = ["--train", "set/train.toml", "--track", "set/track.toml"];
    let gap = ["gap", "--runs", "set/runs", "--out", "out", "--hold-out", "6"];
    folder.done(&[gap.as_slice(), &model].concat());
    (folder.json("out/gap.json"), folder.read("out/report.html"))
}

fn stands_alone(page: &str) {
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    // The kit's script is tested in a browser: it asks for nothing. Pages of runs lie beside this one.
    let page = page.replace(SCRIPT, "").replace("href=\"#", "").replace("href=\"report/run", "");
    for outside in ["http:", "https:", "src=", "href=", "<link", "@import", "url("] {
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
    assert!(page.contains("removable gap is gone on 6 hold-out runs"));
    // How sure the share is, what else was tried, and what is left.
    let numbers = |value: &Value| -> Vec<f64> {
        let all = value.as_array().unwrap().iter();
        all.map(|n| n.as_f64().unwrap()).collect()
    };
    let ends = numbers(&json["gap"]["removed_share_95"]);
    let removed = json["gap"]["removed_share"].as_f64().unwrap();
    assert!(ends[0] <= removed && removed <= ends[1] && ends[0] > 0.3, "{json}");
    let interval = format!("95\u{a0}% interval {:.0} to {:.0}", 100.0 * ends[0], 100.0 * ends[1]);
    assert!(page.contains(&interval), "{interval}");
    let before = json["gap"]["p_value_before"].as_f64().unwrap();
    let after = json["gap"]["p_value_after"].as_f64().unwrap();
    assert!(before < 0.05 && after > 0.05, "{json}");
    let rivals = json["effects"][0]["rivals"].as_array().unwrap();
    assert!(rivals.len() > 3, "{json}");
    let worse: Vec<f64> = rivals.iter().map(|r| r["worse"].as_f64().unwrap()).collect();
    assert!(worse.is_sorted() && worse[0] > 0.0, "{json}");
    assert!(page.contains("<h3>Rivals</h3>") && page.contains("davis error"));
    assert!(page.contains("The law of the tunnel drag over the data"));
    // Without the tunnel the simulated train is too fast and needs too little energy.
    for quantity in ["running_time", "energy"] {
        let json = &json[quantity];
        let of = |name: &str| json[name].as_f64().unwrap();
        let mean = |name: &str| json[name]["mean"].as_f64().unwrap();
        assert!(mean("error_before") < 0.0 && of("runs") == 6.0, "{json}");
        assert!(of("after") < of("before"), "{json}");
        assert!(mean("error_after").abs() < 0.5 * mean("error_before").abs(), "{json}");
        assert!(page.contains(&format!("<td>{:.2}</td>", of("before"))), "{json}");
    }
}

/// What the floors promise: with the right model the errors of running time and energy are those of noise.
#[test]
fn with_the_right_model_time_and_energy_err_as_the_floor_says() {
    let (json, _) = investigated("[load]\nsd = 0.01\n");
    for quantity in ["running_time", "energy"] {
        let of = |name: &str| json[quantity][name].as_f64().unwrap();
        let ratio = of("before") / of("noise_floor");
        // Root mean square of six runs.
        assert!((0.4..1.8).contains(&ratio), "{quantity}: {ratio}");
        assert!(json[quantity]["removed_share"].is_null(), "{json}");
    }
}

/// Logs without an effort column cannot tell energy, and say so.
#[test]
fn without_an_effort_column_energy_is_not_reported() {
    let (json, page) = investigated("[line]\nname = \"hilly\"\n[effort]\ncolumn = false\n");
    let why = json["energy"]["why_not"].as_str().unwrap();
    assert!(why.starts_with("cannot be measured") && page.contains(why));
    assert!(json["running_time"]["windows"].as_u64().unwrap() > 0, "{json}");
}

#[test]
fn without_an_effect_the_page_says_that_there_is_no_gap() {
    let (json, page) = investigated("");
    stands_alone(&page);
    assert_eq!(json["verdict"], "no_gap", "{json}");
    assert!(page.contains("No gap: ") && page.contains("Nothing was added to the model."));
    assert!(!page.contains("section found"));
}
