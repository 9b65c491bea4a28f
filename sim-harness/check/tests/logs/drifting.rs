//! Locations that drift between balises: neither is an exact speed accused of a wheel, nor does a wheel that both have
//! in common hide.

use crate::simulated::{all, kinds};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rundown_check::check;
use rundown_check::finding::{Done, Kind};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

/// A run of 40 km that stops twice, and is set right at each: the location leaps by so much there, m.
fn set_right_at_stops(seed: u64, leap_m: impl Fn(f64, &mut ChaCha8Rng) -> f64) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut recording, truth) = run(seed, 1.0, 1.0);
    let (mut off_m, mut since_m) = (0.0, 0.0);
    for (at, (row, at_m)) in recording.rows.iter_mut().zip(&truth).enumerate() {
        // At a standstill.
        if at % 700 == 695 {
            off_m += leap_m(at_m - since_m, &mut random);
            since_m = *at_m;
        }
        row.location_m = row.location_m.map(|m| m + off_m);
    }
    recording
}

/// A run of 40 km that stops twice. The location reads `located` of the way since the last balise, the speed `speed` of
/// the true one.
fn run(seed: u64, located: f64, speed: f64) -> (Recording, Vec<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = |random: &mut ChaCha8Rng, sd: f64| {
        sd * {
            let x: f64 = StandardNormal.sample(random);
            x
        }
    };
    let (mut at_m, mut mps, mut off_m, mut since_m) = (0.0, 0.0_f64, 0.0, 0.0);
    let mut balise_m = random.random_range(800.0..2500.0);
    let (mut rows, mut truth) = (Vec::new(), Vec::new());
    for second in 0..2000 {
        let wanted_mps = if second % 700 > 620 { 0.0 } else { 22.0 + 8.0 * (f64::from(second) / 90.0).sin() };
        let before_mps = mps;
        mps += (wanted_mps - mps).clamp(-0.7, 0.5);
        let way_m = 0.5 * (before_mps + mps);
        (at_m, off_m, since_m) = (at_m + way_m, off_m + (located - 1.0) * way_m, since_m + way_m);
        if since_m > balise_m && mps > 3.0 {
            (since_m, balise_m, off_m) = (0.0, random.random_range(800.0..2500.0), noise(&mut random, 2.0));
        }
        truth.push(at_m);
        let read_m = at_m + off_m + noise(&mut random, 0.1);
        let read_mps = (speed * mps * 36.0).round() / 36.0;
        let (location_m, speed_mps) = (Some((10.0 * read_m).round() / 10.0), Some(read_mps));
        rows.push(Sample {
            line: second as u64 + 2,
            time_s: f64::from(second),
            location_m,
            speed_mps,
            ..Sample::default()
        });
    }
    (Recording { name: format!("run{seed}"), rows, ..Recording::default() }, truth)
}

#[test]
fn a_location_that_balises_set_right_is_no_wheel_of_the_speed_and_hides_none() {
    for (case, [located, speed]) in [[1.01, 1.0], [1.01, 1.01], [0.99, 1.0], [0.988, 0.988]].into_iter().enumerate() {
        let (mut runs, truths): (Vec<_>, Vec<_>) =
            (0..6).map(|seed| run(100 * case as u64 + seed, located, speed)).unzip();
        let found = check(&mut runs);
        let scale = found.recorders[0].scale.unwrap();
        assert!((scale.value - speed).abs() < 0.0015, "{located} {speed}: {scale:?}");
        let drift = found.recorders[0].findings.iter().find(|one| one.kind == Kind::DriftingLocation).unwrap();
        assert!((drift.figure.value - 100.0 * (located - 1.0)).abs() < 0.1, "{located}: {drift:?}");
        assert_eq!(drift.done, Done::PutRight);
        assert_eq!(kinds(&found).contains(&Kind::SpeedScale), speed != 1.0, "{:?}", all(&found));
        // Between balises that are known to 2 m.
        for (run, truth) in runs.iter().zip(&truths) {
            let off_m = run.rows.iter().zip(truth).map(|(row, at_m)| (row.location_m.unwrap() - at_m).abs());
            assert!(off_m.fold(0.0, f64::max) < 9.0, "{located} {speed}");
        }
    }
}

#[test]
fn exact_locations_and_seconds_that_a_clock_loses_drift_by_nothing() {
    for seed in 0..6 {
        let mut runs: Vec<Recording> = (0..4).map(|i| run(1000 + 10 * seed + i, 1.0, 1.0).0).collect();
        let found = check(&mut runs);
        assert!(!kinds(&found).contains(&Kind::DriftingLocation), "{:?}", all(&found));
        let mut lost: Vec<Recording> = (0..4).map(|i| run(2000 + 10 * seed + i, 1.0, 1.0).0).collect();
        for row in lost.iter_mut().flat_map(|run| run.rows.iter_mut()) {
            row.time_s -= (row.time_s / 106.0).floor();
        }
        let found = check(&mut lost);
        assert!(!kinds(&found).contains(&Kind::DriftingLocation), "{:?}", all(&found));
        assert!(kinds(&found).contains(&Kind::LostSeconds), "{:?}", all(&found));
    }
}

/// A slope through one or two leaps leaves nothing of them.
#[test]
fn stops_that_are_missed_by_some_metres_are_no_drift() {
    for seed in 0..4 {
        let missed = |_: f64, random: &mut ChaCha8Rng| {
            random.random_range(20.0..60.0) * random.random_range(-1.0..1.0_f64).signum()
        };
        let mut runs: Vec<Recording> = (0..8).map(|i| set_right_at_stops(3000 + 10 * seed + i, missed)).collect();
        let found = check(&mut runs);
        assert!(!kinds(&found).contains(&Kind::DriftingLocation), "{:?}", all(&found));
    }
}
