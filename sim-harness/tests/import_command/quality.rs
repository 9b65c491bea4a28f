//! Columns that call readings good or bad, in tables with all readings in one row.

use super::common::Said;
use super::*;

/// The run that comes of these lines of `t`, `x` and `v`, and what was said.
fn read(header: &str, line: impl Fn(f64, f64, f64) -> String) -> (Vec<Vec<f64>>, Said) {
    let folder = Folder::new().with("a.csv", &table(header, &drive(&STOPS_M, 25.0), line));
    let said = folder.done(&["import", "a.csv"]);
    (csv(&folder, "runs/a_01.csv"), said)
}

/// Rows with the marks of good readings, but for 20 rows of the speed, which are wild.
fn judged(header: &str, [good, bad]: [&str; 2]) -> (Vec<Vec<f64>>, Said) {
    read(header, |t, x, v| {
        let is_bad = (100.0..120.0).contains(&t);
        let (speed, mark) = if is_bad { (7.0, bad) } else { (3.6 * v, good) };
        format!("{t},{x:.1},{good},{speed:.1},{mark}")
    })
}

#[test]
fn a_reading_that_a_column_calls_bad_is_left_out_and_counted() {
    for (header, marks) in [
        ("time [s],location [m],location quality,speed [km/h],speed quality", ["Good", "Bad"]),
        ("time [s],location [m],Quality,speed [km/h],Quality", ["192", "0"]),
        ("Zeit [s],Weg [m],Weg gültig,Geschwindigkeit [km/h],Geschwindigkeit gültig", ["1", "0"]),
        ("time [s],odometer [m],odometer_valid,speed_kmh,valid_speed", ["true", "false"]),
    ] {
        let (made, said) = judged(header, marks);
        assert!(said.err.contains("which values are bad is read from "), "{header}: {}", said.err);
        for row in &made {
            assert_eq!(row[2].is_nan(), (100.0..120.0).contains(&row[0]), "{header}: {row:?}");
            assert!(!row[1].is_nan(), "{header}: {row:?}");
        }
        let counted = "values that a column calls bad, left out: 20";
        assert!(said.out.contains(counted) || said.err.contains(counted), "{header}: {}{}", said.out, said.err);
    }
}

#[test]
fn one_column_judges_all_readings_of_its_row() {
    let (made, _) = read("time [s],location [m],speed [km/h],quality", |t, x, v| {
        format!("{t},{x:.1},{:.1},{}", 3.6 * v, if t == 100.0 { "invalid" } else { "ok" })
    });
    let missing = |column: usize| made.iter().filter(|row| row[column].is_nan()).map(|row| row[0]).collect::<Vec<_>>();
    assert_eq!([missing(1), missing(2)], [[100.0], [100.0]]);
}

#[test]
fn states_of_the_train_and_marks_that_never_call_a_reading_good_judge_nothing() {
    for (header, marks) in [
        ("time [s],location [m],door state,speed [km/h],traction status", ["ok", "fault"]),
        ("time [s],location [m],location status,speed [km/h],speed status", ["0", "7"]),
        // Zero for good, as of many buses, and one for a fault.
        ("time [s],location [m],location valid,speed [km/h],speed valid", ["0", "1"]),
        ("time [s],location [m],location quality,speed [km/h],speed quality", ["0", "255"]),
        // That of the equipment.
        ("time [s],location [m],force status,speed [km/h],vehicle status", ["ok", "fault"]),
    ] {
        let (made, said) = judged(header, marks);
        assert!(made.iter().all(|row| !row[2].is_nan()), "{header}");
        assert!(!said.err.contains("which values are bad"), "{}", said.err);
    }
}

#[test]
fn qualities_that_stand_before_their_readings_judge_these_and_that_of_fixes_no_wheel() {
    let (made, _) = read("time [s],quality,location [m],quality,speed [km/h]", |t, x, v| {
        format!("{t},good,{x:.1},{},{:.1}", if t == 100.0 { "bad" } else { "good" }, 3.6 * v)
    });
    assert!(made.iter().all(|row| row[2].is_nan() == (row[0] == 100.0) && !row[1].is_nan()));
    let (made, said) = read("time [s],location [m],speed [km/h],latitude,longitude,valid", |t, x, v| {
        let fix = 47.0 + x / 111_000.0;
        format!("{t},{x:.1},{:.1},{fix:.7},8.0,{}", 3.6 * v, if t < 300.0 { 1 } else { 0 })
    });
    assert!(made.iter().all(|row| !row[1].is_nan() && !row[2].is_nan()), "{}", said.err);
}

#[test]
fn a_column_that_calls_all_readings_bad_is_not_believed_and_that_is_said() {
    for (header, mark) in [
        ("time [s],location [m],location quality,speed [km/h],speed quality", "Bad"),
        ("time [s],location [m],location valid,speed [km/h],speed valid", "0"),
    ] {
        let (made, said) = read(header, |t, x, v| format!("{t},{x:.1},{mark},{:.1},{mark}", 3.6 * v));
        assert!(made.iter().all(|row| !row[1].is_nan() && !row[2].is_nan()), "{header}");
        assert!(said.err.contains("a.csv") && said.err.contains("calls all values bad"), "{header}: {}", said.err);
    }
    let text = table("t [s];signal;value;quality", &drive(&STOPS_M, 25.0), |t, x, v| {
        format!("{t};location [m];{x:.1};bad\n{t};speed [km/h];{:.1};bad", 3.6 * v)
    });
    let said = Folder::new().with("a.csv", &text).done(&["import", "a.csv"]);
    assert!(said.err.contains("calls all values bad"), "{}", said.err);
}
