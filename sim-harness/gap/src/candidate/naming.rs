//! What candidates are named from.

use crate::columns::both_directions;
use crate::data::{believed::Context, rows::Row};
use crate::readings::kinematics::Kinematics;
use crate::traction::limit::FoundLimit;

/// What was found, for naming it.
#[derive(Clone, Copy)]
pub struct Naming<'a> {
    pub context: &'a Context<'a>,
    pub runs: &'a [String],
    pub rows: &'a [Row],
    pub measured: bool,
    pub kinematics: &'a Kinematics,
    /// Spread of the wind between runs with its standard deviation, m/s, where runs surely differ by it.
    pub run_wind: Option<(f64, f64)>,
    pub wind_gain: f64,
    /// Limits of the traction, the best first.
    pub limits: &'a [FoundLimit],
}

impl Naming<'_> {
    /// What the data have already.
    pub fn have(&self) -> Have {
        Have { effort: self.measured, both_directions: both_directions(self.rows) }
    }
}

#[cfg(test)]
impl<'a> Naming<'a> {
    /// Of data with an effort column in which nothing else was found.
    pub(crate) fn plain(context: &'a Context<'a>, kinematics: &'a Kinematics) -> Self {
        Self { context, runs: &[], rows: &[], measured: true, kinematics, run_wind: None, wind_gain: 0.0, limits: &[] }
    }
}

/// What the data at hand have already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Have {
    pub effort: bool,
    pub both_directions: bool,
}
