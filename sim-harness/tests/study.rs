//! Does `rundown study` show what it computes? The numbers behind each picture, the same bytes from the same seed, runs
//! from CSV and Parquet.

mod common;

use common::{Folder, Said};
use parquet::file::reader::FileReader;
use parquet::record::{Field, Row};
use rundown_files::parquet::RunReader;
use rundown_pages::assets::SCRIPT;
use serde_json::Value;
use std::{collections::BTreeSet, path::Path};

/// Runs of the study in these tests: enough for every figure.
const COUNT: usize = 12;

/// Where nothing may be said on stderr.
fn quiet(folder: &Folder, arguments: &[&str]) -> Said {
    let output = folder.rundown(arguments);
    assert_eq!((output.code, output.err.as_str()), (Some(0), ""));
    output
}

fn study(folder: &Folder, out: &str) -> Said {
    quiet(folder, &["study", "--count", &COUNT.to_string(), "--out", out])
}

fn csv_table(folder: &Folder, name: &str) -> Table {
    let mut reader = csv::Reader::from_path(folder.path(name)).unwrap();
    Table {
        header: reader.headers().unwrap().iter().map(String::from).collect(),
        rows: reader.records().map(|row| row.unwrap().iter().map(String::from).collect()).collect(),
    }
}

struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn column(&self, name: &str) -> Vec<&str> {
        let index = self.header.iter().position(|n| n == name);
        let index = index.unwrap_or_else(|| panic!("no column {name} in {:?}", self.header));
        self.rows.iter().map(|row| row[index].as_str()).collect()
    }

    fn numbers(&self, name: &str) -> Vec<f64> {
        let there = self.column(name).into_iter().filter(|text| !text.is_empty());
        there.map(|text| text.parse().unwrap()).collect()
    }

    fn rows_of(&self, column: &str, value: &str) -> Self {
        let keep: Vec<bool> = self.column(column).iter().map(|v| *v == value).collect();
        let rows = self.rows.iter().zip(keep).filter(|(_, keep)| *keep);
        Self { header: self.header.clone(), rows: rows.map(|(row, _)| row.clone()).collect() }
    }
}

/// Files of a folder; those of a folder within with its name before theirs.
fn names(folder: &Path) -> BTreeSet<String> {
    let of_entry = |path: &Path| -> Vec<String> {
        let name = path.file_name().unwrap().to_str().unwrap();
        match path.is_dir() {
            true => names(path).into_iter().map(|file| format!("{name}/{file}")).collect(),
            false => vec![name.to_owned()],
        }
    };
    std::fs::read_dir(folder).unwrap().flat_map(|entry| of_entry(&entry.unwrap().path())).collect()
}

#[test]
fn every_picture_has_its_numbers_and_stands_in_the_report() {
    let folder = Folder::new();
    study(&folder, "out");
    let names = names(&folder.path("out"));
    let mut expected = vec!["fig2_speed_profiles".to_owned()];
    for eyes in ["paper", "gated"] {
        for figure in [
            "fig3_run",
            "fig4_davis",
            "fig5_resistance",
            "fig6_regimes",
            "fig7_style",
            "fig8_brake_rates",
            "fig9_power",
            "fig9_below_40",
        ] {
            expected.push(format!("{figure}_{eyes}"));
        }
    }
    let page = folder.read("out/report.html").replace(SCRIPT, "");
    for name in &expected {
        assert!(names.contains(&format!("{name}.svg")), "{name}");
        assert!(!csv_table(&folder, &format!("out/{name}.csv")).rows.is_empty());
        // A file needs the name space that the page does without; the rest is the same picture.
        let svg = folder.read(&format!("out/{name}.svg"));
        let body = svg.split_once("<title>").unwrap().1;
        assert!(page.contains(body.trim_end()), "{name}");
    }
    assert_eq!(page.matches("<svg").count(), expected.len() + 2);
    assert!(names.contains("fig1_method.svg"));
    for word in ["NaN", "http", "src=", "url("] {
        assert!(!page.contains(word), "{word}");
    }
    assert!(page.contains("does not follow the true resistance"));
    for number in 1..=9 {
        assert!(page.contains(&format!("id=\"fig-{number}\"")));
    }
}

