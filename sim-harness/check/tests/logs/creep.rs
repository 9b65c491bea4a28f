//! Are wheels that creep while they power named, and taken for no wheel that is off?

use crate::simulated::{Recorder, all, check_for_replay, find, found, kinds};
use rundown_check::finding::{Done, Kind};
use rundown_files::recording::Recording;

/// A speed that falls faster is that of a train that coasts or brakes, m/s².
const POWERS_MPS2: f64 = -0.02;
/// Over so long before and behind, s.
const AROUND_S: f64 = 4.0;

/// The wheel turns by `factor` of the train wherever it powers, also to hold its speed: where its speed rises, or falls
/// by less than at `powers_mps2`.
fn creep(recordings: &mut [Recording], recorder: &Recorder, factor: f64, powers_mps2: f64) {
    let around = (AROUND_S / recorder.step_s).ceil() as usize;
    for recording in recordings {
        let speeds: Vec<f64> = recording.rows.iter().map(|row| row.speed_mps.unwrap()).collect();
        for (i, row) in recording.rows.iter_mut().enumerate() {
            let [from, to] = [i.saturating_sub(around), (i + around).min(speeds.len() - 1)];
            if (speeds[to] - speeds[from]) / ((to - from) as f64 * recorder.step_s) > powers_mps2 {
                let steps = (3.6 * factor * speeds[i] / recorder.quantum_kmh).round();
                row.speed_mps = Some(steps * recorder.quantum_kmh / 3.6);
            }
        }
    }
}

fn recorders(scale: f64) -> [Recorder; 3] {
    let fine = Recorder { quantum_kmh: 0.1, noise_m: 3.0, scale, ..Recorder::default() };
    [fine, Recorder { step_s: 2.0, ..fine }, Recorder { quantum_kmh: 1.0, ..fine }]
}

#[test]
fn wheels_that_creep_while_they_power_are_named_and_none_is_put_right() {
    for (i, recorder) in (0..).zip(recorders(1.0)) {
        let mut runs = recorder.hopping(93_000 + i, 8, 8);
        creep(&mut runs, &recorder, 1.02, POWERS_MPS2);
        let read: Vec<_> = runs.iter().flat_map(|run| run.rows.iter().map(|row| row.speed_mps)).collect();
        let check = check_for_replay(&mut runs);
        let creep = found(&check, Kind::Creep);
        assert!(creep.done == Done::Said && (1.0..2.3).contains(&creep.figure.value), "{i} {creep}");
        assert!(creep.figure.sd < 0.3, "{i} {creep}");
        let wrong = [Kind::SpeedScale, Kind::WheelChange];
        assert!(!kinds(&check).iter().any(|kind| wrong.contains(kind)), "{i} {:?}", all(&check));
        let now = runs.iter().flat_map(|run| run.rows.iter().map(|row| row.speed_mps));
        assert!(now.eq(read), "{i} {:?}", all(&check));
        assert!(check.notes().iter().any(|note| note.contains("creep")), "{:?}", check.notes());
    }
}

#[test]
fn a_wheel_that_is_off_at_all_times_does_not_creep() {
    for scale in [1.0, 0.985, 1.015] {
        for (i, recorder) in (0..).zip(recorders(scale)) {
            let check = check_for_replay(&mut recorder.hopping(94_000 + i, 8, 8));
            assert!(find(&check, Kind::Creep).is_none(), "{scale} {i} {:?}", all(&check));
            let wheel = find(&check, Kind::SpeedScale).filter(|wheel| wheel.done == Done::PutRight);
            assert_eq!(wheel.is_some(), scale != 1.0, "{scale} {i} {:?}", all(&check));
        }
    }
}

/// On climbs a train powers while it gets slower.
#[test]
fn creep_of_trains_that_power_while_they_get_slower_is_named_by_their_brakes() {
    for (i, recorder) in (0..).zip(recorders(1.0)) {
        let mut runs = recorder.runs(95_000 + i, 8, 3);
        creep(&mut runs, &recorder, 1.02, -0.15);
        let check = check_for_replay(&mut runs);
        let creep = found(&check, Kind::Creep);
        assert!(creep.done == Done::Said && (1.0..2.3).contains(&creep.figure.value), "{i} {creep}");
        assert!(!kinds(&check).contains(&Kind::SpeedScale), "{i} {:?}", all(&check));
    }
}
