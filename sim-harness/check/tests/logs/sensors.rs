//! Are speeds that read zero below a threshold and speeds that repeat old values found, left out, and taken for nothing
//! else?

use crate::simulated::{Recorder, all, kinds, only};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown_check::check;
use rundown_check::finding::{Done, Kind};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

fn recorders() -> [Recorder; 3] {
    let odometer = Recorder { noise_m: 0.3, odometer_m: 1.0, ..Recorder::default() };
    [Recorder::default(), odometer, Recorder { quantum_kmh: 0.1, noise_m: 1.0, drift_m: 6.0, ..Recorder::default() }]
}

/// Speeds below read zero.
fn below(recordings: &mut [Recording], kmh: f64) {
    let rows = recordings.iter_mut().flat_map(|recording| &mut recording.rows);
    rows.for_each(|row| row.speed_mps = row.speed_mps.map(|mps| if 3.6 * mps < kmh - 1e-6 { 0.0 } else { mps }));
}

fn speeds(rows: &[Sample]) -> Vec<Option<f64>> {
    rows.iter().map(|row| row.speed_mps).collect()
}

#[test]
fn a_threshold_is_found_with_its_speed_and_zeros_beside_movement_are_left_out() {
    let (mut inside, mut sets) = (0, 0);
    for recorder in recorders() {
        for (seed, kmh) in (0..4).flat_map(|seed| [(seed, 5.0), (seed, 12.0)]) {
            let mut recordings = recorder.runs(40_000 + seed, 4, 5);
            let truth: Vec<Vec<Option<f64>>> = recordings.iter().map(|recording| speeds(&recording.rows)).collect();
            below(&mut recordings, kmh);
            let found = check(&mut recordings);
            let finding = only(&found, Kind::DeadZone);
            assert!((finding.figure.value - kmh).abs() < 1.5 && finding.done == Done::LeftOut, "{seed}: {finding}");
            let [low, high] = finding.figure.interval();
            inside += usize::from((low..=high).contains(&kmh));
            sets += 1;
            let rows = recordings.iter().flat_map(|recording| &recording.rows).zip(truth.iter().flatten());
            let wrong = rows.filter(|(row, truth)| row.speed_mps == Some(0.0) && truth.is_some_and(|mps| mps > 0.3));
            assert_eq!(wrong.count(), 0, "{seed} {kmh}: the train moved");
            // A stand is a stand.
            let stands = recordings.iter().flat_map(|recording| &recording.rows);
            let zeros = stands.filter(|row| row.speed_mps == Some(0.0)).count();
            assert!(zeros > 200, "{seed} {kmh}: {zeros} readings of zero are left");
        }
    }
    assert!(10 * inside >= 8 * sets, "{inside} of {sets} intervals");
}

#[test]
fn low_thresholds_and_a_radar_that_reads_half_a_kmh_below_are_found() {
    for (seed, kmh, floor_kmh) in
        [(0, 2.0, 0.0), (1, 2.0, 0.0), (2, 3.0, 0.0), (3, 3.0, 0.0), (4, 5.0, 0.5), (5, 3.0, 0.5)]
    {
        let tachometer = Recorder { quantum_kmh: 0.1, noise_m: 0.3, ..Recorder::default() };
        let mut recordings = tachometer.runs(43_000 + seed, 6, 5);
        assert!(!kinds(&check(&mut recordings.clone())).contains(&Kind::DeadZone), "{seed}");
        below(&mut recordings, kmh);
        let moves = |rows: &[Sample], i: usize| (0.0 < rows[i].speed_mps.unwrap()) as usize;
        for recording in recordings.iter_mut().filter(|_| floor_kmh > 0.0) {
            let read = recording.rows.clone();
            for i in 1..read.len() - 1 {
                if read[i].speed_mps == Some(0.0) && moves(&read, i - 1) + moves(&read, i + 1) > 0 {
                    recording.rows[i].speed_mps = Some(floor_kmh / 3.6);
                }
            }
        }
        let found = check(&mut recordings);
        let finding = only(&found, Kind::DeadZone);
        assert!((finding.figure.value - kmh).abs() < 0.3 && finding.done == Done::LeftOut, "{seed}: {finding}");
        let rows = || recordings.iter().flat_map(|recording| &recording.rows);
        assert!(!rows().any(|row| row.speed_mps.is_some_and(|mps| 0.0 < mps && 3.6 * mps < kmh - 0.1)), "{seed}");
        assert!(rows().filter(|row| row.speed_mps == Some(0.0)).count() > 200, "{seed}: a stand is a stand");
    }
}

