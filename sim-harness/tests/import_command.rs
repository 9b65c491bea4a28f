//! Does `rundown import` make run logs of what recorders write, say what it did, and refuse what it cannot know?

mod common;

use common::Folder;
use rundown_files::column::{About, Kind};
use rundown_files::parquet::TableWriter;
use rundown_files::table::{Cell, Record};
use rundown_files::track_file::TrackFile;
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

/// A table of one line a row.
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

#[test]
fn rides_of_a_phone_come_onto_one_line_with_stations_and_gradients() {
    let rows = drive(&STOPS_M, 25.0);
    let mut folder = Folder::new();
    for (name, beside, from) in [("a.gpx", 4.0, 0.0), ("b.gpx", -4.0, 11_900.0), ("c.gpx", 1.0, 0.0)] {
        folder = folder.with(name, &gpx(&rows, 0.0, beside, from));
    }
    let said = folder.done(&["import", "a.gpx", "b.gpx", "c.gpx", "--track-out", "k.toml"]);
    assert!(said.out.contains("speeds computed from the locations: "), "{}", said.out);
    let index = folder.read("runs/runs.csv");
    let directions: Vec<&str> = index.lines().skip(1).map(|line| line.rsplit(',').next().unwrap()).collect();
    assert_eq!(directions[0], directions[2]);
    assert_ne!(directions[0], directions[1], "{index}");
    let (track, _) = TrackFile::read(&folder.path("k.toml")).unwrap();
    near(track.length_m, 11_900.0, 40.0);
    let stops: Vec<f64> = track.stop.iter().map(|stop| stop.at_m).collect();
    let expected: Vec<f64> =
        if directions[0] == "up" { STOPS_M.to_vec() } else { STOPS_M.iter().rev().map(|at| 11_900.0 - at).collect() };
    assert_eq!(stops.len(), 5, "where one run of three stands is no station: {stops:?}");
    assert!(expected.iter().all(|at| stops.iter().any(|stop| (stop - at).abs() < 40.0)), "{stops:?}");
    let permille = if directions[0] == "up" { 4.0 } else { -4.0 };
    assert!(
        track.gradient[2..10].iter().all(|gradient| (gradient.permille - permille).abs() < 0.3),
        "{:?}",
        track.gradient
    );
    // The same place of two runs, within metres.
    let [a, c] = ["runs/a_01.csv", "runs/c_01.csv"].map(|name| csv(&folder, name));
    for (a, c) in a.iter().zip(&c) {
        assert!((a[1] - c[1]).abs() < 12.0, "{a:?} {c:?}");
    }
    let fast = a.iter().map(|row| row[2]).fold(0.0, f64::max);
    near(fast, 90.0, 1.5);
    // The next ride on the track that is there now.
    folder.done(&["import", "b.gpx", "--track", "k.toml", "--out", "more"]);
    assert!(folder.read("more/runs.csv").contains(directions[1]));
}

#[test]
fn clocks_are_read_as_people_write_them() {
    let rows = drive(&STOPS_M, 30.0);
    let begin_s = 10.0 * 3600.0 + 34.0 * 60.0;
    let digits = |t: f64| clock(begin_s - 3600.0 + t).replace(':', "").trim_start_matches('0').to_owned();
    let days = |t: f64| format!("{:.9}", 45_688.0 + (begin_s + t) / 86_400.0);
    type Written<'a> = &'a dyn Fn(f64) -> String;
    let clocks: [(Written, Option<&str>, &str); 5] = [
        (&|t| format!("\"Fri, 31 January 2025 {}\"", clock(begin_s + t)), Some("2025-01-31T10:34:00Z"), ""),
        (&|t| format!("31.01.2025 {} +0100", clock(begin_s + t)), Some("2025-01-31T09:34:00Z"), ""),
        (&|t| format!("20250131{}", clock(begin_s + t).replace(':', "")), Some("2025-01-31T10:34:00Z"), ""),
        (&digits, None, "without colons: 093400 is hhmmss"),
        (&days, Some("2025-01-31T10:34:00Z"), "days since 1899-12-30"),
    ];
    for (written, departure, note) in clocks {
        let text = table("time,location_m,speed_kmh", &rows, |t, x, v| format!("{},{x:.1},{:.1}", written(t), 3.6 * v));
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv"]);
        let found = csv(&folder, "runs/a_01.csv");
        assert_eq!(found.len(), rows.len(), "{note}: {}", said.err);
        near(last(&found)[0] - found[0][0], rows.last().unwrap().0, 0.002);
        let index = folder.read("runs/runs.csv");
        assert!(departure.is_none_or(|departure| index.contains(departure)), "{index}");
        assert!(said.err.contains(note), "{note} in {}", said.err);
        folder.done(&["import", "--mapping", "runs/import.toml", "--out", "again"]);
        assert_eq!(folder.read("runs/a_01.csv"), folder.read("again/a_01.csv"));
    }
}

