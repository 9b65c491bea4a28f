//! Estimates judged against truth: the same table for the test, for tuning and for the README.

use crate::prelude::*;
use rundown::model::effects::Effects;
use rundown::tick::regime::Regime;
use rundown_truth::driver::Regime as TrueRegime;
use rundown_truth::scenario::fleet;

/// The manufacturer's description that every simulated vehicle deviates from.
pub const TRAIN: TrainDescription = TrainDescription { max_power_w: 2_036_377.8, ..TrainDescription::CASE_STUDY };
/// Its Davis coefficients.
pub const NOMINAL: Davis = TRAIN.davis;

/// The same as the estimator takes it.
pub fn train() -> Train {
    Train::try_new(TRAIN).unwrap()
}

/// The scenario's line and a train as described (not as it truly is).
pub fn description(config: Config, scenario: &Scenario) -> Description {
    let gradients = scenario.line.gradients_permille().iter();
    Description {
        train: TRAIN,
        track_length_m: scenario.line.length_m(),
        gradients: gradients.map(|&(from_m, permille)| Gradient { from_m, permille }).collect(),
        curves: Vec::new(),
        targets: Vec::new(),
        effects: Effects::NONE,
        config,
    }
}

/// An estimator for them.
pub fn estimator(config: Config, scenario: &Scenario) -> Estimator {
    description(config, scenario).estimator().unwrap()
}

/// The measurements of a simulated run.
pub fn measurements(run: &Run) -> Vec<Measurement> {
    let of_sample = |sample: &rundown_truth::sensors::Sample| Measurement {
        time_s: sample.time_s,
        location_m: sample.location_m,
        speed_mps: sample.speed_kmh.map(|kmh| kmh / 3.6),
        effort_n_per_kg: Some(sample.effort_n_per_kg),
    };
    run.samples.iter().map(of_sample).collect()
}

/// Replays one run.
pub fn replay(estimator: &Estimator, vehicle: &mut Vehicle, run: &Run) -> (Vec<Estimate>, RunSummary) {
    let mut state = estimator.begin_run(vehicle, Direction::Up);
    let estimates =
        measurements(run).iter().map(|measurement| estimator.step(&mut state, measurement).unwrap()).collect();
    let summary = estimator.end_run(&mut state, vehicle);
    (estimates, summary)
}

/// Resistance at a speed and its standard deviation.
pub fn resistance(davis: &Gaussian<3>, kmh: f64) -> (f64, f64) {
    let v = kmh / 3.6;
    let at = nalgebra::Vector3::new(1.0, v, v * v);
    (at.dot(&davis.mean), at.dot(&(davis.covariance * at)).sqrt())
}

/// Speeds at which r(v) is judged, km/h.
const SPEEDS_KMH: [f64; 7] = [20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0];

/// Errors of r(v) against the true coefficients.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    square: f64,
    count: f64,
    inside: f64,
    /// Squares of the errors in reported standard deviations.
    deviations: f64,
    /// Sum of the errors at each of the speeds.
    bias: [f64; SPEEDS_KMH.len()],
}

impl Errors {
    /// Adds one estimate, at 20 to 140 km/h.
    pub fn add(&mut self, davis: &Gaussian<3>, truth: &Davis) {
        for (kmh, bias) in SPEEDS_KMH.into_iter().zip(&mut self.bias) {
            let (r, sd) = resistance(davis, kmh);
            let true_r = truth.resistance_n_per_kg(kmh / 3.6);
            let error = (r - true_r) / true_r;
            self.square += error * error;
            *bias += error;
            self.deviations += (r - true_r) * (r - true_r) / (sd * sd);
            self.count += 1.0;
            if (r - true_r).abs() <= 1.96 * sd {
                self.inside += 1.0;
            }
        }
    }

    /// Root mean square, %.
    pub fn rmse_percent(&self) -> f64 {
        100.0 * (self.square / self.count).sqrt()
    }

    /// Mean, %.
    pub fn bias_percent(&self) -> f64 {
        100.0 * self.bias.iter().sum::<f64>() / self.count
    }