#[test]
fn the_numbers_are_those_of_the_runs() {
    let folder = Folder::new();
    study(&folder, "out");
    let runs = csv_table(&folder, "out/runs.csv");
    assert_eq!(runs.rows.len(), COUNT);
    let profiles = csv_table(&folder, "out/fig2_speed_profiles.csv");
    let drawn: BTreeSet<&str> = profiles.column("run").into_iter().collect();
    assert_eq!(drawn, runs.column("run").into_iter().collect());
    let top = profiles.numbers("speed_kmh").into_iter().fold(0.0, f64::max);
    let top_of_runs = runs.numbers("top_kmh").into_iter().fold(0.0, f64::max);
    assert!((top - top_of_runs).abs() < 1e-6);

    // Fig. 4 counts every sample once in each coefficient.
    let samples: f64 = runs.numbers("rows").iter().sum();
    let davis = csv_table(&folder, "out/fig4_davis_paper.csv");
    for name in ["r0", "r1", "r2"] {
        let counted: f64 = davis.rows_of("quantity", name).numbers("count").iter().sum();
        assert_eq!(counted, samples, "{name}");
    }

    // Fig. 7: a final coast of each run lies in the bin that counts it.
    let style = csv_table(&folder, "out/fig7_style_gated.csv").rows_of("quantity", "final_coast_min");
    let coasts = runs.numbers("gated_final_coast_s");
    let (from, to) = (style.numbers("from"), style.numbers("to"));
    for (index, count) in style.numbers("count").into_iter().enumerate() {
        let bin = from[index] - 1e-9..to[index] - 1e-9;
        let inside = coasts.iter().filter(|s| bin.contains(&(*s / 60.0))).count();
        assert_eq!(inside as f64, count);
    }

    // Fig. 8: the mean of a step is that of the runs' means, which stand in their rows.
    let brake = csv_table(&folder, "out/fig8_brake_rates_paper.csv");
    let steps = brake.rows_of("kind", "step").rows_of("run", "60_to_40");
    let step = steps.numbers("brake_rate_mps2")[0];
    let of_runs = runs.numbers("paper_brake_60_to_40_mps2");
    let mean = of_runs.iter().sum::<f64>() / of_runs.len() as f64;
    assert!((mean - step).abs() < 1e-9, "{mean} {step}");
    let drawn = brake.rows_of("kind", "run").rows_of("speed_kmh", "50.0");
    assert_eq!(drawn.numbers("brake_rate_mps2"), of_runs);

    let true_step = brake.rows_of("kind", "true_step").rows_of("run", "60_to_40");
    let true_rate = true_step.numbers("brake_rate_mps2")[0];
    assert!((true_rate - step).abs() < 0.1, "{true_rate} {step}");

    // Fig. 9: one cross a run, its largest power between 50 and 90 km/h; that of the table is a mean over 30 s.
    let power = csv_table(&folder, "out/fig9_power_gated.csv");
    for (run, mean_kw) in runs.column("run").iter().zip(runs.numbers("gated_max_power_50_90_kw")) {
        let of_run = power.rows_of("run", run);
        let cross = of_run.rows_of("kind", "largest_50_90").numbers("power_kw");
        let seen = of_run.rows_of("kind", "observed");
        let points = seen.numbers("speed_kmh").into_iter().zip(seen.numbers("power_kw"));
        let largest = points.filter(|(kmh, _)| (50.0..=90.0).contains(kmh)).map(|(_, kw)| kw).reduce(f64::max);
        assert_eq!(cross, [largest.unwrap()], "{run}");
        assert!(cross[0] >= mean_kw, "{run}: {} {mean_kw}", cross[0]);
    }

    // Figs. 3, 5 and 6 are those of the run nearest to the paper's, a row a sample: fast and braked gently if there is
    // one, then by its regimes.
    let shares = ["traction", "cruise", "coast", "brake"].map(|name| runs.numbers(&format!("paper_share_{name}")));
    let (top_kmh, brake_mps2) = (runs.numbers("top_kmh"), runs.numbers("paper_largest_brake_mps2"));
    let off = |run: usize| -> f64 {
        let pairs = shares.iter().zip([0.164, 0.17, 0.57, 0.093]);
        let regimes: f64 = pairs.map(|(share, papers)| (share[run] - papers).powi(2)).sum();
        let unlike = [top_kmh[run] < 138.0, brake_mps2[run] >= 0.59 * 0.66];
        regimes.sqrt() + unlike.map(|is| f64::from(u8::from(is))).iter().sum::<f64>()
    };
    let nearest = (0..COUNT).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap();
    let rows = runs.numbers("rows")[nearest] as usize;
    let terms = csv_table(&folder, "out/fig5_resistance_gated.csv");
    let motion = csv_table(&folder, "out/fig3_run_gated.csv");
    assert_eq!((terms.rows.len(), motion.rows.len()), (rows, rows));
    let (speed, r2) = (motion.numbers("estimated_kmh"), motion.numbers("r2"));
    for (index, quadratic) in terms.numbers("quadratic_n_per_kg").into_iter().enumerate() {
        let v = speed[index] / 3.6;
        assert!((quadratic - r2[index] * v * v).abs() < 1e-12);
    }
    assert_eq!(csv_table(&folder, "out/fig6_regimes_paper.csv").rows.len(), rows);
}

