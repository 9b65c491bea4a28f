//! All that is known of a data set.

use crate::answer::rivals::Rival;
use crate::config::{GapConfig, HoldoutConfig};
use crate::data::believed::{Believed, Context};
use crate::holdout::innovations::Innovations;
use crate::holdout::journey::{Error, Journey, Summary};
use crate::input::Input;
use crate::investigation::Investigation;
use rundown_files::{effect_file::EffectEntry, track_file::TrackFile, train_file::TrainFile};

/// All that is known of a data set.
#[derive(Clone, Debug)]
pub struct Answer {
    /// What was read.
    pub input: Input,
    /// Thresholds and priors.
    pub config: GapConfig,
    /// What came of it.
    pub found: Investigation,
    /// Rivals of each effect.
    pub rivals: Vec<Vec<Rival>>,
    /// Of the on-board estimator on the hold-out runs, if it had any.
    pub innovations: Option<Innovations>,
}

const J_PER_KWH: f64 = 3.6e6;

impl Answer {
    /// Belief, conditions and settings of the findings.
    pub fn context(&self) -> Context<'_> {
        Context {
            believed: Believed::new(&self.input.train, &self.input.track),
            surroundings: &self.input.surroundings,
            conditions: self.found.findings.conditions,
            config: &self.config,
        }
    }

    pub(crate) fn holdout(&self) -> &HoldoutConfig {
        &self.config.holdout
    }

    /// Train and track with what was found, in place of effects that they had: the analysis knew nothing of these.
    pub fn model(&self) -> (TrainFile, TrackFile) {
        repaired(&self.found, &self.input)
    }

    /// Errors of the running time, s. `None`: no window could be covered.
    pub fn times(&self) -> Option<Summary> {
        let of = |j: &Journey| j.time_s;
        Summary::of(&self.found.journeys.iter().map(of).collect::<Vec<_>>(), self.holdout())
    }

    /// Errors of the energy at the wheel, kWh: energy for each kg of rotating mass becomes energy. `None`: see
    /// `NO_ENERGY`.
    pub fn energies(&self) -> Option<Summary> {
        let kwh = self.input.train.rotating_mass_kg() / J_PER_KWH;
        let of = |j: &Journey| {
            let error = j.energy_j_per_kg?;
            Some(Error {
                measured: kwh * error.measured,
                before: kwh * error.before,
                after: kwh * error.after,
                floor: kwh * kwh * error.floor,
            })
        };
        let errors: Vec<Error> = self.found.journeys.iter().filter_map(of).collect();
        Summary::of(&errors, self.holdout())
    }
}

/// Train and track with what was found.
pub fn repaired(found: &Investigation, input: &Input) -> (TrainFile, TrackFile) {
    let (mut train, mut track) = (input.train_file.clone(), input.track_file.clone());
    train.effect.clear();
    track.effect.clear();
    for one in &found.named {
        let entry = EffectEntry { effect: one.effect.clone(), runs: (!one.runs.is_empty()).then(|| one.runs.clone()) };
        match one.effect.section_m() {
            Some(_) => track.effect.push(entry),
            None => train.effect.push(entry),
        }
    }
    (train, track)
}
