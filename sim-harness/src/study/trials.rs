//! What section 4.2 says the authors tried with their filter, tried again on these runs.
//!
//! | remark | here |
//! |---|---|
//! | larger initial covariances give negative coefficients | [`sensitivity`] |
//! | so does a strong noise of the acceleration, a small one moves them more | [`noise`] |
//! | so does a small noise of the coefficients | [`davis_noise`] |
//! | fewer samples give worse regimes and features | [`thinned`] |
//! | the computation is short enough for more samples | [`pace`] |
//!
//! Table 1 prints standard deviations; the remark speaks of "two orders of magnitude in one of the initial
//! covariances". Read as a covariance that is a deviation ten times as large, read as the printed deviation a hundred
//! times: both are tried.

use super::gather::{Drawn, Estimators};
use super::readings::pass::{Filter, Pass, R0_NOISE, way};
use super::readings::remarks::{SMALL_MPS2, STRONG_MPS2};
use super::{moments::Moments, view::Seen};
use rayon::prelude::*;
use rundown::estimator::config::{Config, Mode};
use rundown::{
    estimator::Estimator, model::line::Line, model::state, model::track::Track, model::train::Train,
    tick::bounds::ConfigError, tick::regime::Regime,
};
use rundown_files::recording::Recording;
use rundown_files::replay::{Tick, replay};
use serde::Serialize;
use std::time::Instant;

/// Factors on the initial standard deviations of Table 1.
pub const FACTORS: [f64; 3] = [1.0, 10.0, 100.0];
/// Which of them are changed.
const WHICH: [(&str, [bool; 3]); 4] = [
    ("r0", [true, false, false]),
    ("r1", [false, true, false]),
    ("r2", [false, false, true]),
    ("r0, r1, r2", [true; 3]),
];

/// One sample in so many is kept.
pub const KEPT: usize = 2;
/// Passes whose shortest counts: other programs only make one longer.
const PASSES: usize = 5;
/// Runs on which other settings of the filter are tried.
const RUNS: usize = 67;

#[derive(Clone, Debug, Default)]
pub struct Trials {
    pub sensitivity: Vec<Sensitivity>,
    pub noise: Vec<Noise>,
    /// With noise of r0, as Q and drawn; none without runs.
    pub davis_noise: Option<[Shaken; 2]>,
    /// All samples, and every second one; none without truth.
    pub thinned: Option<[Misses; 2]>,
    /// Of the paper's and of the gated mode; none without runs.
    pub pace: Option<[Pace; 2]>,
}

/// Noise of the acceleration: as Q of the filter, and drawn and added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    pub sd_mps2: f64,
    pub q: Shaken,
    pub drawn: Shaken,
}

/// What a noise did to the runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaken {
    pub negative_runs: usize,
    pub runs: usize,
    /// What r0 covers, as a multiple of what it covers without.
    pub way: f64,
    /// What it covers more than without in a run, mean over runs, N/kg.
    pub more_n_per_kg: f64,
}

/// How far both modes are from the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misses {
    pub paper: Missed,
    pub gated: Missed,
}

/// How far regimes and features are from the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Missed {
    /// Distance of the lengths of final coast and final brake, s.
    pub lengths_s: [Moments; 2],
    /// 1 for each sample that has another regime, 0 for the others.
    pub regimes: Moments,
}

impl Missed {
    fn add(&mut self, seen: &Seen, truth: &Seen) {
        let lengths = |of: &Seen| [of.outcome.coast_s, of.outcome.brake_s];
        for (moments, (seen_s, was_s)) in self.lengths_s.iter_mut().zip(lengths(seen).into_iter().zip(lengths(truth))) {
            seen_s.zip(was_s).into_iter().for_each(|(seen_s, was_s)| moments.add((seen_s - was_s).abs()));
        }
        let mut were = truth.points.regimes.iter().peekable();
        for (time_s, regime) in &seen.points.regimes {
            while were.next_if(|(at_s, _)| at_s < time_s).is_some() {}
            // The paper has no regime for a train that stands.
            let moving = |(at_s, was): &&(f64, Regime)| at_s == time_s && *was != Regime::Standstill;
            if let Some((_, was)) = were.peek().filter(|sample| moving(sample)) {
                self.regimes.add(f64::from(u8::from(was != regime)));
            }
        }
    }
}

/// How long it takes here at most: a step in whole ms, a run in whole s. Coarse, so that the same seed gives the same
/// report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    pub step_ms: u64,
    pub run_s: u64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The coefficients whose initial deviation is changed.
    pub which: &'static str,
    pub factor: f64,
    /// Runs in which a coefficient fell below zero.
    pub negative_runs: usize,
    pub runs: usize,
    /// Least value of each coefficient over all samples, as a share of the manufacturer's.
    pub least_share: [f64; 3],
}

impl Trials {
    pub fn of(config: &Config, estimators: &Estimators, track: &Track, drawn: &[Drawn]) -> Result<Self, ConfigError> {
        let train = *estimators.paper.train();
        let few: Vec<Recording> = drawn.iter().take(RUNS).map(|run| run.read().clone()).collect();
        Ok(Self {
            sensitivity: sensitivity(config, train, track, &few)?,
            noise: noise(config, &train, track, &few),
            davis_noise: davis_noise(config, &train, track, &few),
            thinned: thinned(estimators, drawn),
            pace: pace(estimators, &few),
        })
    }
}

