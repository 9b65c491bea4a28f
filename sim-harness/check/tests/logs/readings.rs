//! Are readings that are wrong in another way than one by one named for what they are?

use crate::simulated::{Recorder, kinds};
use rundown_check::check;
use rundown_check::finding::{Done, Finding, Kind};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

/// Three runs, the second of them with other rows: what is found in that, and its rows.
fn spoilt(recorder: Recorder, spoil: impl Fn(&mut Vec<Sample>)) -> (Vec<Finding>, Recording) {
    let mut recordings = recorder.runs(70_000, 3, 4);
    spoil(&mut recordings[1].rows);
    let found = check(&mut recordings);
    (found.runs[1].findings.clone(), recordings.remove(1))
}

#[track_caller]
fn one(findings: &[Finding], kind: Kind) -> Finding {
    let of_kind: Vec<&Finding> = findings.iter().filter(|finding| finding.kind == kind).collect();
    assert_eq!((of_kind.len(), findings.len()), (1, 1), "{findings:?}");
    of_kind[0].clone()
}

/// The first row from `from` on at which the train is fast.
fn fast(rows: &[Sample], from: usize) -> usize {
    from + rows[from..].iter().position(|row| row.speed_mps > Some(10.0)).unwrap()
}

#[test]
fn a_location_that_stands_still_is_one_where_fixes_are_lost_too_and_begins_nowhere_again() {
    let (findings, _) = spoilt(Recorder::default(), |rows| {
        let from = fast(rows, 60);
        let stays = rows[from].location_m;
        rows[from..from + 30].iter_mut().for_each(|row| row.location_m = stays);
        rows[from + 25].location_m = None;
    });
    assert_eq!(one(&findings, Kind::StuckLocation).done, Done::LeftOut);
    // Too short to be named, and not where the location begins again.
    let (findings, _) = spoilt(Recorder { noise_m: 0.3, ..Recorder::default() }, |rows| {
        let from = fast(rows, 60);
        let stays = rows[from].location_m;
        rows[from..from + 5].iter_mut().for_each(|row| row.location_m = stays);
    });
    assert_eq!(findings, []);
}

#[test]
fn several_wild_readings_together_are_left_out_and_none_beside() {
    let zeros = |rows: &mut Vec<Sample>, put: fn(&mut Sample)| {
        let moving: Vec<usize> = (10..rows.len() - 10).filter(|i| rows[*i].speed_mps > Some(15.0)).collect();
        // Two, with one that is right before the next two.
        for i in moving.iter().step_by(41) {
            [0, 1, 3, 4].into_iter().for_each(|at| put(&mut rows[i + at]));
        }
    };
    let (findings, run) = spoilt(Recorder::default(), |rows| zeros(rows, |row| row.speed_mps = Some(0.0)));
    assert_eq!(one(&findings, Kind::SpeedSpikes).done, Done::LeftOut);
    let lost = run.rows.iter().filter(|row| row.speed_mps.is_none()).count();
    assert_eq!(lost, one(&findings, Kind::SpeedSpikes).count);
    assert_eq!(lost % 4, 0);
    let (findings, _) = spoilt(Recorder::default(), |rows| zeros(rows, |row| row.location_m = Some(-90_000.0)));
    assert_eq!(one(&findings, Kind::LocationSpikes).count % 4, 0);
}

#[test]
fn speeds_below_zero_are_none() {
    let (findings, run) = spoilt(Recorder::default(), |rows| {
        let from = fast(rows, 60);
        rows[from..from + 8].iter_mut().for_each(|row| row.speed_mps = Some(-30.0));
        rows[1].speed_mps = Some(-0.01);
    });
    assert_eq!(one(&findings, Kind::Impossible).figure.value, 8.0);
    assert_eq!(run.rows[1].speed_mps, Some(-0.01));
}

#[test]
fn blocks_out_of_order_are_sorted_and_no_clock_that_was_set() {
    for kinds_of in [1, 7] {
        let whole = Recorder::default().runs(70_000, 3, 4)[1].rows.clone();
        let (findings, run) = spoilt(Recorder::default(), |rows| {
            let third = rows.len() / 3;
            rows.rotate_left(third);
            rows[..2 * third].rotate_left(kinds_of * 40);
        });
        assert_eq!(one(&findings, Kind::OutOfOrder).done, Done::PutRight);
        assert!(run.rows.iter().zip(&whole).all(|(row, whole)| row.time_s == whole.time_s));
    }
}

