//! Is a column whose small efforts have a gain of their own left out, and a right one not?

use crate::simulated::{found_of_efforts, recording};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown::model::resistance::Davis;
use rundown::model::track::{Gradient, Track};
use rundown::model::train::{Train, TrainDescription};
use rundown_check::finding::{Done, Finding, Kind};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

const DAVIS: Davis = Davis { r0: 0.012, r1: 2e-4, r2: 3e-5 };
const LENGTH_M: f64 = 90e3;

/// What the column has of an effort.
type Shown = fn(f64) -> f64;

/// Slopes of -4 to 4 permille, a kilometre each.
fn permille(place: usize) -> f64 {
    (place * 7 % 9) as f64 - 4.0
}

fn train() -> Train {
    let description = TrainDescription {
        mass_kg: 200e3,
        rotating_mass_factor: 1.0,
        length_m: 1.0,
        davis: DAVIS,
        max_tractive_effort_n: 100e3,
        max_power_w: 2.4e6,
        max_brake_mps2: 1.2,
    };
    Train::try_new(description).unwrap()
}

/// Ten runs of trains that start, hold their speed, coast and brake, a row each second; the column shows so much of an
/// effort, with a noise.
fn runs(shown: Shown, times_slopes: f64) -> Vec<Recording> {
    let mut random = ChaCha8Rng::seed_from_u64(17);
    let gravity = train().gravity_n_per_kg();
    let mut run = |number: usize| {
        let (mut rows, mut at_m, mut mps, mut acts) = (Vec::new(), 100.0, 0.0_f64, 0.0_f64);
        let (mut phase, mut since, mut top_mps) = (0, 0, 30.0);
        for second in 0.. {
            rows.push(Sample {
                time_s: f64::from(second),
                location_m: Some(at_m),
                speed_mps: Some((36.0 * mps).round() / 36.0),
                effort_n_per_kg: Some(shown(acts) + random.random_range(-1e-3..1e-3)),
                ..Sample::default()
            });
            if at_m > LENGTH_M - 2000.0 {
                break;
            }
            let climb = gravity * 1e-3 * times_slopes * permille((at_m / 1000.0) as usize);
            let needs = DAVIS.resistance_n_per_kg(mps) + climb;
            acts = match phase {
                0 => f64::min(0.45, 11.0 / mps.max(1.0)),
                1 => (needs + 0.05 * (top_mps - mps)).max(0.0),
                2 => 0.0,
                _ => -0.6,
            };
            let after = (mps + acts - needs).max(0.0);
            at_m += 0.5 * (mps + after);
            mps = after;
            since += 1;
            if [mps >= top_mps, since > 200, since > 60, mps == 0.0][phase] {
                (phase, since) = ((phase + 1) % 4, 0);
                top_mps = random.random_range(22.0..38.0);
            }
        }
        recording(&format!("run{number}"), rows)
    };
    (0..10).map(&mut run).collect()
}

/// What is found of small efforts, and how many rows keep theirs.
fn found(recordings: Vec<Recording>) -> (Vec<Finding>, usize) {
    let gradient = |place: usize| Gradient { from_m: 1000.0 * place as f64, permille: permille(place) };
    let track = Track::try_new(LENGTH_M, (0..90).map(gradient)).unwrap();
    found_of_efforts(recordings, train(), track, &[Kind::EffortSmall])
}

#[test]
fn small_efforts_with_another_gain_are_found_with_it_and_the_column_is_left_out() {
    let columns: [(f64, Shown); 3] = [
        (1.0 / 0.85, |u| if u.abs() < 0.12 { 0.85 * u } else { u }),
        (1.0 / 1.15, |u| if u.abs() < 0.12 { 1.15 * u } else { u }),
        (1.0 / 0.9, |u| if u.abs() < 0.2 { 0.9 * u } else { u }),
    ];
    for (times, shown) in columns {
        let (findings, kept) = found(runs(shown, 1.0));
        let [Finding { figure, done: Done::LeftOut, .. }] = &findings[..] else { panic!("{times}: {findings:?}") };
        assert!((figure.value - times).abs() < 0.03 && kept == 0, "{times}: {figure:?} {kept}");
    }
}

#[test]
fn one_gain_of_all_efforts_and_slopes_that_are_off_are_no_gain_of_small_ones() {
    for (shown, times_slopes) in [(|u: f64| u) as Shown, |u| 0.9 * u, |u| u].into_iter().zip([1.0, 1.0, 1.15]) {
        let (findings, kept) = found(runs(shown, times_slopes));
        assert_eq!(findings, [], "{times_slopes}");
        assert!(kept > 0);
    }
}
