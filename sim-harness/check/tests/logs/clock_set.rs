//! Is a clock that is set by seconds while the train moves distinguished from locations that leap and from rows that
//! are missing?

use crate::simulated::{Recorder, all, kinds};
use rundown_check::check;
use rundown_check::finding::{Done, Kind};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

fn recorders() -> [Recorder; 3] {
    let odometer = Recorder { noise_m: 0.3, odometer_m: 1.0, ..Recorder::default() };
    [Recorder::default(), odometer, Recorder { step_s: 10.0, ..Recorder::default() }]
}

/// The first row behind the middle at which the train has run at 15 m/s and more for four rows, and goes on so.
fn running(rows: &[Sample]) -> usize {
    let is_fast = |row: &Sample| row.speed_mps.is_some_and(|mps| mps > 15.0);
    (rows.len() / 2..rows.len() - 4).find(|i| rows[i - 4..i + 4].iter().all(is_fast)).unwrap()
}

/// Changes all rows of a run from that one on. Out: its line.
fn changed(Recording { rows, .. }: &mut Recording, change: impl Fn(&mut Sample)) -> u64 {
    let at = running(rows);
    rows[at..].iter_mut().for_each(change);
    rows[at].line
}

#[test]
fn a_clock_that_is_set_by_seconds_is_put_right() {
    for (which, recorder) in recorders().into_iter().enumerate() {
        for (seed, set_s) in [3.0, 5.0, 7.0, 20.0, -3.0, -10.0].into_iter().enumerate() {
            let mut recordings = recorder.runs(61_000 + seed as u64, 4, 5);
            let truth = recordings[1].rows.clone();
            let line = changed(&mut recordings[1], |row| row.time_s += set_s);
            let found = check(&mut recordings);
            let clock: Vec<_> = found.runs[1].findings.iter().filter(|one| one.unit == "s").collect();
            let kind = if set_s > 0.0 { Kind::ClockSetForward } else { Kind::ClockSetBack };
            let [finding] = clock.as_slice() else { panic!("{which}, {set_s} s: {:?}", all(&found)) };
            assert_eq!((finding.kind, finding.done, finding.line), (kind, Done::PutRight, line), "{which}");
            let [low, high] = finding.figure.interval();
            assert!((low..=high).contains(&set_s) && high - low < 2.0, "{which}, {set_s} s: {finding}");
            let off = recordings[1].rows.iter().zip(truth).map(|(row, truth)| (row.time_s - truth.time_s).abs());
            assert!(off.fold(0.0, f64::max) < 0.5, "{which}, {set_s} s");
            assert!(!kinds(&found).contains(&Kind::Reset), "{which}, {set_s} s: {:?}", all(&found));
        }
    }
}

/// The location of the row behind the gap is an old one for some rows, or the locations begin again elsewhere there.
#[test]
fn a_receiver_that_stands_still_behind_a_gap_and_locations_that_leap_are_no_clock() {
    for (which, recorder) in recorders().into_iter().enumerate() {
        for seed in 0..6 {
            let mut recordings = recorder.runs(62_000 + seed, 4, 5);
            let rows = &mut recordings[1].rows;
            let (at, gap) = (running(rows), (30.0 / recorder.step_s) as usize);
            let old = rows[at + gap / 2];
            for row in &mut rows[at + gap..at + gap + 6] {
                (row.location_m, row.speed_mps) = (old.location_m, old.speed_mps);
            }
            rows.drain(at..at + gap);
            changed(&mut recordings[2], |row| row.location_m = row.location_m.map(|m| m - 300.0));
            let found = check(&mut recordings);
            let is_clock = |kind: &Kind| matches!(kind, Kind::ClockSetForward | Kind::ClockSetBack);
            assert!(!kinds(&found).iter().any(is_clock), "{which}, {seed}: {:?}", all(&found));
        }
    }
}
