//! Is a zero of the effort that is off taken from trains that stand, and are zeros that are none left out?

use crate::simulated::recording;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown::model::resistance::Davis;
use rundown::model::track::{Gradient, Track};
use rundown::model::train::{Train, TrainDescription};
use rundown_check::finding::{Done, Finding, Kind};
use rundown_check::limits::Described;
use rundown_check::{Check, Known, check, check_beside};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use std::cell::Cell;

/// Eight runs from stop to stop, a row a second: power, a held speed, a coast, a brake. The column is `read` of the
/// effort and of whether the train stands.
fn runs(seed: u64, read: impl Fn(f64, bool) -> Option<f64>) -> Vec<Recording> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut run = |number: usize| {
        let (mut rows, mut time_s, mut location_m, mut speed_mps) = (Vec::new(), 0.0, 0.0, 0.0_f64);
        for _ in 0..8 {
            let top_mps = random.random_range(15.0..40.0);
            let [hold_s, coast_s] = [random.random_range(60.0..200.0), random.random_range(20.0..80.0)];
            let (mut phase, mut since_s) = (0, 0.0);
            while phase < 5 {
                let resistance = 0.02 + 4e-5 * speed_mps * speed_mps;
                let effort = match phase {
                    0 => 0.45,
                    1 => resistance + 1e-3 * f64::sin(time_s / 7.0),
                    2 | 4 => 0.0,
                    _ => -0.6,
                };
                let stands = speed_mps == 0.0 && phase > 2;
                let effort_n_per_kg = read(if stands { 0.0 } else { effort }, stands);
                let row = Sample { time_s, effort_n_per_kg, ..Sample::default() };
                rows.push(Sample { location_m: Some(location_m), speed_mps: Some(speed_mps), ..row });
                let rate = if stands { 0.0 } else { effort - resistance };
                let after = (speed_mps + rate).max(0.0);
                location_m += 0.5 * (speed_mps + after);
                (speed_mps, time_s, since_s) = (after, time_s + 1.0, since_s + 1.0);
                let over = match phase {
                    0 => speed_mps >= top_mps,
                    1 => since_s >= hold_s,
                    2 => since_s >= coast_s,
                    3 => speed_mps == 0.0,
                    _ => since_s >= 45.0,
                };
                if over {
                    (phase, since_s) = (phase + 1, 0.0);
                }
            }
        }
        recording(&format!("run{number}"), rows)
    };
    (0..8).map(&mut run).collect()
}

fn found(recordings: &mut [Recording]) -> Vec<Finding> {
    found_by(check(recordings))
}

fn found_by(check: Check) -> Vec<Finding> {
    let of_effort =
        |finding: &&Finding| matches!(finding.kind, Kind::EffortOffset | Kind::EffortZeros | Kind::EffortZeroUnseen);
    check.recorders[0].findings.iter().filter(of_effort).cloned().collect()
}

/// It is said once, and nothing else of the zero.
fn leaves_out_zeros(recordings: &mut [Recording]) {
    let findings = found(recordings);
    assert!(
        matches!(findings.as_slice(), [Finding { kind: Kind::EffortZeros, done: Done::LeftOut, .. }]),
        "{findings:?}"
    );
}

fn has_no_zero(recordings: &[Recording]) -> bool {
    recordings.iter().flat_map(|one| &one.rows).all(|row| row.effort_n_per_kg != Some(0.0))
}

#[test]
fn a_right_zero_is_left_alone() {
    for seed in 0..6 {
        assert_eq!(found(&mut runs(70_000 + seed, |effort, _| Some(effort))), []);
        // A brake holds the train that stands.
        assert_eq!(found(&mut runs(70_000 + seed, |effort, stands| Some(if stands { -0.4 } else { effort }))), []);
        // Noise.
        let noisy = |effort: f64, _| Some(effort + 1e-3 * (effort * 1e7).sin());
        assert_eq!(found(&mut runs(70_000 + seed, noisy)), []);
    }
}

