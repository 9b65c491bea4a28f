//! Does `rundown import` make run logs of what recorders write, say what it did, and refuse what it cannot know?

#[path = "import_command/chainage.rs"]
mod chainage;
#[path = "import_command/clocks.rs"]
mod clocks;
#[path = "import_command/columns.rs"]
mod columns;
mod common;
#[path = "import_command/formats.rs"]
mod formats;
#[path = "import_command/meaning.rs"]
mod meaning;
#[path = "import_command/quality.rs"]
mod quality;
#[path = "import_command/signals.rs"]
mod signals;
#[path = "import_command/tables.rs"]
mod tables;
#[path = "import_command/wild.rs"]
mod wild;

use common::{Folder, RUN, reference};
use std::fmt::Write;

/// A train that stops at these places, sampled each second: time, location, speed.
fn drive(stops_m: &[f64], fastest_mps: f64) -> Vec<(f64, f64, f64)> {
    let (mut rows, mut t, mut x) = (Vec::new(), 0.0, stops_m[0]);
    for stop in &stops_m[1..] {
        for _ in 0..40 {
            rows.push((t, x, 0.0));
            t += 1.0;
        }
        let mut v: f64 = 0.0;
        while x < stop - 0.5 {
            v = (v + 0.5).min(fastest_mps).min((2.0 * 0.4 * (stop - x)).sqrt());
            x = (x + v).min(*stop);
            t += 1.0;
            rows.push((t - 1.0, x, v));
        }
    }
    for _ in 0..40 {
        rows.push((t, x, 0.0));
        t += 1.0;
    }
    rows
}

const STOPS_M: [f64; 5] = [0.0, 2100.0, 5600.0, 7300.0, 11_900.0];

fn table(header: &str, rows: &[(f64, f64, f64)], line: impl Fn(f64, f64, f64) -> String) -> String {
    let mut text = format!("{header}\n");
    for (t, x, v) in rows {
        text += &line(*t, *x, *v);
        text.push('\n');
    }
    text
}

/// `hh:mm:ss` of seconds since midnight, the day going on behind it.
fn clock(seconds: f64) -> String {
    let seconds = seconds as u64 % 86_400;
    format!("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

/// A ride of a phone along a line that bends, some metres beside it.
fn gpx(rows: &[(f64, f64, f64)], begin_s: f64, beside_m: f64, from_m: f64) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><trkseg>\n",
    );
    for (t, x, _) in rows {
        let (latitude, longitude) = place((from_m - x).abs(), beside_m);
        let time = jiff::Timestamp::from_second(1_740_000_000 + (begin_s + t) as i64).unwrap();
        let height = 100.0 + 0.004 * (from_m - x).abs();
        writeln!(
            text,
            "<trkpt lat=\"{latitude:.7}\" lon=\"{longitude:.7}\"><ele>{height:.1}</ele><time>{time}</time></trkpt>"
        )
        .unwrap();
    }
    text + "</trkseg></trk></gpx>\n"
}

/// A quarter of a circle of 10 km.
fn place(x: f64, beside_m: f64) -> (f64, f64) {
    let (radius, angle) = (10_000.0, x / 10_000.0);
    let (north, east) = ((radius + beside_m) * angle.sin(), (radius + beside_m) * (1.0 - angle.cos()) - beside_m);
    (50.0 + north / 111_229.0, 8.0 + east / 71_696.0)
}

fn csv(folder: &Folder, name: &str) -> Vec<Vec<f64>> {
    let text = folder.read(name);
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.parse().unwrap_or(f64::NAN)).collect()).collect()
}

fn last(rows: &[Vec<f64>]) -> &[f64] {
    rows.last().unwrap()
}

/// What a message says to write into a file for `--mapping`.
fn to_write(said: &str) -> String {
    let from = said.find("source = [").unwrap();
    let line = said[from..].lines().next().unwrap();
    line[..=line.find(']').unwrap()].to_owned()
}

#[track_caller]
fn near(found: f64, expected: f64, by: f64) {
    assert!((found - expected).abs() <= by, "expected {expected} within {by}, found {found}");
}

