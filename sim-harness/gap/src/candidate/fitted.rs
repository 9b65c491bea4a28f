//! A term with its coefficients, and the intervals of both.

use super::Term;
use crate::named::{Interval95, around};
use rundown_check::figure::Figure;

/// 95 % limits of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionLimits {
    pub edges_m: [(f64, f64); 2],
    /// Of its coefficient, as shares of it: the section may be another, and go by another name.
    pub share: (f64, f64),
}

/// 95 % limits of a shape that is a number, and of the coefficient that goes with it: where the shape moves, the
/// coefficient follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeLimits {
    pub shape: (f64, f64),
    pub beta: (f64, f64),
    /// Of its second number.
    pub second: Option<(f64, f64)>,
}

/// A term with its coefficients.
#[derive(Clone, Debug)]
pub struct Fitted {
    pub term: Term,
    pub beta: Vec<f64>,
    /// Their standard deviations: the larger of noise model and spread between runs, and what sensors may do in all
    /// runs alike.
    pub sd: Vec<f64>,
    /// Log-likelihood that would be lost without it.
    pub gain: f64,
    /// How many times less than the noise says a difference of log-likelihood counts for it, at least 1: the noise does
    /// not fit, or runs differ.
    pub dispersion: f64,
    pub section: Option<SectionLimits>,
    /// Of a section: which share of it acts as soon as the front is inside, and not over the length of the train.
    pub at_once: Option<Figure>,
    /// Limits of a shape that is a number.
    pub shape: Option<ShapeLimits>,
    /// Others that would do nearly as well in its place, with how much worse they are.
    pub rivals: Vec<(Term, f64)>,
    /// Without an effort column: drivers who brake lightly on descents would show it as well.
    pub may_be_brakes: bool,
    /// A section of the line explains what it does, and is refused because drivers may have made what shows it.
    pub may_be_refused: bool,
}

impl Fitted {
    /// A term whose coefficients are known.
    #[cfg(test)]
    pub(crate) fn certain(term: Term, beta: Vec<f64>) -> Self {
        let sd = vec![0.0; beta.len()];
        Self {
            term,
            beta,
            sd,
            gain: 0.0,
            dispersion: 1.0,
            section: None,
            at_once: None,
            shape: None,
            rivals: Vec::new(),
            may_be_brakes: false,
            may_be_refused: false,
        }
    }

    /// The value of the first coefficient in a unit, and its 95 % interval; that of a coefficient whose section may be
    /// another is a share of it.
    pub fn first(&self, parameter: &'static str, scale: f64) -> (f64, Interval95) {
        let value = self.beta[0] * scale;
        let interval = match &self.section {
            Some(SectionLimits { share: (a, b), .. }) => {
                (parameter, (value * a).min(value * b), (value * a).max(value * b))
            }
            None => around(parameter, value, self.sd[0] * scale),
        };
        (value, interval)
    }

    /// The first coefficient, the number that is its shape in another unit, and the intervals of both.
    pub fn with_number(&self, parameter: &'static str, number: &'static str, unit: f64) -> (f64, f64, Vec<Interval95>) {
        let intervals = self.shape.map_or_else(Vec::new, |ShapeLimits { shape, beta, .. }| {
            vec![(parameter, beta.0, beta.1), (number, unit * shape.0, unit * shape.1)]
        });
        (self.beta[0], unit * self.term.shape.number(), intervals)
    }

    pub fn edges(&self) -> Vec<Interval95> {
        self.section.as_ref().map_or_else(Vec::new, |SectionLimits { edges_m: [from, to], .. }| {
            vec![("from_m", from.0, from.1), ("to_m", to.0, to.1)]
        })
    }
}
