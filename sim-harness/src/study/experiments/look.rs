//! A set of runs of one vehicle, driven once, and what a mode says of it.

use super::variant::Variant;
use crate::report::resistance::Resistance;
use crate::study::Refused;
use crate::study::case::{Case, FleetUnit};
use crate::study::view::Seen;
use rundown::estimator::Estimator;
use rundown::estimator::config::{Config, Mode};
use rundown::filter::gaussian::Gaussian;
use rundown::model::train::Train;
use rundown::tick::estimate::Estimate;
use rundown::tick::regime::Regime;
use rundown_check::figure::HALF_95;
use rundown_files::replay::{ReplayedRun, Tick, replay};
use rundown_truth::sensors::TruthSample;

/// Below this speed the resistance is not judged, m/s: what is learned above is continued there.
const SLOWEST_MPS: f64 = 20.0 / 3.6;

/// The runs of a set, in order, and what was true of each.
#[derive(Clone, Debug)]
pub struct Driven {
    pub train: Train,
    pub cases: Vec<Case>,
    pub truth: Vec<Seen>,
}

/// What a mode says of a set; nothing of the truth goes into it.
#[derive(Clone, Debug)]
pub struct Look<'a> {
    pub driven: &'a Driven,
    pub runs: Vec<ReplayedRun>,
    pub seen: Vec<Seen>,
}

impl Driven {
    /// Drives set `set`, counted from 0.
    pub fn new(variant: &Variant, runs: usize, seed: u64, set: usize) -> Result<Self, Refused> {
        let unit = FleetUnit::of(&variant.scenario, runs, seed, set);
        let cases = (0..runs).map(|run| unit.drive(run)).collect::<Result<Vec<_>, _>>()?;
        let truths = cases.iter().flat_map(|case| &case.truth);
        let truth = truths.map(|truth| Seen::of_truth(truth, &variant.train)).collect();
        Ok(Self { train: variant.train, cases, truth })
    }

    /// Replays the set: the paper's mode begins each run with the description, the others carry the vehicle.
    pub fn look(&self, variant: &Variant, config: Config) -> Result<Look<'_>, Refused> {
        self.look_carrying(variant, config, config.mode != Mode::Paper)
    }

    /// Replays the set, each run begun with the description.
    pub fn look_apart(&self, variant: &Variant, config: Config) -> Result<Look<'_>, Refused> {
        self.look_carrying(variant, config, false)
    }

    fn look_carrying(&self, variant: &Variant, config: Config, is_carried: bool) -> Result<Look<'_>, Refused> {
        let estimator = Estimator::try_new(config, self.train, variant.track.clone())?;
        let mut vehicle = estimator.new_vehicle();
        let one = |case: &Case| {
            if !is_carried {
                vehicle = estimator.new_vehicle();
            }
            replay(&estimator, &mut vehicle, &case.recording, Tick::EverySample)
        };
        let runs: Vec<ReplayedRun> = self.cases.iter().map(one).collect();
        let seen = runs.iter().map(|run| Seen::of_replay(run, &self.train)).collect();
        Ok(Look { driven: self, runs, seen })
    }

    /// The true samples of a run.
    pub fn samples(&self, run: usize) -> &[TruthSample] {
        self.cases[run].truth.as_ref().map_or(&[], |truth| &truth.samples)
    }

    /// The runs that are judged: the second half, so that what is carried has been learned.
    pub fn judged(&self) -> std::ops::Range<usize> {
        self.cases.len() / 2..self.cases.len()
    }
}

/// Of the resistance at one sample, N/kg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Miss {
    pub truth: f64,
    pub error: f64,
    pub is_inside: bool,
}

/// What the train met at each sample, wind, load and effects included, against r(v) with these coefficients.
pub fn misses(known: &Gaussian<3>, samples: &[TruthSample]) -> Vec<Miss> {
    let fast = samples.iter().filter(|sample| sample.speed_mps >= SLOWEST_MPS);
    let miss = |sample: &TruthSample| {
        let r = Resistance::at(known, sample.speed_mps)?;
        let error = r.mean_n_per_kg - sample.resistance_n_per_kg;
        let is_inside = error.abs() <= HALF_95 * r.sd_n_per_kg;
        Some(Miss { truth: sample.resistance_n_per_kg, error, is_inside })
    };
    fast.filter_map(miss).collect()
}

impl Look<'_> {
    /// Of the judged runs, with r(v) as it is known at the end of each.
    pub fn misses(&self) -> Vec<Miss> {
        let of_run = |run: usize| misses(&self.runs[run].summary.run_davis, self.driven.samples(run));
        self.driven.judged().flat_map(of_run).collect()
    }

    /// Estimates of the judged runs, with their regimes, beside the truth of the same time.
    pub fn samples(&self) -> Vec<(&Estimate, Regime, &TruthSample)> {
        let mut beside = Vec::new();
        for run in self.driven.judged() {
            let mut truth = self.driven.samples(run).iter().peekable();
            for (estimate, regime) in self.runs[run].estimates.iter().zip(&self.runs[run].regimes) {
                while truth.next_if(|sample| sample.time_s < estimate.time_s).is_some() {}
                if let Some(sample) = truth.peek().filter(|sample| sample.time_s == estimate.time_s) {
                    beside.push((estimate, *regime, *sample));
                }
            }
        }
        beside
    }
}
