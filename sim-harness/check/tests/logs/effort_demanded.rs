//! Is a column of what the lever asks for, or one that ends at a most, left out, and one of what acts not?

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
const MOST_N_PER_KG: f64 = 0.5;
/// Of the motors, W/kg: they limit the train above 11 m/s.
const POWER_W_PER_KG: f64 = 5.5;

/// Runs from stop to stop by a lever that is at a part of its way, a row each `step_s`; the column has `read` of what
/// acts and what is asked for, `late_s` late.
fn runs(step_s: usize, late_s: usize, read: impl Fn(f64, f64) -> f64) -> Vec<Recording> {
    let mut random = ChaCha8Rng::seed_from_u64(31);
    let mut run = |number: usize| {
        let (mut rows, mut at_m, mut mps, mut column) = (Vec::new(), 0.0, 0.0_f64, vec![0.0; late_s]);
        for _ in 0..6 {
            let (lever, top_mps) = (random.random_range(0.6..1.0), random.random_range(28.0..38.0));
            let mut phase = 0;
            for second in 0.. {
                let asked = [lever * MOST_N_PER_KG, 0.0, -0.5, 0.0][phase];
                let acts = f64::min(asked, POWER_W_PER_KG / mps.max(1.0));
                column.push(read(acts, asked));
                let seconds = column.len() - late_s;
                if seconds.is_multiple_of(step_s) {
                    let time_s = seconds as f64;
                    let speed_mps = Some((36.0 * mps).round() / 36.0);
                    let effort_n_per_kg = Some(column[seconds - 1]);
                    rows.push(Sample {
                        time_s,
                        location_m: Some(at_m),
                        speed_mps,
                        effort_n_per_kg,
                        ..Sample::default()
                    });
                }
                let rate = if mps == 0.0 && asked <= 0.0 { 0.0 } else { acts - DAVIS.resistance_n_per_kg(mps) };
                let after = (mps + rate).max(0.0);
                at_m += 0.5 * (mps + after);
                mps = after;
                let over = [mps >= top_mps, mps < 0.8 * top_mps, mps == 0.0, second > 400][phase];
                phase += usize::from(over);
                if phase == 4 {
                    break;
                }
            }
        }
        recording(&format!("run{number}"), rows)
    };
    (0..6).map(&mut run).collect()
}

/// With r described as so many times the true one: what is found of the efforts, and how many rows keep theirs.
fn found(recordings: Vec<Recording>, times_r: f64) -> (Vec<Finding>, usize) {
    let train = Train::try_new(TrainDescription {
        mass_kg: 200e3,
        rotating_mass_factor: 1.0,
        length_m: 100.0,
        davis: Davis { r0: times_r * DAVIS.r0, r1: times_r * DAVIS.r1, r2: times_r * DAVIS.r2 },
        max_tractive_effort_n: 300e3,
        max_power_w: 5e6,
        max_brake_mps2: 1.2,
    });
    let track = Track::try_new(100e3, [Gradient { from_m: 0.0, permille: 0.0 }]).unwrap();
    found_of_efforts(recordings, train.unwrap(), track, &[Kind::EffortDemanded, Kind::EffortCut])
}

#[test]
fn what_the_lever_asks_for_is_left_out() {
    for (step_s, times_r) in [(1, 1.0), (1, 1.6), (1, 0.7), (5, 1.0)] {
        let (findings, kept) = found(runs(step_s, 0, |_, asked| asked), times_r);
        let [Finding { kind: Kind::EffortDemanded, figure, done: Done::LeftOut, .. }] = &findings[..] else {
            panic!("{findings:?}")
        };
        assert!(figure.value < 0.7 && kept == 0, "{figure:?} {kept}");
    }
}

#[test]
fn what_acts_stays_however_late_it_is_and_whatever_is_described() {
    for (step_s, late_s) in [(1, 0), (1, 3), (5, 0), (10, 0), (10, 10)] {
        for times_r in [0.7, 1.0, 1.6] {
            let (findings, kept) = found(runs(step_s, late_s, |acts, _| 1.1 * acts), times_r);
            assert!(findings.is_empty(), "{step_s} s, {late_s} s late, {times_r} r: {findings:?}");
            assert!(kept > 0 || late_s > 5);
        }
    }
}

#[test]
fn what_is_cut_off_above_a_most_is_left_out_and_the_rest_stays() {
    for (step_s, times_r) in [(1, 1.0), (1, 1.6), (1, 0.7), (5, 1.0)] {
        let (_, all) = found(runs(step_s, 0, |acts, _| acts), times_r);
        let (findings, kept) = found(runs(step_s, 0, |acts, _| acts.min(0.28)), times_r);
        let [Finding { kind: Kind::EffortCut, figure, done: Done::LeftOut, .. }] = &findings[..] else {
            panic!("{findings:?}")
        };
        assert!((1.1..1.7).contains(&figure.value), "{figure:?}");
        assert!(kept > all / 2 && kept < all, "{kept} of {all}");
    }
}
