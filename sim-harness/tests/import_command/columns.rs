//! Are columns taken for what they hold, not only for what they are called?

use super::{STOPS_M, csv, drive, last, near, place, table, to_write};
use crate::common::Folder;

const MASS: &str = "[[source]]\nrotating_mass_kg = 100000.0\n";

#[test]
fn a_speed_that_is_a_limit_decides_no_unit() {
    let rows = drive(&STOPS_M, 30.0);
    let limit = |x: f64| if x % 4000.0 < 2000.0 { 160.0 } else { 80.0 };
    for (name, text) in [
        ("constant.csv", table("time_s,distance,speed", &rows, |t, x, _| format!("{t},{x:.0},80"))),
        ("limit.csv", table("time_s,distance,speed", &rows, |t, x, _| format!("{t},{x:.0},{}", limit(x)))),
    ] {
        let folder = Folder::new().with(name, &text);
        let said = folder.rundown(&["import", name]);
        assert_eq!(said.code, Some(6), "{name}: {}", said.out);
    }
    let sloppy = table("time_s,distance,speed", &rows, |t, x, v| {
        format!("{t},{x:.0},{:.0}", 3.6 * v * [0.7, 1.0, 1.4][(t / 60.0) as usize % 3])
    });
    let folder = Folder::new().with("a.csv", &sloppy);
    let said = folder.rundown(&["import", "a.csv"]);
    assert!(said.err.contains("% of the stretches only, expected at least 80 %"), "{}", said.err);
}

#[test]
fn an_effort_in_small_letters_is_no_speed_in_knots() {
    let rows = drive(&STOPS_M, 30.0);
    for header in ["effort_kn", "tractive_effort_kn", "zugkraft [kn]"] {
        let header = format!("time_s,location_m,speed_kmh,{header}");
        let text = table(&header, &rows, |t, x, v| format!("{t},{x:.1},{:.1},{:.1}", 3.6 * v, 50.0 - v));
        let folder = Folder::new().with("a.csv", &text).with("m.toml", MASS);
        folder.done(&["import", "a.csv", "--mapping", "m.toml"]);
        near(csv(&folder, "runs/a_01.csv")[0][3], 0.5, 1e-9);
        let said = folder.done(&["import", "a.csv", "--out", "without"]);
        assert!(said.err.contains("a force needs rotating_mass_kg"), "{}", said.err);
    }
    let text = table("time_s,location_m,effort_kn", &rows, |t, x, v| format!("{t},{x:.1},{:.1}", 50.0 - v));
    let folder = Folder::new().with("a.csv", &text).with("m.toml", MASS);
    let said = folder.done(&["import", "a.csv", "--mapping", "m.toml"]);
    assert!(said.err.contains("no column has a speed"), "{}", said.err);
    folder.write("tonnes.toml", &MASS.replace("100000", "100"));
    let said = folder.rundown(&["import", "a.csv", "--mapping", "tonnes.toml", "--out", "t"]);
    assert!(said.err.contains("rotating_mass_kg: expected kg, 2000 to 100000000, found 100"), "{}", said.err);
}

#[test]
fn a_unit_that_is_not_known_is_said_and_is_not_replaced_by_another_one() {
    let rows = drive(&STOPS_M, 30.0);
    for (header, unit) in [("Effort (MN)", "MN"), ("Traction force [tf]", "tf"), ("Effort [p.u.]", "p.u.")] {
        let header = format!("time_s,location_m,speed_kmh,{header}");
        let text = table(&header, &rows, |t, x, v| format!("{t},{x:.1},{:.1},{:.3}", 3.6 * v, 0.2 - 0.001 * v));
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv"]);
        assert!(said.err.contains(&format!("its unit {unit:?} is not known")), "{}", said.err);
        assert_eq!(csv(&folder, "runs/a_01.csv")[0].len(), 3);
    }
    // What stands in brackets need be no unit.
    let text = table("time_s,location_m,speed (GPS),effort (total)", &rows, |t, x, v| {
        format!("{t},{x:.1},{:.1},{:.3}", 3.6 * v, 0.2 - 0.001 * v)
    });
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    assert!(!said.err.contains("known"), "{}", said.err);
    assert_eq!(csv(&folder, "runs/a_01.csv")[0].len(), 4);
    let text = table("time_s,location_m,speed [rpm]", &rows, |t, x, v| format!("{t},{x:.1},{:.0}", 36.0 * v));
    let folder = Folder::new().with("a.csv", &text);
    let said = folder.done(&["import", "a.csv"]);
    assert!(said.err.contains("\"rpm\" is no unit that is known, 0.1 km/h is taken"), "{}", said.err);
}

