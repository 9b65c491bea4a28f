//! Is a wheel that is turned on the way, or between two runs, found with its place and size, put right, and nothing
//! else?

use crate::simulated::{Recorder, only};
use rundown_check::check;
use rundown_check::finding::{Done, Finding, Kind};
use rundown_files::recording::Recording;

fn recorders() -> [Recorder; 4] {
    let odometer = Recorder { noise_m: 0.3, odometer_m: 1.0, ..Recorder::default() };
    let drifting = Recorder { quantum_kmh: 0.1, noise_m: 1.0, drift_m: 6.0, ..Recorder::default() };
    [Recorder::default(), odometer, Recorder { truncates: true, ..Recorder::default() }, drifting]
}

/// Distance by speed over that by location, of the second half of a run.
fn scale_at_the_end(recording: &Recording) -> f64 {
    let rows = &recording.rows[recording.rows.len() / 2..];
    let by_speed: f64 =
        rows.windows(2).map(|pair| pair[1].speed_mps.unwrap() * (pair[1].time_s - pair[0].time_s)).sum();
    by_speed / (rows[rows.len() - 1].location_m.unwrap() - rows[0].location_m.unwrap())
}

fn is_right(finding: &Finding, ratio: f64) -> bool {
    (finding.figure.value - ratio).abs() < 2e-3 && finding.done == Done::PutRight
}

#[test]
fn a_wheel_that_changes_on_the_way_is_found_with_its_place() {
    // Locations that drift for a minute hide 1 % of a single run.
    for recorder in &recorders()[..3] {
        for (seed, ratio) in (0..4).flat_map(|seed| [(seed, 0.99), (seed, 1.013)]) {
            let changed = Recorder { turned_at: 0.4, turned: ratio, ..*recorder };
            let mut recordings = recorder.runs(50_000 + seed, 4, 5);
            recordings[2] = changed.runs(50_000 + seed, 4, 5).remove(2);
            let changes = recordings[2].rows.len() * 2 / 5;
            let (line, length) = (recordings[2].rows[changes].line, recordings[2].rows.len() as f64);
            let found = check(&mut recordings);
            let of_run = &found.runs[2].findings;
            let finding = of_run.iter().find(|finding| finding.kind == Kind::WheelChange);
            let finding = finding.unwrap_or_else(|| panic!("{seed} {ratio}: {:?}", found.notes()));
            assert!(is_right(finding, ratio), "{seed}: {finding}");
            assert!((finding.line as f64 - line as f64).abs() < 0.15 * length, "{seed} {line}: {finding}");
            let scale = scale_at_the_end(&recordings[2]);
            assert!((scale - 1.0).abs() < 2.5e-3, "{seed} {ratio}: {scale}");
            let others = found.runs.iter().flat_map(|run| &run.findings).filter(|one| one.kind != Kind::WheelChange);
            assert_eq!(others.count(), 0, "{seed} {ratio}: {:?}", found.notes());
        }
    }
}

#[test]
fn a_wheel_that_is_another_one_from_a_run_on_is_found_with_that_run() {
    for recorder in recorders() {
        for (seed, ratio) in (0..3).flat_map(|seed| [(seed, 0.99), (seed, 1.013)]) {
            let turned = Recorder { scale: ratio, ..recorder };
            let mut recordings = recorder.runs(51_000 + seed, 12, 3);
            recordings.splice(7.., turned.runs(51_000 + seed, 12, 3).split_off(7));
            // Read in any order: the days decide.
            (0..12).for_each(|i| recordings[i].day = Some(20_000.0 + i as f64));
            recordings.reverse();
            let found = check(&mut recordings);
            let recorder = &found.recorders[0];
            let finding = recorder.findings.iter().find(|finding| finding.kind == Kind::WheelChange);
            let finding = finding.unwrap_or_else(|| panic!("{seed} {ratio}: {:?}", recorder.findings));
            assert!(is_right(finding, ratio), "{seed}: {finding}");
            assert!(recorder.said(finding).contains("from run07 on"), "{}", recorder.said(finding));
            for recording in &recordings {
                let scale = scale_at_the_end(recording);
                assert!((scale - 1.0).abs() < 4e-3, "{seed} {ratio} {}: {scale}", recording.name);
            }
            let others = found.runs.iter().flat_map(|run| &run.findings);
            assert_eq!(others.count(), 0, "{seed} {ratio}: {:?}", found.notes());
            let scale = recorder.scale.unwrap();
            assert!((scale.value - 1.0).abs() < 2e-3, "{scale:?}");
        }
    }
}

#[test]
fn a_wheel_that_stays_as_it_is_changes_nowhere() {
    let wheel = Recorder { scale: 1.02, ..Recorder::default() };
    for seed in 0..6 {
        only(&wheel.check(52_000 + seed, 12, 3).0, Kind::SpeedScale);
    }
}
