//! One run of the study: what the estimator gets and, of a simulated run, what was true.

use crate::simulation::scenario_file::Simulation;
use rundown::{model::direction::Direction, model::units::KmPerHour};
use rundown_files::{recording::Recording, refusal::ReadError, sample::Sample};
use rundown_truth::facts::{Facts, Mark};
use rundown_truth::plan::{Heading, RunPlan, plan};
use rundown_truth::scenario::{DriveError, Run, Scenario, simulate_planned};
use rundown_truth::sensors::{self, TruthSample};
use rundown_truth::train::DavisTruth;
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use std::path::{Path, PathBuf};

const CASE_STUDY: &str = include_str!("../../../data/scenarios/paper_study.toml");
const SKEWED: &str = include_str!("../../../data/scenarios/paper_skewed.toml");
/// A further unit's resistance is this share above or below the first one's, at most.
const UNIT_SPREAD: f64 = 0.15;

#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    pub recording: Recording,
    /// What the recorder wrote, where a diagnosis put something of it right: the paper's loop gets this.
    pub as_recorded: Option<Recording>,
    pub truth: Option<CaseTruth>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct CaseTruth {
    /// A row for each row of the recording.
    pub samples: Vec<TruthSample>,
    pub facts: RunTruth,
}

/// The truth of a run as a whole, as far as the study shows it: in `truth.json` of a data set on disk it has the same
/// names.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct RunTruth {
    /// Running resistance of this run as still air would have it: load and wind included.
    #[serde(rename = "davis_with_wind")]
    pub davis: DavisTruth,
    #[serde(rename = "train", deserialize_with = "rotating_mass_kg")]
    pub rotating_mass_kg: f64,
    /// The speed the driver wanted to keep, m/s.
    pub cruise_mps: f64,
    /// Start of the final coast; `None` if the driver braked from power.
    pub final_coast: Option<Mark>,
    pub final_brake: Mark,
    /// Standstill at the last stop.
    #[serde(rename = "stops", deserialize_with = "last")]
    pub stop: Mark,
    /// Mean power while accelerating, 50 to 130 km/h, W/kg.
    pub mean_power_50_130_w_per_kg: Option<f64>,
    /// Largest there, 50 to 90 km/h, W/kg.
    pub max_power_50_90_w_per_kg: Option<f64>,
}

fn rotating_mass_kg<'de, D: Deserializer<'de>>(train: D) -> Result<f64, D::Error> {
    #[derive(Deserialize)]
    struct Train {
        mass_kg: f64,
        rotating_mass_factor: f64,
    }
    let train = Train::deserialize(train)?;
    Ok(train.mass_kg * train.rotating_mass_factor)
}

fn last<'de, D: Deserializer<'de>>(stops: D) -> Result<Mark, D::Error> {
    let stops = Vec::<Mark>::deserialize(stops)?;
    stops.last().copied().ok_or_else(|| D::Error::custom("expected at least one stop, found none"))
}

impl From<&Facts> for RunTruth {
    fn from(facts: &Facts) -> Self {
        Self {
            davis: facts.davis,
            rotating_mass_kg: facts.train.rotating_mass_kg(),
            cruise_mps: facts.cruise_mps,
            final_coast: facts.final_coast,
            final_brake: facts.final_brake,
            stop: facts.stop,
            mean_power_50_130_w_per_kg: facts.mean_power_50_130_w_per_kg,
            max_power_50_90_w_per_kg: facts.max_power_50_90_w_per_kg,
        }
    }
}

impl Case {
    /// What the recorder wrote.
    pub fn read(&self) -> &Recording {
        self.as_recorded.as_ref().unwrap_or(&self.recording)
    }

    pub fn simulated(name: String, unit: String, run: Run) -> Self {
        let row = |(index, sample): (usize, &sensors::Sample)| Sample {
            // The line it would have in a log, behind the header.
            line: index as u64 + 2,
            time_s: sample.time_s,
            location_m: sample.location_m,
            speed_mps: sample.speed_kmh.map(|kmh| KmPerHour(kmh).to_mps()),
            effort_n_per_kg: Some(sample.effort_n_per_kg),
            temperature_c: Some(sample.temperature_c),
            ..Sample::default()
        };
        Self {
            recording: Recording {
                path: PathBuf::from(format!("{name}.csv")),
                name,
                unit,
                direction: match run.facts.plan.heading {
                    Heading::Up => Direction::Up,
                    Heading::Down => Direction::Down,
                },
                driver: run.facts.plan.driver.map_or_else(String::new, |turn| turn.name()),
                day: Some(run.facts.plan.departure_s as f64 / 86_400.0),
                rows: run.samples.iter().enumerate().map(row).collect(),
                ..Recording::default()
            },
            as_recorded: None,
            truth: Some(CaseTruth { facts: RunTruth::from(&run.facts), samples: run.truth }),
        }
    }
}

