//! What is simulated: train, line, driver, wind, load, dates, sensors, effects.

use crate::effects::Effect;
use crate::habits::DriverKind;
use crate::line::Line;
use crate::sensors::Sensors;
use crate::timetable::{Dates, Headings};
use crate::train::TrainTruth;
use crate::weather::Climate;
use serde::Deserialize;

/// A red signal in mid-run.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UnscheduledStop {
    /// Where along the distance travelled, m.
    pub at_m: f64,
    /// How long, s.
    pub dwell_s: f64,
    /// Share of the runs that meet it; all unless said.
    #[serde(default = "all")]
    pub share: f64,
}

fn all() -> f64 {
    1.0
}

/// What is simulated. The default is the case study.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The train before load and Davis scale.
    pub train: TrainTruth,
    /// The line.
    pub line: Line,
    /// What kind of service.
    pub driver: DriverKind,
    /// Drivers who take turns, each with a style of their own; 0: every run has another one.
    pub drivers: usize,
    /// Notches of the driver's lever, each with its share of effort and power (a diesel); 0: without steps.
    pub notches: u8,
    /// The column of the effort has of the brake what the motors hold, and nothing of the blocks.
    pub electric_brake_only: bool,
    /// Probability that a driver cruises by cycles of power and coast.
    pub cycle_share: f64,
    /// What half of the coasts, drawn, keep on of the brake, N/kg: a driver who slows a little more than the train does
    /// by itself.
    pub coast_brake_n_per_kg: f64,
    /// Probability that a driver tries the brake after the departure.
    pub brake_test_share: f64,
    /// Whether the run goes on for 30 to 60 s at the last platform. Without, it ends up to one sampling time after the
    /// stop.
    pub final_dwell: bool,
    /// A red signal.
    pub unscheduled_stop: Option<UnscheduledStop>,
    /// True over described r0, r1, r2.
    pub davis_scale: [f64; 3],
    /// Wind along the line, one draw a run, standard deviation, m/s.
    pub wind_sd_mps: f64,
    /// Load, one draw a run, standard deviation as a share of the mass.
    pub load_sd: f64,
    /// Directions of the runs.
    pub headings: Headings,
    /// When the runs are.
    pub dates: Dates,
    /// Temperatures.
    pub climate: Climate,
    /// What the description does not have.
    pub effects: Vec<Effect>,
    /// Integration step, s; divides 1 s and the sampling time.
    pub step_s: f64,
    /// The recorder.
    pub sensors: Sensors,
}

impl Default for Scenario {
    /// The case study: flat corridor, still air, described load, every 10 s, rounded speed, location noise 4 m.
    fn default() -> Self {
        Self {
            train: TrainTruth::default(),
            line: Line::flat_corridor(),
            driver: DriverKind::CaseStudy,
            drivers: 0,
            notches: 0,
            electric_brake_only: false,
            cycle_share: 0.4,
            coast_brake_n_per_kg: 0.0,
            brake_test_share: 0.0,
            final_dwell: false,
            unscheduled_stop: None,
            davis_scale: [1.0; 3],
            wind_sd_mps: 0.0,
            load_sd: 0.0,
            headings: Headings::Up,
            dates: Dates::default(),
            climate: Climate::default(),
            effects: Vec::new(),
            step_s: 0.05,
            sensors: Sensors::default(),
        }
    }
}
