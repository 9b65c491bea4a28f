//! What an analysis found.

use crate::candidate::{Fitted, Naming};
use crate::config::{BetweenRunsConfig, SearchConfig};
use crate::data::believed::{Conditions, Context};
use crate::data::{rows::Row, runs::EffortReading};
use crate::noise::calibrate::Calibrated;
use crate::readings::kinematics::Kinematics;
use crate::search::headwind::Headwind;
use crate::traction::{limit::FoundLimit, powering::SteadyPower};
use rundown_check::agreement::Figure;
use rundown_check::agreement::HALF_95;

#[derive(Clone, Debug)]
pub struct Findings {
    pub kinematics: Kinematics,
    /// How the effort column is read.
    pub effort: EffortReading,
    pub measured: bool,
    /// Gain of the effort column less 1, put right in rows and powering phases; none without the column.
    pub gain: Option<Figure>,
    /// Intervals in which a train moved.
    pub moving: usize,
    /// Rows that counted.
    pub rows: Vec<Row>,
    pub calibrated: Calibrated,
    /// Missing terms of the resistance, with their coefficients.
    pub terms: Vec<Fitted>,
    /// Limits of the traction, the best first.
    pub limits: Vec<FoundLimit>,
    /// Intervals of steady power from which the limits were found, run by run.
    pub powering: Vec<Vec<SteadyPower>>,
    /// Gain of log-likelihood of a wind of its own in each run, over other differences between runs.
    pub wind_gain: f64,
    /// Where the logs have a headwind column.
    pub headwind: Option<Headwind>,
    pub conditions: Conditions,
}

impl Findings {
    /// Spread of the wind between runs and its standard deviation, m/s, if runs surely differ by more than the wind that there always is.
    fn run_wind(&self, config: &BetweenRunsConfig) -> Option<(f64, f64)> {
        let mut runs: Vec<usize> = self.rows.iter().map(|row| row.interval.run).collect();
        runs.dedup();
        let spread = self.calibrated.own.wind_mps;
        let sd = config.wind_sd * spread / (2.0 * runs.len().max(2) as f64).sqrt();
        let sure = self.wind_gain > config.wind_gain && spread - HALF_95 * sd > config.least_wind_mps;
        sure.then_some((spread, sd))
    }

    /// The limit of the traction that is not as believed, if one is worth a name.
    pub fn limit(&self, config: &SearchConfig) -> Option<&FoundLimit> {
        self.limits.first().filter(|found| found.value > config.enough)
    }

    /// What naming needs. `context`: that of the findings.
    pub fn naming<'a>(&'a self, context: &'a Context<'a>, runs: &'a [String]) -> Naming<'a> {
        Naming {
            context,
            runs,
            rows: &self.rows,
            measured: self.measured,
            kinematics: &self.kinematics,
            run_wind: self.run_wind(&context.config.between_runs),
            wind_gain: self.wind_gain,
            limits: &self.limits,
        }
    }
}
