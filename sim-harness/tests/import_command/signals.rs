//! Logs that have one signal in each row.

use super::*;

/// A file of this text, and the runs that come of it.
fn imported(text: &str) -> Folder {
    let folder = Folder::new().with("a.csv", text);
    folder.done(&["import", "a.csv"]);
    folder
}

/// The same drive as a usual table.
fn usual() -> Vec<Vec<f64>> {
    let text = table("time [s],location [m],speed [km/h]", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t},{x:.1},{:.1}", 3.6 * v)
    });
    let folder = imported(&text);
    csv(&folder, "runs/a_01.csv")
}

#[test]
fn one_signal_in_each_row_makes_the_same_run_however_it_is_written() {
    let rows = drive(&STOPS_M, 25.0);
    let with_units = table("Zeit [s];Messgröße;Wert;Einheit", &rows, |t, x, v| {
        let (km, kmh) = (format!("{:.4}", 1e-3 * x).replace('.', ","), format!("{:.1}", 3.6 * v).replace('.', ","));
        format!("{t};Weg;{km};km\n{t};Türen;0;\n{t};v-Ist;{kmh};km/h")
    });
    let of_signal = |name: &str, value: &dyn Fn(f64, f64) -> String| {
        table("", &rows, |t, x, v| format!("{name},{t},{},Good", value(x, v))).trim_start().to_owned()
    };
    let in_blocks = format!(
        "tag,timestamp [s],value,quality\n{}{}",
        of_signal("Speed [km/h]", &|_, v| format!("{:.1}", 3.6 * v)),
        of_signal("Odometer", &|x, _| format!("{x:.1}")),
    );
    let as_objects = table("", &rows, |t, x, v| {
        let object = |signal: &str, value: f64| {
            format!("{{\"seconds\": {t}, \"loco\": \"4021\", \"signal\": \"{signal}\", \"value\": {value:.1}}}")
        };
        format!("{}\n{}", object("odometer", x), object("speed", 3.6 * v))
    });
    let usual = usual();
    for (name, text, signals) in [
        ("a.csv", with_units.as_str(), "each row has one of 3 signals (column \"Messgröße\")"),
        ("b.csv", &in_blocks, "each row has one of 2 signals (column \"tag\")"),
        ("c.jsonl", as_objects.trim_start(), "each row has one of 2 signals (column \"signal\")"),
    ] {
        let folder = Folder::new().with(name, text);
        let said = folder.done(&["import", name]);
        assert!(said.err.contains(signals), "{}", said.err);
        let made = format!("{}_01.csv", &name[..1]);
        assert_eq!(csv(&folder, &format!("runs/{made}")), usual, "{name}");
        folder.done(&["import", "--mapping", "runs/import.toml", "--out", "again"]);
        assert_eq!(folder.read(&format!("again/{made}")), folder.read(&format!("runs/{made}")));
        assert_eq!(folder.read("again/import.toml"), folder.read("runs/import.toml"));
    }
}

#[test]
fn signals_with_times_of_their_own_say_their_units_together() {
    let text = table("Timestamp [s];Signal;Value", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t};Odometer;{x:.1}\n{:.2};Speed;{:.1}", t + 0.03, 2.236_94 * v)
    });
    let folder = imported(&text);
    let mapping = folder.read("runs/import.toml");
    assert!(mapping.contains("unit = \"m\"") && mapping.contains("unit = \"mph\""), "{mapping}");
    let made = csv(&folder, "runs/a_01.csv");
    assert!(made.iter().all(|row| row[1].is_nan() != row[2].is_nan()));
}

#[test]
fn columns_of_signals_may_be_named() {
    let text = table("Zeit [s];Was;Wieviel;unit", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t};Weg [m];{x:.1};94\n{t};Tempo [km/h];{:.1};94", 3.6 * v)
    });
    let layout = |signal: &str| {
        let mapping = format!("source = [{{ layout = {{ signal = \"{signal}\", value = \"Wieviel\" }} }}]");
        Folder::new().with("a.csv", &text).with("m.toml", &mapping)
    };
    let folder = layout("Was");
    folder.done(&["import", "--mapping", "m.toml", "a.csv"]);
    assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
    assert!(folder.read("runs/runs.csv").contains("94"), "a vehicle is no unit of a signal");
    let said = layout("Waz").rundown(&["import", "--mapping", "m.toml", "a.csv"]);
    assert_eq!(said.code, Some(6));
    assert!(said.err.contains("layout: expected two of Zeit [s], Was, Wieviel, unit, found \"Waz\""), "{}", said.err);
}

