//! Are speeds that are counted in one unit and written in steps of another read in the unit that they were counted in?

use crate::simulated::{self, Recorder, all, kinds};
use rundown_check::check;
use rundown_check::finding::{Done, Kind};

const MPH: f64 = 1.609_344;

/// Before, cutting off was an offset of unknown cause, put right or not.
#[test]
fn cutting_off_and_a_wheel_are_found_whatever_the_speeds_are_written_in() {
    for (seed, unit_kmh, written_kmh, scale) in
        [(1, 1.0, 0.36, 1.0), (2, 1.0, 0.036, 1.013), (3, MPH, 1.0, 1.0), (4, MPH, 0.1, 0.987)]
    {
        for truncates in [false, true] {
            let recorder = Recorder { quantum_kmh: unit_kmh, truncates, scale, ..Recorder::default() };
            let mut runs = recorder.runs(5100 + seed, 6, 5);
            for speed_mps in runs.iter_mut().flat_map(|run| &mut run.rows).filter_map(|row| row.speed_mps.as_mut()) {
                *speed_mps = (3.6 * *speed_mps / written_kmh).round() * written_kmh / 3.6;
            }
            let found = check(&mut runs);
            let finding = simulated::found(&found, Kind::RewrittenSpeed);
            assert_eq!((finding.figure.value, finding.done), (unit_kmh, Done::PutRight), "{seed}");
            assert_eq!(found.recorders[0].speed_step_kmh, Some(unit_kmh), "{seed}");
            assert_eq!(kinds(&found).contains(&Kind::TruncatedSpeed), truncates, "{seed}: {:?}", all(&found));
            assert_eq!(kinds(&found).contains(&Kind::SpeedScale), scale != 1.0, "{seed}: {:?}", all(&found));
            let wrong = [Kind::SpeedOffset, Kind::RoundedUpSpeed, Kind::Creep, Kind::Stairs];
            assert!(!kinds(&found).iter().any(|kind| wrong.contains(kind)), "{seed}: {:?}", all(&found));
        }
    }
}

#[test]
fn recorders_that_write_what_they_count_are_not_said_to_count_in_another_unit() {
    for (seed, quantum_kmh) in [(1, 1.0), (2, 0.1), (3, MPH), (4, 5.0), (5, 0.36), (6, 0.01)] {
        for truncates in [false, true] {
            let (found, _) = Recorder { quantum_kmh, truncates, ..Recorder::default() }.check(5200 + seed, 3, 5);
            assert!(!kinds(&found).contains(&Kind::RewrittenSpeed), "{quantum_kmh}: {:?}", all(&found));
        }
    }
}
