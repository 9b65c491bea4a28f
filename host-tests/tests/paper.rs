//! Is this the method of the paper? Its tables, thresholds and worked numbers, and the one number that its step gets
//! wrong.

use host_tests::accuracy::train;
use host_tests::prelude::*;
use nalgebra::SVector;
use rundown::features::FeatureConfig;
use rundown::filter::ukf::{Process, Spread};
use rundown::model::line::Line;
use rundown::model::motion::Motion;
use rundown::model::state::R0;
use rundown::tick::paper::Difference;
use rundown::tick::regime::{PaperRule, Regime};
use rundown_files::replay::{Tick, replay};

/// Section 4.1, per rotating mass.
const DAVIS: Davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };

fn near(found: f64, expected: f64, tolerance: f64) -> bool {
    (found - expected).abs() <= tolerance
}

#[test]
fn weights_of_the_central_point_are_near_1_7_million() {
    let (w0_mean, w0_covariance, w) = Spread::<SIZE>::PAPER.weights();
    assert!(near(w0_mean, -1_666_665.67, 0.01), "{w0_mean}");
    assert!(near(w0_covariance - w0_mean, 3.0 - 1e-6, 1e-6), "{w0_covariance}");
    assert!(near(w, 166_666.67, 0.01), "{w}");
    assert!(near(Spread::<SIZE>::PAPER.reach(), 3e-6, 1e-20));
}

#[test]
fn paper_mode_is_table_1() {
    let config = Config::with_mode(Mode::Paper);
    assert_eq!(config.mode, Mode::Paper);
    let paper = config.paper;
    assert_eq!(paper.spread, Spread::try_new(1e-3, 2.0, -2.0).unwrap());
    assert_eq!(paper.initial_location_sd_m, 1.0);
    assert!(near(paper.initial_speed_sd_kmh / 3.6, 0.0005, 1e-18));
    assert_eq!(paper.initial_davis_sd, [1e-6, 1e-8, 1e-9]);
    assert_eq!((paper.location_sd_m, paper.speed_sd_kmh), (4.0, 1.0));
    // Eq. (4) in one step, no process noise, points reused; the effort is that of docs/paper.md's best reading.
    assert_eq!(paper.acceleration_noise_mps2, 0.0);
    assert_eq!(config.paper_drift.davis_sd, [0.0; 3]);
    assert!(paper.reuse_points && paper.sub_step_s > 3600.0);
    assert_eq!(paper.evaluate, Evaluate::Beginning);
    assert_eq!(paper.difference, Difference::Forward);
    assert!(config.check().is_ok());
}

#[test]
fn regime_thresholds_are_those_of_section_3_2() {
    let rule = PaperRule::default();
    assert_eq!(rule.coast_n_per_kg, 0.025);
    assert_eq!(rule.cruise_mps2, 0.06);
    // 2 km/h in 10 s, rounded up.
    assert!(near(rule.cruise_mps2, 2.0 / 3.6 / 10.0, 0.005));
    // Of the case study's train, about 5 % of the largest effort.
    let largest = 192_920.0 / (1.06 * 364e3);
    assert!(near(rule.coast_n_per_kg / largest, 0.05, 0.001));
    for (effort, acceleration, regime) in [
        (0.025, 0.5, Regime::Coast),
        (-0.025, -0.5, Regime::Coast),
        (0.0251, 0.0599, Regime::Cruise),
        (-0.0251, -0.0599, Regime::Cruise),
        (0.0251, 0.06, Regime::Traction),
        (0.0251, -0.06, Regime::Traction),
        (-0.0251, -0.06, Regime::Brake),
    ] {
        assert_eq!(rule.recognise(effort, acceleration), regime, "{effort} {acceleration}");
    }
}

#[test]
fn at_140_kmh_air_takes_three_quarters_of_the_resistance() {
    let v = 140.0 / 3.6;
    let r = DAVIS.resistance_n_per_kg(v);
    let percent = DAVIS.terms_n_per_kg(v).map(|term| (100.0 * term / r).round());
    assert_eq!(percent, [13.0, 11.0, 76.0]);
}

/// From power to brake in rows of a second, in the `paper` mode; speeds are read where `is_read`.
fn with_missing_speeds(difference: Difference, is_read: impl Fn(u32) -> bool) -> Vec<Estimate> {
    let mut config = Config::with_mode(Mode::Paper);
    config.paper.difference = difference;
    braked(config, is_read)
}

fn braked(config: Config, is_read: impl Fn(u32) -> bool) -> Vec<Estimate> {
    let row = |second: u32| {
        let location_m = (0..second).map(|t| true_mps(f64::from(t) + 0.5)).sum::<f64>();
        let time_s = f64::from(second);
        let speed_mps = is_read(second).then(|| true_mps(time_s));
        Sample { time_s, location_m: Some(location_m), speed_mps, ..Sample::default() }
    };
    let run = Recording { rows: (0..60).map(row).collect(), ..Recording::default() };
    let estimator = Estimator::try_new(config, train(), Track::try_new(10_000.0, []).unwrap()).unwrap();
    replay(&estimator, &mut estimator.new_vehicle(), &run, Tick::EverySample).estimates
}

fn true_mps(time_s: f64) -> f64 {
    if time_s < 40.0 { 5.0 + 0.4 * time_s } else { 21.0 - 0.6 * (time_s - 40.0) }
}

