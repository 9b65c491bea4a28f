//! Does `rundown tune` find a better filter by the paper's criteria, and write one that `rundown replay` takes?

mod common;

use common::{Folder, RUN};

#[test]
fn the_optimum_is_likelier_than_table_1_and_replay_takes_it() {
    let folder = Folder::new().with("run.csv", RUN);
    let few = ["tune", "--count", "4", "--evaluations", "300", "--out", "a"];
    let text = folder.done(&few).out;
    assert!(text.contains("a likely filter is no true one"), "{text}");
    let json = folder.json("a/tune.json");
    let of = |which: &str, name: &str| json[which]["score"][name].as_f64().unwrap();
    assert!(of("optimum", "log_likelihood") > of("table1", "log_likelihood"));
    assert_eq!(of("optimum", "negative_samples"), 0.0);
    assert_eq!(of("table1", "negative_samples"), 0.0);
    assert_eq!(json["table1"]["values"]["location_sd"], 4.0);
    // Larger initial deviations: the paper's remark.
    let sensitivity = json["sensitivity"].as_array().unwrap();
    let negative = |factor: f64| -> u64 {
        let rows = sensitivity.iter().filter(|row| row["factor"] == factor);
        rows.map(|row| row["negative_runs"].as_u64().unwrap()).sum()
    };
    assert_eq!(negative(1.0), 0);
    assert!(negative(100.0) > 0);
    // It follows the truth no better for being likely.
    for which in ["table1", "optimum"] {
        let slope = json["slope"][which]["slope"][1].as_f64().unwrap();
        assert!(slope.abs() < 0.1, "{which}: {slope}");
    }

    assert_eq!(folder.replay(&["--config", "a/config.toml", "run.csv"]).code, Some(0));
    assert_eq!(folder.json("out/replay.json")["mode"], "paper");

    // Each run has a page that is linked, and leads to the next one.
    let report = folder.read("a/report.html");
    for number in 1..=4 {
        let file = format!("report/run000{number}.html");
        assert!(report.contains(&format!("href=\"{file}\"")), "{file}");
        assert_eq!(folder.read(&format!("a/{file}")).contains(">next: "), number < 4, "{file}");
    }

    // The surface has its numbers, and the same seed gives the same bytes.
    assert!(folder.read("a/tune_profiles.csv").lines().count() > 100);
    assert_eq!(folder.read("a/tune_plane.csv").lines().count(), 1 + 81);
    let again = few.map(|word| if word == "a" { "b" } else { word });
    folder.done(&again);
    for name in ["config.toml", "tune.json", "report.html", "tune_plane.svg"] {
        assert_eq!(folder.read(&format!("a/{name}")), folder.read(&format!("b/{name}")), "{name}");
    }
}
