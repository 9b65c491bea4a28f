//! Are runs whose locations count from another place found, and those that merely stop elsewhere not accused?

use crate::simulated::recording;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown_check::location::chainage::{Off, find};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

const LENGTH_M: f64 = 32_000.0;

/// Every 5 s a train that starts, holds 20 m/s and brakes from stop to stop.
fn drive(stops_m: &[f64]) -> Vec<Sample> {
    let (mut at_m, mut mps) = (stops_m[0], 0.0_f64);
    let mut rows = Vec::new();
    for stop_m in &stops_m[1..] {
        for step in 0.. {
            let to_go_m = stop_m - at_m;
            let stands = step < 30 || to_go_m < 1.0;
            mps = if stands { 0.0 } else { (mps + 0.5).min(20.0).min((2.0 * 0.5 * to_go_m).sqrt().max(0.5)) };
            at_m += mps;
            if step % 5 == 0 {
                let time_s = 5.0 * rows.len() as f64;
                rows.push(Sample { time_s, location_m: Some(at_m), speed_mps: Some(mps), ..Sample::default() });
            }
            if step > 30 && to_go_m < 1.0 {
                break;
            }
        }
    }
    rows
}

/// From one end of the line to the other, with stops of its own 4 to 6 km apart.
fn anywhere(random: &mut ChaCha8Rng, from_m: f64, to_m: f64) -> Vec<f64> {
    let mut stops_m = vec![from_m];
    while stops_m[stops_m.len() - 1] < to_m - 6000.0 {
        stops_m.push(stops_m[stops_m.len() - 1] + random.random_range(4000.0..6000.0));
    }
    stops_m.push(to_m);
    stops_m
}

fn off(stops_m: &[Vec<f64>]) -> Vec<Option<Off>> {
    let runs: Vec<Recording> = stops_m.iter().map(|stops_m| recording("run", drive(stops_m))).collect();
    find(&runs, &vec![true; runs.len()], &[])
}

/// With stops anywhere some of one run lie at those of another for any of many shifts.
#[test]
fn runs_that_stop_anywhere_are_not_off() {
    let mut accused = Vec::new();
    for (runs, sets) in [(2, 400), (5, 160), (34, 40)] {
        for seed in 0..sets {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let whole: Vec<_> = (0..runs).map(|_| anywhere(&mut random, 0.0, LENGTH_M)).collect();
            let part = |random: &mut ChaCha8Rng| {
                let from_m = random.random_range(0.0..0.3 * LENGTH_M);
                let to_m = random.random_range(0.7 * LENGTH_M..LENGTH_M);
                anywhere(random, from_m, to_m)
            };
            let parts: Vec<_> = (0..runs).map(|_| part(&mut random)).collect();
            for (which, stops_m) in [("whole line", whole), ("a part", parts)] {
                let found = off(&stops_m).into_iter().flatten().filter(|off| off.is_decided);
                accused.extend(found.map(|off| (runs, seed, which, off.figure.value, off.evidence)));
            }
        }
    }
    assert!(accused.is_empty(), "{} runs: {accused:?}", accused.len());
}

/// Expresses and stopping trains from end to end: neither is the other, moved.
#[test]
fn expresses_among_stopping_trains_are_not_off() {
    let stopping: Vec<f64> = (0..=8).map(|i| f64::from(i) * LENGTH_M / 8.0).collect();
    let express = vec![0.0, 0.25 * LENGTH_M, 0.75 * LENGTH_M, LENGTH_M];
    let runs: Vec<_> = (0..20).map(|i| if i % 4 == 0 { express.clone() } else { stopping.clone() }).collect();
    assert!(off(&runs).iter().all(Option::is_none));
}

#[test]
fn a_run_that_counts_from_elsewhere_is_found_among_those_of_its_stops() {
    for seed in 0..20 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let stations_m = anywhere(&mut random, 0.0, LENGTH_M);
        let by_m = random.random_range(500.0..5000.0);
        let mut runs = vec![stations_m; 8];
        runs[3].iter_mut().for_each(|at_m| *at_m += by_m);
        // One train in three has a pattern of its own.
        runs.extend((0..4).map(|_| anywhere(&mut random, 0.0, LENGTH_M)));
        let found = off(&runs);
        let accused: Vec<usize> = (0..runs.len()).filter(|run| found[*run].is_some()).collect();
        assert_eq!(accused, [3], "{seed}: {found:?}");
        let one = found[3].as_ref().unwrap();
        assert!(one.is_decided && (one.figure.value - by_m).abs() < 30.0, "{seed}: {by_m} m, {one:?}");
    }
}
