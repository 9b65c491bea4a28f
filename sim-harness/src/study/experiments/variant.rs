//! One point of an experiment: what is simulated, how it is described, how it is estimated.

use crate::accuracy_bench::fleets::Fleet;
use crate::simulation::scenario_file::Simulation;
use crate::study::Refused;
use crate::study::description::{self, Believed};
use rundown::estimator::config::Config;
use rundown::model::track::{Gradient, Track};
use rundown::model::train::Train;
use rundown_truth::scenario::Scenario;
use std::path::Path;

#[derive(Clone, Debug)]
pub struct Variant {
    pub name: String,
    /// Where it stands on the axis of the picture.
    pub x: f64,
    pub scenario: Scenario,
    pub train: Train,
    pub track: Track,
    /// Its mode is that of each arm.
    pub config: Config,
}

impl Variant {
    /// The case study in still air with the described load, changed by these fields of a scenario file.
    pub fn parse(name: impl Into<String>, x: f64, fields: &str) -> Result<Self, Refused> {
        let simulation = Simulation::parse(Path::new("experiment.toml"), fields)?;
        let Believed { train, track } = description::of(&simulation)?;
        let (name, config) = (name.into(), Config::default());
        Ok(Self { name, x, scenario: simulation.scenario, train, track, config })
    }

    /// A fleet of the accuracy bench: another train on its own line.
    pub fn of_fleet(x: f64, fleet: &Fleet) -> Result<Self, Refused> {
        let line = &fleet.scenario.line;
        let gradients = line.gradients_permille().iter().map(|&(from_m, permille)| Gradient { from_m, permille });
        Ok(Self {
            name: fleet.name.to_owned(),
            x,
            train: fleet.train().ok_or("the train's description is refused")?,
            track: Track::try_new(line.length_m(), gradients)?,
            scenario: fleet.scenario.clone(),
            config: Config::default(),
        })
    }

    pub fn estimated_by(mut self, change: impl FnOnce(&mut Config)) -> Self {
        change(&mut self.config);
        self
    }

    pub fn driven_by(mut self, change: impl FnOnce(&mut Scenario)) -> Self {
        change(&mut self.scenario);
        self
    }
}
