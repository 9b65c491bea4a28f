//! Is an effort that is some seconds older than the speed found and moved, and one that is not left alone?

use crate::simulated::{Recorder, check_for_replay, find, recording};
use rundown_check::finding::{Done, Kind};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

/// Four runs on gentle slopes. The efforts are those of a wheel that reads 5 % high, means or momentary, `age_s` old;
/// rows `step_s` apart.
fn runs(seed: u64, step_s: usize, is_mean: bool, age_s: usize) -> Vec<Recording> {
    let mut recordings = Recorder { quantum_kmh: 1e-3, noise_m: 1.0, ..Recorder::default() }.runs(seed, 4, 8);
    for recording in &mut recordings {
        let speeds: Vec<f64> = recording.rows.iter().map(|row| row.speed_mps.unwrap()).collect();
        let mut efforts = vec![0.0];
        for i in 1..speeds.len() {
            let slope = 0.03 * (recording.rows[i].location_m.unwrap() / 900.0).sin();
            efforts.push(1.05 * (speeds[i] - speeds[i - 1] + 0.01 + 3e-5 * speeds[i].powi(2) + slope));
        }
        let last = efforts.len() - 1;
        let mean = |from: usize, to: usize| efforts[from..=to].iter().sum::<f64>() / (to + 1 - from) as f64;
        for (i, row) in recording.rows.iter_mut().enumerate() {
            let now = i.saturating_sub(age_s);
            // A momentary effort lies between the means on both sides of it.
            let from = if is_mean { (now + 1).saturating_sub(step_s) } else { now };
            row.effort_n_per_kg = Some(mean(from, if is_mean { now } else { (now + 1).min(last) }));
            row.speed_mps = row.speed_mps.map(|mps| (3.6 * mps).round() / 3.6);
        }
        recording.rows = recording.rows.iter().copied().step_by(step_s).collect();
    }
    recordings
}

#[test]
fn a_late_effort_is_found_and_moved() {
    let mut inside = 0;
    for (seed, is_mean, age_s) in (0..6).flat_map(|seed| [(seed, true, 5), (seed, false, 5), (seed, true, 3)]) {
        let mut recordings = runs(60_000 + seed, 1, is_mean, age_s);
        let found = check_for_replay(&mut recordings);
        let finding =
            find(&found, Kind::EffortLate).unwrap_or_else(|| panic!("{seed} {is_mean} {age_s}: {:?}", found.notes()));
        assert!((finding.figure.value - age_s as f64).abs() < 0.5 && finding.done == Done::PutRight, "{finding}");
        let [low, high] = finding.figure.interval();
        inside += usize::from((low..=high).contains(&(age_s as f64)));
        let truth = runs(60_000 + seed, 1, is_mean, 0);
        for (moved, truth) in recordings.iter().zip(&truth) {
            let pairs = moved.rows.iter().zip(&truth.rows);
            let off = pairs.filter_map(|(a, b)| Some(a.effort_n_per_kg? - b.effort_n_per_kg?));
            let off: Vec<f64> = off.map(|off| off * off).collect();
            let rms = (off.iter().sum::<f64>() / off.len() as f64).sqrt();
            assert!(off.len() + 20 > truth.rows.len() && rms < 0.04, "{seed} {is_mean}: {rms}");
        }
    }
    assert!(inside >= 14, "{inside} of 18 intervals hold");
}

#[test]
fn efforts_that_are_late_by_more_than_half_a_row_are_left_out() {
    for seed in 0..6 {
        let mut recordings = runs(61_000 + seed, 10, true, 8);
        let found = check_for_replay(&mut recordings);
        let finding = find(&found, Kind::EffortLate).unwrap_or_else(|| panic!("{seed}: {:?}", found.notes()));
        assert!((finding.figure.value - 8.0).abs() < 1.0 && finding.done == Done::LeftOut, "{finding}");
        let rows = recordings.iter().flat_map(|recording| &recording.rows);
        assert!(rows.clone().all(|row| row.effort_n_per_kg.is_none()));
        assert!(found.notes().iter().any(|note| note.contains("older than the speed")), "{:?}", found.notes());
    }
}

#[test]
fn an_effort_of_the_age_of_the_speed_is_left_alone() {
    for (seed, step_s, is_mean) in
        (0..8).flat_map(|seed| [(seed, 1, true), (seed, 1, false), (seed, 10, true), (seed, 10, false)])
    {
        let found = check_for_replay(&mut runs(62_000 + seed, step_s, is_mean, 0));
        assert_eq!(find(&found, Kind::EffortLate), None, "{seed} {step_s} {is_mean}");
    }
}

/// A freight train that powers with 0.06 N/kg or coasts: three runs, with means that are so many rows late.
fn freight(seed: u32, late: usize, step_s: u32) -> Vec<Recording> {
    let run = |number: u32| {
        let (mut location_m, mut speed_mps, mut powers) = (0.0, 15.0 + f64::from((seed + number) % 4), true);
        let (mut efforts, mut rows) = (vec![0.0; late], Vec::new());
        for row in 0..9000 / step_s {
            let mut sum = 0.0;
            for _ in 0..step_s {
                let slowest_mps = 16.0 - f64::from(row % 3);
                powers = if powers { speed_mps < 22.0 } else { speed_mps < slowest_mps };
                let effort = if powers { 0.06 } else { 0.0 };
                let after_mps = speed_mps + effort - 0.012 - 2e-5 * speed_mps * speed_mps;
                location_m += 0.5 * (speed_mps + after_mps);
                (speed_mps, sum) = (after_mps, sum + effort);
            }
            efforts.push(sum / f64::from(step_s));
            rows.push(Sample {
                time_s: f64::from(step_s * (row + 1)),
                location_m: Some(location_m),
                speed_mps: Some((36.0 * speed_mps).round() / 36.0),
                effort_n_per_kg: Some(efforts[row as usize]),
                ..Sample::default()
            });
        }
        recording(&format!("run{number}"), rows)
    };
    (0..3).map(run).collect()
}

#[test]
fn small_efforts_that_are_late_by_whole_rows_are_moved_by_these() {
    for (seed, late, step_s) in (0..4).flat_map(|seed| [(seed, 0, 10), (seed, 1, 10), (seed, 0, 5), (seed, 2, 5)]) {
        let mut recordings = freight(seed, late, step_s);
        let found = check_for_replay(&mut recordings);
        let finding = find(&found, Kind::EffortLate);
        if late == 0 {
            assert_eq!(finding, None, "{seed}");
            continue;
        }
        let finding = finding.unwrap_or_else(|| panic!("{seed} {late}: {:?}", found.notes()));
        let late_s = f64::from(step_s) * late as f64;
        assert!((finding.figure.value - late_s).abs() < 1.0 && finding.done == Done::PutRight, "{finding}");
        for (moved, truth) in recordings.iter().zip(freight(seed, 0, step_s)) {
            let (moved_rows, lost) = moved.rows.split_at(moved.rows.len() - late);
            let pairs = moved_rows.iter().zip(&truth.rows);
            assert!(pairs.clone().all(|(a, b)| a.effort_n_per_kg == b.effort_n_per_kg), "{seed} {late}");
            assert!(lost.iter().all(|row| row.effort_n_per_kg.is_none()));
        }
    }
}
