//! What does a flipped bit in the memory of a run do? Every bit of the state is flipped once, in the middle of a
//! segment that teaches.
//!
//! Row 36 of `docs/faults.md` promises more than the code keeps: no checksum is looked at. Here stands what is kept.

use host_tests::accuracy::{estimator, measurements};
use host_tests::prelude::*;
use rayon::prelude::*;
use rundown::Real;
use rundown::estimator::run_state::{MAX_SNAPSHOT, RunState};
use rundown::tick::estimate::Validity;

/// Samples after the flip.
const AFTER: usize = 6;

/// What becomes of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    /// The bytes are no state.
    Refused,
    /// Not a bit of the estimates is another one.
    Same,
    /// The speed is within 1 m/s all the time.
    Near,
    /// A validity says that something is wrong, at once or with the next sample.
    Flagged,
    /// The speed is further off, and nothing says so.
    Wrong,
    /// A number in a frame would be none.
    NoNumber,
}

fn has_numbers(estimate: &Estimate) -> bool {
    let belief = &estimate.belief;
    let states = (0..SIZE).flat_map(|i| [belief.mean[i], belief.sd(i)]);
    let others = [estimate.effort_n_per_kg, estimate.acceleration_mps2];
    let mut all = states.chain(others.into_iter().flatten()).chain([estimate.gradient_n_per_kg]);
    // As they are sent.
    all.all(|number: Real| (number as f32).is_finite())
}

fn fate(estimator: &Estimator, state: &[u8], log: &[Measurement], expected: &[Estimate]) -> Fate {
    let mut run = RunState::idle();
    if run.restore(state).is_err() {
        return Fate::Refused;
    }
    let mut fate = Fate::Same;
    for (measurement, expected) in log.iter().zip(expected) {
        let Ok(found) = estimator.step(&mut run, measurement) else {
            return Fate::Flagged;
        };
        if !has_numbers(&found) {
            return Fate::NoNumber;
        }
        if found.validity != Validity::Valid {
            return Fate::Flagged;
        }
        let off_mps = found.belief.mean[SPEED] - expected.belief.mean[SPEED];
        if off_mps.abs() > 1.0 {
            fate = Fate::Wrong;
        } else if fate == Fate::Same && found != *expected {
            fate = Fate::Near;
        }
    }
    fate
}

#[test]
fn a_flipped_bit_of_the_state_gives_no_panic_and_hardly_ever_a_wrong_speed() {
    let scenario = Scenario::default();
    let log = measurements(&simulate(&scenario, 5));
    for mode in [Mode::Gated, Mode::Measured, Mode::Paper] {
        let estimator = estimator(Config::with_mode(mode), &scenario);
        let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
        let teaches = |(tick, measurement)| {
            let estimate = estimator.step(&mut run, measurement).unwrap();
            tick > 80 && estimate.learning
        };
        let at = log.iter().enumerate().position(teaches).unwrap() + 1;
        let mut buffer = vec![0; MAX_SNAPSHOT];
        let state = run.snapshot(&mut buffer).unwrap().to_vec();
        let log = &log[at..at + AFTER];
        let expected: Vec<Estimate> =
            log.iter().map(|measurement| estimator.step(&mut run, measurement).unwrap()).collect();
        assert_eq!(fate(&estimator, &state, log, &expected), Fate::Same);
        let fates: Vec<Fate> = (0..8 * state.len())
            .into_par_iter()
            .map(|bit| {
                let mut flipped = state.clone();
                flipped[bit / 8] ^= 1 << (bit % 8);
                fate(&estimator, &flipped, log, &expected)
            })
            .collect();
        let share = |wanted: Fate| {
            let found = fates.iter().filter(|fate| **fate == wanted).count();
            100.0 * found as f64 / fates.len() as f64
        };
        for fate in [Fate::Refused, Fate::Same, Fate::Near, Fate::Flagged, Fate::Wrong, Fate::NoNumber] {
            println!("{mode:?}: {fate:?} {:.3} %", share(fate));
        }
        assert!(share(Fate::NoNumber) < 0.1, "{mode:?}");
        assert!(share(Fate::Wrong) < 0.2, "{mode:?}");
    }
}
