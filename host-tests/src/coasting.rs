//! Coast-ahead predictions judged against truth: what the train would do if it coasted from there, driven on by the
//! simulator.

use crate::prelude::*;
use board_tests::described::measurements;
pub use board_tests::described::with_targets;
use rundown::coast_ahead::{CoastAhead, NINETY_PERCENT, Outcome, Steady};
use rundown_truth::driver::Regime;
use rundown_truth::motion::Motion;
use rundown_truth::plan::plan;
use rundown_truth::sensors::TruthSample;
use rundown_truth::world::{History, World};

/// Step of the true coast, s.
const STEP_S: f64 = 0.25;

/// When and how fast a coasting train is at a place; `None`: it stands before.
fn coasted(world: &World, from: &TruthSample, at_m: f64) -> Option<(f64, f64)> {
    let mut motion = Motion { location_m: from.location_m, speed_mps: from.speed_mps };
    let mut history = History { time_s: from.time_s, departed_s: Some(0.0), braked: true, ..History::default() };
    loop {
        let next = world.advance(history, motion, 0.0, STEP_S);
        if next.location_m >= at_m {
            let share = (at_m - motion.location_m) / (next.location_m - motion.location_m);
            let speed_mps = motion.speed_mps + share * (next.speed_mps - motion.speed_mps);
            return Some((speed_mps, history.time_s + share * STEP_S));
        }
        if next.speed_mps < 1.0 {
            return None;
        }
        motion = next;
        history.time_s += STEP_S;
    }
}

/// One prediction and what is true.
#[derive(Clone, Copy, Debug)]
pub struct Judged {
    /// Number of the vehicle's run.
    pub run: usize,
    /// What the train truly did at that moment.
    pub regime: Regime,
    /// The prediction.
    pub said: CoastAhead,
    /// Speed and time at the target; `None`: it stands before.
    pub truth: Option<(f64, f64)>,
}

/// The predictions of all ticks of a vehicle's runs that are faster than `least_kmh`.
pub fn judge(
    config: Config,
    scenario: &Scenario,
    scale: [f64; 3],
    runs: usize,
    seed: u64,
    least_kmh: f64,
) -> Vec<Judged> {
    let scenario = Scenario { davis_scale: scale, ..scenario.clone() };
    let estimator = with_targets(config, &scenario).estimator().unwrap();
    let mut vehicle = estimator.new_vehicle();
    let mut judged = Vec::new();
    for (number, plan) in plan(&scenario, runs, seed).iter().enumerate() {
        let run = simulate_planned(&scenario, plan).unwrap();
        let (trace, _, world) = drive_planned(&scenario, plan).unwrap();
        let log = measurements(&run);
        for (estimate, said) in predictions(&estimator, &mut vehicle, &log) {
            let at = (estimate.time_s / scenario.step_s).round() as usize;
            let Some(from) = trace.get(at).filter(|at| at.speed_mps > least_kmh / 3.6) else {
                continue;
            };
            let Some(target) = said.target.filter(|t| t.at_m > from.location_m) else {
                continue;
            };
            judged.push(Judged { run: number, regime: from.regime, said, truth: coasted(&world, from, target.at_m) });
        }
    }
    judged
}

/// The prediction of each tick of a run.
fn predictions(
    estimator: &Estimator,
    vehicle: &mut Vehicle,
    log: &[rundown::tick::measurement::Measurement],
) -> Vec<(Estimate, CoastAhead)> {
    let mut state = estimator.begin_run(vehicle, Direction::Up);
    let found = log
        .iter()
        .map(|measurement| {
            let estimate = estimator.step(&mut state, measurement).unwrap();
            (estimate, estimator.coast_ahead(&state, &estimate))
        })
        .collect();
    estimator.end_run(&mut state, vehicle);
    found
}