#[test]
fn what_the_speed_changed_by_while_no_speed_was_read_is_made_up_for() {
    let estimates = with_missing_speeds(Difference::Forward, |second| !(38..43).contains(&second));
    let last = estimates.last().unwrap();
    assert!(near(last.belief.mean[SPEED], true_mps(59.0), 0.05), "{last:?}");
    // What is reported is the mean since the reading before, never the jump that makes up.
    let again = &estimates[43];
    let mean_mps2 = (true_mps(43.0) - true_mps(37.0)) / 6.0;
    assert!(near(again.effort_n_per_kg.unwrap(), mean_mps2, 0.03), "{again:?}");
    assert!(near(again.acceleration_mps2.unwrap(), mean_mps2, 0.02), "{again:?}");
}

/// Q on the coefficients, Eq. (3).
#[test]
fn coefficients_that_may_drift_are_known_the_less_the_longer_nothing_is_read() {
    let mut config = Config::with_mode(Mode::Paper);
    let variances = |config: Config| {
        let estimates = braked(config, |second| second == 0);
        [R0, R0 + 1, R0 + 2].map(|i| estimates[59].belief.covariance[(i, i)])
    };
    for (variance, sd) in variances(config).into_iter().zip(config.paper.initial_davis_sd) {
        assert!(near(variance / (sd * sd), 1.0, 1e-5), "{variance}");
    }
    config.paper_drift.davis_sd = [2e-6, 3e-8, 4e-9];
    let of_drift = variances(config).into_iter().zip(config.paper.initial_davis_sd).zip(config.paper_drift.davis_sd);
    for ((variance, sd), in_a_second) in of_drift {
        assert!(near(variance / (sd * sd + 59.0 * in_a_second * in_a_second), 1.0, 1e-4), "{variance}");
    }
}

#[test]
fn a_run_that_begins_without_a_speed_has_the_first_one_that_is_read() {
    // The backward effort is a sample late, 0.6 m/s.
    for (difference, late_mps) in [(Difference::Forward, 0.0), (Difference::Backward, 0.6)] {
        let estimates = with_missing_speeds(difference, |second| second > 3);
        let last = estimates.last().unwrap();
        assert!(near(last.belief.mean[SPEED], true_mps(59.0) + late_mps, 0.1), "{difference:?}: {last:?}");
        let of_run = estimates.iter().filter_map(|estimate| estimate.acceleration_mps2);
        let largest = of_run.map(f64::abs).fold(0.0, f64::max);
        assert!(largest < 0.65, "{difference:?}: that jump is none of the train's: {largest}");
    }
}

#[test]
fn feature_windows_and_brake_steps_are_those_of_section_3_3() {
    let features = FeatureConfig::default();
    assert_eq!(features.brake_steps_kmh, [130.0, 80.0, 60.0, 40.0]);
    assert_eq!(features.effort_window_kmh, [10.0, 30.0]);
    assert_eq!(features.power_window_kmh, [50.0, 130.0]);
    assert_eq!(features.max_power_window_kmh, [50.0, 90.0]);
}

/// Ten seconds of coasting on the flat from `v0`, in steps of at most `sub_step_s`: the speed lost, by the motion
/// model.
fn lost_mps(v0: f64, davis: &Davis, sub_steps: u32, evaluate: Evaluate) -> f64 {
    let train = train();
    let flat = Track::try_new(10_000.0, []).unwrap();
    let line = Line { train: &train, track: &flat, direction: Direction::Up };
    let mut x = SVector::from([0.0, v0, davis.r0, davis.r1, davis.r2]);
    for _ in 0..sub_steps {
        let motion = Motion::new(&line, &x, 0.0, 10.0 / f64::from(sub_steps), evaluate);
        let moved = motion.advance(&x);
        x.rows_mut(0, 2).copy_from(&moved);
    }
    v0 - x[SPEED]
}

/// The same by Runge-Kutta in 10 000 steps; shares no code with the model.
fn truly_lost_mps(v0: f64) -> f64 {
    let r = |v: f64| DAVIS.r0 + DAVIS.r1 * v + DAVIS.r2 * v * v;
    let (mut v, h) = (v0, 1e-3);
    for _ in 0..10_000 {
        let k1 = -r(v);
        let k2 = -r(v + 0.5 * h * k1);
        let k3 = -r(v + 0.5 * h * k2);
        let k4 = -r(v + h * k3);
        v += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    v0 - v
}

/// By how much, in %, the whole resistance must be scaled so that the model loses the true speed: the bias of an
/// estimate that sees speeds only.
fn bias_percent(v0: f64, sub_steps: u32, evaluate: Evaluate) -> f64 {
    let truth = truly_lost_mps(v0);
    let lost = |scale: f64| {
        let davis = Davis { r0: scale * DAVIS.r0, r1: scale * DAVIS.r1, r2: scale * DAVIS.r2 };
        lost_mps(v0, &davis, sub_steps, evaluate)
    };
    let (mut low, mut high) = (0.5, 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if lost(middle) < truth {
            low = middle;
        } else {
            high = middle;
        }
    }
    100.0 * (low - 1.0)
}

#[test]
fn one_step_of_eq_4_makes_the_resistance_at_100_kmh_1_percent_too_small() {
    let v0 = 100.0 / 3.6;
    let one_step = bias_percent(v0, 1, Evaluate::Beginning);
    println!("one step of 10 s as printed: {one_step:.3} % of r at 100 km/h");
    // By hand: -(r1 + 2 r2 v) dt / 2 = -(1.6e-4 + 1.556e-3) * 5 = -0.86 % while nothing but r acts.
    assert!(near(one_step, -0.86, 0.02), "{one_step}");
}

#[test]
fn midway_sub_steps_of_2_5_s_take_the_bias_away() {
    for kmh in [50.0, 100.0, 140.0, 200.0] {
        let bias = bias_percent(kmh / 3.6, 4, Evaluate::Midway);
        println!("midway, 2.5 s, {kmh} km/h: {bias:.5} %");
        assert!(bias.abs() < 0.02, "{kmh} km/h: {bias} %");
    }
}
