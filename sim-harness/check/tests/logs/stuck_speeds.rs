//! A recorder that repeats its last speed while the train brakes or powers: the speed is named, and not the locations
//! beside it.

use crate::simulated::{all, kinds};
use rundown_check::check;
use rundown_check::finding::Kind;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

/// A train that does this for so many seconds, one after the other, m/s²; whole metres, tenths of km/h, rows `step_s`
/// apart.
fn driven(parts: &[(usize, f64)], step_s: usize) -> Vec<Sample> {
    let (mut at_m, mut mps) = (0.0, 0.0_f64);
    let changes = parts.iter().flat_map(|(long_s, mps2)| std::iter::repeat_n(*mps2, *long_s));
    let row = |(second, mps2): (usize, f64)| {
        let before_mps = mps;
        mps = (mps + mps2).max(0.0);
        at_m += 0.5 * (before_mps + mps);
        let (location_m, speed_mps) = (Some(f64::floor(at_m)), Some((36.0 * mps).round() / 36.0));
        Sample { line: second as u64 + 2, time_s: second as f64, location_m, speed_mps, ..Sample::default() }
    };
    changes.enumerate().map(row).step_by(step_s).collect()
}

/// Powers, holds its speed, brakes to half of it, holds that, powers, holds, brakes to a stand, stands; three times.
fn run(step_s: usize) -> Vec<Sample> {
    let hop = [(40, 0.75), (200, 0.0), (20, -0.75), (150, 0.0), (20, 0.75), (100, 0.0), (50, -0.6), (60, 0.0)];
    driven(&hop.repeat(3), step_s)
}

/// What is found where the speed of second `from` stands still until second `to`.
fn found(step_s: usize, [from_s, to_s]: [f64; 2]) -> (Vec<Kind>, String) {
    let mut rows = run(step_s);
    let stays = rows.iter().find(|row| row.time_s >= from_s).and_then(|row| row.speed_mps);
    let stuck = rows.iter_mut().filter(|row| (from_s..to_s).contains(&row.time_s));
    stuck.for_each(|row| row.speed_mps = stays);
    let found = check(&mut [Recording { name: "run".into(), rows, ..Recording::default() }]);
    (kinds(&found), format!("{:?}", all(&found)))
}

#[test]
fn a_speed_that_stands_still_is_named_and_no_location_beside_it() {
    // From powering into the cruise, from braking into the lower one, down to a stand, down to it and up again.
    let stuck = [[670.0, 740.0], [885.0, 960.0], [1170.0, 1215.0], [1185.0, 1300.0]];
    let accused = [Kind::Bridged, Kind::StuckLocation, Kind::Reset, Kind::LocationSpikes];
    for step_s in [1, 2, 5] {
        let kinds = found(step_s, [0.0, 0.0]);
        assert!(
            !kinds.0.contains(&Kind::StuckSpeed) && !kinds.0.iter().any(|kind| accused.contains(kind)),
            "{kinds:?}"
        );
        for stuck in stuck {
            let (kinds, said) = found(step_s, stuck);
            assert!(kinds.contains(&Kind::StuckSpeed), "{step_s} {stuck:?}: {said}");
            assert!(!kinds.iter().any(|kind| accused.contains(kind)), "{step_s} {stuck:?}: {said}");
        }
    }
}

/// A speed of zero that stands still while the train powers: in rows 10 s apart the way of the second one is as that of
/// locations that begin elsewhere.
#[test]
fn a_zero_that_stands_still_in_rows_far_apart_is_no_location_that_begins_again() {
    let (kinds, said) = found(10, [600.0, 675.0]);
    assert!(kinds.contains(&Kind::StuckSpeed) && !kinds.contains(&Kind::Reset), "{said}");
}
