//! What a column means: units, clocks and names by evidence, and what is asked.

use super::*;

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
fn times_whose_parts_have_columns_of_their_own_are_put_together() {
    let rows = drive(&STOPS_M, 30.0);
    let begin_s = 23.0 * 3600.0 + 58.0 * 60.0;
    let plain = |t: f64| clock(begin_s + t).split(':').map(|part| part.parse::<u32>().unwrap()).collect::<Vec<_>>();
    let dated = |t: f64| if begin_s + t < 86_400.0 { "2024;2;29" } else { "2024;3;1" };
    let german = table("Jahr;Monat;Tag;Std;Min;Sek;Weg [km];v [km/h]", &rows, |t, x, v| {
        let [h, m, s] = plain(t)[..] else { panic!() };
        format!("{};{h};{m};{s};{:.4};{:.1}", dated(t), x / 1000.0, 3.6 * v).replace('.', ",")
    });
    // The seconds are a part, and no clock; `s` is no location.
    let english = table("hh,mm,s,ms,location_m,speed_kmh", &rows, |t, x, v| {
        let parts = clock(begin_s + t).replace(':', ",");
        format!("{parts},250,{x:.1},{:.1}", 3.6 * v)
    });
    for (text, departure) in [(german, Some("2024-02-29T23:58:00Z")), (english, None)] {
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv"]);
        let found = csv(&folder, "runs/a_01.csv");
        assert_eq!(found.len(), rows.len(), "{}", said.err);
        near(last(&found)[0] - found[0][0], rows.last().unwrap().0, 0.002);
        assert!(departure.is_none_or(|departure| folder.read("runs/runs.csv").contains(departure)), "{}", said.err);
        folder.done(&["import", "--mapping", "runs/import.toml", "--out", "again"]);
        assert_eq!(folder.read("runs/a_01.csv"), folder.read("again/a_01.csv"));
    }
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
fn parts_of_units_are_read_and_a_wrong_unit_of_the_mapping_is_warned_of() {
    let rows = drive(&STOPS_M, 30.0);
    let fastest = |folder: &Folder, name: &str| csv(folder, name).iter().map(|row| row[2]).fold(0.0, f64::max);
    for (header, factor) in [
        ("time_s,location_m,v [0.1 km/h]", 36.0),
        ("time_s,location_m,speed_01kmh", 36.0),
        ("time_s,location_m,speed", 36.0),
        ("time_s,location_m,speed", 360.0),
        ("time_s,location_m,speed (cm/s)", 100.0),
        ("time_s,location_m,speed", 1000.0),
    ] {
        let folder =
            Folder::new().with("a.csv", &table(header, &rows, |t, x, v| format!("{t},{x:.1},{:.0}", factor * v)));
        folder.done(&["import", "a.csv", "--strict"]);
        near(fastest(&folder, "runs/a_01.csv"), 108.0, 0.1);
    }
    let positions = table("time_s,lat,lon,speed", &rows, |t, x, v| {
        let (latitude, longitude) = place(x, 0.0);
        format!("{t},{latitude:.7},{longitude:.7},{:.0}", 36.0 * v)
    });
    let locations = table("time_s,location_m,speed", &rows, |t, x, v| format!("{t},{x:.1},{:.0}", 36.0 * v));
    let said = "[[source]]\ncolumns.speed = { name = \"speed\", unit = \"km/h\" }\n";
    let folder = Folder::new().with("p.csv", &positions).with("l.csv", &locations).with("m.toml", said);
    for name in ["p", "l"] {
        let (file, log) = (format!("{name}.csv"), format!("right/{name}_01.csv"));
        let said = folder.done(&["import", &file, "--mapping", "m.toml"]);
        assert!(said.err.contains("units of the mapping are believed: expected 1, found: "), "{}", said.err);
        let strict = folder.rundown(&["import", &file, "--mapping", "m.toml", "--strict", "--out", "strict"]);
        assert_eq!(strict.code, Some(1), "{}", strict.err);
        folder.write("right.toml", &to_write(&said.err[said.err.find("are believed").unwrap()..]));
        folder.done(&["import", &file, "--mapping", "right.toml", "--out", "right", "--chainage", "as-is"]);
        near(fastest(&folder, &log), 108.0, 0.1);
    }
}

#[test]
fn speed_and_location_every_ten_seconds_decide_a_unit_and_where_none_does_the_reason_is_said() {
    let stops_m: Vec<f64> = (0..20).map(|stop| 1800.0 * f64::from(stop)).collect();
    let rows = drive(&stops_m, 20.0);
    let thin: Vec<(f64, f64, f64)> = rows.iter().filter(|(t, ..)| t % 10.0 == 0.0).copied().collect();
    let text = |rows: &[(f64, f64, f64)]| table("time_s,location_m,v", rows, |t, x, v| format!("{t},{x:.1},{v:.2}"));
    let posts = table("time_s,location,v [km/h]", &rows, |t, x, v| format!("{t},0/{x:.0},{:.1}", 3.6 * v));
    let hops: Vec<f64> = (0..20).map(|stop| 90.0 * f64::from(stop)).collect();
    let folder = Folder::new()
        .with("thin.csv", &text(&thin))
        .with("short.csv", &text(&rows[..60]))
        .with("hops.csv", &text(&drive(&hops, 20.0).into_iter().step_by(4).collect::<Vec<_>>()))
        .with("posts.csv", &posts);
    folder.done(&["import", "thin.csv", "--strict"]);
    near(csv(&folder, "runs/thin_01.csv").iter().map(|row| row[2]).fold(0.0, f64::max), 72.0, 0.1);
    for (name, why) in [
        ("short.csv", "time, speed and location stand together in 60 rows only"),
        ("hops.csv", "the train hardly ever keeps moving for 5 locations on end"),
        ("posts.csv", "column \"location\" holds no number that can be read"),
    ] {
        let said = folder.rundown(&["import", name, "--out", "none"]);
        assert!(said.code == Some(6) && said.err.contains(why), "{name}: {}", said.err);
    }
}

/// A location in every fifth row, rows that come five at a time, and a location that is held for 30 s: none has twenty
/// even rows that go on.
#[test]
fn sparse_held_and_burst_columns_decide_units_as_even_ones_do() {
    let rows = drive(&[0.0, 20e3, 45e3, 70e3], 30.0);
    let sparse = table("time_s,location,speed", &rows, |t, x, v| {
        let place = if t % 5.0 == 0.0 { format!("{x:.0}") } else { String::new() };
        format!("{t},{place},{:.1}", 3.6 * v)
    });
    let burst = table("time_s,location,speed", &rows, |t, x, v| {
        let sent = 5.0 * (t / 5.0).floor() + 0.02 * (t % 5.0);
        format!("{sent:.2},{x:.1},{:.1}", 3.6 * v)
    });
    let read_m = |t: f64| rows.iter().rfind(|row| row.0 <= t && (row.0 % 30.0 == 0.0 || row.2 < 10.0)).unwrap().1;
    let held =
        table("time_s,location [m],speed [km/h]", &rows, |t, _, v| format!("{t},{:.0},{:.1}", read_m(t), 3.6 * v));
    let folder = Folder::new().with("sparse.csv", &sparse).with("burst.csv", &burst).with("held.csv", &held);
    for name in ["sparse", "burst", "held"] {
        folder.done(&["import", &format!("{name}.csv"), "--out", name]);
        let speeds = csv(&folder, &format!("{name}/{name}_01.csv"));
        near(speeds.iter().map(|row| row[2]).fold(0.0, f64::max), 108.0, 0.1);
    }
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
    for header in ["Geschw. [km/h]", "Tempo (km/h)", "Vit. [km/h]", "abiadura_kmh"] {
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
    let (said, _) = imported(&folder, "t [s],x [m],Muga [km/h],Abiadura", |_| 100.0);
    assert!(said.err.contains("\"Muga [km/h]\" has the unit of a speed without being one"), "{said:?}");
    // One that says what it is needs no test: in this one it follows the speed.
    let folder = Folder::new();
    let (said, _) = imported(&folder, "t [s],x [m],target_speed [km/h],Abiadura", |v| 3.6 * v);
    assert!(said.err.contains("columns.speed = { name = \"Abiadura\" }"), "{said:?}");
    let folder = Folder::new();
    let (said, _) = imported(&folder, "t [s],x [m],Abiadura,Status", |v| 3.6 * v);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(said.err.contains("not used: \"Abiadura\", \"Status\""), "{said:?}");
    folder.write("map.toml", &to_write(&said.err));
    let said = folder.rundown(&["import", "in.csv", "--mapping", "map.toml", "--out", "again"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(!said.err.contains("computed from"), "{said:?}");
    assert_eq!(csv(&folder, "again/in_01.csv")[20][2], 0.0);
}

/// Of one file, whose first runs say what the units are.
#[test]
fn a_unit_that_changes_within_a_file_is_pointed_out() {
    let rows = drive(&STOPS_M, 25.0);
    let days: Vec<_> =
        (0..3).flat_map(|day| rows.iter().map(move |(t, x, v)| (5000.0 * f64::from(day) + t, *x, *v))).collect();
    for (from_s, count) in [(10_000.0, Some(1)), (1e9, None)] {
        let text = table("t [s],x [m],v [km/h]", &days, |t, x, v| {
            format!("{t},{x:.1},{}", if t < from_s { 3.6 * v } else { v })
        });
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv"]);
        let found =
            folder.json("runs/import.json")["counts"]["runs in which location and speed disagree, as of another unit"]
                .as_u64();
        assert_eq!(found, count, "{}", said.out);
    }
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

#[test]
fn a_file_that_denies_the_header_it_shares_is_asked_of_and_spoils_no_other() {
    let rows = drive(&STOPS_M, 30.0);
    let header = "time_s,location_m,speed_kmh";
    let good = table(header, &rows, |t, x, v| format!("{t},{x:.1},{:.1}", 3.6 * v));
    let slow = table(header, &rows, |t, x, v| format!("{t},{x:.1},{v:.2}"));
    let far = table(header, &rows, |t, x, v| format!("{t},{:.4},{:.1}", x / 1000.0, 3.6 * v));
    let dated = table(header, &rows, |t, x, v| format!("2025-01-31T{}Z,{x:.1},{:.1}", clock(36_000.0 + t), 3.6 * v));
    let folder =
        Folder::new().with("good.csv", &good).with("slow.csv", &slow).with("far.csv", &far).with("dated.csv", &dated);
    let alone = folder.done(&["import", "good.csv", "--out", "alone"]);
    assert!(alone.err.is_empty() || !alone.err.contains("error"), "{}", alone.err);
    let good_alone = folder.read("alone/good_01.csv");
    for (others, asked) in [
        (vec!["slow.csv"], vec![("slow.csv", "unit = \"m/s\"")]),
        (vec!["far.csv"], vec![("far.csv", "unit = \"km\"")]),
        (vec!["slow.csv", "far.csv"], vec![("slow.csv", "unit = \"m/s\""), ("far.csv", "unit = \"km\"")]),
        (vec!["dated.csv"], vec![]),
    ] {
        let files: Vec<&str> = others.iter().copied().chain(["good.csv"]).collect();
        let said = folder.rundown(&[&["import", "--out", "runs"], &files[..]].concat());
        assert_eq!(said.code, Some(i32::from(!asked.is_empty())), "{}", said.err);
        for (file, line) in asked {
            let has = |text: &&str| text.contains(file) && text.contains(line);
            assert!(said.err.lines().any(|text| has(&text)), "{file}: {line} in {}", said.err);
        }
        assert_eq!(folder.read("runs/good_01.csv"), good_alone, "{others:?}");
        if others == ["dated.csv"] {
            near(last(&csv(&folder, "runs/dated_01.csv"))[0], rows.last().unwrap().0, 1e-6);
        }
        std::fs::remove_dir_all(folder.path("runs")).unwrap();
    }
}

#[test]
fn an_index_beside_the_files_stays() {
    let rows = drive(&STOPS_M, 30.0);
    let log = table("time_s,location_m,speed_kmh", &rows, |t, x, v| format!("{t},{x:.1},{:.1}", 3.6 * v));
    let index = "file,departure_utc,unit,direction,driver\na.csv,2025-03-01T08:00:00Z,7,up,ann\nb.csv,2025-03-02T08:00:00Z,9,up,ben\n";
    let folder = Folder::new().with("in/a.csv", &log).with("in/b.csv", &log).with("in/runs.csv", index);
    folder.done(&["import", "in"]);
    let kept = folder.read("runs/runs.csv");
    let expected = ["a_01.csv,2025-03-01T08:00:00Z,7,up,ann", "b_01.csv,2025-03-02T08:00:00Z,9,up,ben"];
    assert!(expected.iter().all(|line| kept.contains(line)), "{kept}");
}

#[test]
fn times_of_the_day_with_dots_are_no_dates() {
    let rows = drive(&STOPS_M, 30.0);
    let begin_s = 23.0 * 3600.0 + 50.0 * 60.0;
    let dotted = |t: f64| clock(begin_s + t).replace(':', ".");
    let day = |t: f64| if begin_s + t < 86_400.0 { "14.01.2025" } else { "15.01.2025" };
    let of = |header: &str, written: &dyn Fn(f64) -> String| {
        table(header, &rows, |t, x, v| {
            format!("{}\t{}\t{}", written(t), format!("{:.1}", 3.6 * v).replace('.', ","), x.round())
        })
    };
    let two = of("Data\tOra\tVelocit\u{e0} [km/h]\tProgressiva [m]", &|t| format!("{}\t{}", day(t), dotted(t)));
    let one = of("Data e ora\tVelocit\u{e0} [km/h]\tProgressiva [m]", &|t| format!("{} {}", day(t), dotted(t)));
    // Each of its times may be a date, in some order.
    let early: Vec<(f64, f64, f64)> = drive(&STOPS_M[..2], 30.0).into_iter().filter(|row| row.0 < 700.0).collect();
    let early_text = table("Data\tOra\tkm/h\tProgressiva [m]", &early, |t, x, v| {
        format!("14.01.2025\t{}\t{:.1}\t{}", clock(6.0 * 3600.0 + 60.0 + t).replace(':', "."), 3.6 * v, x.round())
    });
    let alone = of("Ora\tVelocit\u{e0} [km/h]\tProgressiva [m]", &|t| format!("{},5", dotted(t)));
    let said = "[[source]]\n[source.columns]\ntime = { name = \"Ora\", kind = \"time_of_day\" }\n";
    let folder = Folder::new().with("two.csv", &two).with("one.csv", &one).with("alone.csv", &alone);
    let folder = folder.with("early.csv", &early_text);
    let folder = folder.with("m.toml", &format!("{said}date = {{ name = \"Data\", order = \"dmy\" }}\n"));
    let departed = Some("2025-01-14T23:50:00Z");
    for (name, mapping, departure) in [
        ("two.csv", None, departed),
        ("two.csv", Some("m.toml"), departed),
        ("one.csv", None, departed),
        ("alone.csv", None, None),
        ("early.csv", None, Some("2025-01-14T06:01:00Z")),
    ] {
        let mapped: Vec<&str> = mapping.iter().flat_map(|mapping| ["--mapping", mapping]).collect();
        let said = folder.done(&[&["import", name, "--out", "runs"], &mapped[..]].concat());
        let found = csv(&folder, &format!("runs/{}_01.csv", name.split('.').next().unwrap()));
        let rows = if name == "early.csv" { &early } else { &rows };
        assert_eq!(found.len(), rows.len(), "{name}: {}", said.err);
        near(last(&found)[0] - found[0][0], rows.last().unwrap().0, 0.002);
        let index = folder.read("runs/runs.csv");
        assert!(departure.is_none_or(|departure| index.contains(departure)), "{name}: {index}");
        folder.done(&["import", "--mapping", "runs/import.toml", "--out", "again"]);
        assert_eq!(index, folder.read("again/runs.csv"), "{name}");
    }
}

#[test]
fn a_column_that_stands_twice_or_has_no_part_is_said_as_it_is() {
    let rows = drive(&STOPS_M, 30.0);
    let twice = table("time_s,location_m,speed_kmh,speed_kmh,colour", &rows, |t, x, v| {
        format!("{t},{x:.1},{:.1},{:.1},red", 3.6 * v, 3.6 * v)
    });
    let other = table("time_s,location_m,speed_kmh,gps speed [km/h]", &rows, |t, x, v| {
        format!("{t},{x:.1},{:.1},{:.1}", 3.6 * v, 3.6 * v)
    });
    let folder = Folder::new().with("twice.csv", &twice).with("other.csv", &other);
    let said = folder.done(&["import", "twice.csv"]).err;
    let line = "column \"speed_kmh\" stands 2 times (#3, #4): #3 is used; for another one write this into a file for \
                --mapping: source = [{ columns.speed = { name = \"#4\" } }]";
    assert!(said.contains(line), "{said}");
    assert!(said.contains("not used, for no name of theirs is known: \"colour\"\n"), "{said}");
    folder.write("m.toml", &to_write(line));
    folder.done(&["import", "twice.csv", "--mapping", "m.toml", "--out", "fourth"]);
    folder.done(&["import", "--mapping", "fourth/import.toml", "--out", "again"]);
    assert_eq!(folder.read("fourth/import.toml"), folder.read("again/import.toml"));
    assert!(folder.read("again/import.toml").contains("name = \"#4\""));
    folder.write(
        "wrong.csv",
        &table("time_s,location_m,speed_kmh,speed_kmh", &rows, |t, x, v| {
            format!("{t},{x:.1},{:.1},{:.1}", 1.8 * v, 3.6 * v)
        }),
    );
    let said = folder.rundown(&["import", "wrong.csv"]).err;
    assert!(said.contains("is 2.0000 with these units") && said.contains(line), "{said}");
    let said = folder.done(&["import", "other.csv"]).err;
    let line = "not used, for another column has the speed (\"speed_kmh\"): \"gps speed [km/h]\"";
    assert!(said.contains(line) && !said.contains("no name of theirs"), "{said}");
}

#[test]
fn a_speed_that_is_signed_by_direction_is_read_without_its_sign_and_single_ones_are_wrong() {
    let there = drive(&STOPS_M, 30.0);
    let end_s = there.last().unwrap().0 + 1.0;
    let back = there.iter().map(|(t, x, v)| (end_s + t, 11_900.0 - x, -v));
    let both: Vec<(f64, f64, f64)> = there.iter().copied().chain(back.clone()).collect();
    let back: Vec<(f64, f64, f64)> = back.collect();
    let glitches: Vec<(f64, f64, f64)> =
        there.iter().map(|(t, x, v)| (*t, *x, if t % 97.0 == 50.0 { -v } else { *v })).collect();
    // An odometer counts on; the units are found by evidence, too.
    let counts_on: Vec<(f64, f64, f64)> =
        both.iter().map(|(t, x, v)| (*t, if *t < end_s { *x } else { 23_800.0 - x }, *v)).collect();
    let text =
        |header: &str, rows: &[(f64, f64, f64)]| table(header, rows, |t, x, v| format!("{t},{x:.1},{:.1}", 3.6 * v));
    let named = "time_s,location_m,speed_kmh";
    for (header, rows, runs) in
        [(named, &both, 2), ("time_s,Weg,v", &both, 2), (named, &back, 1), (named, &counts_on, 1)]
    {
        let folder = Folder::new().with("a.csv", &text(header, rows));
        let said = folder.done(&["import", "a.csv"]);
        assert!(
            said.err.contains("is taken for the direction of travel") && !said.out.contains("below zero"),
            "{said:?}"
        );
        let last_run = csv(&folder, &format!("runs/a_{runs:02}.csv"));
        near(last_run.iter().map(|row| row[2]).fold(0.0, f64::max), 108.0, 0.1);
        assert!(last_run.iter().all(|row| row[2] >= 0.0), "{runs}");
        folder.done(&["import", "--mapping", "runs/import.toml", "--out", "again"]);
        assert_eq!(folder.read("runs/a_01.csv"), folder.read("again/a_01.csv"));
        assert!(folder.read("again/import.toml").contains("signed = true"));
    }
    let denied = "[[source]]\ncolumns.speed = { name = \"speed_kmh\", signed = false }\n";
    let folder =
        Folder::new().with("g.csv", &text(named, &glitches)).with("b.csv", &text(named, &both)).with("m.toml", denied);
    for arguments in [&["import", "g.csv", "--out", "g"][..], &["import", "b.csv", "--out", "b", "--mapping", "m.toml"]]
    {
        let said = folder.done(arguments);
        assert!(
            !said.err.contains("direction of travel") && said.out.contains("below zero, taken as missing"),
            "{said:?}"
        );
    }
    // A few steps between stops a street apart say nothing; a person does.
    let hops_m: Vec<f64> = (0..20).map(|stop| 90.0 * f64::from(stop)).collect();
    let hops: Vec<(f64, f64, f64)> =
        drive(&hops_m, 20.0).into_iter().step_by(4).map(|(t, x, v)| (t, 1710.0 - x, -v)).collect();
    let folder = Folder::new().with("h.csv", &text(named, &hops));
    let said = folder.done(&["import", "h.csv"]);
    assert!(said.err.contains("does not show that the train goes back"), "{said:?}");
    folder.write("m.toml", &to_write(&said.err));
    let said = folder.done(&["import", "h.csv", "--mapping", "m.toml", "--out", "said"]);
    assert!(
        !said.out.contains("below zero") && csv(&folder, "said/h_01.csv").iter().all(|row| row[2] >= 0.0),
        "{said:?}"
    );
}

#[test]
fn a_date_that_turns_beside_midnight_is_put_right() {
    let rows = drive(&STOPS_M, 30.0);
    let begin_s = 86_400.0 - 200.0;
    let text = |lag_s: f64| {
        table("Datum;Uhrzeit;Weg [m];v [km/h]", &rows, |t, x, v| {
            let day = if begin_s + t < 86_400.0 + lag_s { "30.03.2024" } else { "31.03.2024" };
            format!("{day};{};{x:.0};{:.1}", clock(begin_s + t), 3.6 * v).replace('.', ",").replace(",03,", ".03.")
        })
    };
    let written = |lag_s: f64, zone: &str| {
        let folder = Folder::new().with("a.csv", &text(lag_s));
        folder.write("z.toml", &format!("[[source]]\nzone = {zone:?}\n"));
        let said = folder.done(&["import", "a.csv", "--mapping", "z.toml"]).out;
        (folder.read("runs/a_01.csv"), folder.read("runs/runs.csv"), said)
    };
    for zone in ["UTC", "Europe/Berlin"] {
        let (log, index, said) = written(0.0, zone);
        assert!(!said.contains("whose date turned"), "{said}");
        for lag_s in [3.0, 80.0, -3.0, -80.0] {
            let (found, found_index, said) = written(lag_s, zone);
            assert!(
                said.contains(&format!("whose date turned before or after midnight, put right: {:.0}\n", lag_s.abs())),
                "{said}"
            );
            assert_eq!((found, found_index), (log.clone(), index.clone()), "{lag_s} {zone}");
        }
    }
}

#[test]
fn forces_of_traction_and_brake_in_two_columns_are_one_effort() {
    let rows = drive(&STOPS_M, 30.0);
    let mapping = "[[source]]\nrotating_mass_kg = 400000.0\n";
    // 40 kN of traction in the first minute, 80 kN of the brake in the second, then nothing.
    let traction = |t: f64| if t < 60.0 { "40,0" } else { "0,0" };
    for (brake, idle) in [("80,0", "0,0"), ("-80,0", "0,0"), ("80,0", ""), ("80,0", "-0,1")] {
        let text = table("Zeit [s];Weg [km];v [km/h];Zugkraft [kN];Bremskraft [kN]", &rows, |t, x, v| {
            let released = if idle.is_empty() { "" } else { "0,0" };
            let braking = if (60.0..120.0).contains(&t) { brake } else { released };
            let km = format!("{:.4};{:.1}", x / 1000.0, 3.6 * v).replace('.', ",");
            format!("{t:.0};{km};{};{braking}", if t < 120.0 { traction(t) } else { idle })
        });
        let folder = Folder::new().with("a.csv", &text).with("m.toml", mapping);
        folder.done(&["import", "--mapping", "m.toml", "a.csv"]);
        let log = folder.read("runs/a_01.csv");
        let column = log.lines().next().unwrap().split(',').position(|name| name == "effort_n_per_kg").unwrap();
        let effort = |row: usize| log.lines().nth(row + 1).unwrap().split(',').nth(column).unwrap().parse::<f64>().ok();
        assert_eq!((effort(30), effort(90)), (Some(0.1), Some(-0.2)), "{brake}");
        let idle: Option<f64> = idle.replace(',', ".").parse().ok();
        assert_eq!(effort(150), idle.map(|kn| kn / 400.0));
    }
}

#[test]
fn a_column_that_only_says_whether_the_train_brakes_is_no_force() {
    let rows = drive(&STOPS_M, 30.0);
    let text = table("time_s,location_m,speed_kmh,effort_n_per_kg,braking", &rows, |t, x, v| {
        format!("{t},{x:.1},{:.1},0.25,{}", 3.6 * v, u8::from(t > 100.0))
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    assert!(said.err.contains("column \"braking\" is not used: its unit is not known"), "{}", said.err);
    let log = folder.read("runs/a_01.csv");
    assert!(log.lines().skip(1).all(|line| line.contains("0.25")), "{log}");
}

#[test]
fn metres_in_groups_of_thousands_are_read_beside_speeds_with_decimals() {
    let rows = drive(&STOPS_M, 30.0);
    let grouped = |x: f64, sign: &str| {
        let whole = format!("{:.0}", x);
        match whole.len().checked_sub(3) {
            Some(at) if at > 0 => format!("{}{sign}{}", &whole[..at], &whole[at..]),
            _ => whole,
        }
    };
    for (sign, decimal) in [(".", ","), (",", ".")] {
        let text = table("time [s];location;speed [km/h]", &rows, |t, x, v| {
            format!("{t:.0};{};{}", grouped(x, sign), format!("{:.1}", 3.6 * v).replace('.', decimal))
        });
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv"]);
        let found = csv(&folder, "runs/a_01.csv");
        assert_eq!(found.len(), rows.len(), "{}", said.err);
        near(last(&found)[1] - found[0][1], rows.last().unwrap().1 - rows[0].1, 2.0);
    }
}

#[test]
fn a_counter_of_tenths_and_hundredths_of_a_second_is_recognised() {
    let rows = drive(&STOPS_M, 30.0);
    for (per_s, unit) in [(10.0, "0.1 s"), (100.0, "0.01 s"), (1.0, "s")] {
        let text = table("t,location_m,speed_kmh", &rows, |t, x, v| format!("{:.0},{x:.1},{:.1}", per_s * t, 3.6 * v));
        let folder = Folder::new().with("a.csv", &text);
        folder.done(&["import", "a.csv"]);
        let found = csv(&folder, "runs/a_01.csv");
        near(last(&found)[0] - found[0][0], rows.last().unwrap().0, 0.002);
        assert!(folder.read("runs/import.toml").contains(&format!("unit = \"{unit}\"")), "{unit}");
    }
}
