//! Are speeds that are means found, though the efforts are means over as long, and in rows some seconds apart?

use crate::simulated::{Recorder, all, check_for_replay, find};
use rundown_check::finding::{Done, Kind};
use rundown_files::recording::Recording;

/// Six runs of hops, rows `step_s` apart; speeds and efforts are means over `long_s` around their time.
fn runs(seed: u64, step_s: usize, long_s: usize, has_efforts: bool) -> Vec<Recording> {
    let mut recordings = Recorder { quantum_kmh: 1e-3, noise_m: 1.0, ..Recorder::default() }.hopping(seed, 6, 6);
    for recording in &mut recordings {
        let speeds: Vec<f64> = recording.rows.iter().map(|row| row.speed_mps.unwrap()).collect();
        let effort = |i: usize| speeds[i] - speeds[i.saturating_sub(1)] + 0.01 + 3e-5 * speeds[i].powi(2);
        let efforts: Vec<f64> = (0..speeds.len()).map(effort).collect();
        let mean = |of: &[f64], i: usize| {
            let near = &of[i.saturating_sub(long_s / 2)..(i + long_s / 2 + 1).min(of.len())];
            near.iter().sum::<f64>() / near.len() as f64
        };
        for (i, row) in recording.rows.iter_mut().enumerate() {
            row.speed_mps = Some((36.0 * mean(&speeds, i)).round() / 36.0);
            row.effort_n_per_kg = has_efforts.then(|| mean(&efforts, i));
        }
        recording.rows = recording.rows.iter().copied().step_by(step_s).collect();
    }
    recordings
}

#[test]
fn means_that_the_efforts_share_are_found_and_too_long_ones_teach_no_effort() {
    for (seed, step_s) in (0..4).flat_map(|seed| [(63_000 + seed, 1), (63_000 + seed, 5)]) {
        for (has_efforts, done) in [(true, Done::LeftOut), (false, Done::Said)] {
            let mut recordings = runs(seed, step_s, 17, has_efforts);
            let found = check_for_replay(&mut recordings);
            let finding = find(&found, Kind::SmoothedSpeed).unwrap_or_else(|| panic!("{seed} {step_s}: {found:?}"));
            assert!((finding.figure.value - 17.0).abs() < 3.0 && finding.done == done, "{seed} {step_s} {finding}");
            assert!(recordings.iter().flat_map(|one| &one.rows).all(|row| row.effort_n_per_kg.is_none()));
            assert!(found.notes().iter().any(|note| note.contains("means over some time")), "{:?}", found.notes());
        }
    }
}

#[test]
fn momentary_speeds_five_seconds_apart_are_no_means() {
    for seed in 0..6 {
        let found = check_for_replay(&mut runs(64_000 + seed, 5, 1, true));
        assert_eq!(find(&found, Kind::SmoothedSpeed), None, "{seed}");
    }
}

#[test]
fn means_in_whole_kmh_are_no_wheel() {
    let fine = Recorder { quantum_kmh: 1e-3, noise_m: 1.0, ..Recorder::default() };
    for (seed, runs) in (0..4).flat_map(|seed| [(seed, 8), (seed, 12)]) {
        let mut recordings = fine.trams(65_000 + seed, runs, 20);
        for recording in &mut recordings {
            let speeds: Vec<f64> = recording.rows.iter().map(|row| row.speed_mps.unwrap()).collect();
            for (i, row) in recording.rows.iter_mut().enumerate() {
                let near = &speeds[i.saturating_sub(4)..(i + 5).min(speeds.len())];
                let kmh = 3.6 * near.iter().sum::<f64>() / near.len() as f64;
                row.speed_mps = Some(kmh.round() / 3.6);
            }
        }
        let check = check_for_replay(&mut recordings);
        assert_eq!(check.recorders[0].correction.scale, 1.0, "{seed} {:?}", all(&check));
        // Not for want of a figure: one of 5 % would show.
        let scale = check.recorders[0].scale;
        assert!(scale.is_some_and(|scale| scale.sd < 0.012), "{seed} {scale:?}");
    }
}
