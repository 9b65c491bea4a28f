//! Is it the method of the paper, to the last digits? `data/reference` holds one run computed with 50-digit arithmetic
//! by implementations that share no code with this project, with both readings of the effort.

use host_tests::prelude::*;
use host_tests::reference::{data, measurements, train_and_track};
use rundown::filter::ukf::Spread;
use rundown::tick::paper::Difference;
use rundown::tick::regime::Regime;
use std::collections::HashMap;

type Row = HashMap<String, String>;

fn rows(name: &str) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(data(&format!("reference/{name}"))).unwrap();
    reader.deserialize().map(|row| row.unwrap()).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

fn replayed(spread: Spread<SIZE>, difference: Difference) -> Vec<Estimate> {
    let (train, track) = train_and_track();
    let mut config = Config::with_mode(Mode::Paper);
    config.paper.spread = spread;
    config.paper.difference = difference;
    let estimator = Estimator::try_new(config, train, track).unwrap();
    let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
    measurements().iter().map(|measurement| estimator.step(&mut run, measurement).unwrap()).collect()
}

/// As `max`, but NaN wins: no comparison with a limit accepts it.
fn worst_of(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// Largest difference of a state component from the reference, as a share of the component's largest value,
/// and in standard deviations; of the covariance, relative to √(Pii Pjj).
struct Distance {
    state: f64,
    state_in_sd: f64,
    covariance: f64,
    innovation: f64,
}

fn distance(estimates: &[Estimate], reference: &[Row]) -> Distance {
    assert_eq!(estimates.len(), reference.len());
    let largest: Vec<f64> = (0..SIZE)
        .map(|i| {
            let of_row = |row: &Row| number(row, &format!("x_{i}")).abs();
            reference.iter().map(of_row).fold(0.0, f64::max)
        })
        .collect();
    let mut worst = Distance { state: 0.0, state_in_sd: 0.0, covariance: 0.0, innovation: 0.0 };
    for (estimate, row) in estimates.iter().zip(reference) {
        let variance: Vec<f64> = (0..SIZE).map(|i| number(row, &format!("P_{i}{i}"))).collect();
        for i in 0..SIZE {
            let error = (estimate.belief.mean[i] - number(row, &format!("x_{i}"))).abs();
            worst.state = worst_of(worst.state, error / largest[i]);
            worst.state_in_sd = worst_of(worst.state_in_sd, error / variance[i].sqrt());
            for j in i..SIZE {
                let error = estimate.belief.covariance[(i, j)] - number(row, &format!("P_{i}{j}"));
                let scale = (variance[i] * variance[j]).sqrt();
                worst.covariance = worst_of(worst.covariance, error.abs() / scale);
            }
        }
        assert_eq!(estimate.innovation.is_none(), row["nu_s"].is_empty());
        if let Some(innovation) = &estimate.innovation {
            let s = &innovation.covariance;
            for (found, column) in [
                (innovation.value[0], "nu_s"),
                (innovation.value[1], "nu_v"),
                (s[(0, 0)], "S_ss"),
                (s[(0, 1)], "S_sv"),
                (s[(1, 1)], "S_vv"),
            ] {
                let expected = number(row, column);
                let scale = if column.ends_with('v') { 0.1 } else { 10.0 };
                worst.innovation = worst_of(worst.innovation, (found - expected).abs() / scale);
            }
        }
    }
    worst
}

fn regimes_are_equal(estimates: &[Estimate], reference: &[Row]) {
    for (estimate, row) in estimates.iter().zip(reference) {
        assert_eq!(estimate.regime.as_str(), row["regime"], "at {} s", row["time_s"]);
        assert_ne!(estimate.regime, Regime::Standstill);
        let effort = estimate.effort_n_per_kg.unwrap() - number(row, "u_k");
        let acceleration = estimate.acceleration_mps2.unwrap() - number(row, "a_k");
        assert!(effort.abs() < 1e-7 && acceleration.abs() < 1e-7, "at {} s", row["time_s"]);
    }
}

/// One run against its 50-digit twin: state and covariance of every step to the rounding of double precision, regimes
/// by name.
fn equals_50_digits(spread: Spread<SIZE>, difference: Difference, name: &str) {
    let estimates = replayed(spread, difference);
    let reference = rows(name);
    let worst = distance(&estimates, &reference);
    println!(
        "{name}: x {:.1e} of the largest, {:.1e} sd; P {:.1e}; innovation {:.1e}",
        worst.state, worst.state_in_sd, worst.covariance, worst.innovation
    );
    assert!(worst.state < 1e-12 && worst.state_in_sd < 1e-8);
    assert!(worst.covariance < 1e-9 && worst.innovation < 1e-9);
    regimes_are_equal(&estimates, &reference);
}

/// α = 1, well conditioned: what is left is the rounding of double precision.
#[test]
fn well_conditioned_run_equals_50_digits() {
    equals_50_digits(Spread::WIDE, Difference::Backward, "D_run01.csv");
    equals_50_digits(Spread::WIDE, Difference::Forward, "D_run01_forward.csv");
}

/// Table 1, α = 0.001: textbook forms lose seven digits here.
#[test]
fn run_of_table_1_equals_50_digits() {
    equals_50_digits(Spread::PAPER, Difference::Backward, "A_run01.csv");
    equals_50_digits(Spread::PAPER, Difference::Forward, "A_run01_forward.csv");
}