    /// Mean at 20, 60, 100 and 140 km/h, %: a tilt shows here.
    pub fn tilt_percent(&self) -> [f64; 4] {
        let each = self.count / SPEEDS_KMH.len() as f64;
        [0, 2, 4, 6].map(|i| 100.0 * self.bias[i] / each)
    }

    /// Root mean square of error over reported standard deviation: 1 if the interval is as wide as the errors are.
    pub fn deviations(&self) -> f64 {
        (self.deviations / self.count).sqrt()
    }

    /// Share of truths inside the reported 95 % interval.
    pub fn coverage(&self) -> f64 {
        self.inside / self.count
    }
}

/// What a set of vehicles gives.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Vehicle's r(v) after 1, 10 and all runs.
    pub vehicle: [Errors; 3],
    /// Running run's r(v), run 1, 10 and last.
    pub running: [Errors; 3],
    /// True and estimated deviation of r at 60, 100, 140 km/h after the first run.
    pub slope: [Vec<(f64, f64)>; 3],
    /// Causal and confirmed: rows are the truth, columns what was recognised, indices as `Regime::ALL`.
    pub confusion: [[[f64; 5]; 5]; 2],
    /// Absolute errors: brake start s, coast start s, cruise km/h, power %.
    pub features: [Vec<f64>; 4],
}

/// True over described r0, r1, r2 of so many vehicles: up to 35 % off in common, with a part of its own for each coefficient. The same every time.
pub fn scales(vehicles: usize) -> Vec<[f64; 3]> {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    (0..vehicles)
        .map(|_| {
            let common = rng.random_range(0.75..1.25);
            [0; 3].map(|_| common * rng.random_range(0.92..1.08))
        })
        .collect()
}

/// Vehicles: scale of r0, r1, r2 of each; runs of each.
pub fn judge(config: Config, scenario: &Scenario, scales: &[[f64; 3]], runs: usize, seed: u64) -> Table {
    let mut table = Table::default();
    for (index, scale) in scales.iter().enumerate() {
        let runs = fleet(scenario, *scale, runs, seed + 1000 * index as u64);
        table.judge_vehicle(config, scenario, *scale, &runs);
    }
    table
}

impl Table {
    /// Adds one vehicle by the scale of its r0, r1, r2 and its runs.
    pub fn judge_vehicle(&mut self, config: Config, scenario: &Scenario, scale: [f64; 3], fleet: &[Run]) {
        let table = self;
        let runs = fleet.len();
        let estimator = estimator(config, scenario);
        let truth = Davis { r0: NOMINAL.r0 * scale[0], r1: NOMINAL.r1 * scale[1], r2: NOMINAL.r2 * scale[2] };
        let mut vehicle = estimator.new_vehicle();
        for (index, run) in fleet.iter().enumerate() {
            let (estimates, summary) = replay(&estimator, &mut vehicle, run);
            let slot = match index + 1 {
                1 => Some(0),
                10 => Some(1),
                _ => None,
            };
            let of_run = Davis { r0: run.facts.davis.r0, r1: run.facts.davis.r1, r2: run.facts.davis.r2 };
            let last = (index + 1 == runs).then_some(2);
            for slot in slot.into_iter().chain(last) {
                table.vehicle[slot].add(&vehicle.davis(), &truth);
                table.running[slot].add(&summary.run_davis, &of_run);
            }
            if index == 0 {
                for (pairs, kmh) in table.slope.iter_mut().zip([60.0, 100.0, 140.0]) {
                    let nominal = NOMINAL.resistance_n_per_kg(kmh / 3.6);
                    let true_r = of_run.resistance_n_per_kg(kmh / 3.6);
                    let (r, _) = resistance(&vehicle.davis(), kmh);
                    pairs.push((true_r / nominal - 1.0, r / nominal - 1.0));
                }
            }
            table.regimes(run, &estimates);
            table.feature_errors(run, &summary);
        }
    }
}

/// The estimator's word for a true regime.
pub fn regime(regime: TrueRegime) -> Regime {
    match regime {
        TrueRegime::Standstill => Regime::Standstill,
        TrueRegime::Traction => Regime::Traction,
        TrueRegime::Cruise => Regime::Cruise,
        TrueRegime::Coast => Regime::Coast,
        TrueRegime::Brake => Regime::Brake,
    }
}

