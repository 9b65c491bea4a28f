//! Runs come onto one chainage: odometers, stops, ways there and back.

use super::*;

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
fn ways_there_and_back_over_a_wrap_are_of_one_chainage() {
    let there = drive(&STOPS_M, 30.0);
    let text = |place: fn(f64) -> f64| {
        table("time_s,location_m,speed_kmh", &there, |t, x, v| {
            format!("{t},{:.0},{:.1}", (60_000.0 + place(x)) % 65_536.0, 3.6 * v)
        })
    };
    let [up, down] = [text(|x| x), text(|x| 11_900.0 - x)];
    let folder = Folder::new().with("a.csv", &up).with("b.csv", &down).with("c.csv", &up);
    folder.done(&["import", "a.csv", "b.csv", "c.csv"]);
    let ends = |name: &str| {
        let found = csv(&folder, name);
        (found[0][1], last(&found)[1])
    };
    assert_eq!([ends("runs/a_01.csv"), ends("runs/b_01.csv")], [(60_000.0, 71_900.0), (71_900.0, 60_000.0)]);
    let how = &folder.json("runs/import.json")["runs"][1]["placed"]["how"];
    assert!(how.as_str().unwrap_or_default().contains("by +1 turns, onto "), "{how}");
}

/// Its speeds were 60 000 km/h, and the way back was cut where it wraps.
#[test]
fn a_way_there_and_back_over_a_wrap_is_joined_without_a_speed_too() {
    let there: Vec<_> = drive(&STOPS_M, 30.0).into_iter().step_by(10).collect();
    let begins_back_s = there[there.len() - 1].0 + 200.0;
    let back = there.iter().map(|(t, x, v)| (begins_back_s + t, 11_900.0 - x, *v));
    let rows: Vec<_> = there.iter().copied().chain(back).collect();
    let read_m = |x: f64| (60_000.0 + x) % 65_536.0;
    let with = table("time_s,odometer_m,speed_kmh", &rows, |t, x, v| format!("{t},{:.0},{:.1}", read_m(x), 3.6 * v));
    let without = table("time_s,odometer_m", &rows, |t, x, _| format!("{t},{:.0}", read_m(x)));
    for text in [with, without] {
        let folder = Folder::new().with("a.csv", &text);
        folder.done(&["import", "a.csv"]);
        let found = [csv(&folder, "runs/a_01.csv"), csv(&folder, "runs/a_02.csv")];
        for (rows, [from_m, to_m]) in found.iter().zip([[60_000.0, 71_900.0], [71_900.0, 60_000.0]]) {
            near(rows[0][1], from_m, 1.0);
            near(last(rows)[1], to_m, 1.0);
            assert!(rows.iter().all(|row| row[2] < 115.0), "{rows:?}");
        }
        assert!(!folder.path("runs/a_03.csv").exists());
        assert_eq!(folder.json("runs/import.json")["counts"]["odometers that wrapped, joined"], 2);
    }
}

#[test]
fn locations_in_steps_of_100_m_make_no_speeds() {
    let rows = drive(&STOPS_M, 30.0);
    for (step_m, speeds) in [(100.0, false), (10.0, true)] {
        let text = table("time_s,odometer_m", &rows, |t, x, _| format!("{t},{:.0}", (x / step_m).floor() * step_m));
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv"]);
        let found = csv(&folder, "runs/a_01.csv");
        assert_eq!(found.iter().any(|row| row[2] > 0.0), speeds, "{step_m}");
        assert_eq!(said.out.contains("locations are too coarse for speeds"), !speeds, "{}", said.out);
    }
}

