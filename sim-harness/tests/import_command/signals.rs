//! Logs that have one signal in each row.

use super::*;

const UNREAD: &str = "lines that cannot be read, left out";

/// The same drive as a usual table.
fn usual() -> Vec<Vec<f64>> {
    let text = table("time [s],location [m],speed [km/h]", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t},{x:.1},{:.1}", 3.6 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    folder.done(&["import", "a.csv"]);
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
    let folder = Folder::new().with("a.csv", &text);
    folder.done(&["import", "a.csv"]);
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
    assert!(said.err.contains("layout: expected one of Zeit [s], Was, Wieviel, unit, found \"Waz\""), "{}", said.err);
}

#[test]
fn a_signal_with_two_values_at_a_time_or_another_unit_is_counted() {
    let spoilt = |from: &str, to: &str| {
        let text = table("t [s];signal;value;unit", &drive(&STOPS_M, 25.0), |t, x, v| {
            format!("{t};odometer;{x:.1};m\n{t};door;0;\n{t};speed;{:.1};km/h", 3.6 * v)
        });
        assert!(text.contains(from));
        let folder = Folder::new().with("a.csv", &text.replacen(from, to, 1));
        folder.done(&["import", "a.csv"]);
        (csv(&folder, "runs/a_01.csv"), folder)
    };
    let usual = usual();
    let (made, folder) = spoilt("\n100;door;0;", "\n100;speed;3.6;km/h");
    loses(&folder, "a.csv", UNREAD, 1, "a.csv:304: expected one value of speed at a time, found 3.6 and 90.0");
    assert_eq!(made[100][2], 3.6);
    let (made, folder) = spoilt("\n100;odometer;", "\n100;odometer;0.0;feet\n100;odometer;");
    loses(&folder, "a.csv", UNREAD, 1, "a.csv:302: expected odometer in \"m\" as before, found \"feet\"");
    assert_eq!(made, usual);
    let (made, _) = spoilt("\n100;door;0;", "\n100;door;0;\n100;door;1;");
    assert_eq!(made, usual, "a signal that nobody reads may have two values");
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
        let folder = Folder::new().with("a.csv", &text);
        folder.done(&["import", "a.csv"]);
        assert_eq!(csv(&folder, "runs/a_01.csv"), usual());
    }
}
