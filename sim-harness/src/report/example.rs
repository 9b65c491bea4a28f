//! A plausible run, made by hand for the tests of the report: traction, cruise, a final coast with learning, brake, standstill.

use super::{Report, RunView};
use rundown::Real;
use rundown::estimator::Estimator;
use rundown::estimator::config::{Config, Mode};
use rundown::features::{EffortLine, FeatureConfig, Features, Phase, Statistic, SwitchingPoint};
use rundown::filter::gaussian::Gaussian;
use rundown::filter::ukf::{Innovation, Reading};
use rundown::model::direction::Direction;
use rundown::model::state::{self, SIZE};
use rundown::model::track::Track;
use rundown::model::train::{Train, TrainDescription};
use rundown::tick::estimate::{Cause, Counters, Estimate, Validity};
use rundown::tick::measurement::Measurement;
use rundown::tick::regime::Regime;

/// What a [`RunView`] borrows.
#[derive(Clone, Debug)]
pub struct Example {
    pub name: String,
    pub measurements: Vec<Measurement>,
    pub estimates: Vec<Estimate>,
    pub regimes: Vec<Regime>,
    pub features: Features,
    pub counters: Counters,
    pub warnings: Vec<String>,
}

const TICK_S: Real = 10.0;
const DAVIS: [Real; 3] = [7.1e-3, 1.5e-4, 2.7e-5];

impl Example {
    /// 90 samples of 10 s, every 17th without a speed.
    pub fn run() -> Self {
        let mut run = Self::empty();
        let innovations = Innovations::new();
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
            run.push(&innovations, regime, location_m, speed_mps, acceleration_mps2);
        }
        run.features = features(location_m);
        run
    }

    /// A train that stands for five minutes.
    pub fn standing() -> Self {
        let mut run = Self::empty();
        let innovations = Innovations::new();
        for _ in 0..30 {
            run.push(&innovations, Regime::Standstill, 1000.0, 0.0, 0.0);
        }
        run
    }

    /// No sample.
    pub fn empty() -> Self {
        Self {
            name: "run01".to_owned(),
            measurements: Vec::new(),
            estimates: Vec::new(),
            regimes: Vec::new(),
            features: Features::default(),
            counters: Counters::default(),
            warnings: Vec::new(),
        }
    }

    /// The first samples of [`Example::run`].
    pub fn first(count: usize) -> Self {
        let mut run = Self::run();
        run.drop_samples(count..90);
        run.features = Features::default();
        run
    }

    /// As if the recorder had paused.
    pub fn drop_samples(&mut self, lost: std::ops::Range<usize>) {
        self.measurements.drain(lost.clone());
        self.estimates.drain(lost.clone());
        self.regimes.drain(lost.clone());
        if let Some(next) = self.estimates.get_mut(lost.start) {
            next.dt_s += TICK_S * lost.len() as Real;
        }
    }

    pub fn view(&self) -> RunView<'_> {
        RunView {
            name: &self.name,
            measurements: &self.measurements,
            estimates: &self.estimates,
            coast_ahead: &[],
            regimes: &self.regimes,
            features: &self.features,
            counters: &self.counters,
            warnings: &self.warnings,
            truth: None,
        }
    }

    fn push(
        &mut self,
        innovations: &Innovations,
        regime: Regime,
        location_m: Real,
        speed_mps: Real,
        acceleration: Real,
    ) {
        let index = self.estimates.len();
        let time_s = 5000.0 + TICK_S * index as Real;
        let is_lost = index % 17 == 16;
        let learning = regime == Regime::Coast && !is_lost;
        let reading_kmh = (3.6 * speed_mps).round();
        let measurement = Measurement {
            time_s,
            location_m: Some(location_m + if index.is_multiple_of(2) { 4.0 } else { -3.0 }),
            speed_mps: (!is_lost).then_some(reading_kmh / 3.6),
            effort_n_per_kg: None,
        };
        let mean = [location_m, speed_mps, DAVIS[0], DAVIS[1], DAVIS[2]];
        let belief = Gaussian::independent(mean, [4.0, 0.2, 4e-4, 2e-5, 1e-6]);
        let davis = state::davis(&belief.mean);
        let resistance = davis.resistance_n_per_kg(speed_mps);
        if is_lost {
            self.counters.count(Cause::NoSpeed);
        }
        self.estimates.push(Estimate {
            time_s,
            dt_s: if index == 0 { 0.0 } else { TICK_S },
            belief,
            effort_n_per_kg: (index > 0 && !is_lost).then_some(acceleration + resistance),
            acceleration_mps2: (index > 0 && !is_lost).then_some(acceleration),
            gradient_n_per_kg: 0.01 * (location_m / 3000.0).sin(),
            regime,
            confirmed: None,
            learning,
            innovation: (index > 0).then(|| innovations.of(&belief, &measurement)),
            validity: match is_lost {
                true => Validity::Held(Cause::NoSpeed),
                false => Validity::Valid,
            },
        });
        self.measurements.push(measurement);
        self.regimes.push(regime);
    }
}

/// A report on some runs.
pub fn report<'a>(runs: &'a [Example], train: &'a Train) -> Report<'a> {
    let vehicle = |(index, run): (usize, &Example)| {
        let mean = [DAVIS[0] + 1e-5 * index as Real, DAVIS[1], DAVIS[2]];
        let sd = [4e-4, 1e-5, 5e-7].map(|sd| sd / (1.0 + index as Real).sqrt());
        (run.name.clone(), Gaussian::independent(mean, sd))
    };
    Report {
        title: "Replay".to_owned(),
        train,
        runs: runs.iter().map(Example::view).collect(),
        mode: "gated",
        features: FeatureConfig::default(),
        vehicle: runs.iter().enumerate().map(vehicle).collect(),
    }
}

/// The train of the case study, rounded.
pub fn train() -> Train {
    let description = TrainDescription::CASE_STUDY;
    Train::try_new(description).unwrap()
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

/// An innovation as the filter would give it; one that came from the estimator is its pattern, because nobody else can make one.
struct Innovations {
    pattern: Innovation<2>,
}

impl Innovations {
    fn new() -> Self {
        let track = Track::try_new(10_000.0, []).unwrap();
        let config = Config::with_mode(Mode::Paper);
        let estimator = Estimator::try_new(config, train(), track).unwrap();
        let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
        let estimates = [0.0, 10.0, 20.0].map(|time_s| {
            let measurement =
                Measurement { time_s, location_m: Some(20.0 * time_s), speed_mps: Some(20.0), effort_n_per_kg: None };
            estimator.step(&mut run, &measurement).unwrap()
        });
        let pattern = estimates.into_iter().find_map(|estimate| estimate.innovation).unwrap();
        Self { pattern }
    }

    fn of(&self, belief: &Gaussian<SIZE>, measurement: &Measurement) -> Innovation<2> {
        let mut innovation = self.pattern;
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
}
