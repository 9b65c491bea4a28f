//! A plausible run, made by hand for the tests of the report: traction, cruise, a final coast with learning, brake, standstill.

use super::{Report, RunView};
use rundown::Real;
use rundown::estimator::config::{Config, Mode};
use rundown::estimator::{Estimator, RunSummary};
use rundown::features::{EffortLine, FeatureConfig, Features, Phase, Statistic, SwitchingPoint};
use rundown::filter::gaussian::Gaussian;
use rundown::filter::ukf::{Innovation, Reading};
use rundown::model::direction::Direction;
use rundown::model::state::{self, SIZE};
use rundown::model::track::Track;
use rundown::model::train::{Train, TrainDescription};
use rundown::tick::estimate::{Cause, Estimate, Validity};
use rundown::tick::measurement::Measurement;
use rundown::tick::regime::Regime;
use rundown_files::replay::ReplayedRun;
use std::ops::Range;

const TICK_S: Real = 10.0;
const DAVIS: [Real; 3] = [7.1e-3, 1.5e-4, 2.7e-5];

/// 90 samples of 10 s, every 17th without a speed.
pub fn run() -> ReplayedRun {
    let mut run = empty();
    let pattern = innovation();
    let (mut location_m, mut speed_mps) = (0.0, 0.0);
    for index in 0..90 {
        let (regime, acceleration_mps2) = match index {
            0 => (Regime::Standstill, 0.0),
            1..14 => (Regime::Traction, 0.28),
            14..30 => (Regime::Cruise, 0.0),
            30..77 => (Regime::Coast, -0.03),
            77..85 if speed_mps > 3.0 => (Regime::Brake, -0.3),
            _ => (Regime::Standstill, -speed_mps / TICK_S),
        };
        location_m += TICK_S * (speed_mps + 0.5 * TICK_S * acceleration_mps2);
        speed_mps += TICK_S * acceleration_mps2;
        push(&mut run, pattern, regime, [location_m, speed_mps, acceleration_mps2]);
    }
    run.summary.features = features(location_m);
    run
}

/// A train that stands for five minutes.
pub fn standing() -> ReplayedRun {
    let mut run = empty();
    let pattern = innovation();
    for _ in 0..30 {
        push(&mut run, pattern, Regime::Standstill, [1000.0, 0.0, 0.0]);
    }
    run
}

/// No sample.
pub fn empty() -> ReplayedRun {
    ReplayedRun {
        name: "run01".to_owned(),
        path: "run01.csv".into(),
        unit: "unit".to_owned(),
        direction: Direction::Up,
        rows: 0,
        measurements: Vec::new(),
        estimates: Vec::new(),
        coast_ahead: Vec::new(),
        regimes: Vec::new(),
        dropped: Vec::new(),
        summary: RunSummary::NONE,
        vehicle_before: Gaussian::ZEROED,
        vehicle_after: Gaussian::ZEROED,
        warnings: Vec::new(),
    }
}

/// The first samples of [`run`].
pub fn first(count: usize) -> ReplayedRun {
    let mut run = run();
    drop_samples(&mut run, count..90);
    run.summary.features = Features::default();
    run
}

/// As if the recorder had paused.
pub fn drop_samples(run: &mut ReplayedRun, lost: Range<usize>) {
    run.measurements.drain(lost.clone());
    run.estimates.drain(lost.clone());
    run.regimes.drain(lost.clone());
    if let Some(next) = run.estimates.get_mut(lost.start) {
        next.dt_s += TICK_S * lost.len() as Real;
    }
}

fn push(
    run: &mut ReplayedRun,
    pattern: Innovation<2>,
    regime: Regime,
    [location_m, speed_mps, acceleration]: [Real; 3],
) {
    let index = run.estimates.len();
    let time_s = 5000.0 + TICK_S * index as Real;
    let is_lost = index % 17 == 16;
    let has_past = index > 0;
    let reading_kmh = (3.6 * speed_mps).round();
    let measurement = Measurement {
        time_s,
        location_m: Some(location_m + if index.is_multiple_of(2) { 4.0 } else { -3.0 }),
        speed_mps: (!is_lost).then_some(reading_kmh / 3.6),
        effort_n_per_kg: None,
    };
    let mean = [location_m, speed_mps, DAVIS[0], DAVIS[1], DAVIS[2]];
    let belief = Gaussian::independent(mean, [4.0, 0.2, 4e-4, 2e-5, 1e-6]);
    let resistance = state::davis(&belief.mean).resistance_n_per_kg(speed_mps);
    if is_lost {
        run.summary.counters.count(Cause::NoSpeed);
    }
    run.estimates.push(Estimate {
        time_s,
        dt_s: if has_past { TICK_S } else { 0.0 },
        belief,
        effort_n_per_kg: (has_past && !is_lost).then_some(acceleration + resistance),
        acceleration_mps2: (has_past && !is_lost).then_some(acceleration),
        gradient_n_per_kg: 0.01 * (location_m / 3000.0).sin(),
        regime,
        confirmed: None,
        learning: regime == Regime::Coast && !is_lost,
        innovation: has_past.then(|| of_measurement(pattern, &belief, &measurement)),
        validity: if is_lost { Validity::Held(Cause::NoSpeed) } else { Validity::Valid },
    });
    run.measurements.push(measurement);
    run.regimes.push(regime);
}

