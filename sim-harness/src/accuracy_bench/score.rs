//! Estimates of fleets beside their truth: errors of r(v), intervals, regimes, features.

use crate::bound::Bound;
use nalgebra::Vector3;
use rundown::estimator::{Estimator, RunSummary};
use rundown::filter::gaussian::Gaussian;
use rundown::model::direction::Direction;
use rundown::model::resistance::Davis;
use rundown::tick::estimate::Estimate;
use rundown::tick::measurement::Measurement;
use rundown::tick::memory::Vehicle;
use rundown::tick::regime::Regime;
use rundown_check::figure::HALF_95;
use rundown_files::statistics::{Pairs, mean_of, upper_quantile};
use rundown_truth::driver::Regime as TrueRegime;
use rundown_truth::scenario::Run;
use rundown_truth::train::DavisTruth;

/// Speeds at which r(v) is judged.
const SPEEDS: usize = 7;

/// Resistance at a speed and its standard deviation, N/kg.
pub fn resistance(davis: &Gaussian<3>, kmh: f64) -> (f64, f64) {
    let v = kmh / 3.6;
    let at = Vector3::new(1.0, v, v * v);
    (at.dot(&davis.mean), at.dot(&(davis.covariance * at)).sqrt())
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

/// The true coefficients in the estimator's type.
pub fn davis(truth: &DavisTruth) -> Davis {
    Davis { r0: truth.r0, r1: truth.r1, r2: truth.r2 }
}

/// The measurements of a simulated run.
fn measurements(run: &Run) -> Vec<Measurement> {
    let of_sample = |sample: &rundown_truth::sensors::Sample| Measurement {
        time_s: sample.time_s,
        location_m: sample.location_m,
        speed_mps: sample.speed_kmh.map(|kmh| kmh / 3.6),
        effort_n_per_kg: Some(sample.effort_n_per_kg),
    };
    run.samples.iter().map(of_sample).collect()
}

/// Replays one run. A measurement that the estimator refuses has no estimate.
pub fn replay(estimator: &Estimator, vehicle: &mut Vehicle, run: &Run) -> (Vec<Estimate>, RunSummary) {
    let mut state = estimator.begin_run(vehicle, Direction::Up);
    let step = |measurement: &Measurement| estimator.step(&mut state, measurement).ok();
    let estimates = measurements(run).iter().filter_map(step).collect();
    let summary = estimator.end_run(&mut state, vehicle);
    (estimates, summary)
}

/// Evenly from the slowest to the fastest of a band.
fn speeds_kmh([least_kmh, most_kmh]: [f64; 2]) -> [f64; SPEEDS] {
    std::array::from_fn(|i| least_kmh + (most_kmh - least_kmh) * i as f64 / (SPEEDS - 1) as f64)
}

/// Errors of r(v) against the true coefficients, at seven speeds from the slowest to the fastest of a band.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    square: f64,
    count: f64,
    inside: f64,
    /// Squares of the errors in reported standard deviations.
    deviations: f64,
    /// Sum of the errors at each of the speeds.
    bias: [f64; SPEEDS],
}