#[test]
fn a_german_locomotive_is_read_across_midnight() {
    let rows = drive(&STOPS_M, 30.0);
    let begin = 86_400.0 - 300.0;
    let text = table(
        "Fahrtschreiber Lok 1\nBaureihe;Übersee\n\nDatum;Uhrzeit;Weg [km];Geschwindigkeit [km/h];Außentemperatur [°C]",
        &rows,
        |t, x, v| {
            let day = if begin + t < 86_400.0 { "30.03.2024" } else { "31.03.2024" };
            format!(
                "{day};{};{};{};7,5",
                clock(begin + t),
                format!("{:.3}", 12.0 + x / 1000.0).replace('.', ","),
                format!("{:.1}", 3.6 * v).replace('.', ",")
            )
        },
    );
    let folder = Folder::new().with("z.toml", "[[source]]\nzone = \"Europe/Berlin\"\n");
    let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    std::fs::write(folder.path("lok.csv"), latin).unwrap();
    let said = folder.done(&["import", "lok.csv", "--mapping", "z.toml", "--out", "runs"]);
    assert!(said.out.contains("1 run in runs"), "{}", said.out);
    assert_eq!(
        folder.read("runs/runs.csv"),
        "file,departure_utc,unit,direction\nlok_01.csv,2024-03-30T22:55:00Z,,up\n"
    );
    let found = csv(&folder, "runs/lok_01.csv");
    assert!(
        folder
            .read("runs/lok_01.csv")
            .starts_with("time_s,location_m,speed_kmh,ambient_temperature_c\n0,12000,0,7.5\n")
    );
    assert_eq!(found.len(), rows.len());
    near(last(&found)[0], rows.last().unwrap().0, 1e-6);
    near(last(&found)[1], 23_900.0, 1.0);
    let mapping = folder.read("runs/import.toml");
    for line in
        ["encoding = \"windows-1252\"", "delimiter = \";\"", "decimal = \",\"", "order = \"dmy\"", "header_line = 4"]
    {
        assert!(mapping.contains(line), "{line} in {mapping}");
    }
    folder.done(&["check", "runs"]);
}

