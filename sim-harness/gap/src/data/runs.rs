//! Recorded runs as the gap workflow sees them, and what is known of their recorder.

use rundown::model::direction::Direction;
use rundown_check::{Correction, figure::Figure};
use rundown_files::sample::Sample;
use rundown_files::statistics::median;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// Name in every output.
    pub name: String,
    pub direction: Direction,
    /// Day of the departure, since 1970-01-01 UTC, if the index knows it.
    pub day: Option<f64>,
    /// Samples, times increasing.
    pub samples: Vec<Sample>,
    /// What is known of the recorder.
    pub recorded: Recorded,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EffortReading {
    /// At the moment of its sample.
    #[default]
    Momentary,
    /// Mean since the sample before.
    MeanSinceLast,
}

/// What the diagnosis of the logs says of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Whose recorder it was.
    pub unit: String,
    /// Who drove; empty where no index says so.
    pub driver: String,
    /// What was put right in the speeds of the samples.
    pub correction: Correction,
    /// Measured over true speed of the recorder, where a scale was put right.
    pub scale: Option<Figure>,
    /// The same of this run alone, whether it matters or not.
    pub own_scale: Option<Figure>,
    /// The step of the speed readings, m/s; 0 if there is none.
    pub speed_step_mps: f64,
    /// The step of the efforts, N/kg; 0 if there is none.
    pub effort_step_n_per_kg: f64,
    /// Age of the location less that of the speed, s: of the recorder.
    pub usual_lag_s: Option<Figure>,
    /// The same of this run, as far as it is known; the locations of the samples are as they were read.
    pub location_lag_s: f64,
    /// The effort column is not that of the brake: it has none while the train brakes, and is measured nevertheless.
    pub brakes_aside: bool,
}

/// Median time between samples, s; that of a slow log where there is no second sample.
pub fn usual_step_s(run: &Run) -> f64 {
    median(run.samples.windows(2).map(|pair| pair[1].time_s - pair[0].time_s)).unwrap_or(10.0)
}

/// Runs with their efforts put right, which read by `gain` too much.
pub fn without_gain(runs: &[Run], gain: f64) -> Vec<Run> {
    let mut runs = runs.to_vec();
    for sample in runs.iter_mut().flat_map(|run| &mut run.samples) {
        sample.effort_n_per_kg = sample.effort_n_per_kg.map(|effort| effort / (1.0 + gain));
    }
    runs
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Run `r{index}` of this unit, without samples.
    pub fn of_unit(index: usize, unit: &str) -> Run {
        Run {
            name: format!("r{index}"),
            direction: Direction::Up,
            day: Some(20_000.0 + index as f64),
            samples: Vec::new(),
            recorded: Recorded { unit: unit.to_owned(), ..Recorded::default() },
        }
    }
}