#[test]
fn each_run_has_a_page_with_its_truth_unless_they_are_left_out() {
    let folder = Folder::new();
    study(&folder, "out");
    let read = |name: &str| std::fs::read_to_string(folder.path(name)).unwrap();
    let first = read("out/report.html");
    for number in 1..=COUNT {
        let (file, run) = (format!("report/run{number:04}.html"), format!("unit001_run{number:02}"));
        assert!(first.contains(&format!("<a href=\"{file}\">{run}</a>")), "{file}");
        let page = read(&format!("out/{file}"));
        assert!(page.contains(&format!("<h1>{run}</h1>")) && page.contains("href=\"../report.html#runs\""), "{file}");
        assert!(page.contains("true start"), "{file}: the truth is drawn");
        assert_eq!(page.contains(">before: "), number > 1, "{file}");
        assert_eq!(page.contains(">next: "), number < COUNT, "{file}");
    }
    quiet(&folder, &["study", "--count", "2", "--out", "bare", "--no-run-pages"]);
    assert!(!folder.path("bare/report").exists());
    let bare = read("bare/report.html");
    assert!(bare.contains("unit001_run02") && !bare.contains("report/run0001.html"));
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_does_not() {
    let folder = Folder::new();
    let (first, second) = (study(&folder, "a"), study(&folder, "b"));
    assert_eq!(first.out.replace("a/report", "b/report"), second.out);
    assert_eq!(names(&folder.path("a")), names(&folder.path("b")));
    // The manifest has times.
    for name in names(&folder.path("a")).into_iter().filter(|name| name != "manifest.json") {
        let of = |out: &str| std::fs::read(folder.path(out).join(&name)).unwrap();
        assert!(of("a") == of("b"), "{name}");
    }
    quiet(&folder, &["study", "--count", "2", "--seed", "2", "--out", "c"]);
    let of = |out: &str| csv_table(&folder, &format!("{out}/runs.csv")).rows[0].clone();
    assert_ne!(of("a"), of("c"));
}

#[test]
fn runs_from_logs_and_from_parquet_give_what_the_simulated_ones_gave() {
    let folder = Folder::new();
    let keep = |file: &str| folder.rundown(&["study", "--count", "3", "--out", "simulated", "--keep-runs", file]);
    let refused = keep("simulated/kept.parquet");
    assert_eq!(refused.code, Some(2), "{}", refused.err);
    assert!(refused.err.contains("--keep-runs: expected a file outside of --out simulated"), "{}", refused.err);
    assert!(!folder.path("simulated").exists());
    let kept = keep("kept/runs.parquet");
    assert_eq!(kept.code, Some(0), "{}", kept.err);
    let recorded = |runs: &str, out: &str| {
        let files = ["--train", "simulated/train.toml", "--track", "simulated/track.toml"];
        quiet(&folder, &[&["study", "--runs", runs, "--out", out][..], &files].concat());
        csv_table(&folder, &format!("{out}/runs.csv"))
    };
    let mut runs = RunReader::open(&folder.path("kept/runs.parquet"), None).unwrap();
    while let Some(run) = runs.next_run().unwrap() {
        let mut log = "time_s,location_m,speed_kmh\n".to_owned();
        for row in &run.rows {
            let kmh = (3.6e6 * row.speed_mps.unwrap()).round() / 1e6;
            log += &format!("{},{},{kmh}\n", row.time_s, row.location_m.unwrap());
        }
        folder.write(&format!("logs/{}.csv", run.name), &log);
    }
    let simulated = csv_table(&folder, "simulated/runs.csv");
    for table in [recorded("kept/runs.parquet", "parquet"), recorded("logs", "csv")] {
        assert_eq!(table.column("run"), simulated.column("run"));
        for name in ["paper_r0", "gated_r2", "gated_final_coast_s", "paper_power_kw"] {
            assert_eq!(table.column(name), simulated.column(name), "{name}");
        }
        assert!(table.numbers("true_r0").is_empty(), "no truth is known of recorded runs");
    }
    let claims = csv_table(&folder, "csv/claims.csv");
    assert!(claims.column("truth").iter().all(|text| !text.contains("km/h")));
}

#[test]
fn the_truth_beside_simulated_logs_is_shown_and_its_absence_reported() {
    let folder =
        Folder::new().with("s.toml", "runs = 3\n[driver]\ndrivers = 2\n[wind]\nsd_mps = 2.0\n[load]\nsd = 0.02\n");
    quiet(&folder, &["simulate", "--scenario", "s.toml", "--out", "set"]);
    quiet(&folder, &["study", "--scenario", "s.toml", "--out", "direct"]);
    let study = |runs: &str, out: &str| {
        let described = ["--train", "set/train.toml", "--track", "set/track.toml"];
        folder.rundown(&[&["study", "--runs", runs, "--out", out][..], &described].concat())
    };

    // The whole data set, and its logs alone.
    let direct = csv_table(&folder, "direct/runs.csv");
    for (runs, out) in [("set", "a"), ("set/runs", "b")] {
        let Said { code, out: said, .. } = study(runs, out);
        assert_eq!(code, Some(0));
        assert!(said.contains("3 runs; their truth is known"), "{said}");
        let table = csv_table(&folder, &format!("{out}/runs.csv"));
        assert_eq!(table.column("driver"), direct.column("driver"));
        assert!(table.column("driver").iter().all(|driver| ["driver01", "driver02"].contains(driver)));
        let of_truth = table.header.iter().filter(|name| name.starts_with("true_"));
        for name in of_truth {
            let (read, known) = (table.numbers(name), direct.numbers(name));
            // Not every run brakes in every step.
            assert!(read.len() == known.len() && (known.len() == 3 || name.starts_with("true_brake_")), "{name}");
            let pairs: Vec<(f64, f64)> = read.into_iter().zip(known).collect();
            for (read, known) in pairs {
                // Written with seven digits behind the point.
                assert!((read - known).abs() <= 1e-5 * known.abs() + 1e-9, "{name}: {read} {known}");
            }
        }
        let claims = csv_table(&folder, &format!("{out}/claims.csv"));
        assert_eq!(claims.column("truth"), csv_table(&folder, "direct/claims.csv").column("truth"));
    }

    // One truth is missing, one is of other times: they are named, and the third is shown.
    std::fs::remove_file(folder.path("set/truth/run001.csv")).unwrap();
    let path = "set/truth/run002.csv";
    folder.write(path, &folder.read(path).replace("\n20.0,", "\n21.0,"));
    let Said { code, out: said, err: error } = study("set", "c");
    assert_eq!(code, Some(1));
    assert!(said.contains("1 run; its truth is known"), "{said}");
    assert!(error.contains("run001.csv: cannot be read as truth"), "{error}");
    assert!(error.contains("expected the truth at 20 s"), "{error}");

    folder.write("set/truth/truth.json", "{}");
    let Said { code, err: error, .. } = study("set", "d");
    assert_eq!(code, Some(3));
    assert!(error.contains("missing field `runs`"), "{error}");

    std::fs::remove_dir_all(folder.path("set/truth")).unwrap();
    let Said { code, out: said, .. } = study("set", "e");
    assert_eq!(code, Some(0));
    assert!(said.contains("3 runs; no truth lies beside them"), "{said}");
    let page = folder.read("e/report.html");
    assert!(page.contains("no truth lies beside them"));
    assert!(csv_table(&folder, "e/runs.csv").numbers("true_r0").is_empty());
}

#[test]
fn a_table_of_runs_is_the_same_as_csv_and_as_parquet() {
    let folder = Folder::new();
    quiet(&folder, &["study", "--count", "2", "--out", "out"]);
    let csv = csv_table(&folder, "out/runs.csv");
    let bytes = std::fs::File::open(folder.path("out/runs.parquet")).unwrap();
    let reader = parquet::file::serialized_reader::SerializedFileReader::new(bytes).unwrap();
    let rows: Vec<Row> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    assert_eq!(rows.len(), csv.rows.len());
    for (fields, row) in csv.rows.iter().zip(&rows) {
        let columns: Vec<(&String, &Field)> = row.get_column_iter().collect();
        assert_eq!(columns.len(), csv.header.len());
        for (index, (name, value)) in columns.into_iter().enumerate() {
            let field = &fields[index];
            assert_eq!(*name, csv.header[index]);
            match value {
                Field::Null => assert_eq!(field, "", "{name}"),
                Field::Str(text) => assert_eq!(field, text, "{name}"),
                Field::Long(count) => assert_eq!(field, &count.to_string(), "{name}"),
                Field::Double(number) => assert_eq!(field.parse(), Ok(*number), "{name}"),
                other => panic!("{name}: {other:?}"),
            }
        }
    }
}

#[test]
fn the_truth_is_followed_by_the_gated_mode_and_not_by_the_paper() {
    let folder = Folder::new();
    let arguments = ["study", "--truth-slope", "--vehicles", "8", "--vehicle-runs", "3", "--json", "--out", "out"];
    let output = quiet(&folder, &arguments);
    let json: Value = serde_json::from_str(&output.out).unwrap();
    let answers = json["answers"].as_array().unwrap();
    assert_eq!(answers.len(), 3 * 2, "three modes after 1 and 3 runs");
    for answer in answers {
        let slope = answer["slope"][1].as_f64().unwrap();
        let coverage = answer["coverage"].as_f64().unwrap();
        match answer["mode"].as_str().unwrap() {
            "paper" => assert!(slope.abs() < 0.05, "{answer}"),
            _ => assert!((slope - 1.0).abs() < 0.2 && coverage > 0.7, "{answer}"),
        }
    }
    // More runs cannot be known less well.
    let bound = |mode: &str, runs: u64| {
        let found = answers.iter().find(|a| a["mode"] == mode && a["runs"] == runs);
        found.unwrap()["bound_percent"].as_f64().unwrap()
    };
    assert!(bound("gated", 3) < bound("gated", 1));
    assert!(bound("measured", 1) < bound("gated", 1));
    let table = csv_table(&folder, "out/slope.csv");
    assert_eq!(table.rows.len(), 6);
    assert_eq!(csv_table(&folder, "out/slope_after_1_run.csv").rows.len(), 3 * 8);
    assert!(folder.path("out/slope_after_3_runs.svg").exists());
}

#[test]
fn the_headline_speaks_of_all_sets_and_not_of_the_first() {
    let folder = Folder::new();
    let of = |sets: &str, out: &str| -> Value {
        let count = ["study", "--count", "3", "--no-run-pages", "--json", "--out", out];
        serde_json::from_str(&quiet(&folder, &[&count[..], &["--seeds", sets]].concat()).out).unwrap()
    };
    let json = of("3", "three");
    assert_eq!((json["sets"].as_u64(), json["sets_needed"].as_u64()), (Some(3), Some(3)));
    let claims = json["claims"].as_array().unwrap();
    let held = |claim: &&Value| claim["sets_reproduced"] == 3;
    let some_sets = claims.iter().filter(|claim| [1, 2].map(Value::from).contains(&claim["sets_reproduced"])).count();
    assert!(some_sets > 0, "without a claim that holds in some sets alone this shows nothing");
    for claim in claims {
        assert_eq!(claim["verdict"] == "reproduced", held(&claim), "{claim}");
    }
    for kind in json["claims_by_kind"].as_array().unwrap() {
        let of_kind = claims.iter().filter(|claim| claim["kind"] == kind["kind"]);
        assert_eq!(kind["claims"], of_kind.clone().count());
        assert_eq!(kind["reproduced"], of_kind.filter(held).count(), "{kind}");
    }
    let page = folder.read("three/report.html");
    assert!(page.contains("Judged on 3 sets of runs: a claim holds where it does in 3 of them or more"));

    let json = of("1", "one");
    assert_eq!(json["sets"], 1);
    assert!(folder.read("one/report.html").contains("Judged on one set of runs alone"));
    let said = quiet(&folder, &["study", "--count", "2", "--no-run-pages", "--out", "screen"]);
    assert!(said.out.contains("Judged on one set of runs alone"), "{}", said.out);
}

/// Whichever of two runs has one.
#[test]
fn a_run_with_a_hole_is_not_the_one_of_the_figures() {
    let folder = Folder::simulated("name = \"set\"\nruns = 2\nseed = 5\n");
    for holed in ["set/runs/run001.csv", "set/runs/run002.csv"] {
        let whole = folder.read(holed);
        let lines: Vec<&str> = whole.lines().collect();
        folder.write(holed, &[&lines[..60], &lines[70..]].concat().join("\n"));
        let recorded = ["--runs", "set/runs", "--train", "set/train.toml", "--track", "set/track.toml"];
        folder.done(&[&["study", "--no-run-pages", "--out", "out"], &recorded[..]].concat());
        let times_s = csv_table(&folder, "out/fig3_run_paper.csv").numbers("time_s");
        assert!(times_s.len() > 50 && times_s.windows(2).all(|pair| pair[1] - pair[0] < 60.0), "{holed}: {times_s:?}");
        folder.write(holed, &whole);
    }
}

/// `data/golden/paper` has what `rundown study --all --seeds 20 --out paper` wrote: claims/claims.md and
/// readings/readings.md, with which docs/paper.md is compared, slope/slope.md, with which docs/study.md is, and
/// study/claims.csv, whose words are those of the first set.
#[test]
fn the_first_set_of_runs_says_what_was_measured() {
    let folder = Folder::new();
    quiet(&folder, &["study", "--no-run-pages", "--out", "out"]);
    let ours = csv_table(&folder, "out/claims.csv");
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/golden/paper/claims.csv");
    let golden = csv_table(&folder, golden.to_str().unwrap());
    for name in ["statement", "kind", "paper_mode", "gated_mode", "truth", "error", "why"] {
        for (claim, (now, then)) in
            ours.column("statement").iter().zip(ours.column(name).iter().zip(golden.column(name)))
        {
            // How long a step takes here is no result.
            assert!(*now == then || claim.contains("computation time"), "{claim}, {name}: {now} for {then}");
        }
    }
}

#[test]
fn arguments_that_do_not_go_together_are_refused() {
    let folder = Folder::new().with("t.toml", "name = 1\n");
    let code = |arguments: &[&str]| folder.rundown(&[&["study"], arguments].concat()).code;
    assert_eq!(code(&["--runs", "logs"]), Some(2), "without train and track");
    assert_eq!(code(&["--truth-slope", "--count", "3"]), Some(2));
    assert_eq!(code(&["--truth-slope", "--vehicles", "2"]), Some(2));
    assert_eq!(code(&["--runs", "logs", "--train", "t.toml", "--track", "t.toml"]), Some(3));
}

#[test]
fn an_experiment_is_a_figure_and_the_table_behind_it() {
    let folder = Folder::new();
    let said = quiet(&folder, &["study", "--experiment", "wind", "--seeds", "2", "--count", "2", "--out", "wind"]);
    assert!(said.out.starts_with("wind: What does wind do"), "{}", said.out);
    let files = ["manifest.json", "report.html", "wind.csv", "wind.svg"];
    assert_eq!(names(&folder.path("wind")), files.map(str::to_owned).into());
    let page = folder.read("wind/report.html");
    // The table of the page is that of the screen.
    let row = said.out.lines().find(|line| line.starts_with("still air")).unwrap();
    let cells = row.split("  ").map(str::trim).filter(|cell| cell.contains('\u{b1}'));
    assert!(page.contains("<figure") && cells.clone().count() > 1, "{row}");
    cells.for_each(|cell| assert!(page.contains(&format!("<td>{cell}</td>")), "{cell}"));
    // Kinds stand under their names, wrapped.
    let svg = folder.read("wind/wind.svg");
    assert!(svg.contains("\nstill air\n") && svg.contains("\nheadwind of 4"), "names on the axis");
    let table = csv_table(&folder, "wind/wind.csv");
    // Five variants, three modes, two sets.
    assert_eq!(table.rows.len(), 5 * 3 * 2);
    let gated = table.rows_of("mode", "gated").numbers("resistance_error_percent");
    assert!(gated.len() == 10 && gated.iter().all(|error| *error > 0.0));
    let again = quiet(&folder, &["study", "--experiment", "wind", "--seeds", "2", "--count", "2", "--out", "again"]);
    assert_eq!(folder.read("wind/wind.csv"), folder.read("again/wind.csv"));
    assert_eq!(said.out.replace("wind\n", ""), again.out.replace("again\n", ""));
}

/// A skewed, truncating recorder and another train: its runs are compared as recorded and put right, the band of the
/// paper's r0 is left out.
#[test]
fn readings_are_compared_on_recorded_runs_and_what_they_say_nothing_of_is_left_out() {
    let scenario = "runs = 8\n[train]\ndavis = { r0 = 8e-3, r1 = 1.6e-4, r2 = 2.8e-5 }\n[sensors]\nspeed = \"truncated\"\nspeed_lag_s = [10.0, 10.0]\n";
    let folder = Folder::new().with("s.toml", scenario);
    quiet(&folder, &["simulate", "--scenario", "s.toml", "--out", "set"]);
    let recorded = ["--runs", "set/runs", "--train", "set/train.toml", "--track", "set/track.toml", "--out", "out"];
    let said = folder.rundown(&[&["study", "--readings"], &recorded[..]].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.err.contains("not judged, for these runs say nothing of it: lower end, upper end"), "{}", said.err);
    let table = csv_table(&folder, "out/readings.csv");
    // Two efforts, each with two gradients, two readings of Table 1 and, as printed, two other spreads; two recorders.
    assert_eq!(table.rows.len(), 2 * (2 * 2 + 2) * 2);
    assert!(table.column("holds_lower_end").iter().all(|share| share.is_empty()));
    assert!(table.numbers("remarks_judged").iter().all(|judged| *judged == 13.0));
    let truncated = table.rows_of("speed", "truncated");
    assert!(truncated.numbers("skew_s").iter().all(|skew_s| (skew_s - 10.0).abs() < 1.0), "{:?}", truncated.rows);
    let forward = |speed: &str| table.rows_of("speed", speed).rows_of("effort", "forward").numbers("speed_rms_kmh")[0];
    assert!(forward("rounded") < 0.5 * forward("truncated"), "{} {}", forward("rounded"), forward("truncated"));
    assert!(folder.read("out/report.html").contains("8 recorded runs"));
    let strict = folder.rundown(&[&["study", "--readings", "--strict"], &recorded[..]].concat());
    assert_eq!(strict.code, Some(1));
}

/// The folder of `RUNDOWN_LOGS` with its train.toml and track.toml: claims and readings on runs of one's own.
#[test]
#[ignore = "needs recorded runs: RUNDOWN_LOGS=FOLDER"]
fn own_runs_are_studied() {
    let own = std::env::var("RUNDOWN_LOGS").expect("RUNDOWN_LOGS=FOLDER with runs/, train.toml and track.toml");
    let folder = Folder::new();
    let [runs, train, track] = ["runs", "train.toml", "track.toml"].map(|name| format!("{own}/{name}"));
    for (what, out) in [("--readings", "readings"), ("--no-run-pages", "claims")] {
        let said =
            folder.rundown(&["study", what, "--runs", &runs, "--train", &train, "--track", &track, "--out", out]);
        assert!(matches!(said.code, Some(0 | 1)), "{}", said.err);
    }
    let judged = csv_table(&folder, "readings/readings.csv").numbers("remarks_judged");
    assert!(judged.iter().all(|judged| *judged >= 9.0), "{judged:?}");
    assert!(csv_table(&folder, "claims/claims.csv").column("verdict").contains(&"reproduced"));
}

#[test]
fn an_experiment_takes_values_of_ones_own() {
    let folder = Folder::new();
    let run = |name: &str, values: &str| {
        let extent = ["--seeds", "1", "--count", "2", "--out", "out", "--values", values];
        folder.rundown(&[&["study", "--experiment", name], &extent[..]].concat())
    };
    let said = run("wind", "0,3.5");
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    let table = csv_table(&folder, "out/wind.csv");
    assert_eq!(table.rows_of("mode", "gated").numbers("x"), [0.0, 3.5]);
    assert!(folder.read("out/wind.svg").contains("wind along the line, sd between runs, m/s"));
    for (name, values, expected) in [
        ("trains", "1", "--values: expected an experiment whose variants are values, found trains"),
        ("units", "1", "--values: expected an experiment whose variants are values, found units"),
        ("all", "1", "--values: expected one experiment, found all"),
        ("wind", "-1", "sd_mps"),
    ] {
        let refused = run(name, values);
        assert!(refused.code != Some(0) && refused.err.contains(expected), "{name}: {}", refused.err);
    }
}

#[test]
fn experiments_are_listed_and_an_unknown_one_is_refused() {
    let folder = Folder::new();
    let listed = quiet(&folder, &["study", "--list-experiments"]).out;
    for name in ["measured-effort", "regime-feedback", "units", "diesel", "drivers"] {
        assert!(listed.lines().any(|line| line.starts_with(name) && line.contains('?')), "{name} in {listed}");
    }
    let refused = folder.rundown(&["study", "--experiment", "moon", "--out", "moon"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.err.contains("'moon' for '--experiment <NAME>'"), "{}", refused.err);
    assert!(refused.err.contains("[possible values: all, measured-effort, "), "{}", refused.err);
    assert!(!folder.path("moon").exists());
}

#[test]
fn a_study_reads_the_effort_forward_unless_its_configuration_says_otherwise() {
    let folder = Folder::new();
    folder.write("backward.toml", "[paper]\ndifference = \"backward\"\n");
    folder.write("other.toml", "[paper]\nlocation_sd_m = 4.0\n");
    let rms_kmh = |out: &str, more: &[&str]| {
        quiet(&folder, &[&["study", "--count", "3", "--out", out][..], more].concat());
        let rms = csv_table(&folder, &format!("{out}/runs.csv")).numbers("paper_speed_rms_kmh");
        rms.iter().sum::<f64>() / rms.len() as f64
    };
    let [forward, other] = [rms_kmh("a", &[]), rms_kmh("b", &["--config", "other.toml"])];
    assert!(forward < 0.1 && other == forward, "{forward} {other}");
    assert!(rms_kmh("c", &["--config", "backward.toml"]) > 3.0);
    assert!(folder.read("a/report.html").contains("over the interval of the step (forward)"));
}