/// A table of speed, odometer and what else there is, spoilt once; the run that comes of it.
fn spoilt(from: &str, to: &str) -> (Vec<Vec<f64>>, Folder) {
    let text = table("t [s];signal;value;unit", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t};odometer;{x:.1};m\n{t};door;0;\n{t};speed;{:.1};km/h", 3.6 * v)
    });
    assert!(text.contains(from));
    let folder = Folder::new().with("a.csv", &text.replacen(from, to, 1));
    folder.done(&["import", "a.csv"]);
    (csv(&folder, "runs/a_01.csv"), folder)
}

#[test]
fn a_signal_with_two_values_at_a_time_is_counted_and_another_unit_converted() {
    let usual = usual();
    let (made, folder) = spoilt("\n100;door;0;", "\n100;speed;3.6;km/h");
    let place = "a.csv:304: expected one value of speed at a time, found 3.6 and 90.0";
    loses(&folder, "a.csv", "values beside another one of the same signal and time, left out", 1, place);
    assert_eq!(made[100][2], 3.6);
    let (made, _) = spoilt("\n100;speed;90.0;km/h", "\n100;speed;25;m/s");
    assert_eq!(made, usual);
    let (made, _) = spoilt("\n100;door;0;", "\n100;door;0;\n100;door;1;");
    assert_eq!(made, usual, "a signal that nobody reads may have two values");
}

#[test]
fn most_of_the_values_may_be_in_another_unit_than_the_first() {
    let text = table("time [s],tag,value,uom", &drive(&STOPS_M, 25.0), |t, x, v| {
        let location = if t < 60.0 { format!("{x:.1},m") } else { format!("{:.4},km", 1e-3 * x) };
        format!("{t},odometer,{location}\n{t},speed,{:.1},km/h", 3.6 * v)
    });
    let folder = imported(&text);
    assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
}

#[test]
fn trains_that_take_turns_are_separated_or_a_column_that_does_is_asked_for() {
    let of = |column: &str| {
        let header = format!("time [s],{column},tag,value,unit");
        table(&header, &drive(&STOPS_M, 25.0), |t, x, v| {
            let of =
                |train: u32, x: f64| format!("{t},{train},odometer,{x:.1},m\n{t},{train},speed,{:.1},km/h", 3.6 * v);
            format!("{}\n{}", of(94, x), of(95, x + 30_000.0))
        })
    };
    let trains = |folder: &Folder| {
        let made = [1, 2].map(|number| csv(folder, &format!("runs/a_0{number}.csv")));
        let far: Vec<f64> = made.iter().map(|rows| last(rows)[1]).collect();
        assert_eq!((far, made[0].len()), (vec![11_900.0, 41_900.0], usual().len()));
    };
    let folder = Folder::new().with("a.csv", &of("vehicle"));
    folder.done(&["import", "a.csv"]);
    trains(&folder);
    let folder = Folder::new().with("a.csv", &of("asset"));
    let said = folder.rundown(&["import", "a.csv"]);
    assert!(said.code == Some(6) && said.err.contains("is it asset?"), "{}", said.err);
    folder.write("m.toml", &to_write(&said.err));
    folder.done(&["import", "--mapping", "m.toml", "a.csv"]);
    trains(&folder);
}

#[test]
fn an_hour_of_the_clock_that_comes_twice_is_read_twice() {
    let rows = drive(&STOPS_M, 25.0);
    // From 02:50 summer time on, by clocks that go back to 02:00 at 03:00.
    let local = |t: f64| {
        let t = 10_200.0 + t;
        format!("2024-10-27T{}", clock(if t < 10_800.0 { t } else { t - 3600.0 }))
    };
    let long: Vec<(f64, f64, f64)> = rows.iter().map(|(t, x, v)| (5.0 * t, *x, 0.2 * v)).collect();
    assert!(long.last().unwrap().0 > 4200.0, "beyond 03:00, twice");
    let row = |name: &str, t: f64, value: f64| format!("{};{name};{value:.2}", local(t));
    let turns = table("Zeit;Signal;Wert", &long, |t, x, v| {
        format!("{}\n{}", row("Weg [m]", t, x), row("Tempo [km/h]", t, 3.6 * v))
    });
    let of_signal = |name: &str, value: &dyn Fn(f64, f64) -> f64| {
        table("", &long, |t, x, v| row(name, t, value(x, v))).trim_start().to_owned()
    };
    let [speeds, places] = [of_signal("Tempo [km/h]", &|_, v| 3.6 * v), of_signal("Weg [m]", &|x, _| x)];
    let mapping = "source = [{ zone = \"Europe/Berlin\", columns.speed.name = \"Tempo [km/h]\" }]";
    for text in [turns, format!("Zeit;Signal;Wert\n{speeds}{places}")] {
        let folder = Folder::new().with("a.csv", &text).with("m.toml", mapping);
        folder.done(&["import", "--mapping", "m.toml", "a.csv"]);
        let made = csv(&folder, "runs/a_01.csv");
        assert_eq!(made.len(), long.len());
        for (made, (t, x, v)) in made.iter().zip(&long) {
            near(made[0], *t, 0.01);
            near(made[1], *x, 0.01);
            near(made[2], 3.6 * v, 0.01);
        }
    }
}