#[test]
fn a_constant_on_the_effort_is_taken_from_it() {
    for (seed, off) in [(0, -0.002), (1, 0.001), (2, 0.004), (3, -0.0005)] {
        let mut recordings = runs(71_000 + seed, |effort, _| Some(effort + off));
        let findings = found(&mut recordings);
        let [finding] = findings.as_slice() else { panic!("{off}: {findings:?}") };
        assert_eq!((finding.kind, finding.done), (Kind::EffortOffset, Done::PutRight));
        let truth = runs(71_000 + seed, |effort, _| Some(effort));
        let rows = recordings.iter().zip(&truth).flat_map(|(a, b)| a.rows.iter().zip(&b.rows));
        let worst = rows.filter_map(|(a, b)| Some((a.effort_n_per_kg? - b.effort_n_per_kg?).abs())).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{off}: {worst}");
    }
}

#[test]
fn a_constant_is_seen_in_coasts_where_a_brake_holds_trains_that_stand() {
    for (seed, off, noise) in [(0, -0.002, 0.0), (1, 8e-4, 0.0), (2, 4e-3, 2e-3), (3, -6e-4, 1e-3)] {
        let count = Cell::new(0.0);
        let noisy = |effort: f64, stands| {
            count.set(count.get() + 1.0);
            Some(if stands { -0.4 } else { effort + off + noise * f64::sin(1.7 * count.get()) })
        };
        let findings = found(&mut runs(71_500 + seed, noisy));
        let [finding] = findings.as_slice() else { panic!("{off}: {findings:?}") };
        assert_eq!((finding.kind, finding.done), (Kind::EffortOffset, Done::PutRight));
        assert!((finding.figure.value - off).abs() < 1e-4, "{off}: {:?}", finding.figure);
    }
}

#[test]
fn a_light_brake_of_trains_that_stand_is_no_zero_where_coasts_have_one() {
    for seed in 0..4 {
        let holds = |effort, stands| Some(if stands { -0.01 } else { effort });
        assert_eq!(found(&mut runs(71_600 + seed, holds)), []);
    }
}

#[test]
fn a_zero_that_nothing_shows_is_reported() {
    for seed in 0..4 {
        let hides =
            |effort, stands: bool| if effort == 0.0 && !stands { None } else { Some(effort - 0.4 * f64::from(stands)) };
        let findings = found(&mut runs(71_700 + seed, hides));
        assert!(
            matches!(findings.as_slice(), [Finding { kind: Kind::EffortZeroUnseen, done: Done::Said, .. }]),
            "{findings:?}"
        );
    }
}

/// Beside a train of this resistance on a line of this slope.
fn beside(r0: f64, r2: f64, permille: f64) -> Known {
    let davis = Davis { r0, r1: 0.0, r2 };
    let train = Train::try_new(TrainDescription { davis, ..TrainDescription::CASE_STUDY }).ok();
    let track = Some(Track::try_new(1e6, [Gradient { from_m: 0.0, permille }]).unwrap());
    Known { limits: Described { train, ..Described::default() }, track, moves_locations: true, ..Known::default() }
}

/// One for all would be wrong in each.
#[test]
fn zeros_that_differ_from_run_to_run_are_taken_run_by_run() {
    let offs = [0.003, -0.002, 0.0, 0.004, -0.004, 0.001, -0.001, 0.002];
    for seed in 0..3 {
        let truth = runs(71_800 + seed, |effort, _| Some(effort));
        let mut recordings = truth.clone();
        for (recording, off) in recordings.iter_mut().zip(offs) {
            let efforts = recording.rows.iter_mut().filter_map(|row| row.effort_n_per_kg.as_mut());
            efforts.for_each(|effort| *effort += off);
        }
        let check = check_beside(&mut recordings, &beside(0.02, 4e-5, 0.0));
        let differ = check.recorders[0].findings.iter().find(|one| one.kind == Kind::EffortZerosDiffer);
        assert!(differ.is_some_and(|one| one.done == Done::PutRight), "{:?}", check.recorders[0].findings);
        let rows = recordings.iter().zip(&truth).flat_map(|(a, b)| a.rows.iter().zip(&b.rows));
        let worst = rows.filter_map(|(a, b)| Some((a.effort_n_per_kg? - b.effort_n_per_kg?).abs())).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{seed}: {worst}");
    }
}