impl Table {
    fn regimes(&mut self, run: &Run, estimates: &[Estimate]) {
        for (index, (estimate, truth)) in estimates.iter().zip(&run.truth).enumerate() {
            let confirmed = estimates.get(index + 1).and_then(|next| next.confirmed);
            let recognised = [estimate.regime, confirmed.unwrap_or(estimate.regime)];
            for (confusion, recognised) in self.confusion.iter_mut().zip(recognised) {
                confusion[regime(truth.regime) as usize][recognised as usize] += 1.0;
            }
        }
    }

    fn feature_errors(&mut self, run: &Run, summary: &RunSummary) {
        let features = &summary.features;
        if let Some(brake) = &features.final_brake {
            self.features[0].push((brake.start_time_s - run.facts.final_brake.time_s).abs());
        }
        if let (Some(coast), Some(truth)) = (&features.final_coast, &run.facts.final_coast) {
            self.features[1].push((coast.start_time_s - truth.time_s).abs());
        }
        if let Some(median) = features.cruise_speed_median_mps {
            self.features[2].push(3.6 * (median - run.facts.cruise_mps).abs());
        }
        if let Some(truth) = run.facts.mean_power_50_130_w_per_kg
            && features.power_w_per_kg.count > 0
        {
            self.features[3].push(100.0 * (features.power_w_per_kg.mean / truth - 1.0).abs());
        }
    }

    /// Slope of estimated on true deviation at 60, 100, 140 km/h.
    pub fn slopes(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| {
            let pairs = &self.slope[i];
            let count = pairs.len() as f64;
            let mean = |f: fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>() / count;
            let (x, y) = (mean(|p| p.0), mean(|p| p.1));
            let covariance: f64 = pairs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
            let variance: f64 = pairs.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
            covariance / variance
        })
    }

    /// Accuracy and macro F1, causal and one sample later.
    pub fn regime_scores(&self) -> [(f64, f64); 2] {
        [0, 1].map(|i| {
            let confusion = &self.confusion[i];
            let all: f64 = confusion.iter().flatten().sum();
            let right: f64 = (0..5).map(|k| confusion[k][k]).sum();
            let f1: f64 = (0..5)
                .map(|k| {
                    let row: f64 = confusion[k].iter().sum();
                    let column: f64 = confusion.iter().map(|row| row[k]).sum();
                    2.0 * confusion[k][k] / (row + column)
                })
                .sum();
            (right / all, f1 / 5.0)
        })
    }

    /// 90th percentile of the absolute feature errors: brake start s, coast start s, cruise km/h, power %.
    pub fn feature_p90(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|i| {
            let mut errors = self.features[i].clone();
            errors.sort_by(f64::total_cmp);
            let index = (0.9 * errors.len() as f64) as usize;
            errors.get(index).copied().unwrap_or(f64::NAN)
        })
    }

    /// As lines of text.
    pub fn print(&self, title: &str) {
        println!("{title}");
        let row = |name: &str, errors: &[Errors; 3]| {
            let cell = |e: &Errors| {
                format!(
                    "{:.2} % ({:+.2}, {:.0} % inside, {:.2} sd)",
                    e.rmse_percent(),
                    e.bias_percent(),
                    100.0 * e.coverage(),
                    e.deviations()
                )
            };
            println!("  {name}: run 1 {}, run 10 {}, last {}", cell(&errors[0]), cell(&errors[1]), cell(&errors[2]));
        };
        row("vehicle r(v) rmse", &self.vehicle);
        row("running r(v) rmse", &self.running);
        println!("  last vehicle's mean error at 20/60/100/140 km/h: {:+.2?} %", self.vehicle[2].tilt_percent());
        println!("  slope at 60/100/140 km/h: {:.2?}", self.slopes());
        println!("  regimes (accuracy, macro F1) causal, confirmed: {:.3?}", self.regime_scores());
        println!("  p90 of brake start s, coast start s, cruise km/h, power %: {:.2?}", self.feature_p90());
    }
}