#[test]
fn a_value_that_a_column_calls_bad_is_left_out() {
    for (good, bad) in [("Good", "Bad"), ("192", "24")] {
        let text = table("t [s];signal;value;quality", &drive(&STOPS_M, 25.0), |t, x, v| {
            let speed = if t == 100.0 { format!("-999;{bad}") } else { format!("{:.1};{good}", 3.6 * v) };
            format!("{t};odometer [m];{x:.1};{good}\n{t};speed [km/h];{speed}")
        });
        let folder = Folder::new().with("a.csv", &text);
        let place = format!("a.csv:203: expected a good value of speed [km/h], found {bad}");
        loses(&folder, "a.csv", "values that a column calls bad, left out", 1, &place);
        assert!(csv(&folder, "a/a_01.csv")[100][2].is_nan());
    }
}

#[test]
fn the_number_of_a_train_holds_until_the_next_one_is_written() {
    let text = table("t [s];signal;value", &drive(&STOPS_M, 25.0), |t, x, v| {
        let number = if t % 50.0 == 20.0 { format!("\n{t};train number;4711") } else { String::new() };
        format!("{t};odometer [m];{x:.1}\n{t};speed [km/h];{:.1}{number}", 3.6 * v)
    });
    let folder = imported(&text);
    assert_eq!(csv(&folder, "runs/a_4711_01.csv"), usual());
}

#[test]
fn a_line_for_the_mapping_may_name_a_signal() {
    let text = table("t [s];signal;value", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t};Location;{:.4}\n{t};Speed;{:.1}", 1e-3 * x, 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.rundown(&["import", "a.csv"]);
    assert!(said.code == Some(6) && said.err.contains("km with km/h"), "{}", said.err);
    folder.write("m.toml", &to_write(&said.err));
    folder.done(&["import", "--mapping", "m.toml", "a.csv"]);
    assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
}

