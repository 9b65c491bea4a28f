//! The paper's remark on sensitivity (section 4.2): larger initial covariances of the coefficients give negative ones.
//!
//! Table 1 prints standard deviations; the remark speaks of "two orders of magnitude in one of the initial covariances". Read as a covariance
//! that is a deviation ten times as large, read as the printed deviation a hundred times: both are tried.

use rayon::prelude::*;
use rundown::estimator::Estimator;
use rundown::estimator::config::{Config, Mode};
use rundown::model::state;
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown::tick::bounds::ConfigError;
use rundown_files::recording::Recording;
use rundown_files::replay::{Tick, replay};
use serde::Serialize;

/// Factors on the initial standard deviations of Table 1.
pub const FACTORS: [f64; 3] = [1.0, 10.0, 100.0];
/// Which of them are changed.
const WHICH: [(&str, [bool; 3]); 4] = [
    ("r0", [true, false, false]),
    ("r1", [false, true, false]),
    ("r2", [false, false, true]),
    ("r0, r1, r2", [true; 3]),
];

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

/// Tries every change.
pub fn sensitivity(
    config: &Config,
    train: Train,
    track: &Track,
    runs: &[Recording],
) -> Result<Vec<Sensitivity>, ConfigError> {
    let mut found = Vec::new();
    for factor in FACTORS {
        for (which, changed) in WHICH {
            // As printed: one row is enough.
            if factor == 1.0 && which != "r0, r1, r2" {
                continue;
            }
            let mut config = Config { mode: Mode::Paper, ..*config };
            for (sd, changed) in config.paper.initial_davis_sd.iter_mut().zip(changed) {
                *sd *= if changed { factor } else { 1.0 };
            }
            let estimator = Estimator::try_new(config, train, track.clone())?;
            let least: Vec<[f64; 3]> = runs.par_iter().map(|run| least(&estimator, run)).collect();
            let is_negative = |least: &&[f64; 3]| least.iter().any(|share| *share < 0.0);
            let smallest =
                |all: [f64; 3], of_run: &[f64; 3]| std::array::from_fn(|index| f64::min(all[index], of_run[index]));
            found.push(Sensitivity {
                which,
                factor,
                negative_runs: least.iter().filter(is_negative).count(),
                runs: runs.len(),
                least_share: least.iter().fold([f64::INFINITY; 3], smallest),
            });
        }
    }
    Ok(found)
}

pub(super) fn negative_runs(estimator: &Estimator, runs: &[Recording]) -> usize {
    let is_negative = |run: &&Recording| least(estimator, run).iter().any(|share| *share < 0.0);
    runs.par_iter().filter(is_negative).count()
}

/// Least coefficients of a run, as shares of the manufacturer's.
fn least(estimator: &Estimator, run: &Recording) -> [f64; 3] {
    let replayed = replay(estimator, &mut estimator.new_vehicle(), run, Tick::EverySample);
    let stated = estimator.train().davis();
    let stated = [stated.r0, stated.r1, stated.r2];
    let mut least = [f64::INFINITY; 3];
    for estimate in &replayed.estimates {
        for (index, least) in least.iter_mut().enumerate() {
            let share = estimate.belief.mean[state::R0 + index] / stated[index];
            *least = least.min(share);
        }
    }
    least
}