#[test]
fn positions_in_degrees_and_minutes_are_the_same_places() {
    let rows = drive(&STOPS_M, 25.0);
    let minutes = |degrees: f64| 100.0 * degrees.floor() + 60.0 * degrees.fract();
    let words = |degrees: f64| format!("{}° {:.4}'", degrees.floor(), 60.0 * degrees.fract());
    let written: [&dyn Fn(f64) -> String; 3] =
        [&|degrees| format!("{degrees:.7}"), &|degrees| format!("{:.5}", minutes(degrees)), &words];
    let made = written.map(|written| {
        let text = table("time [s],lat,lon,speed [km/h]", &rows, |t, x, v| {
            let (latitude, longitude) = place(x, 0.0);
            format!("{t},{},{},{:.1}", written(latitude), written(longitude), 3.6 * v)
        });
        let folder = Folder::new().with("a.csv", &text);
        folder.done(&["import", "a.csv", "--chainage", "line"]);
        csv(&folder, "runs/a_01.csv")
    });
    for other in &made[1..] {
        assert_eq!(other.len(), made[0].len());
        other.iter().zip(&made[0]).for_each(|(a, b)| near(a[1], b[1], 2.0));
    }
    near((last(&made[0])[1] - made[0][0][1]).abs(), 11_900.0, 40.0);
}

