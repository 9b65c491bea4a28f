//! A plausible run for the tests of the report, made by hand and replayed: traction, cruise, a final coast with
//! learning, brake, standstill.

use super::{Report, RunView, Vehicle};
use rundown::estimator::config::{Config, Mode};
use rundown::model::train::{Train, TrainDescription};
use rundown::{Real, estimator::Estimator, features::FeatureConfig, filter::gaussian::Gaussian, model::track::Track};
use rundown_files::replay::{ReplayedRun, Tick, replay};
use rundown_files::{recording::Recording, sample::Sample};
use std::ops::Range;

const TICK_S: Real = 10.0;

/// 90 samples of 10 s, every 17th without a speed.
pub fn run() -> ReplayedRun {
    replayed(moving())
}

/// The first samples of [`run`].
pub fn first(count: usize) -> ReplayedRun {
    replayed(moving().into_iter().take(count).collect())
}

/// As if the recorder had paused.
pub fn without(lost: Range<usize>) -> ReplayedRun {
    let mut rows = moving();
    rows.drain(lost);
    replayed(rows)
}

/// A train that stands for five minutes.
pub fn standing() -> ReplayedRun {
    replayed((0..30).map(|index| sample(index, 1000.0, 0.0)).collect())
}

/// No sample.
pub fn empty() -> ReplayedRun {
    replayed(Vec::new())
}

fn moving() -> Vec<Sample> {
    let (mut location_m, mut speed_mps) = (0.0, 0.0);
    let row = |index: usize| {
        let acceleration_mps2 = match index {
            1..14 => 0.28,
            30..77 => -train().davis().resistance_n_per_kg(speed_mps),
            77..85 if speed_mps > 3.0 => -0.3,
            0 | 14..30 => 0.0,
            _ => -speed_mps / TICK_S,
        };
        location_m += TICK_S * (speed_mps + 0.5 * TICK_S * acceleration_mps2);
        speed_mps += TICK_S * acceleration_mps2;
        sample(index, location_m, speed_mps)
    };
    (0..90).map(row).collect()
}

fn sample(index: usize, location_m: Real, speed_mps: Real) -> Sample {
    Sample {
        line: index as u64 + 2,
        time_s: 5000.0 + TICK_S * index as Real,
        location_m: Some(location_m + if index.is_multiple_of(2) { 4.0 } else { -3.0 }),
        speed_mps: (index % 17 != 16).then_some((3.6 * speed_mps).round() / 3.6),
        ..Sample::default()
    }
}

fn replayed(rows: Vec<Sample>) -> ReplayedRun {
    let recording = Recording {
        name: "run01".to_owned(),
        path: "run01.csv".into(),
        unit: "unit".to_owned(),
        rows,
        ..Recording::default()
    };
    let track = Track::try_new(40_000.0, []).unwrap();
    let estimator = Estimator::try_new(Config::with_mode(Mode::Gated), train(), track).unwrap();
    replay(&estimator, &mut estimator.new_vehicle(), &recording, Tick::EverySample)
}

/// A report on some runs.
pub fn report<'a>(runs: &'a [ReplayedRun], train: &'a Train) -> Report<'a> {
    let vehicle = |(index, run): (usize, &ReplayedRun)| {
        let sd = [4e-4, 1e-5, 5e-7].map(|sd| sd / (1.0 + index as Real).sqrt());
        (run.name.clone(), Gaussian::independent([7.1e-3 + 1e-5 * index as Real, 1.5e-4, 2.7e-5], sd))
    };
    let of_one = || Vehicle { unit: runs[0].unit.clone(), after: runs.iter().enumerate().map(vehicle).collect() };
    Report {
        title: "Replay".to_owned(),
        train,
        runs: runs.iter().map(|run| RunView::of(run, None)).collect(),
        first: 0,
        before: None,
        after: None,
        has_run_pages: true,
        mode: Mode::Gated,
        features: FeatureConfig::default(),
        vehicles: (!runs.is_empty()).then(of_one).into_iter().collect(),
        notes: &[],
        failed: &[],
    }
}

pub fn train() -> Train {
    Train::try_new(TrainDescription::CASE_STUDY).unwrap()
}