/// Its zeros were taken for those of a column that drops small efforts, though it has lost its speed by its resistance.
#[test]
fn a_train_that_hardly_loses_speed_coasts_where_slope_and_resistance_are_that() {
    let run = |number: usize| {
        let (mut location_m, mut speed_mps) = (0.0, 20.0);
        let row = |second: usize| {
            let powers = second % 300 < 40;
            let effort = if powers { 0.05 + 0.002 * ((second / 300 + number) % 20) as f64 } else { 0.0 };
            let after_mps = speed_mps + effort - 0.0125;
            location_m += 0.5 * (speed_mps + after_mps);
            speed_mps = after_mps;
            Sample {
                time_s: second as f64,
                location_m: Some(location_m),
                speed_mps: Some(speed_mps),
                effort_n_per_kg: Some(effort),
                ..Sample::default()
            }
        };
        recording(&format!("run{number}"), (0..6000).map(row).collect())
    };
    let of = |(r0, permille)| {
        let mut recordings: Vec<Recording> = (0..4).map(run).collect();
        let found = found_by(check_beside(&mut recordings, &beside(r0, 0.0, permille)));
        found.into_iter().filter(|one| one.kind == Kind::EffortZeros).count()
    };
    // 9.81/1.06 of 2.4 permille are 0.0222 N/kg.
    assert_eq!([(0.0125, 0.0), (0.016, 0.0), (0.0347, -2.4)].map(of), [0; 3]);
    assert_eq!([(0.2, 0.0), (0.0347, 2.4)].map(of), [1; 2]);
}

/// Nothing shows which of them are those of a light brake, as on a descent.
#[test]
fn all_zeros_of_a_column_without_brakes_are_left_out() {
    for seed in 0..4 {
        // Nor does a brake that holds the train that stands.
        let mut recordings = runs(72_100 + seed, |effort, stands| Some(if stands { -0.4 } else { effort.max(0.0) }));
        leaves_out_zeros(&mut recordings);
        assert!(has_no_zero(&recordings));
    }
}

#[test]
fn zeros_of_brakes_that_are_mostly_not_recorded_are_left_out() {
    for seed in 0..4 {
        let brakes = Cell::new(0);
        let mut recordings = runs(72_000 + seed, |effort, _| {
            brakes.set(brakes.get() + usize::from(effort < 0.0));
            Some(if brakes.get() < 60 { effort } else { effort.max(0.0) })
        });
        leaves_out_zeros(&mut recordings);
        let truth = runs(72_000 + seed, |effort, _| Some(effort));
        let read = recordings.iter().flat_map(|one| &one.rows).map(|row| row.effort_n_per_kg);
        let pairs: Vec<_> = read.zip(truth.iter().flat_map(|one| &one.rows)).collect();
        let is_brake = |row: &Sample| row.effort_n_per_kg.is_some_and(|effort| effort < -0.05);
        let wrong = pairs.iter().filter(|(read, truth)| *read == Some(0.0) && is_brake(truth)).count();
        let coasts = |row: &Sample| row.effort_n_per_kg == Some(0.0) && row.speed_mps > Some(0.0);
        let coasts: Vec<_> = pairs.iter().filter(|(_, truth)| coasts(truth)).collect();
        let (all, kept) = (coasts.len(), coasts.iter().filter(|(read, _)| read.is_some()).count());
        // Of each coast the last ten seconds may be the brake that comes up, and two rows are needed to see it.
        assert!(wrong == 0 && kept + 8 * 8 * 12 >= all, "{wrong} wrong, {kept} of {all} coasting rows kept");
    }
}

#[test]
fn zeros_of_a_column_that_drops_what_is_small_are_left_out() {
    for seed in 0..4 {
        let mut recordings = runs(73_000 + seed, |effort, _| Some(if effort.abs() < 0.09 { 0.0 } else { effort }));
        leaves_out_zeros(&mut recordings);
        assert!(has_no_zero(&recordings));
    }
}

/// A band of 0.035 N/kg around 0: at low speeds it takes the efforts that hold them, at high ones none.
#[test]
fn zeros_of_a_column_that_drops_only_the_smallest_efforts_are_left_out() {
    for seed in 0..4 {
        let mut recordings = runs(75_000 + seed, |effort, _| Some(if effort.abs() < 0.035 { 0.0 } else { effort }));
        leaves_out_zeros(&mut recordings);
        assert!(has_no_zero(&recordings));
    }
}