/// Coverage and sharpness of a set of predictions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Calibration {
    /// Predictions that say that the train arrives, and it does.
    pub count: f64,
    /// Truths inside the 90 % interval: speed, time.
    pub inside: [f64; 2],
    /// Sums of half the interval: km/h, s.
    pub half_width: [f64; 2],
    /// Sums of squared errors: (km/h)², s².
    pub square: [f64; 2],
    /// Sums of errors: km/h, s.
    pub bias: [f64; 2],
    /// Sums of squared errors in standard deviations.
    pub deviations: [f64; 2],
    /// It was said to arrive and stood before, and the other way round.
    pub wrong: [f64; 2],
    /// Predictions of where it stands, or that this is not known.
    pub stands: [f64; 2],
}

impl Calibration {
    /// Judges predictions against what the coasts came to.
    pub fn of<'a>(judged: impl IntoIterator<Item = &'a Judged>) -> Self {
        let mut sum = Self::default();
        for one in judged {
            match (one.said.outcome, one.truth) {
                (Outcome::Arrives(arrival), Some((speed_mps, time_s))) => {
                    sum.count += 1.0;
                    let errors = [
                        (arrival.speed_mps - speed_mps, arrival.speed_sd_mps, 3.6),
                        (arrival.time_s - time_s, arrival.time_sd_s, 1.0),
                    ];
                    for (i, (error, sd, unit)) in errors.into_iter().enumerate() {
                        sum.inside[i] += f64::from(error.abs() <= NINETY_PERCENT * sd);
                        sum.half_width[i] += NINETY_PERCENT * sd * unit;
                        sum.square[i] += error * error * unit * unit;
                        sum.bias[i] += error * unit;
                        sum.deviations[i] += error * error / (sd * sd);
                    }
                }
                (Outcome::Arrives(_), None) => sum.wrong[0] += 1.0,
                (Outcome::Stops { .. }, Some(_)) => sum.wrong[1] += 1.0,
                (Outcome::Stops { .. }, None) => sum.stands[0] += 1.0,
                (Outcome::MayStop, _) => sum.stands[1] += 1.0,
                (Outcome::Unknown | Outcome::NoTarget, _) => {}
            }
        }
        sum
    }

    /// Share of truths inside the interval: speed, time.
    pub fn coverage(&self) -> [f64; 2] {
        self.inside.map(|inside| inside / self.count)
    }

    /// A row of a table.
    pub fn row(&self) -> String {
        let [speed, time] = self.coverage();
        let each = |sums: [f64; 2]| sums.map(|sum| sum / self.count);
        let ([wide_kmh, wide_s], [square_kmh, square_s], [bias_kmh, bias_s], [dev_v, dev_t]) =
            (each(self.half_width), each(self.square), each(self.bias), each(self.deviations));
        format!(
            "{:6} {:5.1} % ±{wide_kmh:5.2} rms {:5.2} bias {bias_kmh:+5.2} km/h z {:4.2} | {:5.1} % ±{wide_s:5.2} rms {:5.2} bias {bias_s:+5.2} s z {:4.2} | wrong {:?} stands {:?}",
            self.count,
            100.0 * speed,
            square_kmh.sqrt(),
            dev_v.sqrt(),
            100.0 * time,
            square_s.sqrt(),
            dev_t.sqrt(),
            self.wrong,
            self.stands,
        )
    }
}

/// How often predictions are published, by a run's ticks with a target: all, and while truly coasting: published, of so
/// many.
pub fn published(config: &Config, judged: &[Judged]) -> [[usize; 2]; 2] {
    let mut counts = [[0; 2]; 2];
    let mut steady = Steady::NONE;
    let mut run = 0;
    for one in judged {
        if one.run != run {
            (run, steady) = (one.run, Steady::NONE);
        }
        let news = usize::from(steady.is_news(&config.coast, &one.said));
        let coasting = usize::from(one.regime == Regime::Coast);
        counts[0][0] += news;
        counts[0][1] += 1;
        counts[1][0] += coasting * news;
        counts[1][1] += coasting;
    }
    counts
}
