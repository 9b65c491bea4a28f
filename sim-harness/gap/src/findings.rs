//! What an analysis found.

use crate::candidate::{Fitted, Naming};
use crate::config::{BetweenRunsConfig, SearchConfig};
use crate::data::believed::{Conditions, Context};
use crate::data::{rows::Row, runs::EffortReading};
use crate::levels::{NotCompared, Standout};
use crate::noise::calibrate::Calibrated;
use crate::readings::kinematics::Kinematics;
use crate::search::headwind::Headwind;
use crate::traction::{limit::FoundLimit, powering::SteadyPower};
use rundown_check::figure::Figure;
use rundown_check::figure::HALF_95;

/// By what runs differ from each other, beside the terms.
#[derive(Clone, Debug, Default)]
pub struct BetweenRuns {
    /// Spread of a wind of its own in each run, m/s, beside the units and drivers that differ.
    pub wind_mps: f64,
    /// Its gain of log-likelihood over other differences between runs.
    pub wind_gain: f64,
    /// Units, drivers and days that differ from the others.
    pub standouts: Vec<Standout>,
    /// Which of these could not be compared with each other.
    pub not_compared: Vec<NotCompared>,
}

#[derive(Clone, Debug)]
pub struct Findings {
    pub kinematics: Kinematics,
    /// How the effort column is read.
    pub effort: EffortReading,
    pub measured: bool,
    /// Gain of the effort column less 1, put right in rows and powering phases; none without the column.
    pub gain: Option<Figure>,
    /// These data cannot tell that gain from another mass.
    pub gain_may_be_mass: bool,
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
    /// By what runs differ from each other.
    pub differing: BetweenRuns,
    /// Where the logs have a headwind column.
    pub headwind: Option<Headwind>,
    pub conditions: Conditions,
}

impl Findings {
    /// Spread of the wind between runs and its standard deviation, m/s, if runs surely differ by more than the wind
    /// that there always is.
    fn run_wind(&self, config: &BetweenRunsConfig) -> Option<(f64, f64)> {
        let mut runs: Vec<usize> = self.rows.iter().map(|row| row.interval.run).collect();
        runs.dedup();
        let BetweenRuns { wind_mps: spread, wind_gain, .. } = self.differing;
        let sd = config.wind_sd * spread / (2.0 * runs.len().max(2) as f64).sqrt();
        let sure = wind_gain > config.wind_gain && spread - HALF_95 * sd > config.least_wind_mps;
        sure.then_some((spread, sd))
    }

    /// What the described gradients are off by at most places, standard deviation, permille.
    pub fn gradient_errors_permille(&self) -> Option<f64> {
        Some(self.calibrated.gradients.sd_permille).filter(|permille| *permille > 0.0)
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
            wind_gain: self.differing.wind_gain,
            limits: &self.limits,
        }
    }
}
