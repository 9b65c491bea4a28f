//! Dates in any order, clocks that nobody set, zones by their names, numbers that count from another year.

use super::*;

/// Departures of the runs.
fn departures(folder: &Folder) -> Vec<String> {
    let index = folder.read("runs/runs.csv");
    index.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().to_owned()).collect()
}

/// One run with this time for each second.
fn timed(time: &str, text_of: impl Fn(f64) -> String) -> Folder {
    let rows = drive(&STOPS_M, 30.0);
    let text =
        table(&format!("{time},km,v_kmh"), &rows, |t, x, v| format!("{},{:.4},{:.1}", text_of(t), x / 1000.0, 3.6 * v));
    Folder::new().with("a.csv", &text)
}

/// They were read as 25 March 2024, and on two days as those of two years.
#[test]
fn years_of_two_digits_may_stand_at_either_end() {
    let of_one_day = timed("time", |t| format!("25-03-24 {}", clock(3600.0 + t)));
    let said = of_one_day.rundown(&["import", "a.csv"]);
    assert_eq!(said.code, Some(6), "{}", said.out);
    assert!(said.err.contains("found \"25-03-24 01:00:00\", which may be year or day first"), "{}", said.err);
    of_one_day.write("m.toml", &to_write(&said.err));
    of_one_day.done(&["import", "a.csv", "--mapping", "m.toml"]);
    assert_eq!(departures(&of_one_day), ["2025-03-24T01:00:00Z"]);
    let rows = drive(&STOPS_M, 30.0);
    for (first, second, expected) in [("25-03-04", "25-03-05", "2025-03-0"), ("14-03-25", "15-03-25", "2025-03-1")] {
        let day = |day: &str| {
            table("time,km,v_kmh", &rows, |t, x, v| {
                format!("{day} {},{:.4},{:.1}", clock(3600.0 + t), x / 1000.0, 3.6 * v)
            })
        };
        let both = day(first) + day(second).split_once('\n').unwrap().1;
        let folder = Folder::new().with("a.csv", &both);
        folder.done(&["import", "a.csv"]);
        assert_eq!(departures(&folder), [4, 5].map(|day| format!("{expected}{day}T01:00:00Z")));
    }
}

/// The recorder begins at its first day until it has its clock set: the run departed in the year 2000.
#[test]
fn the_clock_that_most_rows_have_is_that_of_the_run() {
    let set = |t: f64| if t < 60.0 { 946_684_800.0 + t } else { 1_740_000_000.0 + t };
    let stands = timed("time", |t| format!("{}", set(t + 10.0)));
    stands.done(&["import", "a.csv"]);
    assert_eq!(departures(&stands), ["2025-02-19T21:21:00Z"]);
    // Set while the train moves, and switched on again.
    let rows = drive(&STOPS_M, 30.0);
    let text = |day: f64| {
        table("time,km,v_kmh", &rows, |t, x, v| {
            let unset = if t < 60.0 { 946_684_800.0 + t } else { 1_740_000_000.0 + 86_400.0 * day + t };
            format!("{unset},{:.4},{:.1}", if day == 1.0 { 11.9 - x / 1000.0 } else { x / 1000.0 }, 3.6 * v)
        })
    };
    let both = text(0.0) + text(1.0).split_once('\n').unwrap().1;
    let folder = Folder::new().with("a.csv", &both);
    folder.done(&["import", "a.csv"]);
    assert_eq!(departures(&folder), ["2025-02-19T21:20:00Z", "2025-02-20T21:20:00Z"]);
    assert!(folder.read("runs/runs.csv").ends_with(",,down\n"));
    near(last(&csv(&folder, "runs/a_02.csv"))[0], rows[rows.len() - 1].0, 0.1);
}

/// The first row of the way back was put 40 min too early.
#[test]
fn a_train_that_turns_while_its_recorder_is_silent_set_no_clock() {
    let there = drive(&[0.0, 9000.0], 25.0);
    let back_s = there[there.len() - 1].0 + 2400.0;
    let back = there.iter().map(|(t, x, v)| (back_s + t, 9000.0 - x, *v));
    let rows: Vec<_> = there.iter().copied().chain(back).filter(|(.., v)| *v >= 12.0).collect();
    let text =
        table("time,location_m,speed_kmh", &rows, |t, x, v| format!("{},{x:.1},{:.1}", 1_740_000_000.0 + t, 3.6 * v));
    let folder = Folder::new().with("a.csv", &text);
    folder.done(&["import", "a.csv"]);
    let begins =
        |row: &(f64, f64, f64)| jiff::Timestamp::from_second(1_740_000_000 + row.0 as i64).unwrap().to_string();
    let middle = rows.len() / 2;
    assert_eq!(departures(&folder), [begins(&rows[0]), begins(&rows[middle])]);
}

#[test]
fn a_name_of_a_zone_is_read_asked_or_said() {
    let date = |t: f64| format!("2025-03-14 {}", clock(36_000.0 + t));
    for zone in ["UTC+1", "UTC+01:00", "GMT+01"] {
        let folder = timed("time", |t| format!("{} {zone}", date(t)));
        folder.done(&["import", "a.csv"]);
        assert_eq!(departures(&folder), ["2025-03-14T09:00:00Z"], "{zone}");
    }
    let said = timed("time", |t| format!("{} MEZ", date(t))).rundown(&["import", "a.csv"]);
    let asked = "time: expected a zone as +01:00 or Z, or none, found \"2025-03-14 10:00:00 MEZ\"; write it so in the file, or leave out MEZ and give zone";
    assert!(said.err.contains(asked), "{}", said.err);
    for (header, expected) in [
        ("Time (UTC)", "times are taken for UTC, as column \"Time (UTC)\" says"),
        ("Zeit [MEZ]", "times are taken for UTC, and not for MEZ of column \"Zeit [MEZ]\"; give zone in [[source]]"),
    ] {
        let said = timed(header, date).done(&["import", "a.csv"]);
        assert!(said.err.contains(expected), "{}", said.err);
    }
    let folder = timed("Time (UTC)", date).with("m.toml", "[[source]]\nzone = \"Europe/Berlin\"\n");
    let said = folder.done(&["import", "a.csv", "--mapping", "m.toml"]);
    assert!(said.err.contains("zone \"Europe/Berlin\" of the mapping is believed, not UTC of"), "{}", said.err);
}

#[test]
fn numbers_that_may_count_from_another_year_are_said() {
    for (header, begin_s, expected) in [
        ("GPS time [s]", 1_425_967_945.0, Some("2015-03-10T06:12:25Z in the first row; where it is GPS time")),
        ("timestamp", 3_824_777_527.0, Some("2091-03-15T06:12:07Z in the first row; where it counts from 1904")),
        ("timestamp", 1_740_000_000.0, None),
    ] {
        let folder = timed(header, |t| format!("{}", begin_s + t));
        let said = folder.done(&["import", "a.csv"]);
        folder.done(&["import", "--mapping", "runs/import.toml", "--out", "again"]);
        assert_eq!(folder.read("runs/import.json"), folder.read("again/import.json"));
        match expected {
            Some(expected) => assert!(said.err.contains(expected), "{}", said.err),
            None => assert!(!said.err.contains("since 1970"), "{}", said.err),
        }
    }
}
