//! When a run ends, and what ends none.

use board_tests::board::{described, estimate, running};
use board_tests::prelude::*;
use board_tests::said;
use rundown::tick::regime::Regime;
use rundown_wire::Refusal;

#[test]
fn a_long_stop_ends_the_run_and_keeps_what_it_taught() {
    let (mut board, _, log) = running(described());
    for measurement in &log {
        board.measure(measurement);
    }
    let last = *log.last().unwrap();
    let mut ended = 0;
    for minute in 1..=480_u32 {
        let frames = board.measure(&Measurement {
            time_s: last.time_s + 60.0 * f64::from(minute),
            speed_mps: Some(0.0),
            ..last
        });
        ended += usize::from(said!(frames, RunSummary).is_some());
        assert_eq!(estimate(&frames).unwrap().regime, Regime::Standstill);
    }
    // Eight hours: one end, one record.
    assert_eq!((ended, board.status().records), (1, [1, 0]));
}

#[test]
fn a_run_that_is_none_does_not_end() {
    let (mut board, ..) = running(described());
    board.end();
    assert_eq!(board.ask(Request::Command(Command::End)), Err(Refusal::NotRunning));
    assert_eq!(board.ask(Request::Command(Command::Snapshot)), Err(Refusal::NotRunning));
}

#[test]
fn a_run_ends_with_the_tick_in_which_the_train_has_stood_for_five_minutes() {
    let (mut board, _, log) = running(described());
    let last = *log.last().unwrap();
    let stands =
        (1..=40).map(|tick| Measurement { time_s: last.time_s + 10.0 * f64::from(tick), speed_mps: Some(0.0), ..last });
    let (mut since_s, mut ended_s) = (None, None);
    for measurement in log.iter().copied().chain(stands) {
        let frames = board.measure(&measurement);
        if ended_s.is_none() && said!(frames, RunSummary).is_some() {
            ended_s = Some(measurement.time_s);
        }
        match estimate(&frames).unwrap().regime {
            Regime::Standstill => since_s = since_s.or(Some(measurement.time_s)),
            _ => since_s = None,
        }
    }
    assert_eq!(ended_s, since_s.map(|since_s| since_s + 300.0));
}

#[test]
fn a_wrong_time_at_a_stop_on_the_way_ends_no_run() {
    type Wrong = fn(usize, f64) -> f64;
    let clocks: [(&str, Wrong); 6] = [
        ("one row 140 s ahead", |k, time_s| if k == 13 { time_s + 140.0 } else { time_s }),
        ("one row 290 s ahead", |k, time_s| if k == 0 { time_s + 290.0 } else { time_s }),
        ("one row 400 s ahead", |k, time_s| if k == 0 { time_s + 400.0 } else { time_s }),
        ("one row an hour ahead", |k, time_s| if k == 0 { time_s + 3600.0 } else { time_s }),
        ("an hour back", |_, time_s| time_s - 3600.0),
        ("a week ahead", |_, time_s| time_s + 604_800.0),
    ];
    for (name, clock) in clocks {
        let (mut board, _, log) = running(described());
        let last = *log.last().unwrap();
        let stands = (1..=20).map(|tick| Measurement {
            time_s: last.time_s + 10.0 * f64::from(tick),
            speed_mps: Some(0.0),
            ..last
        });
        let rows: Vec<Measurement> = log.iter().copied().chain(stands).collect();
        for (number, row) in rows.iter().enumerate() {
            let wrong = number.checked_sub(log.len() + 3);
            let time_s = wrong.map_or(row.time_s, |since| clock(since, row.time_s));
            let frames = board.measure(&Measurement { time_s, ..*row });
            assert!(said!(frames, RunSummary).is_none(), "{name}: at row {number} of {}", rows.len());
        }
    }
}

#[test]
fn a_long_stop_in_few_rows_ends_the_run_with_the_row_behind_it() {
    // Standing is recorded every 180 s, or where it begins and where it ends.
    for (step_s, ended_s) in [(180.0, 540.0), (1800.0, 1810.0)] {
        let (mut board, _, log) = running(described());
        for measurement in &log {
            board.measure(measurement);
        }
        let last = *log.last().unwrap();
        let at = |since_s: f64, speed_mps: f64| Measurement {
            time_s: last.time_s + since_s,
            speed_mps: Some(speed_mps),
            ..last
        };
        let stands =
            (0..4).map(|k| at(step_s * f64::from(k), 0.0)).take_while(|row| row.time_s <= last.time_s + 1800.0);
        let rows: Vec<Measurement> = stands.chain([at(1810.0, 5.0), at(1820.0, 5.0)]).skip(1).collect();
        let ended = rows.iter().find(|row| said!(board.measure(row), RunSummary).is_some());
        assert_eq!(ended.map(|row| row.time_s - last.time_s), Some(ended_s), "{step_s}");
    }
}
