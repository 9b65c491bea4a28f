//! Does a run go on where its snapshot was taken? To the last bit, in every mode, from any tick.

use host_tests::accuracy::{estimator, measurements};
use host_tests::prelude::*;
use rundown::estimator::run_state::{MAX_SNAPSHOT, RunState};

#[test]
fn a_restored_run_goes_on_bit_by_bit() {
    let scenario = Scenario::default();
    let log = measurements(&simulate(&scenario, 5));
    for mode in [Mode::Paper, Mode::Gated, Mode::Measured] {
        let estimator = estimator(Config::with_mode(mode), &scenario);
        let mut vehicle = estimator.new_vehicle();
        let mut run = estimator.begin_run(&vehicle, Direction::Up);
        // From before: nothing of it may shine through.
        let mut restored = run.clone();
        let mut buffer = vec![0; MAX_SNAPSHOT];
        for (tick, measurement) in log.iter().enumerate() {
            let bytes = run.snapshot(&mut buffer).unwrap().to_vec();
            restored.restore(&bytes).unwrap();
            let expected = estimator.step(&mut run, measurement).unwrap();
            let found = estimator.step(&mut restored, measurement).unwrap();
            assert_eq!(found, expected, "{mode:?}, tick {tick}");
        }
        let mut same = vehicle;
        assert_eq!(estimator.end_run(&mut restored, &mut same), estimator.end_run(&mut run, &mut vehicle), "{mode:?}");
    }
}

/// Full regime changes of every kind for hours: every buffer of the features is full.
#[test]
fn the_longest_snapshot_fits() {
    let scenario = Scenario::default();
    let estimator = estimator(Config::default(), &scenario);
    let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
    let mut buffer = vec![0; MAX_SNAPSHOT];
    let (mut largest, mut location_m, mut speed_mps) = (0, 0.0, 0.0);
    for tick in 0_u32..20_000 {
        // Traction, coasting with a staircase, brake; every 250 s another top speed.
        let phase = tick % 250;
        let rate = match phase {
            0..=59 => 0.4 + 1e-3 * f64::from(tick % 89),
            60..=149 => -0.03,
            150..=199 => 0.0,
            _ => -0.8,
        };
        speed_mps = f64::max(speed_mps + rate, 0.0);
        location_m = (location_m + speed_mps) % 30e3;
        let measurement = Measurement {
            time_s: 1e9 + f64::from(tick),
            location_m: Some(location_m),
            speed_mps: Some((speed_mps * 3.6).round() / 3.6),
            effort_n_per_kg: None,
        };
        estimator.step(&mut run, &measurement).unwrap();
        if tick % 7 == 0 {
            largest = largest.max(run.snapshot(&mut buffer).unwrap().len());
        }
    }
    println!("largest snapshot: {largest} bytes of {MAX_SNAPSHOT}; a run in memory: {} bytes", size_of::<RunState>());
    assert!(largest > MAX_SNAPSHOT / 3, "the run fills its buffers: {largest}");
}
