//! Positions, sentences of a receiver and JSON become run logs; what cannot be read is counted with its place.

use super::*;
use rundown_files::track_file::TrackFile;

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
    let stops = track.stops_m();
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
    // Nor does it take a unit: no unit of trains agrees with the names.
    for (header, note) in [
        ("time [s],lon,lat,speed", Some("in km/h, and no other unit agrees,")),
        ("time [s],lat,lon,speed", None),
        ("time,lon,lat,location,speed", Some("of that by location as")),
        ("time,lat,lon,location,speed", None),
    ] {
        let text = table(header, &rows, |t, x, v| {
            let (latitude, longitude) = place(x, 0.0);
            let located = if header.contains("location") { format!("{x:.1},") } else { String::new() };
            format!("{t},{latitude:.7},{longitude:.7},{located}{:.1}", 3.6 * v)
        });
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv", "--chainage", "line"]).err;
        assert_eq!(said.contains("is taken for the latitude"), note.is_some(), "{header}: {said}");
        assert!(note.is_none_or(|note| said.contains(note)), "{header}: {said}");
        let found = csv(&folder, "runs/a_01.csv");
        near(found.iter().map(|row| row[2]).fold(0.0, f64::max), 90.0, 0.1);
        near(last(&found)[1] - found[0][1], last(&right)[1] - right[0][1], 2.0);
    }
    // What a person said is not turned, but refused.
    let folder = folder_of("a,b,c,speed [km/h]", 0.0);
    let mapping = "[[source]]\n[source.columns]\ntime = { name = \"a\", unit = \"s\" }\nlatitude = { name = \"c\" }\nlongitude = { name = \"b\" }\n";
    let folder = folder.with("m.toml", mapping);
    let said = folder.rundown(&["import", "--mapping", "m.toml", "a.csv", "--chainage", "line"]);
    assert!(said.code != Some(0) && said.err.contains("latitude and longitude are exchanged"), "{}", said.err);
}