/// A recorder that writes another speed only where it has changed by 2 km/h skips the small ones, too.
#[test]
fn speeds_that_follow_in_steps_of_their_change_have_no_threshold() {
    let tachometer = Recorder { quantum_kmh: 0.1, noise_m: 0.3, ..Recorder::default() };
    let mut recordings = tachometer.runs(45_000, 8, 5);
    for recording in &mut recordings {
        let mut last_mps = 0.0;
        for row in &mut recording.rows {
            let mps = row.speed_mps.unwrap();
            last_mps = if (mps - last_mps).abs() * 3.6 >= 1.9 || mps == 0.0 { mps } else { last_mps };
            row.speed_mps = Some(last_mps);
        }
    }
    assert!(!kinds(&check(&mut recordings)).contains(&Kind::DeadZone));
}

/// Their step is none of those that are known, and the first of them is the only small speed.
#[test]
fn whole_kmh_of_another_wheel_have_no_threshold() {
    for (seed, gain) in [(0, 0.973), (1, 0.986), (2, 1.013), (3, 1.027)] {
        let odometer = Recorder { noise_m: 0.3, odometer_m: 1.0, ..Recorder::default() };
        let mut recordings = odometer.hopping(46_000 + seed, 8, 10);
        for row in recordings.iter_mut().flat_map(|recording| &mut recording.rows) {
            row.speed_mps = row.speed_mps.map(|mps| gain * mps);
            row.location_m = row.location_m.map(|m| gain * m);
        }
        assert!(!kinds(&check(&mut recordings)).contains(&Kind::DeadZone), "{seed}");
    }
}

/// Starts at whole seconds have no smaller reading than what a train gains in one, and are no threshold.
#[test]
fn trains_that_start_at_whole_seconds_have_no_threshold() {
    let mut random = ChaCha8Rng::seed_from_u64(44_000);
    let (mut rows, mut time_s, mut at_m) = (Vec::new(), 0.0, 0.0);
    for _ in 0..12 {
        let top_mps = random.random_range(14.0..16.0);
        let mut mps: f64 = 0.0;
        for second in 0..110 {
            let before = mps;
            mps = match second {
                0..30 => 0.0,
                30..60 => (mps + 0.8).min(top_mps),
                60..80 => mps,
                _ => (mps - 0.7).max(0.0),
            };
            at_m += 0.5 * (before + mps);
            let read_mps = (36.0 * mps).round() / 36.0;
            rows.push(Sample { time_s, location_m: Some(at_m), speed_mps: Some(read_mps), ..Sample::default() });
            time_s += 1.0;
        }
    }
    let mut recordings = [Recording { name: "run".into(), rows, ..Recording::default() }];
    assert!(!kinds(&check(&mut recordings)).contains(&Kind::DeadZone));
}

/// With rows that are far apart the smallest reading is above the threshold by chance: the interval says so.
#[test]
fn rows_far_apart_say_less() {
    let (mut found, mut inside) = (0, 0);
    for seed in 0..20 {
        let mut recordings = Recorder { step_s: 10.0, ..Recorder::default() }.runs(41_000 + seed, 4, 5);
        below(&mut recordings, 12.0);
        let check = check(&mut recordings);
        let finding = all(&check).into_iter().find(|finding| finding.kind == Kind::DeadZone).cloned();
        found += usize::from(finding.is_some());
        inside += usize::from(finding.is_some_and(|finding| {
            let [low, high] = finding.figure.interval();
            (low..=high).contains(&12.0)
        }));
    }
    assert!(found >= 15 && 10 * inside >= 8 * found, "{found} of 20 found, {inside} intervals hold");
}

/// Three in a hundred, each repeating the last.
fn held(rows: &mut [Sample], from: usize, each: usize, long: usize) -> Vec<usize> {
    let begins = (from..rows.len() - long).step_by(each);
    let held: Vec<usize> = begins.flat_map(|begin| begin..begin + long).collect();
    held.iter().for_each(|i| rows[*i].speed_mps = rows[*i - 1].speed_mps);
    held
}

#[test]
fn held_speeds_are_found_and_most_of_what_is_left_out_was_held() {
    for recorder in recorders() {
        for (seed, [each, long]) in (0..3).flat_map(|seed| [(seed, [33, 1]), (seed, [130, 4])]) {
            let mut recordings = recorder.runs(42_000 + seed, 4, 5);
            let truth: Vec<Vec<usize>> =
                recordings.iter_mut().map(|recording| held(&mut recording.rows, 5, each, long)).collect();
            let found = check(&mut recordings);
            assert!(kinds(&found).contains(&Kind::HeldSpeeds), "{each} {long} {seed}: {:?}", all(&found));
            let (mut right, mut left_out) = (0, 0);
            for (recording, held) in recordings.iter().zip(&truth) {
                let missing = (0..recording.rows.len()).filter(|i| recording.rows[*i].speed_mps.is_none());
                let missing: Vec<usize> = missing.collect();
                left_out += missing.len();
                right += missing.iter().filter(|i| held.contains(i)).count();
            }
            assert!(left_out >= 5 && 10 * right >= 9 * left_out, "{each} {long} {seed}: {right} of {left_out}");
        }
    }
}