/// Tries every change of the initial deviations.
pub fn sensitivity(
    config: &Config,
    train: Train,
    track: &Track,
    runs: &[Recording],
) -> Result<Vec<Sensitivity>, ConfigError> {
    let smallest = |all: [f64; 3], of_run: &[f64; 3]| std::array::from_fn(|index| f64::min(all[index], of_run[index]));
    let mut found = Vec::new();
    for factor in FACTORS {
        // As printed: one row is enough.
        let some = if factor == 1.0 { WHICH.len() - 1 } else { 0 };
        for (which, changed) in &WHICH[some..] {
            let mut config = *config;
            for (sd, changed) in config.paper.initial_davis_sd.iter_mut().zip(changed) {
                *sd *= if *changed { factor } else { 1.0 };
            }
            let least = least_shares(config, train, track, runs)?;
            found.push(Sensitivity {
                which,
                factor,
                negative_runs: negative(&least),
                runs: runs.len(),
                least_share: least.iter().fold([f64::INFINITY; 3], smallest),
            });
        }
    }
    Ok(found)
}

fn noise(config: &Config, train: &Train, track: &Track, runs: &[Recording]) -> Vec<Noise> {
    let quiet = Filter::from(config.paper);
    let of = |sd_mps2: f64| {
        let mut q = quiet;
        q.config.acceleration_noise_mps2 = sd_mps2;
        let drawn = Filter { drawn_mps2: sd_mps2, ..quiet };
        let [q, drawn] = [q, drawn].map(|noisy| shaken([&quiet, &noisy], train, track, runs));
        Noise { sd_mps2, q, drawn }
    };
    SMALL_MPS2.into_iter().chain(STRONG_MPS2).map(of).collect()
}

fn davis_noise(config: &Config, train: &Train, track: &Track, runs: &[Recording]) -> Option<[Shaken; 2]> {
    let quiet = Filter::from(config.paper);
    let q = Filter { davis_noise: [R0_NOISE, 0.0, 0.0], ..quiet };
    let drawn = Filter { drawn_r0: R0_NOISE, ..quiet };
    (!runs.is_empty()).then(|| [q, drawn].map(|noisy| shaken([&quiet, &noisy], train, track, runs)))
}

fn shaken(quiet_and_noisy: [&Filter; 2], train: &Train, track: &Track, runs: &[Recording]) -> Shaken {
    let [quiet, noisy] = quiet_and_noisy.map(|filter| -> Vec<Pass> {
        let one = |run: &Recording| filter.pass(&Line { train, track, direction: run.direction }, run);
        runs.par_iter().map(one).collect()
    });
    let (with, without) = (way(&noisy), way(&quiet));
    Shaken {
        negative_runs: noisy.iter().filter(|pass| pass.is_negative()).count(),
        runs: runs.len(),
        way: with / without,
        more_n_per_kg: (with - without) / runs.len().max(1) as f64,
    }
}

/// Least coefficients of each run in the paper's mode, as shares of the manufacturer's.
fn least_shares(config: Config, train: Train, track: &Track, runs: &[Recording]) -> Result<Vec<[f64; 3]>, ConfigError> {
    let estimator = Estimator::try_new(Config { mode: Mode::Paper, ..config }, train, track.clone())?;
    let stated = [train.davis().r0, train.davis().r1, train.davis().r2];
    let of_run = |run: &Recording| {
        let replayed = replay(&estimator, &mut estimator.new_vehicle(), run, Tick::EverySample);
        let mut least = [f64::INFINITY; 3];
        for estimate in &replayed.estimates {
            for (index, least) in least.iter_mut().enumerate() {
                *least = least.min(estimate.belief.mean[state::R0 + index] / stated[index]);
            }
        }
        least
    };
    Ok(runs.par_iter().map(of_run).collect())
}

/// How many have a coefficient below zero.
fn negative(least: &[[f64; 3]]) -> usize {
    least.iter().filter(|least| least.iter().any(|share| *share < 0.0)).count()
}

/// Replays the runs whose truth is known with all their samples and with every [`KEPT`]th, each for itself.
fn thinned(estimators: &Estimators, drawn: &[Drawn]) -> Option<[Misses; 2]> {
    let known: Vec<(&Recording, &Seen)> =
        drawn.iter().filter_map(|run| Some((&run.recording, run.truth.as_ref()?))).collect();
    let misses = |estimator: &Estimator, every: usize| {
        let of_run = |(recording, _): &(&Recording, &Seen)| {
            let mut recording = (*recording).clone();
            recording.rows = recording.rows.into_iter().step_by(every).collect();
            let mut vehicle = estimator.new_vehicle();
            let run = replay(estimator, &mut vehicle, &recording, Tick::EverySample);
            Seen::of_replay(&run, estimator.train())
        };
        let of_runs: Vec<Seen> = known.par_iter().map(of_run).collect();
        let mut missed = Missed::default();
        of_runs.iter().zip(&known).for_each(|(seen, (_, truth))| missed.add(seen, truth));
        missed
    };
    let of = |every| Misses { paper: misses(&estimators.paper, every), gated: misses(&estimators.gated, every) };
    (!known.is_empty()).then(|| [1, KEPT].map(of))
}

fn pace(estimators: &Estimators, runs: &[Recording]) -> Option<[Pace; 2]> {
    let longest = runs.iter().max_by_key(|run| run.rows.len())?;
    let of = |estimator: &Estimator| {
        let passes = (0..PASSES).map(|_| {
            let mut vehicle = estimator.new_vehicle();
            let begun = Instant::now();
            replay(estimator, &mut vehicle, longest, Tick::EverySample);
            begun.elapsed()
        });
        let took_s = passes.min().unwrap_or_default().as_secs_f64();
        let steps = longest.rows.len().max(1) as f64;
        Pace { step_ms: (1e3 * took_s / steps).ceil().max(1.0) as u64, run_s: took_s.ceil().max(1.0) as u64 }
    };
    Some([of(&estimators.paper), of(&estimators.gated)])
}
