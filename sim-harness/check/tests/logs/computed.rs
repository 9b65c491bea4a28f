//! Is a speed that was computed from the locations no fault of the recorder, whatever multipath made of it?

use crate::simulated::{Recorder, all, kinds};
use rundown_check::finding::Kind;
use rundown_check::limits::Described;
use rundown_check::{Check, Known, check_beside};
use rundown_files::recording::Recording;

/// Runs whose speeds have the length of a scattering vector, as those of positions beside walls.
fn beside_walls(seed: u64, computed: usize) -> Vec<Recording> {
    let receiver = Recorder { quantum_kmh: 0.1, noise_m: 3.0, drift_m: 6.0, ..Recorder::default() };
    let mut recordings = receiver.runs(36_000 + seed, 6, 5);
    for row in recordings.iter_mut().take(computed).flat_map(|recording| &mut recording.rows) {
        row.speed_mps = row.speed_mps.map(|mps| mps.hypot(6.0));
    }
    recordings
}

fn say_so(recordings: &mut [Recording], computed: usize) {
    let rows = recordings.iter_mut().take(computed).flat_map(|recording| &mut recording.rows);
    rows.for_each(|row| row.speed_is_computed = true);
}

fn checked(recordings: &mut [Recording]) -> Check {
    let limits = Described { train: None, speeds: vec![(-1e6, 60.0)] };
    check_beside(recordings, &Known { limits, moves_locations: true, ..Known::default() })
}

#[test]
fn speeds_of_positions_are_blamed_for_nothing() {
    for seed in 0..5 {
        let mut recordings = beside_walls(seed, 6);
        let blamed = kinds(&checked(&mut recordings.clone()));
        assert!(blamed.contains(&Kind::SpeedOffset) && blamed.contains(&Kind::AboveSpeedLimit), "{blamed:?}");
        say_so(&mut recordings, 6);
        let read = recordings.clone();
        let found = checked(&mut recordings);
        assert_eq!(kinds(&found), [Kind::ComputedSpeed], "{seed}: {:?}", all(&found));
        let recorder = &found.recorders[0];
        assert_eq!((recorder.compared, recorder.scale, found.clean()), (0, None, 6));
        assert!(recordings.iter().zip(read).all(|(now, was)| now.rows == was.rows));
    }
}

#[test]
fn beside_them_speeds_that_were_read_are_judged_as_ever() {
    let mut recordings = beside_walls(9, 3);
    say_so(&mut recordings, 3);
    for row in recordings[3..].iter_mut().flat_map(|recording| &mut recording.rows) {
        row.speed_mps = row.speed_mps.map(|mps| 1.02 * mps);
    }
    let read = recordings.clone();
    let found = check_beside(&mut recordings, &Known::default());
    let recorder = &found.recorders[0];
    assert_eq!((recorder.compared, recorder.runs), (3, 6));
    assert!(recorder.scale.is_some_and(|scale| (scale.value - 1.02).abs() < 0.004), "{:?}", recorder.scale);
    assert!(recordings.iter().zip(read).take(3).all(|(now, was)| now.rows == was.rows), "a wheel of the others");
}
