//! Whether an effect can be simulated at all.

use super::Affected;
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

/// What is expected of the parameters of an effect.
#[derive(Clone, Copy, Debug)]
pub struct Expect {
    /// Name of the effect.
    pub effect: &'static str,
    /// Whether the line has curves.
    pub curves: bool,
}

impl Expect {
    pub(super) fn that(&self, good: bool, field: &'static str, expected: &str, found: f64) -> Result<(), EffectError> {
        let refused = || EffectError::OutOfRange { effect: self.effect, field, expected: expected.to_owned(), found };
        good.then_some(()).ok_or_else(refused)
    }

    pub(super) fn finite(&self, field: &'static str, value: f64) -> Result<(), EffectError> {
        self.that(value.is_finite() && value.abs() < 1e7, field, "finite", value)
    }

    pub(super) fn positive(&self, field: &'static str, value: f64) -> Result<(), EffectError> {
        self.that(value.is_finite() && value > 0.0, field, "above 0", value)
    }

    pub(super) fn within(&self, field: &'static str, value: f64, least: f64, most: f64) -> Result<(), EffectError> {
        self.that((least..=most).contains(&value), field, &format!("{least} to {most}"), value)
    }

    pub(super) fn section(&self, from_m: f64, to_m: f64) -> Result<(), EffectError> {
        self.finite("from_m", from_m)?;
        self.finite("to_m", to_m)?;
        self.that(to_m > from_m, "to_m", "beyond from_m", to_m)
    }

    pub(super) fn runs(&self, runs: &Affected) -> Result<(), EffectError> {
        match runs {
            Affected::Share(share) => self.that((0.0..=1.0).contains(share), "runs", "a share of 0 to 1", *share),
            Affected::Numbers(numbers) => self.that(!numbers.contains(&0), "runs", "numbers counted from 1", 0.0),
        }
    }

    pub(super) fn curves(&self) -> Result<(), EffectError> {
        self.curves.then_some(()).ok_or(EffectError::NoCurves { effect: self.effect })
    }
}
