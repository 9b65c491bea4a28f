//! Did the answer change? Replays of fixed runs against `data/golden/replay.csv`, our own last accepted answer.
//!
//! `BLESS=1 cargo test -p host-tests --test replay` rewrites it; the commit then says why it moved.

use host_tests::accuracy::{estimator, measurements, resistance};
use host_tests::prelude::*;
use host_tests::reference::{self, data, train_and_track};
use rundown::model::state::SPEED;
use rundown::tick::paper::Difference;
use rundown::tick::regime::Regime;
use std::fmt::Write as _;

/// Columns after the name, each with the difference that is accepted: another platform rounds libm the same, so these
/// only hide the printing.
const COLUMNS: [(&str, f64); 10] = [
    ("ticks", 0.0),
    ("r60_n_per_kg", 2e-8),
    ("r140_n_per_kg", 2e-8),
    ("sd_r100_n_per_kg", 2e-8),
    ("learned_s", 0.01),
    ("coast_share", 1e-4),
    ("cruise_kmh", 0.01),
    ("final_brake_s", 0.01),
    ("final_brake_m", 0.1),
    ("power_w_per_kg", 1e-4),
];

/// One row: replay of a run by a new vehicle.
fn row(name: &str, estimator: &Estimator, measurements: &[Measurement]) -> (String, Vec<f64>) {
    let mut vehicle = estimator.new_vehicle();
    let mut run = estimator.begin_run(&vehicle, Direction::Up);
    let ticks = measurements.iter().filter(|measurement| estimator.step(&mut run, measurement).is_ok()).count();
    let summary = estimator.end_run(&mut run, &mut vehicle);
    let features = &summary.features;
    let time_s: f64 = features.regime_time_s.iter().sum();
    let brake = features.final_brake;
    let missing = -1.0;
    let values = vec![
        ticks as f64,
        resistance(&summary.run_davis, 60.0).0,
        resistance(&summary.run_davis, 140.0).0,
        resistance(&summary.run_davis, 100.0).1,
        summary.learned_s,
        features.regime_time_s[Regime::Coast as usize] / time_s,
        features.cruise_speed_median_mps.map_or(missing, |v| 3.6 * v),
        brake.map_or(missing, |brake| brake.start_time_s),
        brake.map_or(missing, |brake| brake.start_location_m),
        features.power_w_per_kg.mean,
    ];
    (name.to_owned(), values)
}

fn rows() -> Vec<(String, Vec<f64>)> {
    let mut rows = Vec::new();
    let (train, track) = train_and_track();
    let reference = reference::measurements();
    for (name, mode) in [("reference paper", Mode::Paper), ("reference gated", Mode::Gated)] {
        let estimator = Estimator::try_new(Config::with_mode(mode), train, track.clone()).unwrap();
        rows.push(row(name, &estimator, &reference));
    }
    // The other reading of the paper's effort: docs/paper.md compares them.
    let mut backward = Config::with_mode(Mode::Paper);
    backward.paper.difference = Difference::Backward;
    let estimator_of = |config| Estimator::try_new(config, train, track.clone()).unwrap();
    rows.push(row("reference paper backward", &estimator_of(backward), &reference));
    let fast = Sensors { sampling_s: 1.0, ..Sensors::default() };
    let dropouts = Sensors { dropout_probability: 0.1, ..Sensors::default() };
    for (name, mode, sensors) in [
        ("simulated gated 10 s", Mode::Gated, Sensors::default()),
        ("simulated gated 1 s", Mode::Gated, fast),
        ("simulated gated dropouts", Mode::Gated, dropouts),
        ("simulated measured 10 s", Mode::Measured, Sensors::default()),
    ] {
        let scenario = Scenario { sensors, davis_scale: [0.9, 1.1, 0.95], ..Scenario::default() };
        let run = simulate(&scenario, 2024);
        let estimator = estimator(Config::with_mode(mode), &scenario);
        rows.push(row(name, &estimator, &measurements(&run)));
    }
    rows
}

#[test]
fn replays_give_the_accepted_answers() {
    let rows = rows();
    let path = data("golden/replay.csv");
    if std::env::var_os("BLESS").is_some() {
        let names: Vec<&str> = COLUMNS.iter().map(|(name, _)| *name).collect();
        let mut table = format!("run,{}\n", names.join(","));
        for (name, values) in &rows {
            let cells: Vec<String> = values.iter().map(|value| format!("{value:.8}")).collect();
            writeln!(table, "{name},{}", cells.join(",")).unwrap();
        }
        std::fs::write(&path, table).unwrap();
        println!("wrote data/golden/replay.csv");
        return;
    }
    let golden = std::fs::read_to_string(&path).expect("data/golden/replay.csv: run once with BLESS=1");
    assert_eq!(golden.lines().count(), rows.len() + 1);
    let names = COLUMNS.iter().map(|(name, _)| *name);
    let header: Vec<&str> = std::iter::once("run").chain(names).collect();
    assert_eq!(golden.lines().next(), Some(header.join(",").as_str()));
    for (line, (name, values)) in golden.lines().skip(1).zip(&rows) {
        let mut cells = line.split(',');
        assert_eq!(cells.next(), Some(name.as_str()));
        assert_eq!(cells.clone().count(), COLUMNS.len(), "{name}");
        for ((cell, value), (column, tolerance)) in cells.zip(values).zip(COLUMNS) {
            let accepted: f64 = cell.parse().unwrap();
            let moved = (accepted - value).abs();
            assert!(moved <= tolerance + 1e-8, "{name}: {column} was {accepted}, is {value}");
        }
    }
}

/// The filter begins a coast with a speed that it takes from the next reading; what is published is no less sure than
/// the reading.
#[test]
fn the_published_speed_is_as_sure_as_a_reading_where_a_coast_begins() {
    let (train, track) = train_and_track();
    let estimator = Estimator::try_new(Config::with_mode(Mode::Gated), train, track).unwrap();
    let vehicle = estimator.new_vehicle();
    let mut run = estimator.begin_run(&vehicle, Direction::Up);
    let (mut coasts, mut before) = (0, Regime::Standstill);
    for measurement in reference::measurements() {
        let estimate = estimator.step(&mut run, &measurement).unwrap();
        coasts += u32::from(estimate.regime == Regime::Coast && before != Regime::Coast);
        before = estimate.regime;
        let sd_mps = estimate.belief.covariance[(SPEED, SPEED)].sqrt();
        assert!(sd_mps < 0.3, "{sd_mps} m/s at {} s", estimate.time_s);
    }
    assert!(coasts >= 2, "{coasts} coasts");
}
