//! What section 4.2 says the authors tried with their filter, tried again on these runs.
//!
//! | remark | here |
//! |---|---|
//! | larger initial covariances give negative coefficients | [`sensitivity`](super::sensitivity) |
//! | so does a strong noise of the acceleration | [`noise`] |
//! | fewer samples give worse regimes and features | [`thinned`] |
//! | the computation is short enough for more samples | [`pace`] |

use super::gather::{Drawn, Estimators};
use super::moments::Moments;
use super::sensitivity::{Sensitivity, negative_runs};
use super::view::Seen;
use rayon::prelude::*;
use rundown::estimator::Estimator;
use rundown::estimator::config::{Config, Mode};
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown::tick::bounds::ConfigError;
use rundown_files::recording::Recording;
use rundown_files::replay::{Tick, replay};
use std::time::Instant;

/// Standard deviations of the acceleration noise that are tried, m/s²; Table 1 has none.
pub const NOISES_MPS2: [f64; 3] = [0.001, 0.01, 0.1];
/// Every so manieth sample is kept.
pub const KEPT: usize = 2;
/// Passes whose shortest counts: other programs only make one longer.
const PASSES: usize = 5;

#[derive(Clone, Debug, Default)]
pub struct Trials {
    pub sensitivity: Vec<Sensitivity>,
    pub noise: Vec<Noise>,
    /// All samples, and every second one; none without truth.
    pub thinned: Option<[Misses; 2]>,
    /// Of the paper's and of the gated mode; none without runs.
    pub pace: Option<[Pace; 2]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    pub sd_mps2: f64,
    pub negative_runs: usize,
    pub runs: usize,
}

/// How far lengths are from the truth: final coast and final brake, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misses {
    pub paper: [Moments; 2],
    pub gated: [Moments; 2],
}

/// How long it takes here at most: a step in whole ms, a run in whole s. Coarse, so that the same seed gives the same report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    pub step_ms: u64,
    pub run_s: u64,
}

/// Tries noises of the acceleration in the paper's mode.
pub fn noise(config: &Config, train: Train, track: &Track, runs: &[Recording]) -> Result<Vec<Noise>, ConfigError> {
    let of = |sd_mps2: f64| {
        let mut config = Config { mode: Mode::Paper, ..*config };
        config.paper.acceleration_noise_mps2 = sd_mps2;
        let estimator = Estimator::try_new(config, train, track.clone())?;
        Ok(Noise { sd_mps2, negative_runs: negative_runs(&estimator, runs), runs: runs.len() })
    };
    NOISES_MPS2.into_iter().map(of).collect()
}

/// Replays the runs whose truth is known with all their samples and with every [`KEPT`]th, each for itself.
pub fn thinned(estimators: &Estimators, drawn: &[Drawn]) -> Option<[Misses; 2]> {
    let known: Vec<(&Recording, &Seen)> =
        drawn.iter().filter_map(|run| Some((&run.recording, run.truth.as_ref()?))).collect();
    let misses = |estimator: &Estimator, every: usize| {
        let of_run = |(recording, truth): &(&Recording, &Seen)| {
            let mut recording = (*recording).clone();
            recording.rows = recording.rows.into_iter().step_by(every).collect();
            let mut vehicle = estimator.new_vehicle();
            let run = replay(estimator, &mut vehicle, &recording, Tick::EverySample);
            let (seen, was) = (Seen::of_replay(&run, estimator.train()).outcome, &truth.outcome);
            [(seen.coast_s, was.coast_s), (seen.brake_s, was.brake_s)].map(|(seen, was)| Some((seen? - was?).abs()))
        };
        let of_runs: Vec<_> = known.par_iter().map(of_run).collect();
        let mut moments = [Moments::default(); 2];
        for miss in of_runs {
            for (moments, miss_s) in moments.iter_mut().zip(miss) {
                miss_s.into_iter().for_each(|s| moments.add(s));
            }
        }
        moments
    };
    let of = |every| Misses { paper: misses(&estimators.paper, every), gated: misses(&estimators.gated, every) };
    (!known.is_empty()).then(|| [1, KEPT].map(of))
}

pub fn pace(estimators: &Estimators, runs: &[Recording]) -> Option<[Pace; 2]> {
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
