//! A candidate with its shape chosen: the columns of a linear fit.

use super::{Candidate, Nature};
use crate::columns::coordinate;
use crate::data::{believed::Context, interval::Interval, rows::Row};
use rundown::model::effects::{Coordinate, EffectKind};
use std::fmt;

/// What is chosen of a term beside its coefficients.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Nothing.
    Law,
    /// Which of 1, v, v².
    Powers([bool; 3]),
    /// A section of the line, m.
    Section([f64; 2]),
    /// A time constant, a speed, a length.
    Number(f64),
    /// Such a number, and a second one.
    Numbers(f64, f64),
    /// The runs in which it acts.
    Runs(Vec<usize>),
    /// A number, and the runs in which it acts.
    NumberInRuns(f64, Vec<usize>),
    /// Constant below a value of a coordinate, or above another; a straight line between the two.
    Step(Coordinate, [f64; 2], Side),
    /// Piecewise linear along a coordinate, with these knots.
    Table(Coordinate, Vec<f64>),
}

/// On which side of its value a step acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Below,
    Above,
}

/// What a shape is made of, for the candidate that made it: of another form it has nothing.
impl Shape {
    pub fn number(&self) -> f64 {
        match self {
            Self::Number(number) | Self::Numbers(number, _) | Self::NumberInRuns(number, _) => *number,
            _ => f64::NAN,
        }
    }

    pub fn second_number(&self) -> f64 {
        if let Self::Numbers(_, number) = self { *number } else { f64::NAN }
    }

    /// The same with another number.
    pub fn with_number(&self, number: f64) -> Self {
        match self {
            Self::Numbers(_, second) => Self::Numbers(number, *second),
            Self::NumberInRuns(_, runs) => Self::NumberInRuns(number, runs.clone()),
            Self::Law
            | Self::Powers(_)
            | Self::Section(_)
            | Self::Number(_)
            | Self::Runs(_)
            | Self::Step(..)
            | Self::Table(..) => Self::Number(number),
        }
    }

    pub fn section(&self) -> [f64; 2] {
        if let Self::Section(section) = self { *section } else { [f64::NAN; 2] }
    }

    pub fn powers(&self) -> [bool; 3] {
        if let Self::Powers(wrong) = self { *wrong } else { [false; 3] }
    }

    pub fn runs(&self) -> &[usize] {
        if let Self::Runs(runs) | Self::NumberInRuns(_, runs) = self { runs } else { &[] }
    }

    /// How many coefficients it has.
    pub fn coefficients(&self, nature: Nature) -> usize {
        match self {
            Self::Powers(wrong) => wrong.iter().filter(|w| **w).count(),
            Self::Table(_, knots) => knots.len(),
            Self::Law
            | Self::Section(_)
            | Self::Number(_)
            | Self::Numbers(..)
            | Self::Runs(_)
            | Self::NumberInRuns(..)
            | Self::Step(..) => 1 + usize::from(nature.constant_beside),
        }
    }
}

/// A candidate of the resistance with its shape.
#[derive(Clone)]
pub struct Term {
    pub of: &'static dyn Candidate,
    pub shape: Shape,
}

impl fmt::Debug for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.of.name(), self.shape)
    }
}

impl PartialEq for Term {
    fn eq(&self, other: &Self) -> bool {
        self.of.name() == other.of.name() && self.shape == other.shape
    }
}

impl Term {
    /// The same candidate, with a shape of the same form.
    pub fn is_like(&self, other: &Self) -> bool {
        let form = |term: &Self| core::mem::discriminant(&term.shape);
        self.of.name() == other.of.name() && form(self) == form(other)
    }

    pub fn with(&self, shape: Shape) -> Self {
        Self { of: self.of, shape }
    }

    pub fn is(&self, kind: EffectKind) -> bool {
        self.of.facts().kind == Some(kind)
    }

    pub fn columns(&self, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        self.of.columns(&self.shape, context, rows)
    }

    pub fn count(&self) -> usize {
        self.shape.coefficients(self.of.facts().nature)
    }

    /// Its column is what it is: the coefficient is 1 and not fitted.
    pub fn is_whole(&self) -> bool {
        self.of.facts().nature.whole
    }

    pub fn section(&self) -> Option<[f64; 2]> {
        match self.shape {
            Shape::Section(section) => Some(section),
            _ => None,
        }
    }

    pub fn by_place(&self) -> bool {
        self.section().is_some() || self.of.facts().nature.by_place
    }

    /// The same all through a run, another in each.
    pub fn between_runs(&self) -> bool {
        match &self.shape {
            Shape::Runs(_) | Shape::Step(..) | Shape::Table(Coordinate::Day | Coordinate::Temperature, _) => true,
            Shape::Law
            | Shape::Powers(_)
            | Shape::Section(_)
            | Shape::Number(_)
            | Shape::Numbers(..)
            | Shape::NumberInRuns(..)
            | Shape::Table(..) => self.of.facts().nature.between_runs,
        }
    }

    pub fn is_unnamed(&self) -> bool {
        self.is(EffectKind::Unknown)
    }

    /// What it adds to the resistance in each row with these coefficients, N/kg.
    pub fn extra(&self, beta: &[f64], context: &Context<'_>, rows: &[Row]) -> Vec<f64> {
        let columns = self.columns(context, rows);
        let of_row = |i: usize| columns.iter().zip(beta).map(|(c, b)| c[i] * b).sum();
        (0..rows.len()).map(of_row).collect()
    }

    /// A table reaches this interval. Laws reach everywhere.
    pub fn covers(&self, interval: &Interval) -> bool {
        let Shape::Table(which, knots) = &self.shape else {
            return true;
        };
        // Few rows lie beyond the last knots but one.
        let inner = knots.get(1).zip(knots.get(knots.len().saturating_sub(2)));
        let at = coordinate(*which, interval, interval.middle());
        at.zip(inner).is_some_and(|(at, (first, last))| (*first..=*last).contains(&at))
    }

    /// Penalty of its freedom, of log-likelihood.
    pub fn penalty(&self, context: &Context<'_>, rows: &[Row]) -> f64 {
        self.of.penalty(&self.shape, &context.penalty(), rows)
    }

    /// What an unnamed section must be better by only because it has no name: it fits as well as one with a name that
    /// is better by no more.
    pub fn unnamed_penalty(&self, context: &Context<'_>) -> f64 {
        let is_section = self.is_unnamed() && self.section().is_some();
        if is_section { context.config.penalty.unnamed } else { 0.0 }
    }
}