#[test]
fn a_clock_that_is_set_back_by_less_than_half_a_minute_is_put_right_while_the_train_runs() {
    let (findings, run) = spoilt(Recorder::default(), |rows| {
        let from = fast(rows, 60) + 10;
        rows[from..].iter_mut().for_each(|row| row.time_s -= 20.0);
    });
    let finding = one(&findings, Kind::ClockSetBack);
    assert!((finding.figure.value + 20.0).abs() < 1.0, "{finding}");
    assert!(run.rows.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
}

#[test]
fn a_clock_coarser_than_its_rows_is_no_other_unit() {
    for (step_s, done) in [(60.0, Done::Refused), (10.0, Done::Refused), (1.5, Done::Said)] {
        let (findings, _) = spoilt(Recorder::default(), |rows| {
            rows.iter_mut().for_each(|row| row.time_s = (row.time_s / step_s).floor() * step_s);
        });
        let first = &findings[0];
        assert_eq!((first.kind, first.done), (Kind::CoarseClock, done), "{findings:?}");
        assert!(findings.iter().all(|finding| finding.kind != Kind::OtherUnit), "{findings:?}");
    }
}

#[test]
fn a_speed_that_cannot_exceed_a_value_is_no_other_unit() {
    let (findings, _) = spoilt(Recorder::default(), |rows| {
        rows.iter_mut().for_each(|row| row.speed_mps = row.speed_mps.map(|mps| mps.min(30.0 / 3.6)));
    });
    assert!(findings.iter().all(|finding| finding.kind != Kind::OtherUnit), "{findings:?}");
    assert!(findings.iter().any(|finding| finding.kind == Kind::StuckSpeed), "{findings:?}");
}

#[test]
fn a_unit_that_changes_within_a_log_is_named_with_its_line() {
    let (findings, _) = spoilt(Recorder::default(), |rows| {
        let half = rows.len() / 2;
        rows[half..].iter_mut().for_each(|row| row.speed_mps = row.speed_mps.map(|mps| mps / 3.6));
    });
    let finding = findings.iter().find(|finding| finding.kind == Kind::OtherUnit).unwrap();
    assert!(
        (finding.figure.value - 3.6).abs() < 0.3 && finding.done == Done::Refused && finding.line > 100,
        "{finding}"
    );
}

#[test]
fn rows_a_minute_apart_have_no_threshold() {
    for seed in 0..10 {
        let (found, _) = Recorder { step_s: 60.0, ..Recorder::default() }.check(71_000 + seed, 8, 12);
        assert!(!kinds(&found).contains(&Kind::DeadZone), "{seed}");
    }
}

/// Between rows 30 s apart a train starts: the mean of both speeds is no distance over time.
#[test]
fn rows_far_apart_tell_nothing_of_the_speed() {
    for seed in 0..6 {
        let recorder = Recorder { step_s: 30.0, ..Recorder::default() };
        let (found, recordings) = recorder.check(74_000 + seed, 12, 8);
        assert_eq!(found.recorders[0].compared, 0);
        let of_speed = [Kind::TruncatedSpeed, Kind::SpeedOffset, Kind::SpeedScale, Kind::Skew];
        assert!(kinds(&found).iter().all(|kind| !of_speed.contains(kind)), "{:?}", found.notes());
        let was = recorder.runs(74_000 + seed, 12, 8);
        let rows = recordings.iter().zip(&was).flat_map(|(is, was)| is.rows.iter().zip(&was.rows));
        assert!(rows.into_iter().all(|(is, was)| is.speed_mps == was.speed_mps));
    }
}

/// For 25 s a receiver says its last fix, in rows 10 s apart two or three times; then it is where the train is.
#[test]
fn a_receiver_that_stands_still_for_two_rows_begins_nowhere_again() {
    for late in 0..10 {
        let (findings, run) = spoilt(Recorder { step_s: 1.0, ..Recorder::default() }, |rows| {
            let from = fast(rows, 240) + 20;
            let last = rows[from];
            for row in &mut rows[from..from + 25] {
                (row.location_m, row.speed_mps) = (last.location_m, last.speed_mps);
            }
            *rows = rows.iter().skip((from + late) % 10).step_by(10).copied().collect();
        });
        let line = one(&findings, Kind::StuckLocation).line;
        let first = run.rows.iter().position(|row| row.line == line).unwrap();
        // What is written a fifth of the step after the last fix and later is no place of the train.
        assert!(late == 2 || run.rows[first].location_m.is_none() == (late > 2), "{late}: {findings:?}");
        assert!(run.rows[first + 1].location_m.is_none() && run.rows[first + 3].location_m.is_some(), "{late}");
    }
}

#[test]
fn a_wild_speed_in_a_row_is_no_end_of_a_line_that_bridges_others() {
    let (findings, _) = spoilt(Recorder { noise_m: 0.0, ..Recorder::default() }, |rows| {
        // Where the train hardly changes its speed it keeps it, on a straight line.
        let mps = |row: usize| rows[row].speed_mps.unwrap();
        let is_even = |row: &usize| mps(*row) > 10.0 && (mps(row + 30) - mps(*row)).abs() < 0.1;
        let from = (60..rows.len() - 30).find(is_even).unwrap();
        let (at_m, speed_mps, begin_s) = (rows[from].location_m.unwrap(), mps(from), rows[from].time_s);
        let (end_m, end_s) = (rows[from + 30].location_m.unwrap(), rows[from + 30].time_s);
        for row in &mut rows[from..from + 30] {
            row.speed_mps = Some(speed_mps);
            row.location_m = Some(at_m + (end_m - at_m) * (row.time_s - begin_s) / (end_s - begin_s));
        }
        rows[from + 20].speed_mps = Some(255.0 / 3.6);
    });
    assert_eq!(one(&findings, Kind::SpeedSpikes).count, 1);
}
