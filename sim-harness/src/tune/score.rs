//! The two criteria of section 4.2 for one configuration.
//!
//! ```text
//! log p(z[k] | z[1..k-1]) = -1/2 (ν' S⁻¹ ν + ln det S) - ln 2π        ν, S: innovation and its covariance
//! ```
//!
//! summed over all samples of all runs; and the share of samples with a coefficient below zero, which must be none.

use super::parameters::{Place, config};
use rayon::prelude::*;
use rundown::tick::estimate::{Cause, Estimate};
use rundown::{
    estimator::Estimator, estimator::config::Config, filter::ukf::Reading, model::state, model::track::Track,
    model::train::Train,
};
use rundown_files::recording::Recording;
use rundown_files::replay::{Tick, replay};
use serde::Serialize;

/// Cost of a coefficient as far below zero as the manufacturer's is above, at every sample, in units of likelihood a
/// sample.
const NEGATIVE_COST: f64 = 1e4;
/// Cost of a share of samples at which the filter had to be repaired.
const REPAIRED_COST: f64 = 1e3;
/// Cost of a place that is no filter.
const NO_FILTER: f64 = 1e9;

#[derive(Clone, Debug)]
pub struct Bench {
    pub base: Config,
    pub train: Train,
    pub track: Track,
    pub runs: Vec<Recording>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FilterScore {
    pub log_likelihood: f64,
    /// Samples that have one.
    pub samples: u64,
    /// Samples with a coefficient below zero.
    pub negative_samples: u64,
    /// Mean over the samples of how far the coefficients are below zero, as a share of the manufacturer's.
    pub negative_depth: f64,
    /// Samples at which the covariance had to be repaired.
    pub repaired: u64,
}

impl FilterScore {
    pub fn per_sample(&self) -> f64 {
        self.log_likelihood / self.samples as f64
    }

    /// What the search makes small: both criteria in one number.
    pub fn cost(&self) -> f64 {
        let n = self.samples as f64;
        let cost = -self.per_sample() + NEGATIVE_COST * self.negative_depth + REPAIRED_COST * self.repaired as f64 / n;
        if cost.is_finite() { cost } else { NO_FILTER }
    }
}

impl Bench {
    /// The score at a place; none where it is no filter.
    pub fn score(&self, place: &Place) -> Option<FilterScore> {
        let mut all = FilterScore::default();
        // Added in order, so that the same runs give the same bits.
        for run in self.scores(place)? {
            all.log_likelihood += run.log_likelihood;
            all.samples += run.samples;
            all.negative_samples += run.negative_samples;
            all.negative_depth += run.negative_depth;
            all.repaired += run.repaired;
        }
        all.negative_depth /= all.samples as f64;
        Some(all)
    }

    /// The scores of the runs, each with its sum of depths instead of a mean.
    pub fn scores(&self, place: &Place) -> Option<Vec<FilterScore>> {
        let config = config(&self.base, place).ok()?;
        let estimator = Estimator::try_new(config, self.train, self.track.clone()).ok()?;
        Some(self.runs.par_iter().map(|run| of_run(&estimator, run)).collect())
    }

    pub fn cost(&self, place: &Place) -> f64 {
        self.score(place).map_or(NO_FILTER, |score| score.cost())
    }
}

fn of_run(estimator: &Estimator, run: &Recording) -> FilterScore {
    let mut vehicle = estimator.new_vehicle();
    let replayed = replay(estimator, &mut vehicle, run, Tick::EverySample);
    let stated = estimator.train().davis();
    let stated = [stated.r0, stated.r1, stated.r2];
    let mut score = FilterScore::default();
    for estimate in &replayed.estimates {
        if let Some(log) = log_likelihood(estimate) {
            score.log_likelihood += log;
            score.samples += 1;
        }
        let shares = (0..3).map(|i| estimate.belief.mean[state::R0 + i] / stated[i].max(1e-9));
        let below: f64 = shares.map(|share| (-share).max(0.0)).sum();
        score.negative_depth += below;
        score.negative_samples += u64::from(below > 0.0);
    }
    score.repaired = u64::from(replayed.summary.counters.of(Cause::Numerics));
    score
}

/// Of both readings of a sample; none when one is missing.
fn log_likelihood(estimate: &Estimate) -> Option<f64> {
    let innovation = estimate.innovation?;
    if innovation.readings.contains(&Reading::Missing) {
        return None;
    }
    let (nu, s) = (innovation.value, innovation.covariance);
    let inverse = s.try_inverse()?;
    let log = -0.5 * (nu.dot(&(inverse * nu)) + s.determinant().ln());
    let log = log - (2.0 * std::f64::consts::PI).ln();
    log.is_finite().then_some(log)
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::parameters::place;
    use super::*;
    use crate::study::case::{case_study, fleet_run};
    use crate::study::description;
    use rundown::tick::paper::{Difference, PaperConfig};

    pub(crate) fn bench(runs: usize) -> Bench {
        let description = description::of(&case_study().unwrap()).unwrap();
        Bench {
            base: Config::default(),
            train: description.train,
            track: description.track,
            runs: (0..runs).map(|index| fleet_run(&case_study().unwrap(), 4, index).unwrap().recording).collect(),
        }
    }

    #[test]
    fn the_likelihood_is_the_normal_one_of_each_innovation() {
        let bench = bench(1);
        let config = config(&bench.base, &place(&bench.base.paper)).unwrap();
        let estimator = Estimator::try_new(config, bench.train, bench.track.clone()).unwrap();
        let mut vehicle = estimator.new_vehicle();
        let run = replay(&estimator, &mut vehicle, &bench.runs[0], Tick::EverySample);
        let innovation = run.estimates[5].innovation.unwrap();
        let (nu, s) = (innovation.value, innovation.covariance);
        let (a, b, c) = (s[(0, 0)], s[(0, 1)], s[(1, 1)]);
        let det = a * c - b * b;
        let square = (c * nu[0] * nu[0] - 2.0 * b * nu[0] * nu[1] + a * nu[1] * nu[1]) / det;
        let density = (-0.5 * square).exp() / (2.0 * std::f64::consts::PI * det.sqrt());
        let found = log_likelihood(&run.estimates[5]).unwrap();
        assert!((found - density.ln()).abs() < 1e-9, "{found}");
    }

    #[test]
    fn negative_coefficients_cost_more_than_any_likelihood_gains() {
        let mut bench = bench(3);
        // With the forward effort no coefficient falls below zero here: docs/paper.md.
        bench.base.paper.difference = Difference::Backward;
        let of = |factor: f64| {
            let mut paper = PaperConfig::default();
            paper.initial_davis_sd = paper.initial_davis_sd.map(|sd| factor * sd);
            bench.score(&place(&paper)).unwrap()
        };
        let (printed, wild) = (of(1.0), of(100.0));
        assert_eq!(printed.negative_samples, 0);
        assert!(wild.negative_samples > 0);
        assert!(wild.cost() > printed.cost());
    }
}