/// The paper's 67 runs, simulated: one unit with 8 % less resistance than its manufacturer says, wind of 2 m/s and load
/// of 3 % standard deviation from run to run, and a feeding section at the departure that gives less power than the
/// motors can take.
pub fn case_study() -> Result<Simulation, ReadError> {
    Simulation::parse(Path::new("paper_study.toml"), CASE_STUDY)
}

/// The same runs by the recorder that explains most of section 4.2: truncated speeds, a row older than the locations.
pub fn skewed_case_study() -> Result<Simulation, ReadError> {
    Simulation::parse(Path::new("paper_skewed.toml"), SKEWED)
}

/// The same line, train and driver in still air and with the described load, and no effect: for the Cramér-Rao bound.
pub fn calm() -> Result<Simulation, ReadError> {
    Simulation::parse(Path::new("calm.toml"), "name = \"calm\"\n")
}

/// A unit of a simulated fleet: as many runs as the simulation has, the first unit as it says, each other with a
/// resistance of its own.
#[derive(Clone, Debug)]
pub struct FleetUnit {
    unit: usize,
    scenario: Scenario,
    plans: Vec<RunPlan>,
}

impl FleetUnit {
    pub fn runs(simulation: &Simulation) -> usize {
        simulation.runs.max(1)
    }

    pub fn new(simulation: &Simulation, seed: u64, unit: usize) -> Self {
        Self::of(&simulation.scenario, Self::runs(simulation), seed, unit)
    }

    /// A unit with so many runs.
    pub fn of(scenario: &Scenario, runs: usize, seed: u64, unit: usize) -> Self {
        // Low-discrepancy: every share of a fleet has units from all over the range.
        let place = (0.5 + unit as f64 * 0.618_033_988_749_894_9).fract();
        let factor = 1.0 + UNIT_SPREAD * (2.0 * place - 1.0);
        let scenario = Scenario { davis_scale: scenario.davis_scale.map(|scale| scale * factor), ..scenario.clone() };
        let seed = seed.wrapping_add(1_000_003 * unit as u64);
        Self { unit, plans: plan(&scenario, runs, seed), scenario }
    }

    /// Drives a run, counted from 0.
    ///
    /// # Panics
    /// If the unit has fewer runs.
    pub fn drive(&self, run: usize) -> Result<Case, DriveError> {
        let unit = self.unit + 1;
        Ok(Case::simulated(
            format!("unit{unit:03}_run{:02}", run + 1),
            format!("unit{unit:03}"),
            simulate_planned(&self.scenario, &self.plans[run])?,
        ))
    }
}

/// Run `index` of a fleet, unit after unit.
#[cfg(any(feature = "link", test))]
pub fn fleet_run(simulation: &Simulation, seed: u64, index: usize) -> Result<Case, DriveError> {
    let runs = FleetUnit::runs(simulation);
    FleetUnit::new(simulation, seed, index / runs).drive(index % runs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_skewed_case_study_differs_by_its_recorder_alone() {
        let (plain, skewed) = (case_study().unwrap(), skewed_case_study().unwrap());
        assert_eq!(skewed.scenario.sensors.speed_lag_s, [10.0; 2]);
        assert!(skewed.scenario.final_dwell, "late speeds come to zero");
        let Scenario { sensors, final_dwell, .. } = plain.scenario.clone();
        assert_eq!(Scenario { sensors, final_dwell, ..skewed.scenario }, plain.scenario);
        assert_eq!((skewed.train, skewed.track, skewed.runs), (plain.train, plain.track, plain.runs));
    }

    #[test]
    fn the_first_unit_is_the_scenario_and_the_next_differs() {
        let text = "runs = 2\n[train]\ntrue_davis_over_described = [0.9, 0.9, 0.9]\n";
        let simulation = Simulation::parse("s.toml".as_ref(), text).unwrap();
        let r0 = |index| {
            let truth = fleet_run(&simulation, 3, index).unwrap().truth.unwrap();
            truth.facts.davis.r0 / simulation.scenario.train.davis.r0
        };
        assert!((r0(0) - 0.9).abs() < 1e-12);
        assert_eq!(r0(1), r0(0));
        let other = r0(2);
        assert!((other - 0.9).abs() > 0.01 && (other / 0.9 - 1.0).abs() <= UNIT_SPREAD);
    }

    #[test]
    fn rows_and_truth_are_the_same_times() {
        let case = fleet_run(&case_study().unwrap(), 1, 5).unwrap();
        let truth = case.truth.unwrap();
        assert_eq!(case.recording.rows.len(), truth.samples.len());
        for (row, sample) in case.recording.rows.iter().zip(&truth.samples) {
            assert_eq!(row.time_s, sample.time_s);
        }
        assert_eq!(case.recording.name, "unit001_run06");
    }
}
