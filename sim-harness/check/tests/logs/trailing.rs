//! Is a speed that trails behind in a filter found and the effort sent through the same, and is a delay, or a mean,
//! none?

use crate::simulated::{Recorder, check_for_replay, find};
use rundown_check::finding::{Done, Kind};
use rundown_files::recording::Recording;

/// Six runs of hops, rows 1 s apart, speeds in whole km/h that `read` makes of the true ones; efforts are those of the
/// moment.
fn runs(seed: u64, read: impl Fn(&[f64], usize) -> f64) -> Vec<Recording> {
    let mut recordings = Recorder { quantum_kmh: 1e-3, noise_m: 1.0, ..Recorder::default() }.hopping(seed, 6, 6);
    for recording in &mut recordings {
        let speeds: Vec<f64> = recording.rows.iter().map(|row| row.speed_mps.unwrap()).collect();
        for (i, row) in recording.rows.iter_mut().enumerate() {
            let acceleration = 0.5 * (speeds[(i + 1).min(speeds.len() - 1)] - speeds[i.saturating_sub(1)]);
            row.effort_n_per_kg = Some(acceleration + 0.01 + 3e-5 * speeds[i].powi(2));
            row.speed_mps = Some((3.6 * read(&speeds, i)).round() / 3.6);
        }
    }
    recordings
}

/// First order, 2 s: what is older than 20 s counts for nothing.
fn filtered(speeds: &[f64], i: usize) -> f64 {
    let weight = |age: usize| (-(age as f64) / 2.0).exp();
    let ages = 0..20.min(i + 1);
    ages.clone().map(|age| weight(age) * speeds[i - age]).sum::<f64>() / ages.map(weight).sum::<f64>()
}

fn delayed(speeds: &[f64], i: usize) -> f64 {
    speeds[i.saturating_sub(2)]
}

fn mean(speeds: &[f64], i: usize) -> f64 {
    let near = &speeds[i.saturating_sub(4)..(i + 5).min(speeds.len())];
    near.iter().sum::<f64>() / near.len() as f64
}

#[test]
fn a_speed_that_trails_in_a_filter_is_found_and_the_efforts_go_through_it() {
    let mut count = 0;
    for seed in 0..6 {
        let mut recordings = runs(65_000 + seed, filtered);
        let sharp = runs(65_000 + seed, filtered);
        let found = check_for_replay(&mut recordings);
        let Some(finding) = find(&found, Kind::TrailingSpeed) else { continue };
        count += 1;
        let [low, high] = finding.figure.interval();
        assert!((low..=high).contains(&2.0) && high < 4.0 && finding.done == Done::PutRight, "{seed} {finding}");
        assert_eq!(find(&found, Kind::EffortLate), None, "{seed}: an effort through the filter is as old as the speed");
        let effort = |of: &[Recording], i: usize| of[0].rows[i].effort_n_per_kg.unwrap();
        let steepest = |of: &[Recording]| {
            (1..of[0].rows.len()).map(|i| (effort(of, i) - effort(of, i - 1)).abs()).fold(0.0, f64::max)
        };
        assert!(steepest(&recordings) < 0.7 * steepest(&sharp), "{seed}");
    }
    // Six runs in whole km/h say little.
    assert!(count >= 3, "{count} of 6");
}

#[test]
fn delays_means_and_speeds_in_time_are_no_filter() {
    for seed in 0..4 {
        for read in [delayed, mean, |speeds: &[f64], i: usize| speeds[i]] {
            let found = check_for_replay(&mut runs(66_000 + seed, read));
            assert_eq!(find(&found, Kind::TrailingSpeed), None, "{seed}");
        }
    }
}