#[test]
fn what_is_measured_splits_no_runs() {
    let rows = drive(&STOPS_M, 30.0);
    let course = |t: f64| 90.0 + 0.1 * (t % 7.0);
    for (header, value, why) in [
        ("course", &(|t, _, _| format!("{:.1}", course(t))) as &dyn Fn(f64, f64, f64) -> String, "is no whole number"),
        ("track", &|t, _, _| format!("{:.0}", 120.0 + 40.0 * (t / 50.0).sin()), "it has"),
        ("run", &|_, _, v| format!("{}", u8::from(v > 0.0)), "goes to and fro between on and off"),
        ("run", &|_, _, v| if v > 0.0 { "True".to_owned() } else { "False".to_owned() }, "goes to and fro"),
        ("Trip [km]", &|_, x, _| format!("{:.0}", x / 1000.0), "no name of theirs is known"),
        ("Zug [kN]", &|_, _, v| format!("{:.0}", 100.0 - v), "no name of theirs is known"),
    ] {
        let header = format!("time_s,location_m,speed_kmh,{header}");
        let text = table(&header, &rows, |t, x, v| format!("{t},{x:.1},{:.1},{}", 3.6 * v, value(t, x, v)));
        let folder = Folder::new().with("a.csv", &text);
        let said = folder.done(&["import", "a.csv"]);
        assert!(said.err.contains(why), "{header}: {}", said.err);
        assert!(said.out.contains("1 run in runs"), "{header}: {}", said.out);
        assert_eq!(csv(&folder, "runs/a_01.csv").len(), rows.len(), "{header}");
    }
    for (header, names) in [("run", ["0", "1"]), ("trip", ["4711.1", "4711.2"]), ("Zug (Nr.)", ["7.0", "NaN"])] {
        let two = table(&format!("time_s,location_m,speed_kmh,{header}"), &rows, |t, x, v| {
            format!("{t},{x:.1},{:.1},{}", 3.6 * v, names[usize::from(x > 5600.0)])
        });
        let folder = Folder::new().with("a.csv", &two).with("b.csv", &two);
        let said = folder.done(&["import", "a.csv", "b.csv"]);
        assert!(said.out.contains("4 runs in runs"), "{header}: {}\n{}", said.out, said.err);
    }
}

#[test]
fn knots_in_a_column_of_miles_are_refused_and_a_distance_that_is_off_is_warned_of() {
    let rows = drive(&STOPS_M, 30.0);
    let knots = table("time_s,location_m,speed_mph", &rows, |t, x, v| format!("{t},{x:.1},{:.2}", v / 0.514_444));
    let folder = Folder::new().with("a.csv", &knots);
    let said = folder.rundown(&["import", "a.csv"]);
    assert_eq!(said.code, Some(6), "{}", said.out);
    folder.write("m.toml", &to_write(&said.err));
    folder.done(&["import", "a.csv", "--mapping", "m.toml"]);
    near(csv(&folder, "runs/a_01.csv").iter().map(|row| row[2]).fold(0.0, f64::max), 108.0, 0.1);

    // A way by positions that jitter is too long, and no reason for another unit.
    let jitters = table("time_s,lat,lon,speed_mph", &rows, |t, x, v| {
        let (latitude, longitude) = place(x + 8.0 * (2.1 * t).sin(), 14.0 * (1.3 * t).cos());
        format!("{t},{latitude:.7},{longitude:.7},{:.2}", v / 0.447_04)
    });
    let folder = Folder::new().with("a.csv", &jitters);
    let said = folder.done(&["import", "a.csv"]);
    assert!(said.err.contains("distance by speed is 1.1"), "{}", said.err);
    assert!(!said.err.contains("look at both columns"), "{}", said.err);

    let easting = table("time_s,X [m],speed_kmh", &rows, |t, x, v| format!("{t},{:.1},{:.1}", 0.85 * x, 3.6 * v));
    let folder = Folder::new().with("a.csv", &easting);
    let said = folder.rundown(&["import", "a.csv", "--strict"]);
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert!(said.err.contains("expected 1 within 0.06, found: distance by location over distance by speed is 0.85"));
    folder.done(&["import", "a.csv"]);
    near(last(&csv(&folder, "runs/a_01.csv"))[1], 0.85 * 11_900.0, 1.0);
}