#[test]
fn positions_under_each_others_names_are_put_right_with_the_figure() {
    let rows = drive(&STOPS_M, 25.0);
    let folder_of = |header: &str, east: f64| {
        let text = table(header, &rows, |t, x, v| {
            let (latitude, longitude) = place(x, 0.0);
            format!("{t},{latitude:.7},{:.7},{:.1}", longitude + east, 3.6 * v)
        });
        Folder::new().with("a.csv", &text)
    };
    let placed = |header: &str, east: f64| {
        let folder = folder_of(header, east);
        let said = folder.done(&["import", "a.csv", "--chainage", "line"]).err;
        folder.done(&["import", "--mapping", "runs/import.toml", "--out", "again"]);
        assert_eq!(folder.read("runs/a_01.csv"), folder.read("again/a_01.csv"));
        (csv(&folder, "runs/a_01.csv"), said)
    };
    let (right, said) = placed("time [s],lat,lon,speed [km/h]", 0.0);
    assert!(!said.contains("is taken for the latitude"), "{said}");
    for (east, why) in [(0.0, "once they are exchanged"), (130.0, "is no latitude")] {
        let (found, said) = placed("time [s],lon,lat,speed [km/h]", east);
        assert!(said.contains("\"lon\" is taken for the latitude") && said.contains(why), "{said}");
        assert!(
            said.contains("over distance by speed is 1.00") || said.contains("over distance by speed is 0.99"),
            "{said}"
        );
        assert_eq!(found.len(), right.len());
        found.iter().zip(&right).for_each(|(a, b)| near(a[1], b[1], 2.0));
    }
    // What a person said is not turned, but refused.
    let folder = folder_of("a,b,c,speed [km/h]", 0.0);
    let mapping = "[[source]]\n[source.columns]\ntime = { name = \"a\", unit = \"s\" }\nlatitude = { name = \"c\" }\nlongitude = { name = \"b\" }\n";
    let folder = folder.with("m.toml", mapping);
    let said = folder.rundown(&["import", "--mapping", "m.toml", "a.csv", "--chainage", "line"]);
    assert!(said.code != Some(0) && said.err.contains("latitude and longitude are exchanged"), "{}", said.err);
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
fn places_without_a_fix_decide_no_units() {
    let rows = drive(&STOPS_M, 25.0);
    let text = table("time_s,lat,lon,speed_kmh", &rows, |t, x, v| {
        let (latitude, longitude) = if t % 5.0 == 0.0 { (0.0, 0.0) } else { place(x, 0.0) };
        format!("{t},{latitude:.7},{longitude:.7},{:.1}", 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    assert!(said.out.contains("positions that are no place on Earth, taken as missing: "), "{}", said.out);
}

fn checksum(sentence: &str) -> String {
    let sum = sentence.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${sentence}*{sum:02X}\r\n")
}

#[test]
fn sentences_of_a_receiver_are_read_and_a_damaged_one_is_counted() {
    let degrees = |value: f64| format!("{:02}{:08.5}", value as u32, 60.0 * value.fract());
    let mut text = String::new();
    let rows = drive(&STOPS_M[..3], 30.0);
    for (t, x, v) in &rows {
        let (latitude, longitude) = place(*x, 0.0);
        let time = clock(43_000.0 + t).replace(':', "");
        text += &checksum(&format!(
            "GPGGA,{time}.00,{},N,0{},E,1,08,0.9,120.5,M,47.0,M,,",
            degrees(latitude),
            degrees(longitude)
        ));
        text += &checksum(&format!(
            "GPRMC,{time}.00,A,{},N,0{},E,{:.2},084.4,140225,,,A",
            degrees(latitude),
            degrees(longitude),
            v * 3600.0 / 1852.0
        ));
    }
    let damaged = text.replacen("GPRMC,115710", "GPRMC,115711", 1);
    assert_ne!(damaged, text);
    let folder = Folder::new().with("gps.nmea", &damaged);
    folder.done(&["import", "gps.nmea"]);
    let json = folder.json("runs/import.json");
    assert_eq!(json["counts"]["lines that cannot be read, left out"], 1, "{json}");
    assert!(folder.read("runs/runs.csv").contains("2025-02-14T11:56:40Z"));
    let found = csv(&folder, "runs/gps_01.csv");
    assert_eq!(found.len(), rows.len());
    near(last(&found)[1] - found[0][1], 5600.0, 10.0);
    near(found.iter().map(|row| row[2]).fold(0.0, f64::max), 108.0, 0.1);
}

#[test]
fn json_lines_in_miles_are_converted_and_units_that_agree_alike_are_asked_for() {
    let rows = drive(&STOPS_M, 30.0);
    let lines = |speed: &str, distance: &str| {
        table("", &rows, |t, x, v| {
            format!(
                "{{\"gps\": {{\"timestamp\": {}}}, \"{distance}\": {:.5}, \"{speed}\": {:.2}}}",
                1.74e9 + t,
                x / 1609.344,
                v / 0.44704
            )
        })
    };
    let folder = Folder::new()
        .with("a.jsonl", &lines("speed_mph", "distance_miles"))
        .with("b.jsonl", &lines("speed", "distance"));
    folder.done(&["import", "a.jsonl"]);
    let found = csv(&folder, "runs/a_01.csv");
    near(last(&found)[1], 11_900.0, 1.0);
    near(found.iter().map(|row| row[2]).fold(0.0, f64::max), 108.0, 0.1);
    let said = folder.rundown(&["import", "b.jsonl", "--preview"]);
    assert_eq!(said.code, Some(1));
    assert!(said.out.contains("not known") && said.err.contains("km with km/h"), "{}{}", said.out, said.err);
    let said = folder.rundown(&["import", "b.jsonl", "--out", "b"]);
    assert_eq!(said.code, Some(6));
    for words in ["km with km/h", "miles with mph", "for --mapping (or another unit)"] {
        assert!(said.err.contains(words), "{}", said.err);
    }
    assert!(!folder.path("b").exists());
    let line = to_write(&said.err);
    assert!(line.contains("unit = \"km/h\""), "{line}");
    folder.write("m.toml", &line.replace("km/h", "mph").replace("\"km\"", "\"miles\""));
    folder.done(&["import", "b.jsonl", "--mapping", "m.toml", "--out", "b"]);
    near(last(&csv(&folder, "b/b_01.csv"))[1], 11_900.0, 1.0);
}

/// An array of objects as programs write it: pretty, in one line, torn off, and lines of which the first has no end.
#[test]
fn json_objects_over_several_lines_are_read() {
    let rows = drive(&STOPS_M[..3], 30.0);
    let object = |gap: &str, (t, x, v): &(f64, f64, f64)| {
        format!(
            "{{{gap}\"gps\": {{\"time_s\": {t}}},{gap}\"location_m\": {x:.1},{gap}\"note\": \"a \\\" }} b\",{gap}\"speed_kmh\": {:.1}{gap}}}",
            3.6 * v
        )
    };
    let all = |gap: &str| rows.iter().map(|row| object(gap, row)).collect::<Vec<_>>();
    let pretty = format!("[\n  {}\n]\n", all("\n    ").join(",\n  "));
    let folder = Folder::new()
        .with("pretty.json", &pretty)
        .with("line.json", &format!("[{}]", all("").join(",")))
        .with("torn.json", &pretty[..pretty.len() - 10])
        .with("first.jsonl", &format!("{{\"gps\": {{\"ti\n{}\n", all("").join("\n")));
    for (name, lost, bad) in
        [("pretty.json", 0, None), ("line.json", 0, None), ("torn.json", 1, Some(1)), ("first.jsonl", 0, Some(1))]
    {
        folder.done(&["import", name, "--out", "runs"]);
        let found = csv(&folder, &format!("runs/{}_01.csv", name.split('.').next().unwrap()));
        assert_eq!(found.len(), rows.len() - lost, "{name}");
        near(found[found.len() - 1][1], rows[rows.len() - 1 - lost].1, 0.06);
        let json = folder.json("runs/import.json");
        assert_eq!(json["counts"]["lines that cannot be read, left out"].as_u64(), bad, "{name}: {json}");
    }
}

#[test]
fn a_workbook_is_read() {
    let folder = Folder::new();
    let mut book = rust_xlsxwriter::Workbook::new();
    book.add_worksheet().set_name("Notes").unwrap().write(0, 0, "made by hand").unwrap();
    let sheet = book.add_worksheet().set_name("Log").unwrap();
    let date = rust_xlsxwriter::Format::new().set_num_format("yyyy-mm-dd hh:mm:ss");
    sheet.write(0, 0, "Unit 7").unwrap();
    for (column, name) in ["Fecha y hora", "Distancia (m)", "Velocidad (km/h)", "Fecha hora"].into_iter().enumerate() {
        sheet.write(2, column as u16, name).unwrap();
    }
    let rows = drive(&STOPS_M, 30.0);
    for (row, (t, x, v)) in (3..).zip(&rows) {
        sheet.write(row, 1, *x).unwrap();
        sheet.write(row, 2, 3.6 * v).unwrap();
        sheet.write_with_format(row, 3, 45_700.25 + t / 86_400.0, &date).unwrap();
    }
    book.save(folder.path("log.xlsx")).unwrap();
    folder.done(&["import", "log.xlsx"]);
    let found = csv(&folder, "runs/log_01.csv");
    assert_eq!(found.len(), rows.len());
    near(last(&found)[0], rows.last().unwrap().0, 0.01);
    near(last(&found)[1], 11_900.0, 1.0);
    assert!(folder.read("runs/runs.csv").contains("2025-02-12T06:00:00Z"), "{}", folder.read("runs/runs.csv"));
}

#[test]
fn a_table_of_parquet_is_read_and_split_by_its_runs() {
    let folder = Folder::new();
    let mut records: Vec<Record> = Vec::new();
    for (number, begin) in [("101", 0.0), ("102", 2000.0)] {
        for (t, x, v) in drive(&STOPS_M, 30.0) {
            let cells = [
                ("zugnummer", Cell::Text(number.to_owned())),
                ("time_s", Cell::Number(begin + t)),
                ("location_m", Cell::Number(x)),
                ("v [m/s]", Cell::Number(v)),
            ];
            records.push(cells.map(|(name, cell)| (name.to_owned(), cell)).to_vec());
        }
    }
    let number = |name| About::new(name, Kind::Number, "");
    let columns =
        vec![About::new("zugnummer", Kind::Text, ""), number("time_s"), number("location_m"), number("v [m/s]")];
    let mut writer = TableWriter::new(&folder.path("log.parquet"), columns);
    writer.write(&records).unwrap();
    writer.close().unwrap();
    folder.done(&["import", "log.parquet", "--chainage", "as-is"]);
    for name in ["runs/log_101_01.csv", "runs/log_102_01.csv"] {
        near(csv(&folder, name).iter().map(|row| row[2]).fold(0.0, f64::max), 108.0, 0.1);
    }
}

#[test]
fn an_odometer_that_wraps_is_joined() {
    let rows = drive(&STOPS_M, 30.0);
    let text = table("time_s\tlocation_m\tspeed_kmh", &rows, |t, x, v| {
        format!("{t}\t{:.0}\t{:.1}", (60_000.0 + x) % 65_536.0, 3.6 * v)
    });
    let folder = Folder::new();
    let wide: Vec<u8> = std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    std::fs::write(folder.path("a.txt"), wide).unwrap();
    folder.done(&["import", "a.txt"]);
    let found = csv(&folder, "runs/a_01.csv");
    near(last(&found)[1] - found[0][1], 11_900.0, 1.0);
    assert_eq!(folder.json("runs/import.json")["counts"]["odometers that wrapped, joined"], 1);
}

#[test]
fn an_odometer_that_wrapped_goes_on_behind_a_gap() {
    let there = drive(&STOPS_M, 30.0);
    let back = there.iter().map(|(t, x, v)| (5000.0 + t, 11_900.0 - x, *v));
    let rows: Vec<_> = there.iter().copied().chain(back).collect();
    let text = table("time_s;location_m;speed_kmh", &rows, |t, x, v| {
        format!("{t};{};{:.1}", (1000.0 + x) as u32 % 10_000, 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    folder.done(&["import", "a.csv"]);
    let back = csv(&folder, "runs/a_02.csv");
    near(back[0][1], 12_900.0, 1.0);
    near(last(&back)[1], 1000.0, 1.0);
    assert!(folder.read("runs/runs.csv").ends_with("a_02.csv,,,down\n"));
}

/// Locomotives count their way for life, up whichever way they go.
#[test]
fn an_odometer_beyond_any_line_comes_onto_one_chainage_by_the_stops() {
    let back: Vec<f64> = STOPS_M.iter().map(|at| 11_900.0 - at).rev().collect();
    let runs = [drive(&STOPS_M, 30.0), drive(&back, 25.0), drive(&STOPS_M, 28.0)];
    let rows = runs.iter().enumerate().flat_map(|(run, rows)| {
        rows.iter().map(move |(t, x, v)| (run as f64 * 5000.0 + t, run as f64 * 11_900.0 + x, *v))
    });
    let rows: Vec<_> = rows.collect();
    let folder = Folder::new();
    for (name, from_m) in [("life", 1.234_567e9), ("wrapped", 9_990_000.0)] {
        let text = table("Time [s],Odometer [m],Speed [km/h]", &rows, |t, x, v| {
            format!("{t},{:.0},{:.1}", if from_m < 1e7 { (from_m + x) % 1e7 } else { from_m + x }, 3.6 * v)
        });
        folder.write(&format!("{name}.csv"), &text);
        let said = folder.done(&["import", &format!("{name}.csv"), "--out", name]);
        assert!(said.out.contains("an odometer; most runs stop at the same places"), "{said:?}");
        let ends = |run: usize| {
            let rows = csv(&folder, &format!("{name}/{name}_0{run}.csv"));
            (rows[0][1], last(&rows)[1])
        };
        // Nothing says which end is the first.
        let (begin_m, end_m) = ends(1);
        near(begin_m.min(end_m), 0.0, 5.0);
        near(begin_m.max(end_m), 11_900.0, 5.0);
        near(ends(2).0, end_m, 5.0);
        near(ends(2).1, begin_m, 5.0);
        near(ends(3).0, begin_m, 5.0);
    }
}

/// Each has one of its own; they overlap by chance.
#[test]
fn odometers_of_several_units_are_recognised_unit_by_unit() {
    let back: Vec<f64> = STOPS_M.iter().map(|at| 11_900.0 - at).rev().collect();
    let runs = [drive(&STOPS_M, 30.0), drive(&back, 25.0), drive(&STOPS_M, 28.0)];
    let folder = Folder::new();
    for (unit, from_m) in [("201", 410_000.0), ("202", 403_300.0)] {
        for (run, rows) in runs.iter().enumerate() {
            let text = table("Zeit [s],Strecken-km,v-Ist [km/h],Fahrzeug", rows, |t, x, v| {
                format!("{t},{:.3},{:.1},{unit}", (from_m + run as f64 * 11_900.0 + x) / 1000.0, 3.6 * v)
            });
            folder.write(&format!("u{unit}_0{}.csv", run + 1), &text);
        }
    }
    let logs = ["u201_01.csv", "u201_02.csv", "u201_03.csv", "u202_01.csv", "u202_02.csv", "u202_03.csv"];
    let said = folder.done(&[&["import"], &logs[..], &["--out", "runs"]].concat());
    assert!(
        said.out.contains("no two runs of a unit overlap: an odometer; most runs stop at the same places"),
        "{said:?}"
    );
    let begins = |name: &str| csv(&folder, &format!("runs/{name}_01.csv"))[0][1];
    near(begins("u201_01"), begins("u202_01"), 5.0);
    near(begins("u201_02"), begins("u202_02"), 5.0);
    near((begins("u201_01") - begins("u201_02")).abs(), 11_900.0, 10.0);
}

/// The track says where the first stop is, and which end it is.
#[test]
fn an_odometer_comes_onto_the_chainage_of_a_track_by_its_stops() {
    let back: Vec<f64> = STOPS_M.iter().map(|at| 11_900.0 - at).rev().collect();
    let runs = [drive(&back, 25.0), drive(&STOPS_M, 30.0)];
    let rows = runs.iter().enumerate().flat_map(|(run, rows)| {
        rows.iter().map(move |(t, x, v)| (run as f64 * 5000.0 + t, 2e7 + run as f64 * 11_900.0 + x, *v))
    });
    let rows: Vec<_> = rows.collect();
    let folder = Folder::new();
    folder.write(
        "log.csv",
        &table("Time [s],Odometer [m],Speed [km/h]", &rows, |t, x, v| format!("{t},{x:.0},{:.1}", 3.6 * v)),
    );
    let track = |stops: &[f64]| {
        let stops = stops.iter().map(|at| format!("[[stop]]\nat_m = {:.1}\nname = \"S\"\n", at + 2000.0));
        format!("name = \"line\"\nlength_m = 20000.0\n{}", stops.collect::<String>())
    };
    folder.write("line.toml", &track(&STOPS_M));
    let said = folder.done(&["import", "log.csv", "--track", "line.toml", "--out", "runs"]);
    assert!(said.out.contains("chainage: stops (the track has stops"), "{said:?}");
    for (run, [begin_m, end_m]) in [(1, [13_900.0, 2000.0]), (2, [2000.0, 13_900.0])] {
        let rows = csv(&folder, &format!("runs/log_0{run}.csv"));
        near(rows[0][1], begin_m, 5.0);
        near(last(&rows)[1], end_m, 5.0);
    }
    // On their chainage they stay as they are.
    let again =
        folder.done(&["import", "runs/log_01.csv", "runs/log_02.csv", "--track", "line.toml", "--out", "again"]);
    assert!(again.out.contains("2 of 2 runs stop where the track has its stops"), "{again:?}");
    folder.write("short.toml", &track(&STOPS_M[..2]));
    let refused = folder.rundown(&["import", "log.csv", "--track", "short.toml", "--out", "none"]);
    assert!(
        refused.err.contains("short.toml: stop: expected a centre line, or at least 3 stops, found 2 stops"),
        "{refused:?}"
    );
}

/// A counter that has no reading has all its bits set.
#[test]
fn a_reading_beyond_any_line_makes_no_odometer() {
    let rows = drive(&STOPS_M, 30.0);
    let text = table("time_s,location_m,speed_kmh", &rows, |t, x, v| {
        let read = if t % 100.0 == 50.0 { 4_294_967_295.0 } else { x };
        format!("{t},{read:.0},{:.1}", 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text).with("b.csv", &text);
    let said = folder.done(&["import", "a.csv", "b.csv"]);
    assert!(!said.out.contains("odometer;") && !said.out.contains("odometer,"), "{said:?}");
    let found = csv(&folder, "runs/a_01.csv");
    near(found[0][1], 0.0, 1.0);
    near(last(&found)[1], 11_900.0, 1.0);
    assert!(said.out.contains("locations beyond any line among others that are not, left out"), "{said:?}");
}

#[test]
fn odometers_of_unlike_ways_begin_at_zero() {
    let folder = Folder::new();
    let ways: [(&str, &[f64], f64); 2] =
        [("a", &[0.0, 1500.0, 4100.0, 9000.0], 7.0e8), ("b", &[0.0, 2900.0, 3700.0, 8000.0], 1.3e9)];
    for (name, stops, from_m) in ways {
        let rows = drive(stops, 30.0);
        let text = table("Time [s],Odometer [m],Speed [km/h]", &rows, |t, x, v| {
            format!("{t},{:.0},{:.1}", from_m + x, 3.6 * v)
        });
        folder.write(&format!("{name}.csv"), &text);
    }
    let said = folder.done(&["import", "a.csv", "b.csv"]);
    assert!(said.out.contains("chainage: as-is (a_01 is at 700009 km, beyond any line: an odometer, and"), "{said:?}");
    near(csv(&folder, "runs/a_01.csv")[0][1], 0.0, 1e-6);
    near(last(&csv(&folder, "runs/b_01.csv"))[1], 8000.0, 1.0);
    let how = &folder.json("runs/import.json")["runs"][1]["placed"]["how"];
    assert!(how.as_str().unwrap().contains("each run begins at 0"), "{how}");
}

#[test]
fn there_and_back_become_two_runs_and_a_long_standing_is_cut() {
    let there = drive(&STOPS_M, 30.0);
    let end_s = there.last().unwrap().0;
    let back = there.iter().map(|(t, x, v)| (end_s + 200.0 + t, 11_900.0 - x, *v));
    let wait = (1..200).map(|t| (end_s + f64::from(t), 11_900.0, 0.0));
    let mut rows: Vec<_> = there.iter().copied().chain(wait).chain(back).collect();
    let end_s = rows.last().unwrap().0;
    rows.extend((1..1000).map(|t| (end_s + f64::from(t), 0.0, 0.0)));
    // Another run, not the first one again.
    rows.extend(drive(&STOPS_M, 28.0).iter().map(|(t, x, v)| (end_s + 1000.0 + t, *x, *v)));
    let text = table("time_s,location_m,speed_kmh", &rows, |t, x, v| format!("{t},{x:.1},{:.1}", 3.6 * v));
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    let index = folder.read("runs/runs.csv");
    let directions: Vec<&str> = index.lines().skip(1).map(|line| line.rsplit(',').next().unwrap()).collect();
    assert_eq!(directions, ["up", "down", "up"], "{}", said.out);
    assert!(said.out.contains("the train turns") && said.out.contains("the train stands for"), "{}", said.out);
    folder.done(&["check", "runs"]);
}

#[test]
fn locations_of_their_own_are_put_on_one_chainage_by_the_stops() {
    let line = [0.0, 2100.0, 5600.0, 7300.0, 11_900.0, 14_200.0];
    let own = |stops: &[f64]| {
        let rows = drive(&stops.iter().map(|at| (at - stops[0]).abs()).collect::<Vec<_>>(), 25.0);
        table("time_s,location_m,speed_kmh", &rows, |t, x, v| format!("{t},{x:.1},{:.1}", 3.6 * v))
    };
    let back: Vec<f64> = line.iter().rev().copied().collect();
    let other = [0.0, 900.0, 1700.0, 3000.0];
    let folder = Folder::new()
        .with("a.csv", &own(&line))
        .with("b.csv", &own(&line[2..]))
        .with("c.csv", &own(&back))
        .with("d.csv", &own(&other));
    let said = folder.rundown(&["import", "a.csv", "b.csv", "c.csv", "d.csv"]);
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert!(said.out.contains("chainage: stops (the locations of 4 of 4 logs begin at 0)"), "{}", said.out);
    near(csv(&folder, "runs/b_01.csv")[0][1], 5600.0, 2.0);
    near(csv(&folder, "runs/c_01.csv")[0][1], 14_200.0, 2.0);
    assert!(folder.read("runs/runs.csv").contains("c_01.csv,,,down"));
    assert!(said.err.contains("d_01 is left out") && !folder.path("runs/d_01.csv").exists(), "{}", said.err);
    folder.done(&["import", "a.csv", "b.csv", "c.csv", "--chainage", "align", "--out", "aligned"]);
    near(csv(&folder, "aligned/b_01.csv")[0][1], 5600.0, 100.0);
}

#[test]
fn runs_that_stop_at_their_ends_only_are_placed_by_these_and_turned_by_their_speeds() {
    let folder = Folder::new();
    folder.done(&["simulate", "--runs", "20", "--out", "set"]);
    let said = folder.done(&["import", "set/runs", "--out", "there"]);
    assert!(said.out.contains("20 of 20 logs begin at 0, and 20 end at the same place"), "{}", said.out);
    let as_it_was = |run: &str| {
        let (was, is) = (csv(&folder, &format!("set/runs/{run}.csv")), csv(&folder, &format!("there/{run}_01.csv")));
        was.iter().zip(&is).all(|(was, is)| was[..3] == is[..3])
    };
    assert!((1..=20).all(|run| as_it_was(&format!("run{run:03}"))), "{}", folder.read("there/import.json"));

    // The same runs as those of trains that come back, each with an odometer of its own.
    let text = folder.read("set/runs/run007.csv");
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let (end_s, end_m) = (last(&rows)[0], last(&rows)[1]);
    let back: String =
        rows.iter().rev().map(|row| format!("{},{},{}\n", end_s - row[0], end_m - row[1], row[2])).collect();
    let folder = folder.with("set/runs/run007.csv", &format!("time_s,location_m,speed_kmh\n{back}"));
    folder.done(&["import", "set/runs", "--out", "back"]);
    let index = folder.read("back/runs.csv");
    let down: Vec<&str> = index.lines().filter(|line| line.ends_with(",down")).collect();
    assert_eq!(down, ["run007_01.csv,,,down"]);
    near(csv(&folder, "back/run007_01.csv")[0][1], end_m, 100.0);
}

#[test]
fn units_are_found_by_evidence_and_wrong_ones_refused() {
    let rows = drive(&STOPS_M, 30.0);
    let bare = table("Zeit;Weg;v", &rows, |t, x, v| format!("{};{x:.0};{:.1}", 1000.0 * t, 3.6 * v));
    let wrong = table("time_s,location_m,speed_kmh", &rows, |t, x, v| format!("{t},{x:.0},{v:.2}"));
    let folder = Folder::new().with("bare.csv", &bare).with("wrong.csv", &wrong);
    let said = folder.done(&["import", "bare.csv", "--preview"]);
    assert!(said.out.contains("--preview=FILE.svg") && !folder.path("preview.svg").exists(), "looking writes nothing");
    assert!(
        said.out.contains("by evidence: distance by location over distance by speed is 1.0")
            && said.out.contains("km/h"),
        "{}",
        said.out
    );
    folder.done(&["import", "bare.csv", "--preview=speeds.svg"]);
    assert!(folder.read("speeds.svg").starts_with("<?xml") && !folder.path("runs").exists());
    folder.done(&["import", "bare.csv"]);
    near(last(&csv(&folder, "runs/bare_01.csv"))[0], rows.last().unwrap().0, 1e-6);
    let said = folder.rundown(&["import", "wrong.csv", "--out", "w"]);
    assert_eq!(said.code, Some(6));
    folder.write("m.toml", &to_write(&said.err));
    folder.done(&["import", "wrong.csv", "--mapping", "m.toml", "--out", "right"]);
    near(csv(&folder, "right/wrong_01.csv").iter().map(|row| row[2]).fold(0.0, f64::max), 108.0, 0.1);
}

#[test]
fn what_cannot_be_known_is_asked() {
    let rows = drive(&STOPS_M[..3], 30.0);
    let ambiguous = table("Date,Time,location_m,speed_kmh", &rows, |t, x, v| {
        format!("03/04/2025,{},{x:.0},{:.1}", clock(t), 3.6 * v)
    });
    let strange = table("foo,bar,baz", &rows, |t, x, v| format!("{t},{x:.0},{:.1}", 3.6 * v));
    let folder = Folder::new().with("a.csv", &ambiguous).with("s.csv", &strange);
    let said = folder.rundown(&["import", "a.csv"]);
    assert_eq!(said.code, Some(6));
    assert!(said.err.contains("(or \"mdy\")"), "{}", said.err);
    folder.write("m.toml", &to_write(&said.err).replace("dmy", "mdy"));
    folder.done(&["import", "a.csv", "--mapping", "m.toml"]);
    assert!(folder.read("runs/runs.csv").contains("2025-03-04T00:00:00Z"));
    let said = folder.rundown(&["import", "s.csv"]);
    assert!(
        said.err.contains("expected columns for time and location") && said.err.contains("foo, bar, baz"),
        "{}",
        said.err
    );
    let columns = "[[source]]\nlayout = { header_line = 1 }\n[source.columns]\ntime = { name = \"foo\", unit = \"s\" }\nlocation = { name = \"#2\", unit = \"m\" }\nspeed = { name = \"baz\", unit = \"km/h\" }\n";
    folder.write("m.toml", columns);
    folder.done(&["import", "s.csv", "--mapping", "m.toml"]);
    folder.write("m.toml", "[runs]\ngap = 5\n");
    let said = folder.rundown(&["import", "s.csv", "--mapping", "m.toml"]);
    assert_eq!(said.code, Some(3));
    assert!(said.err.contains("m.toml:2:1: ") && said.err.contains("gap"), "{}", said.err);
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
fn units_behind_the_values_and_a_clock_that_was_set_forward_are_read() {
    let rows = drive(&STOPS_M, 30.0);
    let comma = |value: f64| format!("{value:.3}").replace('.', ",");
    let text = table("Zeit;Ort;Geschwindigkeit;Zug", &rows, |t, x, v| {
        let shown = if t < 300.0 { t } else { t + 3600.0 };
        format!("{shown} s;{} km;{} km/h;RE 4711", comma(x / 1000.0), comma(3.6 * v))
    });
    let folder = Folder::new().with("a.csv", &text);
    folder.done(&["import", "a.csv"]);
    let found = csv(&folder, "runs/a_RE_4711_01.csv");
    assert_eq!(found.len(), rows.len());
    near(last(&found)[0], rows.last().unwrap().0, 1.1);
    near(last(&found)[1], 11_900.0, 1.0);
    assert_eq!(folder.json("runs/import.json")["counts"]["clocks set forward, put right"], 1);
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

/// A train with a table of these columns, imported; out: the note lines, the speeds of the run.
fn imported(folder: &Folder, header: &str, speed: impl Fn(f64) -> f64) -> (common::Said, Vec<f64>) {
    let rows = drive(&STOPS_M, 25.0);
    folder.write("in.csv", &table(header, &rows, |t, x, v| format!("{t},{x:.1},{:.1},7", speed(v))));
    let said = folder.rundown(&["import", "in.csv", "--out", "runs"]);
    let rows = if said.code == Some(0) { csv(folder, "runs/in_01.csv") } else { Vec::new() };
    (said, rows.iter().map(|row| row[2]).collect())
}

#[test]
fn a_speed_that_no_name_tells_is_taken_by_its_unit() {
    for header in ["Geschw. [km/h]", "Tempo (km/h)", "Vit. [km/h]", "fart_kmh"] {
        let folder = Folder::new();
        let (said, speeds) = imported(&folder, &format!("t [s],x [m],{header},Status"), |v| 3.6 * v);
        assert_eq!(said.code, Some(0), "{said:?}");
        assert!(said.err.contains(&format!("column {header:?} is taken for the speed")), "{said:?}");
        assert_eq!(speeds[20], 0.0, "{header}: a train that stands");
        near(speeds.iter().copied().fold(0.0, f64::max), 90.0, 0.1);
    }
}

/// A limit has the unit of a speed, too.
#[test]
fn a_limit_is_no_speed_and_the_note_has_the_line_that_takes_another_column() {
    let folder = Folder::new();
    let (said, _) = imported(&folder, "t [s],x [m],Limit [km/h],Snelheid", |_| 100.0);
    assert!(said.err.contains("\"Limit [km/h]\" has a unit of a speed, but is none"), "{said:?}");
    let folder = Folder::new();
    let (said, _) = imported(&folder, "t [s],x [m],Snelheid,Status", |v| 3.6 * v);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(said.err.contains("not used: \"Snelheid\", \"Status\""), "{said:?}");
    folder.write("map.toml", &to_write(&said.err));
    let said = folder.rundown(&["import", "in.csv", "--mapping", "map.toml", "--out", "again"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(!said.err.contains("computed from"), "{said:?}");
    assert_eq!(csv(&folder, "again/in_01.csv")[20][2], 0.0);
}

#[test]
fn a_location_that_no_name_tells_is_taken_by_its_unit_where_the_speed_agrees() {
    let rows = drive(&STOPS_M, 25.0);
    let folder = Folder::new();
    folder.write(
        "in.csv",
        &table("t [s],Laufweg [km],v [km/h]", &rows, |t, x, v| format!("{t},{:.4},{}", x / 1e3, 3.6 * v)),
    );
    let said = folder.rundown(&["import", "in.csv", "--out", "runs"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    near(last(&csv(&folder, "runs/in_01.csv"))[1], 11_900.0, 0.5);
    folder.write(
        "height.csv",
        &table("t [s],Gelaende [m],v [km/h]", &rows, |t, x, v| format!("{t},{},{}", (x / 300.0).sin(), 3.6 * v)),
    );
    let said = folder.rundown(&["import", "height.csv", "--out", "none"]);
    assert!(said.code != Some(0) && said.err.contains("expected columns for location"), "{said:?}");
}