#[test]
fn rows_of_another_train_in_one_file_are_pointed_out() {
    let rows = drive(&STOPS_M, 30.0);
    let line = |t: f64, x: f64, v: f64| format!("{t},{x:.1},{:.1}", 3.6 * v);
    let both = table("time_s,location_m,speed_kmh", &rows, |t, x, v| {
        format!("{}\n{}", line(t, x, v), line(t, 30_000.0 - x, v))
    });
    let twice = table("time_s,location_m,speed_kmh", &rows, |t, x, v| format!("{}\n{}", line(t, x, v), line(t, x, v)));
    for (text, is_other) in [(both, true), (twice, false)] {
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv"]);
        assert_eq!(said.out.contains("another train?"), is_other, "{}", said.out);
    }
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

/// Whether it has seven stops or four: a shift alone would leave the ends 150 m apart, or the run out.
#[test]
fn an_odometer_with_the_distances_of_another_wheel_is_put_right_by_the_stops_of_a_track() {
    let stops =
        |at: &[f64]| -> String { at.iter().map(|at| format!("[[stop]]\nat_m = {at}\nname = \"S\"\n")).collect() };
    let four = [0.0, 3_200.0, 7_900.0, 11_900.0];
    for (stops_m, too_long) in [(&STOPS_M[..], 1.025), (&four, 1.025), (&four, 0.978)] {
        let rows = drive(stops_m, 30.0);
        let folder = Folder::new();
        let text = table("Time [s],Odometer [m],Speed [km/h]", &rows, |t, x, v| {
            format!("{t},{:.0},{:.1}", 700_000.0 + too_long * x, 3.6 * too_long * v)
        });
        folder.write("log.csv", &text);
        folder.write("line.toml", &format!("name = \"line\"\nlength_m = 12000.0\n{}", stops(stops_m)));
        let said = folder.done(&["import", "log.csv", "--track", "line.toml", "--out", "runs"]);
        assert!(
            said.out.contains("runs with distances of another wheel, put right by the stops of the track"),
            "{said:?}"
        );
        let rows = csv(&folder, "runs/log_01.csv");
        near(rows[0][1], 0.0, 25.0);
        near(last(&rows)[1], 11_900.0, 25.0);
        let scale = &folder.json("runs/import.json")["runs"][0]["placed"]["scale"];
        near(scale.as_f64().unwrap(), 1.0 / too_long, 0.003);
    }
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
    folder.done(&["simulate", "--runs", "67", "--out", "set"]);
    let said = folder.done(&["import", "set/runs", "--out", "there"]);
    assert!(said.out.contains("67 of 67 logs begin at 0, and 67 end at the same place"), "{}", said.out);
    let as_it_was = |run: &str| {
        let (was, is) = (csv(&folder, &format!("set/runs/{run}.csv")), csv(&folder, &format!("there/{run}_01.csv")));
        was.iter().zip(&is).all(|(was, is)| was[..3] == is[..3])
    };
    // Run 51 is slow at first, as if it came to its end: that the others go so decides.
    assert!((1..=67).all(|run| as_it_was(&format!("run{run:03}"))), "{}", folder.read("there/import.json"));

    // The same runs as those of trains that come back, each with an odometer of its own.
    let text = folder.read("set/runs/run007.csv");
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let (end_s, end_m) = (last(&rows)[0], last(&rows)[1]);
    let back: String =
        rows.iter().rev().map(|row| format!("{},{},{}\n", end_s - row[0], end_m - row[1], row[2])).collect();
    let folder = folder.with("set/runs/run007.csv", &format!("time_s,location_m,speed_kmh\n{back}"));
    let said = folder.rundown(&["import", "set/runs", "--out", "back"]);
    // Now that not all go one way, nothing tells where the slow one goes.
    assert_eq!((said.code, said.err.matches("is left out").count()), (Some(1), 1), "{}", said.err);
    assert!(said.err.contains("run051_01 is left out: ") && said.err.contains("--chainage as-is"), "{}", said.err);
    let index = folder.read("back/runs.csv");
    let down: Vec<&str> = index.lines().filter(|line| line.ends_with(",down")).collect();
    assert_eq!(down, ["run007_01.csv,2024-01-14T08:24:14Z,unit-1,down"]);
    near(csv(&folder, "back/run007_01.csv")[0][1], end_m, 100.0);
}

#[test]
fn positions_count_as_a_track_without_a_centre_line_by_its_stops_or_it_is_said_that_they_do_not() {
    let rows = drive(&STOPS_M, 25.0);
    let mut folder = Folder::new();
    for (name, beside, from) in [("a.gpx", 4.0, 0.0), ("b.gpx", -4.0, 11_900.0), ("c.gpx", 1.0, 0.0)] {
        folder = folder.with(name, &gpx(&rows, 0.0, beside, from));
    }
    let track = |stops_m: &[f64]| {
        let mut text = "name = \"k\"\nlength_m = 20000\n[[gradient]]\nfrom_m = 0\npermille = 0\n".to_owned();
        stops_m.iter().for_each(|at_m| text += &format!("[[stop]]\nat_m = {at_m}\nname = \"s\"\n"));
        text
    };
    let ends = |name: &str| {
        let rows = csv(&folder, name);
        (rows[0][1], last(&rows)[1])
    };
    // It counts from the other end, and begins 1500 m before.
    let stops_m: Vec<f64> = STOPS_M.iter().rev().map(|at_m| 13_400.0 - at_m).collect();
    folder.write("k.toml", &track(&stops_m));
    let said = folder.done(&["import", "a.gpx", "b.gpx", "c.gpx", "--track", "k.toml"]);
    assert!(
        !said.err.contains("not used, for those")
            && said.out.contains("the line is counted as the track is: 5 of 5 stops agree"),
        "{said:?}"
    );
    for (name, from_m, to_m) in [("a", 13_400.0, 1500.0), ("b", 1500.0, 13_400.0), ("c", 13_400.0, 1500.0)] {
        let (begin_m, end_m) = ends(&format!("runs/{name}_01.csv"));
        near(begin_m, from_m, 40.0);
        near(end_m, to_m, 40.0);
    }
    // Of another line.
    folder.write("other.toml", &track(&[500.0, 1500.0, 3900.0, 9100.0]));
    let others = ["import", "a.gpx", "b.gpx", "c.gpx", "--track", "other.toml", "--out", "other"];
    let said = folder.done(&others);
    assert!(said.err.contains("the track has no centre line, and its stops are not used"), "{said:?}");
    let strict = folder.rundown(&[&others[..], &["--strict"]].concat());
    assert!(strict.code == Some(1) && strict.err.contains("its stops are not used"), "{strict:?}");
}

/// From one to the next they were further apart than a train was thought to get.
#[test]
fn positions_far_apart_are_on_the_line_that_is_made_of_them() {
    let ride = drive(&[0.0, 15_000.0], 45.0);
    for (step, names) in [(10, ["a.gpx", "b.gpx", "c.gpx", "d.gpx"]), (20, ["e.gpx", "f.gpx", "g.gpx", "h.gpx"])] {
        let mut folder = Folder::new();
        for (i, name) in names.iter().enumerate() {
            let rows: Vec<_> = ride.iter().copied().skip(3 * i).step_by(step).collect();
            let (beside_m, from_m) = ([4.0, -4.0, 1.0, -2.0][i], if i % 2 == 0 { 0.0 } else { 15_000.0 });
            folder = folder.with(name, &gpx(&rows, 0.0, beside_m, from_m));
        }
        let said = folder.done(&[&["import"], &names[..]].concat());
        assert!(!said.err.contains("of its positions lie on the centre line"), "{step}: {said:?}");
        assert_eq!(folder.read("runs/runs.csv").lines().count(), 1 + names.len(), "{step}: {said:?}");
    }
}
