//! Short hops on which nobody coasts: speeds that are held, and fall as those of a coasting train do.

use host_tests::accuracy::train;
use host_tests::prelude::*;
use rundown::estimator::config::{Config, Mode};

const HOPS: u32 = 8;
const TOP_MPS: f64 = 25.0;
const ACCELERATION_MPS2: f64 = 0.8;
const HELD_S: u32 = 60;

/// A log of 1 s: each hop powers to 90 km/h, keeps that speed for a while but for a slow fall, brakes and stands.
/// The effort column says what is applied meanwhile, on the first two nothing: it is not known yet that hops are short.
fn log(falls_mps2: f64, held_n_per_kg: Option<f64>) -> Vec<Measurement> {
    let (mut location_m, mut speed_mps) = (0.0, 0.0_f64);
    let power_s = (TOP_MPS / ACCELERATION_MPS2) as u32;
    let mut log = Vec::new();
    for second in 0..HOPS * 130 {
        let (hop, of_hop) = (second / 130, second % 130);
        let (acceleration_mps2, effort_n_per_kg) = match of_hop {
            _ if of_hop < power_s => (ACCELERATION_MPS2, Some(ACCELERATION_MPS2 + 0.02)),
            _ if of_hop < power_s + HELD_S => (-falls_mps2, held_n_per_kg),
            _ => (-ACCELERATION_MPS2, None),
        };
        let after_mps = (speed_mps + acceleration_mps2).max(0.0);
        location_m += 0.5 * (speed_mps + after_mps);
        speed_mps = after_mps;
        log.push(Measurement {
            time_s: f64::from(second),
            location_m: Some(location_m),
            speed_mps: Some((3.6 * speed_mps).round() / 3.6),
            effort_n_per_kg: effort_n_per_kg.filter(|_| hop > 1),
        });
    }
    log
}

/// Time that taught, s, on a line of one gradient.
fn learned_s(config: Config, permille: f64, log: &[Measurement]) -> f64 {
    let track = Track::try_new(32e3, [Gradient { from_m: 0.0, permille }]).unwrap();
    let estimator = Estimator::try_new(config, train(), track).unwrap();
    let mut vehicle = estimator.new_vehicle();
    let mut state = estimator.begin_run(&vehicle, Direction::Up);
    for row in log {
        estimator.step(&mut state, row).unwrap();
    }
    estimator.end_run(&mut state, &mut vehicle).learned_s
}

/// The train is described with 0.029 N/kg at 90 km/h, of which a slope of 1.3 permille leaves 0.017: a coast of 10 s loses 0.6 km/h, and so do drivers who
/// hold a speed. They taught that the resistance is what balances the slope (trams and suburban trains of another simulator: 20 to 37 % too little).
#[test]
fn a_speed_that_is_held_where_the_slope_balances_the_resistance_teaches_nothing() {
    let held = log(0.03, None);
    let mut everywhere = Config::default();
    everywhere.short_hops.min_resistance_n_per_kg = 0.0;
    assert!(learned_s(everywhere, -1.3, &held) > 60.0, "it looks like a coast");
    assert_eq!(learned_s(Config::default(), -1.3, &held), 0.0);
    let coasts = log(0.03, None);
    assert!(learned_s(Config::default(), 0.0, &coasts) > 60.0, "a coast on the level");
}

#[test]
fn a_fall_of_the_speed_under_power_is_no_coast_where_the_effort_is_measured() {
    let measured = Config::with_mode(Mode::Measured);
    assert!(learned_s(measured, 0.0, &log(0.025, Some(0.003))) > 60.0, "a coast, and a sensor that is a little off");
    for held_n_per_kg in [0.02, -0.02] {
        assert_eq!(learned_s(measured, 0.0, &log(0.025, Some(held_n_per_kg))), 0.0, "{held_n_per_kg} N/kg");
    }
}
