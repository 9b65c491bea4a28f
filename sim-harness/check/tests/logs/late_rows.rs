//! Is a speed that is late by a row or two compared with the locations that it belongs to?

use crate::simulated::{Recorder, all, kinds};
use rundown_check::finding::Kind;
use rundown_check::{Known, check_beside};

const WRONG: [Kind; 3] = [Kind::SpeedScale, Kind::SpeedOffset, Kind::WheelChange];

#[test]
fn truncation_and_wheels_are_seen_beside_speeds_that_are_rows_late() {
    let late = |skew_s| Recorder { step_s: 10.0, noise_m: 0.5, skew_s, ..Recorder::default() };
    for (seed, skew_s) in [(1, 10.0), (2, 8.0), (3, 20.0), (4, 10.0), (5, -10.0), (6, 13.0)] {
        let (found, _) = Recorder { truncates: true, ..late(skew_s) }.check(31_000 + seed, 8, 6);
        let is_right =
            kinds(&found).contains(&Kind::TruncatedSpeed) && !kinds(&found).iter().any(|kind| WRONG.contains(kind));
        let skew = found.recorders[0].skew_s.unwrap();
        assert!(is_right && (skew.value - skew_s).abs() < 0.3, "{skew_s}: {skew:?} {:?}", all(&found));
        let (found, _) = Recorder { quantum_kmh: 0.1, scale: 1.01, ..late(skew_s) }.check(32_000 + seed, 8, 6);
        let scale = found.recorders[0].scale.unwrap();
        assert!((scale.value - 1.01).abs() < 1.96 * scale.sd.max(0.0005) && scale.sd < 0.003, "{skew_s}: {scale:?}");
        let wrong = [Kind::SpeedOffset, Kind::WheelChange];
        assert!(!kinds(&found).iter().any(|kind| wrong.contains(kind)), "{skew_s}: {:?}", all(&found));
    }
}

#[test]
fn a_tram_whose_speeds_are_seconds_late_has_no_other_offset_and_no_wheel() {
    for (seed, skew_s) in [(1, 3.0), (2, -3.0), (3, 2.0)] {
        let late = Recorder { quantum_kmh: 0.1, noise_m: 0.3, drift_m: 0.0, skew_s, ..Recorder::default() };
        let found = check_beside(&mut late.trams(34_000 + seed, 8, 15), &Known::default());
        assert!(!kinds(&found).iter().any(|kind| WRONG.contains(kind)), "{skew_s}: {:?}", all(&found));
        let skew = found.recorders[0].skew_s.unwrap();
        assert!((skew.value - skew_s).abs() < 0.05, "{skew_s}: {skew:?}");
    }
}

#[test]
fn a_run_too_short_to_say_how_late_its_speeds_are_has_those_of_its_recorder() {
    let late = Recorder { step_s: 10.0, noise_m: 0.5, quantum_kmh: 0.1, skew_s: 10.0, ..Recorder::default() };
    let mut recordings = late.runs(33_000, 7, 6);
    let rows = &mut recordings[6].rows;
    let from = 3 + rows.iter().position(|row| row.speed_mps > Some(10.0)).unwrap();
    *rows = rows[from..from + 12].to_vec();
    let read = rows.clone();
    let found = check_beside(&mut recordings, &Known { moves_locations: true, ..Known::default() });
    assert!(found.runs[6].skew_s.is_none() && kinds(&found).contains(&Kind::Skew));
    for (row, read) in recordings[6].rows.iter().zip(&read) {
        let moved_s = (read.location_m.unwrap() - row.location_m.unwrap()) / read.speed_mps.unwrap();
        assert!((moved_s - 10.0).abs() < 1.0, "{moved_s}");
    }
}

/// A filter of 3 s is as late as it is long, and no delay: as one it was given wheels of 0.96 to 0.99 and offsets.
#[test]
fn speeds_behind_a_filter_of_first_order_have_no_wheel() {
    let exact = Recorder { quantum_kmh: 0.1, noise_m: 0.0, odometer_m: 1.0, ..Recorder::default() };
    for mut runs in [exact.trams(35_001, 8, 15), exact.hopping(35_002, 8, 6)] {
        for recording in &mut runs {
            let mut behind_mps = 0.0;
            for row in &mut recording.rows {
                behind_mps += (1.0 - (-1.0_f64 / 3.0).exp()) * (row.speed_mps.unwrap() - behind_mps);
                row.speed_mps = Some((36.0 * behind_mps).round() / 36.0);
            }
        }
        let found = check_beside(&mut runs, &Known::default());
        assert!(!kinds(&found).iter().any(|kind| WRONG.contains(kind)), "{:?}", all(&found));
        let skew = found.recorders[0].skew_s.unwrap();
        assert!((skew.value - 2.5).abs() < 0.2, "{skew:?}");
    }
}