#[test]
fn a_time_of_the_day_goes_on_behind_midnight() {
    let rows = drive(&STOPS_M, 30.0);
    let text = table("Heure;PK (km);Vitesse (km/h)", &rows, |t, x, v| {
        format!("{};{:.3};{:.1}", clock(86_000.0 + t), x / 1000.0, 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    folder.done(&["import", "a.csv"]);
    assert_eq!(csv(&folder, "runs/a_01.csv").len(), rows.len());
    assert_eq!(folder.json("runs/import.json")["counts"]["midnights, joined"], 1);
}

#[test]
fn the_same_bytes_come_out_again() {
    let rows = drive(&STOPS_M, 30.0);
    let text = table("t,distance,speed", &rows, |t, x, v| format!("{t},{x:.1},{:.1}", 3.6 * v));
    let folder = Folder::new().with("a.csv", &text).with("b.gpx", &gpx(&rows, 0.0, 3.0, 0.0));
    folder.done(&["import", "a.csv", "--out", "first"]);
    folder.done(&["import", "--mapping", "first/import.toml", "--out", "second"]);
    folder.done(&["import", "b.gpx", "--out", "third"]);
    folder.done(&["import", "--mapping", "third/import.toml", "--out", "fourth"]);
    for (a, b) in [("first", "second"), ("third", "fourth")] {
        let mut names: Vec<_> = std::fs::read_dir(folder.path(a))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        // The manifest has times.
        names.retain(|name| name != "manifest.json");
        names.sort();
        assert!(names.contains(&"import.toml".to_owned()) && names.len() >= 4, "{names:?}");
        for name in names {
            assert_eq!(folder.read(&format!("{a}/{name}")), folder.read(&format!("{b}/{name}")), "{name}");
        }
    }
}

#[test]
fn each_column_of_a_log_is_read_by_its_own_name() {
    // A column of the table that the import does not know would be lost without a word.
    let names: Vec<&str> = rundown_files::sample::COLUMNS.iter().map(|column| column.name).collect();
    let rows = drive(&STOPS_M, 30.0);
    let text = table(&names.join(","), &rows, |t, x, v| {
        let value = |name: &&str| match *name {
            "time_s" => format!("{t}"),
            "location_m" => format!("{x:.1}"),
            "speed_kmh" => format!("{:.1}", 3.6 * v),
            "latitude_deg" => format!("{:.7}", place(x, 0.0).0),
            "longitude_deg" => format!("{:.7}", place(x, 0.0).1),
            // Of each other one a value that its range has.
            _ => "0.25".to_owned(),
        };
        names.iter().map(value).collect::<Vec<_>>().join(",")
    });
    let folder = Folder::new().with("all.csv", &text);
    folder.done(&["import", "all.csv", "--out", "runs"]);
    let logs = std::fs::read_dir(folder.path("runs")).unwrap().map(|entry| entry.unwrap().path());
    let mut tables = logs.filter(|path| path.extension().is_some_and(|end| end == "csv"));
    // The list of the runs is a table, too.
    let written = tables.find_map(|path| std::fs::read_to_string(path).ok().filter(|text| text.starts_with("time_s")));
    let written = written.expect("a log");
    let header: Vec<&str> = written.lines().next().unwrap().split(',').collect();
    for name in names {
        let at = header.iter().position(|column| *column == name);
        let at = at.unwrap_or_else(|| panic!("{name} is not in {header:?}"));
        assert!(written.lines().skip(1).any(|line| !line.split(',').nth(at).unwrap().is_empty()), "{name} is empty");
    }
}

/// Rows, time and speed of the table, spoilt as text, and what is said.
fn spoilt(name: &str, spoil: impl Fn(String) -> String) -> (common::Said, Option<usize>) {
    let rows = drive(&STOPS_M, 30.0);
    let text = table("time_s,location_m,speed_kmh,remark", &rows, |t, x, v| format!("{t},{x:.1},{:.1},r", 3.6 * v));
    let folder = Folder::new().with(name, &spoil(text));
    let said = folder.rundown(&["import", name]);
    let found = folder.path("runs/a_01.csv").exists().then(|| csv(&folder, "runs/a_01.csv").len());
    (said, found.map(|found| rows.len() - found))
}

#[test]
fn a_quote_that_is_never_closed_swallows_no_rows_without_a_word() {
    // An inch in the first lines, and one far behind what is looked at first.
    let (_, lost) = spoilt("a.csv", |text| text.replacen(",r\n", ",\"pipe\n", 1));
    assert_eq!(lost, Some(0));
    let long = "r".repeat(600);
    let (said, lost) = spoilt("a.csv", |text| {
        let text = text.replace(",r\n", &format!(",{long}\n"));
        let at = text.len() - text.len() / 5;
        let at = at + text[at..].find(&format!(",{long}")).unwrap() + 1;
        format!("{}\"{}", &text[..at], &text[at..])
    });
    let lost = lost.filter(|lost| *lost > 50).unwrap();
    assert!(said.out.contains(&format!("lines that cannot be read, left out: {lost}")), "{lost}: {}", said.out);
}

#[test]
fn lines_that_end_as_on_old_computers_are_lines() {
    let (said, lost) = spoilt("a.csv", |text| text.replace('\n', "\r"));
    assert_eq!(lost, Some(0), "{}", said.err);
}

#[test]
fn a_refusal_gives_the_true_reason() {
    let rows = drive(&STOPS_M, 25.0);
    let points: String = rows
        .iter()
        .map(|(_, x, _)| format!("<trkpt lat=\"{}\" lon=\"{}\"></trkpt>", place(*x, 0.0).0, place(*x, 0.0).1))
        .collect();
    let folder = Folder::new()
        .with("no_times.gpx", &format!("<gpx><trk><trkseg>{points}</trkseg></trk></gpx>"))
        .with("sums.nmea", &"$GPRMC,115640.00,A,5000.61200,N,00800.02400,E,53.02,084.4,140225,,,A*00\n".repeat(50))
        .with("twice.csv", &table("a,b", &rows, |t, x, _| format!("{t},{x}")))
        .with(
            "twice.toml",
            "[[source]]\ncolumns.time.name = \"a\"\ncolumns.location.name = \"b\"\ncolumns.speed.name = \"b\"\n",
        );
    for (arguments, reason) in [
        (vec!["import", "no_times.gpx"], "time: expected times, found none in any row"),
        (
            vec!["import", "sums.nmea"],
            "expected rows with readings, found none; line 1: expected a sentence with its checksum",
        ),
        (
            vec!["import", "twice.csv", "--mapping", "twice.toml"],
            "columns.speed: expected a column of its own, found \"b\" again",
        ),
    ] {
        let said = folder.rundown(&arguments);
        assert!(said.code != Some(0) && said.err.contains(reason), "{reason}: {}", said.err);
    }
}

#[test]
fn rows_of_several_runs_in_no_order_of_time_are_said() {
    let rows = drive(&STOPS_M, 30.0);
    let of_run = |run: u32| {
        let line = move |(t, x, v): &(f64, f64, f64)| {
            format!("2025-01-31 {},{x:.0},{:.1}", clock(36_000.0 + 3600.0 * f64::from(run) + t), 3.6 * v)
        };
        rows.iter().map(line)
    };
    let lines: Vec<String> = (0..4).flat_map(of_run).collect();
    let mut blocks: Vec<(usize, &[String])> = lines.chunks(60).enumerate().collect();
    blocks.sort_by_key(|(i, _)| i * 7919 % 101);
    let mixed: Vec<&str> = blocks.iter().flat_map(|(_, block)| block.iter().map(String::as_str)).collect();
    let text = |lines: &str| format!("time,location_m,speed_kmh\n{lines}\n");
    let folder = Folder::new().with("sorted.csv", &text(&lines.join("\n"))).with("mixed.csv", &text(&mixed.join("\n")));
    let words = "runs that begin before the one before them ends (rows in no order of time";
    for (name, is_mixed) in [("sorted.csv", false), ("mixed.csv", true)] {
        let said = folder.done(&["import", name, "--chainage", "as-is", "--out", name.trim_end_matches(".csv")]);
        assert_eq!(format!("{}{}", said.out, said.err).contains(words), is_mixed, "{name}: {}{}", said.out, said.err);
    }
}

#[test]
fn clocks_that_were_set_back_and_blocks_out_of_order_are_put_right() {
    let rows = drive(&STOPS_M, 30.0);
    let line = |t: f64, x: f64, v: f64| format!("{},{x:.0},{:.1}", clock(50_000.0 + t), 3.6 * v);
    let set_back =
        table("time,location_m,speed_kmh", &rows, |t, x, v| line(if t < 210.0 { t } else { t - 3600.0 }, x, v));
    let mut mixed = rows.clone();
    mixed[100..300].rotate_left(80);
    let folder =
        Folder::new().with("a.csv", &set_back).with("b.csv", &table("time,location_m,speed_kmh", &mixed, line));
    folder.done(&["import", "a.csv", "b.csv", "--chainage", "as-is"]);
    let json = folder.json("runs/import.json");
    assert_eq!(json["counts"]["clocks set back, put right"], 1, "{json}");
    let [a, b] = ["runs/a_01.csv", "runs/b_01.csv"].map(|name| csv(&folder, name));
    assert_eq!((a.len(), b.len()), (rows.len(), rows.len()));
    for ((a, b), (t, x, _)) in a.iter().zip(&b).zip(&rows) {
        near(a[0], *t, 1.1);
        near(b[0], *t, 1e-6);
        near(b[1], *x, 0.6);
    }
}

#[test]
fn unreadable_fields_are_counted_with_their_places() {
    let rows = drive(&STOPS_M[..3], 30.0);
    let text = table("time_s,location_m,speed_kmh", &rows, |t, x, v| match t as u32 {
        100 => format!("{t},{x:.0},fast"),
        101 => format!(",{x:.0},{:.1}", 3.6 * v),
        102 => format!("{t},{x:.0},{:.1}\n{t},{x:.0},{:.1}", 3.6 * v, 3.6 * v),
        _ => format!("{t},{x:.0},{:.1}", 3.6 * v),
    });
    let folder = Folder::new().with("a.csv", &text);
    folder.done(&["import", "a.csv"]);
    let json = folder.json("runs/import.json");
    let place = &json["places"]["fields that cannot be read, taken as missing"][0];
    assert_eq!(place, "a.csv:102:3: speed_kmh: expected a number, found \"fast\"");
    assert_eq!(json["counts"]["rows without a time, left out"], 1);
    assert_eq!(json["counts"]["rows with a time that was there before, left out"], 1);
}

/// Sums of the way there and back differ in their last digits.
#[test]
fn rows_that_are_written_newest_first_are_all_in_a_run() {
    let folder = Folder::new();
    for (file, offset_m) in (0..8).map(|file| (file, 0.1 + 3.7 * f64::from(file))) {
        let rows: Vec<_> = drive(&STOPS_M, 30.0 + 0.1 * offset_m).into_iter().rev().collect();
        let text = |t: f64, x: f64, v: f64| format!("{t},{:.1},{:.1}", x + offset_m + (t * 7.0) % 1.3, 3.6 * v);
        folder.write(&format!("in/{file}.csv"), &table("time_s,location_m,speed_kmh", &rows, text));
    }
    folder.done(&["import", "in"]);
    assert_eq!(std::fs::read_to_string(folder.path("runs/runs.csv")).unwrap().lines().count(), 9);
}

#[test]
fn a_file_with_nothing_usable_leaves_nothing() {
    let standing: Vec<_> = (0..500).map(|t| (f64::from(t), 5.0, 0.0)).collect();
    let text = table("time_s,location_m,speed_kmh", &standing, |t, x, v| format!("{t},{x},{v}"));
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.rundown(&["import", "a.csv"]);
    assert_eq!(said.code, Some(6));
    assert!(
        said.err.contains("pieces too short for a run, left out: 1") && said.err.contains("found none"),
        "{}",
        said.err
    );
    let left: Vec<_> = std::fs::read_dir(folder.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["a.csv"]);
    // Beside others it is named.
    let rows = drive(&STOPS_M, 30.0);
    folder.write("c.csv", &table("time_s,location_m,speed_kmh", &rows, |t, x, v| format!("{t},{x:.0},{:.1}", 3.6 * v)));
    folder.write("d.csv", &table("time_s,location_m,speed_kmh", &standing[..90], |t, x, v| format!("{t},{x},{v}")));
    folder.done(&["import", "c.csv", "d.csv", "--out", "both"]);
    assert_eq!(folder.json("both/import.json")["places"]["files of which no row is in a run"][0], "d.csv: 90 rows");
    // What is not of an import stays.
    folder.write("runs/mine.csv", "x");
    let rows = drive(&STOPS_M, 30.0);
    folder.write("b.csv", &table("time_s,location_m,speed_kmh", &rows, |t, x, v| format!("{t},{x:.0},{:.1}", 3.6 * v)));
    let said = folder.rundown(&["import", "b.csv"]);
    assert_eq!(said.code, Some(4), "{}", said.err);
    assert_eq!(folder.read("runs/mine.csv"), "x");
}

#[test]
fn no_bytes_make_it_panic() {
    let names = ["csv", "xlsx", "xls", "ods", "gpx", "nmea", "jsonl", "parquet", "bin"];
    let contents: [&[u8]; 10] = [
        b"",
        b"\xff\xfe",
        b"\xff\xfet\x00",
        b"PAR1",
        b"PK\x03\x04",
        b"<gpx><trkpt lat='x' lon='1e999'><time>9</time></trkpt><trkpt",
        b"$GPRMC,,V,,,,,,,,,,N*53\n$GPGGA,999999,,*\n",
        b"{\"time\": 1e308, \"lat\": -1e308, \"lon\": 1}\n{\"time\": -1e308, \"lat\": 1, \"lon\": 2}\n[]\n",
        b"time_s,location_m,speed_kmh\n1e308,1e308,1e308\n-1e308,-1e308,1\n0,0,0\n99999999999999999999,,\n",
        b"date;time;location;speed\n99.99.9999;99:99:99;1;1\n31.12.9999;23:59:60;1;1\n01.01.0001;00:00:00;2;2\n",
    ];
    let folder = Folder::new();
    for name in names {
        for (number, content) in contents.iter().enumerate() {
            let file = format!("{number}.{name}");
            std::fs::write(folder.path(&file), content).unwrap();
            let said = folder.rundown(&["import", &file, "--out", "out"]);
            assert_eq!(said.code, Some(6), "{file}: {}", said.err);
            assert!(said.err.starts_with("error: ") && !said.err.contains("panicked"), "{file}: {}", said.err);
        }
    }
}

#[test]
fn new_files_of_a_recorder_are_read_by_the_mapping_of_its_first() {
    let rows = drive(&STOPS_M, 30.0);
    let line = |t: f64, x: f64, v: f64| format!("{t},{:.4},{:.1}", x / 1000.0, 3.6 * v);
    let folder = Folder::new()
        .with("a.csv", &table("p,q,r", &rows, line))
        .with("b.csv", &table("another day\np,q,r", &rows, line))
        .with("m.toml", "[[source]]\n[source.columns]\ntime = { name = \"p\", unit = \"s\" }\nlocation = { name = \"q\", unit = \"km\" }\nspeed = { name = \"r\", unit = \"km/h\" }\n");
    folder.done(&["import", "a.csv", "--mapping", "m.toml", "--out", "a"]);
    folder.done(&["import", "b.csv", "--mapping", "a/import.toml", "--out", "b"]);
    assert_eq!(folder.read("a/a_01.csv"), folder.read("b/b_01.csv"));
}

#[test]
fn results_of_rundown_and_an_index_are_no_logs() {
    let index = "file,departure_utc,unit,direction\na.csv,2025-01-01T08:00:00Z,7,up\n";
    let folder = Folder::new().with("logs/a.csv", RUN).with("logs/runs.csv", index);
    let (train, track) = (reference("train.toml"), reference("track.toml"));
    folder.done(&["replay", "--train", &train, "--track", &track, "--out", "logs", "logs"]);
    assert!(folder.path("logs/a.estimates.csv").is_file());
    let named: Vec<String> = std::fs::read_dir(folder.path("logs"))
        .unwrap()
        .map(|entry| format!("logs/{}", entry.unwrap().file_name().display()))
        .filter(|name| name.ends_with(".csv"))
        .collect();
    let named: Vec<&str> = named.iter().map(String::as_str).collect();
    for files in [&["logs"][..], &named] {
        let said = folder.done(&[&["import", "--out", "imported"], files].concat());
        assert!(said.out.contains("1 run in imported"), "{files:?}: {}", said.out);
        assert!(said.err.contains("are results of a command, and no logs"), "{}", said.err);
        assert!(folder.read("imported/runs.csv").contains(",7,up"), "the index was read");
    }
    // A table of that name that is no index is a log.
    folder.write("mine/runs.csv", RUN);
    assert!(folder.done(&["import", "mine", "--out", "mine-out"]).out.contains("1 run in mine-out"));
}

#[test]
fn results_that_were_copied_without_their_manifest_are_recognised_by_their_columns() {
    let folder = Folder::new().with("logs/a.csv", RUN);
    let (train, track) = (reference("train.toml"), reference("track.toml"));
    folder.done(&["replay", "--train", &train, "--track", &track, "--out", "out", "logs"]);
    std::fs::create_dir_all(folder.path("copied")).unwrap();
    for name in ["a.estimates.csv", "features.csv", "parameters.csv", "switching_points.csv"] {
        std::fs::copy(folder.path(&format!("out/{name}")), folder.path(&format!("copied/{name}"))).unwrap();
    }
    let nothing = folder.rundown(&["import", "copied", "--out", "imported"]);
    assert_eq!(nothing.code, Some(3), "{}", nothing.err);
    std::fs::copy(folder.path("logs/a.csv"), folder.path("copied/a.csv")).unwrap();
    let said = folder.done(&["import", "copied", "--out", "imported"]);
    assert!(said.out.contains("1 run in imported"), "{}{}", said.out, said.err);
    for words in [
        "4 results of Rundown are left out",
        "a.estimates.csv: expected a log, found the columns of a result of `rundown replay: <run>.estimates`",
    ] {
        assert!(said.err.contains(words), "{}", said.err);
    }
}

#[test]
fn a_date_of_the_index_that_cannot_be_read_is_said_and_a_warning_where_none_may_be() {
    let index = "file,departure_utc\na.csv,01.03.2025 08:00\n";
    let folder = Folder::new().with("logs/a.csv", RUN).with("logs/runs.csv", index);
    let said = folder.done(&["import", "logs", "--out", "imported"]);
    let place = "logs/runs.csv:2:2: departure_utc: expected a date as 2025-03-01T08:00:00Z, found \"01.03.2025 08:00\"";
    assert!(said.err.contains(place), "{}", said.err);
    let strict = folder.rundown(&["import", "--strict", "logs", "--out", "strict"]);
    assert!(strict.code == Some(1) && strict.err.contains(place), "{}", strict.err);
}

/// What a file loses is said on the screen, stands in `import.json` with its first place, and is refused with
/// `--strict`.
#[track_caller]
fn loses(folder: &Folder, name: &str, what: &str, times: u64, place: &str) {
    let said = folder.done(&["import", name, "--out", name.split('.').next().unwrap()]);
    assert!(said.out.contains(&format!("{what}: {times}\n")), "{}{}", said.out, said.err);
    let json = folder.json(&format!("{}/import.json", name.split('.').next().unwrap()));
    assert_eq!(json["places"][what][0], place, "{json}");
    let strict = folder.rundown(&["import", name, "--out", "strict", "--strict"]);
    assert!(strict.code == Some(1) && strict.err.contains(what), "{}", strict.err);
}

const UNREADABLE: &str = "fields that cannot be read, taken as missing";