impl Errors {
    /// Adds one estimate at speeds of a band, km/h.
    pub fn add(&mut self, band_kmh: [f64; 2], davis: &Gaussian<3>, truth: &Davis) {
        for (bias, kmh) in self.bias.iter_mut().zip(speeds_kmh(band_kmh)) {
            let (r, sd) = resistance(davis, kmh);
            let true_r = truth.resistance_n_per_kg(kmh / 3.6);
            let error = (r - true_r) / true_r;
            self.square += error * error;
            *bias += error;
            self.deviations += (r - true_r) * (r - true_r) / (sd * sd);
            self.count += 1.0;
            if (r - true_r).abs() <= HALF_95 * sd {
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

    /// Mean at the slowest, two between, and the fastest of the speeds, %: a tilt shows here.
    pub fn tilt_percent(&self) -> [f64; 4] {
        let each = self.count / SPEEDS as f64;
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

    fn cell(&self) -> String {
        format!(
            "{:.2} % ({:+.2}, {:.0} % inside, {:.2} sd)",
            self.rmse_percent(),
            self.bias_percent(),
            100.0 * self.coverage(),
            self.deviations()
        )
    }
}

/// One vehicle and what it is judged by.
pub struct JudgedVehicle<'a> {
    /// The estimator with the train as described.
    pub estimator: &'a Estimator,
    /// Its true coefficients in still air.
    pub truth: Davis,
    /// Speeds of this kind of train, km/h.
    pub band_kmh: [f64; 2],
}

/// What a fleet gives.
#[derive(Clone, Debug, Default)]
pub struct FleetFigures {
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
    /// Time learned from in each run, s.
    pub learned_s: Vec<f64>,
    /// Squares of the smallest possible errors of the vehicle's r(v), as shares of it, after 1, 10 and all runs: by the
    /// prior that the board has, and for one who knows how the fleet scatters.
    possible: [[Vec<f64>; 3]; 2],
}

/// Which of the looks, after 1, 10 and all runs, follow a run.
fn looks(index: usize, runs: usize) -> impl Iterator<Item = usize> {
    let slot = match index + 1 {
        1 => Some(0),
        10 => Some(1),
        _ => None,
    };
    slot.into_iter().chain((index + 1 == runs).then_some(2))
}

impl FleetFigures {
    /// Adds one vehicle by its runs.
    pub fn judge_vehicle(&mut self, judged: &JudgedVehicle<'_>, fleet: &[Run]) {
        let JudgedVehicle { estimator, truth, band_kmh } = judged;
        let nominal = estimator.train().davis();
        let mut vehicle = estimator.new_vehicle();
        for (index, run) in fleet.iter().enumerate() {
            let (estimates, summary) = replay(estimator, &mut vehicle, run);
            let of_run = davis(&run.facts.davis);
            for slot in looks(index, fleet.len()) {
                self.vehicle[slot].add(*band_kmh, &vehicle.davis(), truth);
                self.running[slot].add(*band_kmh, &summary.run_davis, &of_run);
            }
            if index == 0 {
                for (pairs, kmh) in self.slope.iter_mut().zip([60.0, 100.0, 140.0]) {
                    let nominal = nominal.resistance_n_per_kg(kmh / 3.6);
                    let true_r = of_run.resistance_n_per_kg(kmh / 3.6);
                    let (r, _) = resistance(&vehicle.davis(), kmh);
                    pairs.push((true_r / nominal - 1.0, r / nominal - 1.0));
                }
            }
            self.learned_s.push(summary.learned_s);
            self.regimes(run, &estimates);
            self.feature_errors(run, &summary);
        }
    }

    /// Adds what can be known of one vehicle, by both priors.
    pub(crate) fn judge_bounds(&mut self, judged: &JudgedVehicle<'_>, bounds: [Bound; 2], fleet: &[Run]) {
        for (mut bound, possible) in bounds.into_iter().zip(&mut self.possible) {
            for (index, run) in fleet.iter().enumerate() {
                let DavisTruth { r0, r1, r2 } = run.facts.davis;
                bound.run(&run.truth, &run.samples, [r0, r1, r2]);
                for slot in looks(index, fleet.len()) {
                    let least = Gaussian { mean: Vector3::zeros(), covariance: bound.davis() };
                    let share = |kmh: f64| resistance(&least, kmh).1 / judged.truth.resistance_n_per_kg(kmh / 3.6);
                    possible[slot].extend(speeds_kmh(judged.band_kmh).map(share).map(|share| share * share));
                }
            }
        }
    }

    /// Root mean squares of the smallest possible errors of the vehicle's r(v) after 1, 10 and all runs, %: by the
    /// board's prior, and for one who knows how the fleet scatters.
    pub fn possible_percent(&self) -> [[f64; 3]; 2] {
        [0, 1].map(|prior| [0, 1, 2].map(|slot| 100.0 * mean_of(&self.possible[prior][slot]).sqrt()))
    }

    /// Adds the vehicles of another table.
    pub fn merge(&mut self, other: Self) {
        let errors = self.vehicle.iter_mut().chain(&mut self.running);
        for (own, other) in errors.zip(other.vehicle.into_iter().chain(other.running)) {
            own.square += other.square;
            own.count += other.count;
            own.inside += other.inside;
            own.deviations += other.deviations;
            own.bias.iter_mut().zip(other.bias).for_each(|(own, other)| *own += other);
        }
        self.slope.iter_mut().zip(other.slope).for_each(|(own, other)| own.extend(other));
        let cells = self.confusion.iter_mut().flatten().flatten();
        cells.zip(other.confusion.iter().flatten().flatten()).for_each(|(own, other)| *own += other);
        self.features.iter_mut().zip(other.features).for_each(|(own, other)| own.extend(other));
        self.learned_s.extend(other.learned_s);
        let possible = self.possible.iter_mut().flatten();
        possible.zip(other.possible.into_iter().flatten()).for_each(|(own, other)| own.extend(other));
    }

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
        [0, 1, 2].map(|i| Pairs::of(&self.slope[i]).slope())
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
        [0, 1, 2, 3].map(|i| upper_quantile(&self.features[i], 0.9).unwrap_or(f64::NAN))
    }

    /// As lines of text.
    pub fn print(&self, title: &str) {
        println!("{title}");
        let row = |name: &str, errors: &[Errors; 3]| {
            println!("  {name}: run 1 {}, run 10 {}, last {}", errors[0].cell(), errors[1].cell(), errors[2].cell());
        };
        row("vehicle r(v) rmse", &self.vehicle);
        row("running r(v) rmse", &self.running);
        println!("  last vehicle's mean error from slow to fast: {:+.2?} %", self.vehicle[2].tilt_percent());
        println!("  slope at 60/100/140 km/h: {:.2?}", self.slopes());
        println!("  regimes (accuracy, macro F1) causal, confirmed: {:.3?}", self.regime_scores());
        println!("  p90 of brake start s, coast start s, cruise km/h, power %: {:.2?}", self.feature_p90());
        let learned_s = mean_of(&self.learned_s);
        println!("  learned from {learned_s:.0} s of a run");
    }
}