#[test]
fn a_single_fix_that_is_no_latitude_is_missing_and_says_nothing_of_the_others() {
    let rows = drive(&STOPS_M, 25.0);
    let placed = |wrong: f64| {
        let row = std::cell::Cell::new(0);
        let text = table("time [s],lat,lon,speed [km/h]", &rows, |t, x, v| {
            row.set(row.get() + 1);
            let (latitude, longitude) = place(x, 0.0);
            let latitude = if row.get() == 100 { wrong } else { latitude };
            format!("{t},{latitude:.7},{longitude:.7},{:.1}", 3.6 * v)
        });
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv", "--chainage", "line"]);
        (csv(&folder, "runs/a_01.csv"), said.out + &said.err)
    };
    let (right, _) = placed(place(rows[99].1, 0.0).0);
    // No latitude; and one that may be degrees and minutes.
    for wrong in [95.0, 132.0] {
        let (found, said) = placed(wrong);
        assert!(!said.contains("is taken for") && !said.contains("are taken for"), "{wrong}: {said}");
        assert!(said.contains("no place on Earth, taken as missing: 1"), "{wrong}: {said}");
        near(last(&found)[1] - found[0][1], last(&right)[1] - right[0][1], 2.0);
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

/// Five rows a second, of a receiver with one fix a second.
#[test]
fn a_reading_that_a_logger_writes_again_is_one_reading() {
    let rows = drive(&STOPS_M, 30.0);
    let again = rows.iter().flat_map(|(t, x, v)| (0..5).map(move |i| (t + 0.2 * f64::from(i), *x, *v)));
    let again: Vec<_> = again.collect();
    let text = |rows: &[(f64, f64, f64)]| {
        table("time_s,location_m,speed_kmh", rows, |t, x, v| format!("{t:.1},{x:.1},{:.2}", 3.6 * v))
    };
    let folder = Folder::new().with("once.csv", &text(&rows)).with("often.csv", &text(&again));
    let said = folder.done(&["import", "once.csv", "often.csv", "--chainage", "as-is"]);
    assert!(said.out.contains("rows that repeat the reading before within a second, left out"), "{}", said.out);
    let [once, often] = ["runs/once_01.csv", "runs/often_01.csv"].map(|name| csv(&folder, name));
    let moving = |rows: &[Vec<f64>]| rows.iter().filter(|row| row[2] > 4.0).cloned().collect::<Vec<_>>();
    assert_eq!(moving(&once), moving(&often));
}

/// The distance is that of the clock's true second.
#[test]
fn a_clock_that_jitters_makes_no_wheel_of_speeds_that_are_computed() {
    let rows = drive(&STOPS_M, 30.0);
    let text = table("time_s,location_m", &rows, |t, x, _| {
        let jitter_s = 0.15 * (12.9898 * t).sin();
        format!("{:.3},{x:.1}", t + jitter_s)
    });
    let folder = Folder::new().with("a.csv", &text);
    folder.done(&["import", "a.csv", "--chainage", "as-is"]);
    let (read, driven) = (csv(&folder, "runs/a_01.csv"), rows);
    let [mut by_speed, mut true_m] = [0.0; 2];
    for (row, (_, _, mps)) in read.iter().zip(&driven).filter(|(_, (_, _, mps))| *mps > 15.0) {
        by_speed += row[2] / 3.6;
        true_m += mps;
    }
    assert!((by_speed / true_m - 1.0).abs() < 0.001, "{by_speed} {true_m}");
}

/// A check that compares it with the locations would find what the import made of them.
#[test]
fn a_log_says_that_its_speed_was_computed_also_after_another_import() {
    let text = table("time_s,location_m", &drive(&STOPS_M, 30.0), |t, x, _| format!("{t},{x:.1}"));
    let folder = Folder::new().with("a.csv", &text);
    folder.done(&["import", "a.csv", "--chainage", "as-is"]);
    let header = "time_s,location_m,speed_kmh,speed_is_computed";
    assert_eq!(folder.read("runs/a_01.csv").lines().next(), Some(header));
    let said = folder.done(&["check", "--strict", "runs"]);
    let computed = "speeds were computed from the locations, and say nothing beyond them: 1 runs";
    assert!(said.out.contains("compared in 0 of 1 runs") && said.out.contains(computed), "{}", said.out);
    folder.done(&["import", "runs/a_01.csv", "--chainage", "as-is", "--out", "again"]);
    assert_eq!(csv(&folder, "again/a_01_01.csv"), csv(&folder, "runs/a_01.csv"));
}

#[test]
fn a_code_page_that_is_not_found_is_asked_for() {
    let rows = drive(&STOPS_M[..3], 30.0);
    let text =
        table("time_s,location_m,szybko\u{15b}\u{107} (km/h)", &rows, |t, x, v| format!("{t},{x:.0},{:.1}", 3.6 * v));
    // Windows-1250.
    let bytes: Vec<u8> = text
        .chars()
        .map(|c| match c {
            '\u{15b}' => 0x9c,
            '\u{107}' => 0xe6,
            ascii => u8::try_from(ascii).unwrap(),
        })
        .collect();
    let folder = Folder::new();
    std::fs::write(folder.path("a.csv"), bytes).unwrap();
    let said = folder.done(&["import", "a.csv"]);
    assert!(said.err.contains("layout.encoding = \"windows-1250\""), "{}", said.err);
    let line = said.err.split("say the code page: ").nth(1).unwrap().split(" (or").next().unwrap();
    folder.write("m.toml", line);
    let said = folder.done(&["import", "a.csv", "--mapping", "m.toml"]);
    assert!(!said.err.contains("layout.encoding") && said.err.contains("szybko\u{15b}\u{107}"), "{}", said.err);
}

/// Two trains that follow each other, their rows in the order of their times.
fn taking_turns(header: &str, line: impl Fn(&str, f64, f64, f64) -> String) -> String {
    let mut rows: Vec<(f64, &str, f64, f64)> = Vec::new();
    for (train, begin_s) in [("4011", 0.0), ("4013", 300.5)] {
        rows.extend(drive(&STOPS_M, 30.0).iter().map(|(t, x, v)| (begin_s + t, train, *x, *v)));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let lines: Vec<String> = rows.into_iter().map(|(t, train, x, v)| line(train, t, x, v)).collect();
    format!("{header}\n{}\n", lines.join("\n"))
}

#[test]
fn trains_whose_rows_take_turns_in_one_file_are_separated_by_their_column() {
    let text = taking_turns("time_s,train,location_m,speed_kmh", |train, t, x, v| {
        format!("{t},{train},{x:.1},{:.2}", 3.6 * v)
    });
    let folder = Folder::new().with("fleet.csv", &text);
    let said = folder.done(&["import", "fleet.csv", "--chainage", "as-is"]);
    assert!(said.out.contains("2 runs in"), "{}", said.out);
    let driven = drive(&STOPS_M, 30.0);
    for train in ["4011", "4013"] {
        let rows = csv(&folder, &format!("runs/fleet_{train}_01.csv"));
        assert_eq!(rows.len(), driven.len(), "{}", said.out);
        for (row, (_, x, v)) in rows.iter().zip(&driven) {
            near(row[1], *x, 0.1);
            near(row[2], 3.6 * v, 0.02);
        }
    }
}

#[test]
fn trains_whose_rows_take_turns_without_a_column_are_said() {
    let text = taking_turns("time_s,location_m,speed_kmh", |_, t, x, v| format!("{t},{x:.1},{:.2}", 3.6 * v));
    let folder = Folder::new().with("fleet.csv", &text);
    let said = folder.done(&["import", "fleet.csv", "--chainage", "as-is"]);
    assert!(said.out.contains("name the column that tells them apart"), "{}", said.out);
}

#[test]
fn rows_of_another_length_than_the_header_are_counted() {
    let rows = drive(&STOPS_M, 30.0);
    let text = table("time_s,location_m,speed_kmh", &rows, |t, x, v| {
        if t % 3.0 == 0.0 { format!("{t},{x:.1}") } else { format!("{t},{x:.1},{:.2}", 3.6 * v) }
    });
    let long = table("time_s,location_m,speed_kmh", &rows, |t, x, v| {
        if t == 7.0 { format!("{t},{x:.1},0,5") } else { format!("{t},{x:.1},{:.2}", 3.6 * v) }
    });
    // A column that nobody needs may be missing, and nothing may stand behind the last one.
    let good = table("time_s,location_m,speed_kmh,remark,", &rows, |t, x, v| {
        if t == 9.0 { format!("{t},{x:.1},{:.2}", 3.6 * v) } else { format!("{t},{x:.1},{:.2},ok,,", 3.6 * v) }
    });
    let folder = Folder::new().with("short.csv", &text).with("long.csv", &long).with("good.csv", &good);
    let what = "rows with fewer fields than the header, the rest taken as missing";
    let short = rows.iter().filter(|(t, ..)| t % 3.0 == 0.0).count() as u64;
    loses(&folder, "short.csv", what, short, "short.csv:2: expected 3 fields, found 2");
    let what = "rows with more fields than the header, the rest not read";
    loses(&folder, "long.csv", what, 1, "long.csv:9: expected 3 fields, found 4");
    folder.done(&["import", "good.csv", "--strict", "--out", "whole"]);
}

#[test]
fn a_track_that_is_torn_off_between_two_points_is_said() {
    let whole = gpx(&drive(&STOPS_M, 25.0), 0.0, 0.0, 0.0);
    let end = whole[..whole.len() / 2].rfind("</trkpt>").unwrap() + "</trkpt>".len();
    let folder = Folder::new().with("torn.gpx", &whole[..end]);
    let points = whole[..end].matches("</trkpt>").count();
    let place = format!(
        "torn.gpx:{points}: expected XML behind track point {points}, found the end of the file within <trkseg>; \
         the rest of the file is lost"
    );
    loses(&folder, "torn.gpx", "lines that cannot be read, left out", 1, &place);
}

#[test]
fn lines_are_counted_alike_whatever_ends_them() {
    let text = table("time_s,location_m,speed_kmh", &drive(&STOPS_M, 30.0), |t, x, v| {
        let speed = if t == 98.0 { "bad".to_owned() } else { format!("{:.2}", 3.6 * v) };
        format!("{t},{x:.1},{speed}")
    });
    for end in ["\n", "\r\n", "\r"] {
        let folder = Folder::new().with("a.csv", &text.replace('\n', end));
        loses(&folder, "a.csv", UNREADABLE, 1, "a.csv:100:3: speed_kmh: expected a number, found \"bad\"");
        let preview = folder.done(&["import", "--preview", "a.csv"]).out;
        assert!(preview.contains("     3  1 | 0.0 | 0.00"), "{end:?}: {preview}");
    }
}

/// Means over some seconds are too small where a train is fastest, and too large where it is slow, as if its wheel were
/// another one.
#[test]
fn speeds_of_positions_follow_a_train_that_is_hardly_ever_at_one_speed() {
    let stops_m: Vec<f64> = (0..12).map(|stop| 350.0 * f64::from(stop)).collect();
    let rows = drive(&stops_m, 25.0);
    for (header, fixes) in [("time_s,lat,lon", true), ("time_s,location_m", false)] {
        let text = table(header, &rows, |t, x, _| {
            let (latitude, longitude) = place(x, 0.0);
            if fixes { format!("{t},{latitude:.7},{longitude:.7}") } else { format!("{t},{x:.2}") }
        });
        let folder = Folder::new().with("a.csv", &text);
        folder.done(&["import", "a.csv"]);
        let found = csv(&folder, "runs/a_01.csv");
        let pairs: Vec<(f64, f64)> =
            found.iter().zip(&rows).filter(|(_, row)| row.2 > 1.0).map(|(read, row)| (row.2, read[2] / 3.6)).collect();
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
        let (x, y) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
        let scale = mean(&|pair| (pair.0 - x) * (pair.1 - y)) / mean(&|pair| (pair.0 - x).powi(2));
        near(scale, 1.0, 0.01);
    }
}

#[test]
fn a_receiver_that_stood_still_and_leapt_makes_no_train_of_a_thousand_kilometres_an_hour() {
    let rows = drive(&STOPS_M, 25.0);
    let text = table("time_s,lat,lon", &rows, |t, x, _| {
        let is_frozen = (75.0..95.0).contains(&t);
        let (latitude, longitude) = place(if is_frozen { rows[75].1 } else { x }, 0.0);
        format!("{t},{latitude:.7},{longitude:.7}")
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    assert!(said.out.contains("as of a receiver in a tunnel, taken as missing: 19"), "{}", said.out);
    let found = csv(&folder, "runs/a_01.csv");
    assert!(found.iter().all(|row| row[2].is_nan() || row[2] < 95.0));
    assert!(found.iter().filter(|row| row[2].is_nan()).count() <= 20);
}

#[test]
fn files_of_other_kinds_in_a_folder_are_said_and_read_where_they_are_named() {
    let log = gpx(&drive(&STOPS_M, 25.0), 0.0, 0.0, 0.0);
    let others = ["raw/b.gps", "raw/b.kml", "raw/b.out", "raw/b.prn", "raw/c.geojson", "raw/d.pdf", "raw/m.toml"];
    let folder = others.iter().fold(Folder::new().with("raw/a.gpx", &log), |folder, name| folder.with(name, &log));
    let said = folder.done(&["import", "raw"]);
    let named = "skipped 6 files of other kinds (b.gps, b.kml, b.out, b.prn, c.geojson, ...)";
    assert!(said.err.contains(named), "{}", said.err);
    let said = folder.done(&["import", "raw/b.gps", "--out", "other"]);
    assert!(!said.err.contains("skipped") && folder.read("other/runs.csv").lines().count() == 2, "{}", said.err);
}

/// Both were left out without a word, as if the fields were empty.
#[test]
fn fields_that_hold_no_number_are_counted() {
    let rows = drive(&STOPS_M, 25.0);
    let text = table("time_s,location_m,speed_kmh", &rows, |t, x, v| match t as u32 % 100 {
        7 => format!("{t},{x:.1},inf"),
        17 => format!("{t},-Infinity,{:.1}", 3.6 * v),
        27 | 37 => format!("{t},{x:.1},NaN"),
        _ => format!("{t},{x:.1},{:.1}", 3.6 * v),
    });
    let count = |field: &str| text.lines().filter(|line| line.split(',').any(|read| read == field)).count();
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    let counts = &folder.json("runs/import.json")["counts"];
    assert_eq!(counts["fields that cannot be read, taken as missing"], count("inf") + count("-Infinity"));
    assert_eq!(counts["fields with NaN, taken as empty"], count("NaN"));
    assert!(said.out.contains(&format!("fields with NaN, taken as empty: {}", count("NaN"))), "{said:?}");
    // Tables write NaN into empty fields: nothing is warned of.
    let folder = Folder::new().with("a.csv", &text.replace("-Infinity", "NaN").replace("inf", "NaN"));
    folder.done(&["import", "--strict", "a.csv"]);
}

#[test]
fn text_that_is_packed_is_read_as_it_is() {
    let rows = drive(&STOPS_M[..3], 30.0);
    let text = table("time_s,location_m,speed_kmh", &rows, |t, x, v| format!("{t},{x:.1},{:.1}", 3.6 * v));
    let folder = Folder::new().with("a.csv", &text).with("logs/note.txt.xz", "").with("b.csv.zst", &text);
    let packed = std::fs::File::create(folder.path("logs/a.csv.gz")).unwrap();
    let mut packed = flate2::write::GzEncoder::new(packed, flate2::Compression::default());
    std::io::Write::write_all(&mut packed, text.as_bytes()).unwrap();
    packed.finish().unwrap();
    folder.done(&["import", "a.csv", "--chainage", "as-is"]);
    let said = folder.done(&["import", "logs", "--chainage", "as-is", "--out", "of_packed"]);
    assert_eq!(csv(&folder, "of_packed/a_01.csv"), csv(&folder, "runs/a_01.csv"));
    assert!((said.out + &said.err).contains("skipped 1 file: 1 compressed, to be unpacked first (note.txt.xz)"));
    // Beside what it was made from it is the same log; beside another file of this name a log of its own.
    for (beside, runs) in [(text.clone(), 1), (text.replacen("\n0,0.0,0.0", "\n0,0.4,0.0", 1), 2)] {
        folder.write("logs/a.csv", &beside);
        let said = folder.done(&["import", "logs", "--chainage", "as-is", "--out", "of_both"]);
        assert_eq!(folder.json("of_both/import.json")["runs"].as_array().unwrap().len(), runs);
        assert_eq!(said.err.contains("1 compressed file holds what a file beside it holds: read once"), runs == 1);
    }
    let said = folder.rundown(&["import", "b.csv.zst"]);
    assert!(said.err.contains("expected text, or text packed by gzip, found .zst: unpack it first"), "{}", said.err);
}

#[test]
fn minutes_that_are_written_at_the_end_of_the_file_are_a_run_of_their_time() {
    // Over a day of three runs; what the first of them could not send comes last.
    let rows = drive(&STOPS_M, 25.0);
    let end_s = rows.last().unwrap().0;
    let all: Vec<(f64, f64, f64)> = (0..3)
        .flat_map(|run| rows.iter().map(move |(t, x, v)| (f64::from(run) * (end_s + 1500.0) + t, *x, *v)))
        .collect();
    let (late, in_time): (Vec<_>, Vec<_>) = all.into_iter().partition(|row| (100.0..400.0).contains(&row.0));
    let line = |t: f64, x: f64, v: f64| format!("2025-03-04T{}Z,{x:.1},{:.1}", clock(21_600.0 + t), 3.6 * v);
    let text = table("time,location_m,speed_kmh", &[in_time, late].concat(), line);
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    assert!(said.out.contains("the time goes back by") && said.out.contains("to another place"), "{}", said.out);
    let index = folder.read("runs/runs.csv");
    assert_eq!(index.lines().count(), 5, "{index}");
    assert!(index.contains("2025-03-04T06:01:40Z"), "the run of the late rows begins at its own time: {index}");
    for name in ["a_01", "a_03"] {
        let run = csv(&folder, &format!("runs/{name}.csv"));
        assert!(last(&run)[1] < 12_000.0, "no odometer is joined over what is missing: {:?}", last(&run));
    }
}

#[test]
fn what_is_sent_late_in_the_middle_of_a_run_interrupts_nothing() {
    let rows = drive(&STOPS_M, 25.0);
    let end_s = rows.last().unwrap().0;
    let line = |t: f64, x: f64, v: f64| format!("2025-03-04T{}Z,{x:.1},{:.1}", clock(21_600.0 + t), 3.6 * v);
    // Of a run in the morning minutes are missing; they come in the middle of the next one.
    let (late, first): (Vec<_>, Vec<_>) = rows.iter().copied().partition(|row| (100.0..400.0).contains(&row.0));
    let next: Vec<_> = rows.iter().map(|(t, x, v)| (t + end_s + 3000.0, 11_900.0 - x, *v)).collect();
    let all = [first, next[..600].to_vec(), late, next[600..].to_vec()].concat();
    let folder = Folder::new().with("a.csv", &table("time,location_m,speed_kmh", &all, line));
    folder.done(&["import", "a.csv"]);
    let index = folder.read("runs/runs.csv");
    let runs: Vec<usize> =
        (1..index.lines().count()).map(|i| csv(&folder, &format!("runs/a_{i:02}.csv")).len()).collect();
    assert!(runs.contains(&next.len()) && runs.contains(&300), "{runs:?} of {}: {index}", next.len());
}
