//! Whether an effect can be simulated at all.

use super::Affected;
use rundown_wire::EffectKind;
use thiserror::Error;

/// Why an effect was refused.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum EffectError {
    /// A parameter is out of range.
    #[error("{effect}.{field}: expected {expected}, found {found}")]
    OutOfRange {
        /// Name of the effect.
        effect: &'static str,
        /// Name of the parameter.
        field: &'static str,
        /// What it should be.
        expected: String,
        /// What it is.
        found: f64,
    },
    /// The effect needs something that the line does not have.
    #[error("{effect}: expected a line with curves, found none")]
    NoCurves {
        /// Name of the effect.
        effect: &'static str,
    },
}

/// A parameter as it stands in files.
#[derive(Clone, Copy, Debug)]
pub enum Parameter<'a> {
    /// A number.
    Number(f64),
    /// The runs in which the effect acts.
    Runs(&'a Affected),
}

impl From<&f64> for Parameter<'_> {
    fn from(number: &f64) -> Self {
        Self::Number(*number)
    }
}

impl<'a> From<&'a Affected> for Parameter<'a> {
    fn from(runs: &'a Affected) -> Self {
        Self::Runs(runs)
    }
}

/// What is expected of the parameters of an effect.
#[derive(Clone, Copy, Debug)]
pub struct Expect {
    pub(super) effect: &'static str,
    /// Whether the line has curves.
    pub(super) curves: bool,
    pub(super) length_m: f64,
}

impl Expect {
    /// Ranges are those of the catalogue, in its order; what is in no catalogue is finite. Ends of a section stand
    /// before, runs behind them.
    pub(super) fn all(
        &self,
        kind: Option<EffectKind>,
        parameters: &[(&'static str, Parameter)],
    ) -> Result<(), EffectError> {
        let mut ranges = kind.map_or(&[][..], EffectKind::parameters).iter();
        let mut from_m = f64::NEG_INFINITY;
        for &(field, parameter) in parameters {
            match (field, parameter) {
                (_, Parameter::Runs(Affected::Share(share))) => self.within(field, *share, 0.0, 1.0)?,
                (_, Parameter::Runs(Affected::Numbers(runs))) => {
                    self.that(!runs.contains(&0), field, "1 or more", 0.0)?
                }
                ("from_m", Parameter::Number(at_m)) => {
                    // A section beyond the line would be hidden where no train goes.
                    let expected = format!("a place before the end of the line, at {} m", self.length_m);
                    self.that(at_m < self.length_m, field, &expected, at_m)?;
                    self.finite(field, at_m)?;
                    from_m = at_m;
                }
                ("to_m", Parameter::Number(at_m)) => {
                    self.finite(field, at_m)?;
                    self.that(at_m > from_m, field, "a place beyond from_m", at_m)?;
                }
                (_, Parameter::Number(found)) => match ranges.next() {
                    Some(range) => self.within(range.name, found, range.least, range.most)?,
                    None => self.finite(field, found)?,
                },
            }
        }
        Ok(())
    }

    fn that(&self, good: bool, field: &'static str, expected: &str, found: f64) -> Result<(), EffectError> {
        let refused = || EffectError::OutOfRange { effect: self.effect, field, expected: expected.to_owned(), found };
        good.then_some(()).ok_or_else(refused)
    }

    fn finite(&self, field: &'static str, value: f64) -> Result<(), EffectError> {
        self.that(value.abs() < 1e7, field, "a finite number", value)
    }

    pub(super) fn above_zero(&self, field: &'static str, value: f64) -> Result<(), EffectError> {
        self.that(value > 0.0, field, "above 0", value)
    }

    pub(super) fn within(&self, field: &'static str, value: f64, least: f64, most: f64) -> Result<(), EffectError> {
        self.that((least..=most).contains(&value), field, &format!("{least} to {most}"), value)
    }

    pub(super) fn curves(&self) -> Result<(), EffectError> {
        self.curves.then_some(()).ok_or(EffectError::NoCurves { effect: self.effect })
    }
}
