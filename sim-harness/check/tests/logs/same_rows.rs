//! Is a log that is given several times counted once, and are two runs that are alike left apart?

use crate::simulated::{Recorder, recording};
use rundown_check::finding::{Done, Kind};
use rundown_check::rows::same::Seen;
use rundown_check::{Check, Known, check, check_after};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

/// Three runs, and the second of them again, changed by `spoil`.
fn again(seed: u64, spoil: impl Fn(&mut Recording)) -> (Vec<Recording>, Check) {
    let mut recordings = Recorder::default().runs(seed, 3, 3);
    let mut copy = recordings[1].clone();
    copy.name = "copy".to_owned();
    spoil(&mut copy);
    recordings.push(copy);
    let found = check(&mut recordings);
    (recordings, found)
}

fn refused(check: &Check) -> Vec<(&str, Kind)> {
    check.refused().map(|run| (run.name.as_str(), run.refusal().unwrap().kind)).collect()
}

#[test]
fn the_same_rows_are_counted_once_under_any_name_and_by_any_clock() {
    let clock = |by_s: f64| move |copy: &mut Recording| copy.rows.iter_mut().for_each(|row| row.time_s += by_s);
    for seed in 0..5 {
        for (_, found) in [again(seed, |_| ()), again(seed, clock(3600.0)), again(seed, clock(0.1))] {
            assert_eq!(refused(&found), [("copy", Kind::SameRows)], "{seed}");
            let copy = &found.runs[3];
            let text = copy.said(copy.refusal().unwrap());
            assert!(text.contains("run01") && copy.refusal().unwrap().done == Done::Refused, "{text}");
            assert!(text.contains(" rows;") && !text.contains('.'), "rows are whole: {text}");
        }
        let (_, found) = again(seed, |copy| copy.rows.iter_mut().for_each(|row| row.line += 7));
        assert_eq!(refused(&found), [("copy", Kind::SameRows)]);
    }
}

#[test]
fn a_log_that_differs_in_one_reading_is_still_given_twice() {
    let (_, found) = again(7, |copy| copy.rows[40].speed_mps = copy.rows[40].speed_mps.map(|mps| mps + 1.0 / 3.6));
    assert_eq!(refused(&found), [("copy", Kind::SharedRows)]);
}

/// Two standing trains read alike: only their clocks say that they are two.
#[test]
fn the_clocks_distinguish_two_trains_that_stand() {
    let standing = |from_s: f64| {
        let row = |i| Sample {
            time_s: from_s + f64::from(i),
            location_m: Some(0.0),
            speed_mps: Some(0.0),
            ..Sample::default()
        };
        (0..100).map(row).collect::<Vec<Sample>>()
    };
    let of = |starts_s: [f64; 2]| check(&mut starts_s.map(|from_s| recording(&format!("{from_s}"), standing(from_s))));
    assert_eq!(of([0.0, 5000.0]).refused().count(), 0);
    assert_eq!(of([0.0, 0.0]).refused().count(), 1);
}

/// Runs are read a chunk at a time.
#[test]
fn a_copy_in_a_later_chunk_is_found() {
    let mut seen = Seen::default();
    let mut chunk = Recorder::default().runs(11, 2, 3);
    let mut later = chunk.clone();
    assert_eq!(check_after(&mut chunk, &Known::default(), &mut seen).refused().count(), 0);
    assert_eq!(check_after(&mut later, &Known::default(), &mut seen).refused().count(), 2);
}

#[test]
fn no_two_runs_of_a_line_are_taken_for_one() {
    for recorder in
        [Recorder::default(), Recorder { step_s: 10.0, odometer_m: 1.0, noise_m: 0.3, ..Recorder::default() }]
    {
        for seed in 0..15 {
            assert_eq!(recorder.check(30_000 + seed, 8, 3).0.refused().count(), 0, "{seed}");
        }
    }
}

#[test]
fn a_log_that_holds_rows_of_another_one_says_how_many() {
    for seed in 80_000..80_010 {
        for odometer_m in [0.0, 1.0] {
            let recorder =
                Recorder { odometer_m, noise_m: if odometer_m > 0.0 { 0.3 } else { 4.0 }, ..Recorder::default() };
            let found = |cut: fn(&mut Vec<Sample>)| {
                let mut recordings = recorder.runs(seed, 3, 3);
                let mut part = recordings[1].clone();
                part.name = "part".to_owned();
                cut(&mut part.rows);
                recordings.push(part);
                let found = check(&mut recordings);
                let shared = found.runs[3].findings.iter().find(|finding| finding.kind == Kind::SharedRows).cloned();
                let others = found.runs[..3].iter().flat_map(|run| &run.findings);
                assert!(others.clone().all(|finding| finding.kind != Kind::SharedRows), "{seed}");
                shared.map(|finding| (finding.figure.value, finding.done))
            };
            let (percent, done) = found(|rows| rows.truncate(rows.len() / 2)).unwrap();
            assert!(percent > 90.0 && done == Done::Refused, "{seed} {odometer_m}: {percent}");
            // Half of it is its own: another train's rows, far from those.
            let (percent, done) = found(|rows| {
                let half = rows.len() / 2;
                rows[half..].iter_mut().enumerate().for_each(|(i, row)| {
                    row.location_m = row.location_m.map(|m| m + 0.7 + 1e-3 * (i % 7) as f64);
                });
            })
            .unwrap();
            assert!((20.0..80.0).contains(&percent) && done == Done::Said, "{seed} {odometer_m}: {percent}");
        }
    }
}

/// Full power from the same platform, in whole km/h and metres: the same rows, until one of them has gone far enough to
/// differ.
#[test]
fn two_trains_that_start_alike_are_no_log_that_is_given_again() {
    let started = |alike: u32, slower: f64| {
        let row = |i: u32| {
            let speed_mps = 0.9 * f64::from(i) - if i > alike { slower * f64::from(i - alike) } else { 0.0 };
            let location_m = 0.5 * f64::from(i) * speed_mps;
            let (location_m, speed_mps) = (Some(location_m.round()), Some((3.6 * speed_mps).round() / 3.6));
            Sample { time_s: f64::from(i), location_m, speed_mps, ..Sample::default() }
        };
        (0..80).map(row).collect::<Vec<Sample>>()
    };
    let shared = |alike: u32| {
        let found = check(&mut [0.1, 0.3].map(|slower| recording(&format!("{slower}"), started(alike, slower))));
        found.runs.iter().flat_map(|run| &run.findings).filter(|finding| finding.kind == Kind::SharedRows).count()
    };
    assert_eq!([30, 70].map(shared), [0, 1]);
}