#[test]
fn a_table_of_many_signals_is_read_and_one_without_any_is_none() {
    let rows = drive(&STOPS_M, 25.0);
    let others: String = (0..300).map(|number| format!("\n0;register {number};1")).collect();
    let text = table("t [s];signal;value", &rows, |t, x, v| {
        let others = if t == 0.0 { others.as_str() } else { "" };
        format!("{t};T1/Odometer_m;{x:.1}\n{t};T1/SpeedAct [km/h];{:.1}{others}", 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    assert!(said.err.contains("one of 302 signals"), "{}", said.err);
    assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
    // Aspects that the train meets, in a table with columns that nobody knows.
    let text = table("t [s];Signal;Radweg;Wert", &rows, |t, x, _| format!("{t};Hp{};{x};5", i32::from(t < 200.0)));
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.rundown(&["import", "a.csv"]);
    let found = "found t [s], Signal, Radweg, Wert;";
    assert!(said.code == Some(6) && said.err.contains(found), "{}", said.err);
    assert!(said.err.contains("layout.signal and layout.value in [[source]]"), "{}", said.err);
}

#[test]
fn a_train_stands_in_rows_that_have_one_reading_each() {
    let mut rows = drive(&STOPS_M, 25.0);
    let at = rows.iter().position(|(_, x, v)| *x >= STOPS_M[2] && *v == 0.0).unwrap();
    rows[at + 1..].iter_mut().for_each(|(t, ..)| *t += 1500.0);
    let (t, x, _) = rows[at];
    rows.splice(at + 1..at + 1, (1..25).map(|minute| (t + 60.0 * f64::from(minute), x, 0.0)));
    let text = table("t [s],odometer [m],speed [km/h]", &rows, |t, x, v| {
        format!("{t},{x:.1},\n{:.1},,{:.1}", t + 0.4, 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    assert!(said.out.contains("begins because the train stands for 15"), "{}", said.out);
}

#[test]
fn rows_of_one_time_with_other_readings_are_one_row() {
    let text = table("t [s],odometer [m],speed [km/h]", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t},{x:.1},\n{t},,{:.1}", 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    let usual = usual();
    let joined = format!("rows of the same time with other readings, joined: {}", usual.len());
    assert!(said.out.contains(&joined), "{}", said.out);
    assert_eq!(csv(&folder, "runs/a_01.csv"), usual);
}

#[test]
fn a_speed_that_is_written_twice_in_a_second_takes_no_location_with_it() {
    let text = table("t [s],odometer [m],speed [km/h]", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t},,{:.1}\n{t},,{:.1}\n{t},{x:.1},", 3.6 * v, 3.6 * v + 0.1)
    });
    let folder = imported(&text);
    assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
    // The same in a table of signals; and no several trains.
    let text = table("t [s],tag,value", &drive(&STOPS_M, 25.0), |t, x, v| {
        let speed = |more: f64| format!("{t},speed [km/h],{:.1}", 3.6 * v + more);
        format!("{}\n{}\n{t},odometer [m],{x:.1}", speed(0.0), speed(0.1))
    });
    let folder = imported(&text);
    assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
}

#[test]
fn two_trains_with_a_row_for_each_reading_are_said() {
    let text = table("t [s],odometer [m],speed [km/h]", &drive(&STOPS_M, 25.0), |t, x, v| {
        let kmh = 3.6 * v;
        format!("{t},{x:.1},\n{t},,{kmh:.1}\n{t},{:.1},\n{t},,{:.1}", x + 9000.0, kmh + 1.0)
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.rundown(&["import", "a.csv"]);
    assert!(said.out.contains("another train?"), "{}{}", said.out, said.err);
}

#[test]
fn a_train_number_holds_for_its_vehicle() {
    let text = table("t [s],vehicle,tag,value", &drive(&STOPS_M, 25.0), |t, x, v| {
        let of = |vehicle: u32, x: f64| {
            let number =
                if t % 50.0 == 0.0 { format!("\n{t},{vehicle},train,{}", 10 * vehicle) } else { String::new() };
            format!("{t},{vehicle},odometer [m],{x:.1}\n{t},{vehicle},speed [km/h],{:.1}{number}", 3.6 * v)
        };
        format!("{}\n{}", of(94, x), of(95, x + 30_000.0))
    });
    let folder = imported(&text);
    for (number, from) in [("940", 0.0), ("950", 30_000.0)] {
        let made = csv(&folder, &format!("runs/a_{number}_01.csv"));
        assert_eq!((made.len(), made[0][1]), (usual().len(), from));
    }
}

#[test]
fn the_unit_of_a_signal_is_the_first_that_it_may_have_and_a_state_of_the_train_is_no_quality() {
    let text = table("t [s],tag,value,unit,status", &drive(&STOPS_M, 25.0), |t, x, v| {
        let unit = if t < 20.0 { "%" } else { "km/h" };
        let status = if t < 300.0 { "error" } else { "driving" };
        format!("{t},odometer,{x:.1},m,{status}\n{t},speed,{:.1},{unit},{status}", 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    let (made, usual) = (csv(&folder, "runs/a_01.csv"), usual());
    assert_eq!(made[20..], usual[20..]);
    assert!(made[..20].iter().all(|row| row[2].is_nan()));
    assert!(said.err.contains("not used: \"status\""), "{}", said.err);
}

#[test]
fn thousandths_of_a_second_may_have_a_column_of_their_own() {
    let text = table("Time;ms;odometer [m];speed [km/h]", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("2025-03-03 {};250;{x:.1};\n2025-03-03 {};750;;{:.1}", clock(t), clock(t), 3.6 * v)
    });
    let folder = imported(&text);
    let made = csv(&folder, "runs/a_01.csv");
    assert!((0..20).all(|i| made[2 * i + 1][0] - made[2 * i][0] == 0.5), "{:?}", &made[..3]);
}

#[test]
fn numbers_that_are_no_readings_do_not_decide_the_decimal_sign() {
    let text = table("t [s];odometer [m];speed [km/h];Version;Address", &drive(&STOPS_M, 25.0), |t, x, v| {
        let kmh = format!("{:.1}", 3.6 * v).replace('.', ",");
        format!("{t};{x:.0};{kmh};3.7;10.25")
    });
    let folder = imported(&text);
    assert!(csv(&folder, "runs/a_01.csv").iter().zip(usual()).all(|(made, usual)| made[2] == usual[2]));
}

#[test]
fn times_and_columns_with_a_unit_decide_the_decimal_sign() {
    let german = |value: f64| format!("{value:.1}").replace('.', ",");
    for (header, time, speed) in [
        ("Zeit [s];Weg [m];v [km/h]", true, false),
        ("Zeit [s];Weg [m];Tempo [km/h]", false, true),
        ("Zeit [s];Weg [m];Geschw. [km/h]", false, true),
    ] {
        let text = table(header, &drive(&STOPS_M, 25.0), |t, x, v| {
            let time = if time { german(t + 0.5) } else { format!("{t}") };
            let kmh = if speed { german(3.6 * v) } else { format!("{:.0}", 3.6 * v) };
            format!("{time};{x:.0};{kmh}")
        });
        let folder = imported(&text);
        let (made, usual) = (csv(&folder, "runs/a_01.csv"), usual());
        assert_eq!((made.len(), made[20][0]), (usual.len(), 20.0), "{header}");
        near(made[30][2], usual[30][2], 0.5);
    }
}

#[test]
fn a_preamble_of_names_and_values_is_none() {
    let rows = drive(&STOPS_M, 25.0);
    let text = table("t [s];s [m];Rapidity [km/h]", &rows, |t, x, v| format!("{t};{x:.1};{:.1}", 3.6 * v));
    let folder = Folder::new().with("a.csv", &format!("Parameter;Wert\nLok;94\n{text}"));
    folder.done(&["import", "a.csv"]);
    assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
}

#[test]
fn parts_of_a_time_may_be_in_an_object_and_an_effort_may_be_of_an_engine() {
    let text = table("", &drive(&STOPS_M, 25.0), |t, x, v| {
        let (hour, minute, second) = (9 + t as u64 / 3600, t as u64 / 60 % 60, t as u64 % 60);
        let time = format!("{{\"hour\": {hour}, \"minute\": {minute}, \"second\": {second}}}");
        let engine = format!("{{\"tractive_effort\": {:.3}, \"speed\": 1500}}", 0.01 * v);
        format!("{{\"time\": {time}, \"odo_m\": {x:.1}, \"speed_kmh\": {:.1}, \"engine\": {engine}}}", 3.6 * v)
    });
    let folder = Folder::new().with("a.jsonl", text.trim_start());
    folder.done(&["import", "a.jsonl"]);
    let (made, usual) = (csv(&folder, "runs/a_01.csv"), usual());
    for (made, usual) in made.iter().zip(&usual) {
        assert_eq!(made[..3], usual[..]);
        near(made[3], 0.01 * made[2] / 3.6, 0.001);
    }
}

#[test]
fn a_unit_of_the_location_alone_is_no_vehicle() {
    let text = table("t [s];signal;value;unit", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t};odometer;{x:.1};m\n{t};speed [km/h];{:.1};", 3.6 * v)
    });
    let folder = imported(&text);
    assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
}

#[test]
fn a_run_that_is_faster_than_any_train_is_said() {
    let text = table("t [s];odometer", &drive(&STOPS_M, 25.0), |t, x, _| format!("{t};{:.1}", 100.0 * x));
    let mapping = "source = [{ columns = { location = { name = \"odometer\", unit = \"m\" } } }]";
    let folder = Folder::new().with("a.csv", &text).with("m.toml", mapping);
    let said = folder.rundown(&["import", "--mapping", "m.toml", "a.csv"]);
    assert!(said.out.contains("faster than any train by their locations"), "{}{}", said.out, said.err);
}

#[test]
fn units_are_found_of_trains_that_take_turns_and_of_rows_newest_first() {
    let rows = drive(&STOPS_M, 25.0);
    let turns = table("t [s],vehicle,odometer,speed", &rows, |t, x, v| {
        format!("{t},94,{x:.1},{:.1}\n{t},95,{:.1},{:.1}", 3.6 * v, x + 30_000.0, 3.6 * v)
    });
    let newest: Vec<(f64, f64, f64)> = rows.iter().rev().copied().collect();
    let newest = table("t [s],odometer,speed", &newest, |t, x, v| format!("{t},{x:.1},{:.1}", 3.6 * v));
    for text in [turns, newest] {
        let folder = imported(&text);
        assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
    }
}

#[test]
fn kilometres_and_metres_on_both_sides_of_a_plus_are_a_location() {
    for (decimal, delimiter) in [('.', ','), (',', ';')] {
        let header = format!("time [s]{delimiter}PK{delimiter}speed [km/h]");
        let text = table(&header, &drive(&STOPS_M, 25.0), |t, x, v| {
            let metres = format!("{:05.1}", x % 1000.0).replace('.', &decimal.to_string());
            let kmh = format!("{:.1}", 3.6 * v).replace('.', &decimal.to_string());
            format!("{t}{delimiter}{}+{metres}{delimiter}{kmh}", (x / 1000.0).floor())
        });
        let folder = imported(&text);
        assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
    }
}