/// A report on some runs.
pub fn report<'a>(runs: &'a [ReplayedRun], train: &'a Train) -> Report<'a> {
    let vehicle = |(index, run): (usize, &ReplayedRun)| {
        let mean = [DAVIS[0] + 1e-5 * index as Real, DAVIS[1], DAVIS[2]];
        let sd = [4e-4, 1e-5, 5e-7].map(|sd| sd / (1.0 + index as Real).sqrt());
        (run.name.clone(), Gaussian::independent(mean, sd))
    };
    Report {
        title: "Replay".to_owned(),
        train,
        runs: runs.iter().map(|run| RunView::of(run, None)).collect(),
        mode: "gated",
        features: FeatureConfig::default(),
        vehicle: runs.iter().enumerate().map(vehicle).collect(),
    }
}

pub fn train() -> Train {
    Train::try_new(TrainDescription::CASE_STUDY).unwrap()
}

fn features(end_m: Real) -> Features {
    let statistic = |count, mean, sd| Statistic { count, mean, sd };
    let phase = |start_time_s, start_location_m, start_speed_mps, duration_s, length_m| Phase {
        start_time_s,
        start_location_m,
        start_speed_mps,
        duration_s,
        length_m,
    };
    let mut features = Features {
        max_effort: Some(EffortLine { effort: statistic(3, 0.41, 0.02), at_lower_n_per_kg: 0.42, slope: -0.003 }),
        power_w_per_kg: statistic(9, 5.1, 0.2),
        max_power_w_per_kg: Some(5.6),
        cruise_speed_mps: statistic(16, 36.5, 0.3),
        cruise_speed_median_mps: Some(36.4),
        final_coast: Some(phase(5300.0, 8300.0, 36.4, 470.0, end_m - 9900.0)),
        final_brake: Some(phase(5770.0, end_m - 1600.0, 22.3, 80.0, 1600.0)),
        regime_time_s: [60.0, 130.0, 160.0, 470.0, 70.0],
        ..Features::default()
    };
    features.brake_rate_mps2[2] = statistic(4, 0.31, 0.02);
    features.brake_rate_mps2[3] = statistic(1, 0.29, 0.0);
    features.energy.traction_j_per_kg = 690.0;
    let point =
        SwitchingPoint { time_s: 5300.0, location_m: 8300.0, speed_mps: 36.4, from: Regime::Cruise, to: Regime::Coast };
    features.switching_points.push(point).unwrap();
    features
}

/// An innovation of the estimator, which alone can make one.
fn innovation() -> Innovation<2> {
    let track = Track::try_new(10_000.0, []).unwrap();
    let estimator = Estimator::try_new(Config::with_mode(Mode::Paper), train(), track).unwrap();
    let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
    let estimates = [0.0, 10.0, 20.0].map(|time_s| {
        let measurement =
            Measurement { time_s, location_m: Some(20.0 * time_s), speed_mps: Some(20.0), effort_n_per_kg: None };
        estimator.step(&mut run, &measurement).unwrap()
    });
    estimates.into_iter().find_map(|estimate| estimate.innovation).unwrap()
}

/// As the filter would give it.
fn of_measurement(mut innovation: Innovation<2>, belief: &Gaussian<SIZE>, measurement: &Measurement) -> Innovation<2> {
    let readings = [measurement.location_m, measurement.speed_mps];
    let sd = [4.5, 0.2];
    for (reading, z) in readings.into_iter().enumerate() {
        let value = z.map(|z| z - belief.mean[reading]);
        innovation.value[reading] = value.unwrap_or(0.0);
        innovation.covariance[(reading, reading)] = sd[reading] * sd[reading];
        innovation.readings[reading] = match value {
            None => Reading::Missing,
            Some(value) if value.abs() > 3.0 * sd[reading] => Reading::Gated,
            Some(_) => Reading::Used,
        };
    }
    innovation
}
