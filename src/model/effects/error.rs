//! Why an effect, or its frame, was refused.

use crate::Real;
use crate::model::bounds::{OutOfRange, between};
use core::fmt;
use rundown_wire::EffectKind;

/// Why an effect was refused. What was in force before stays in force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum EffectError {
    /// A parameter is out of range.
    OutOfRange(EffectKind, OutOfRange),
    /// A section does not end behind its beginning.
    Section {
        /// Which effect.
        effect: EffectKind,
        /// Where it begins, m.
        from_m: Real,
        /// Where it ends, m.
        to_m: Real,
    },
    /// Point `index` of a table is not finite, out of range, or not behind the one before it.
    Point {
        /// Which point, counted from 0.
        index: usize,
    },
    /// A table without points.
    NoPoints,
    /// More effects than a list holds.
    TooMany {
        /// How many it holds.
        most: usize,
    },
    /// A second effect of a kind that may stand only once.
    Twice {
        /// Which effect.
        effect: EffectKind,
    },
}

impl fmt::Display for EffectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(effect, error) => write!(f, "{effect}.{error}"),
            Self::Section { effect, from_m, to_m } => {
                write!(f, "{effect}.to_m: expected beyond from_m = {from_m}, found {to_m}")
            }
            Self::Point { index } => {
                write!(
                    f,
                    "unknown.table: expected finite points, each beyond the one before it and within 1 N/kg, found another in point {index}"
                )
            }
            Self::NoPoints => write!(f, "unknown.table: expected a point, found none"),
            Self::TooMany { most } => write!(f, "effect: expected at most {most}, found one more"),
            Self::Twice { effect } => write!(f, "effect: expected {effect} once, found it twice"),
        }
    }
}

impl core::error::Error for EffectError {}

/// Why an effect frame was refused; the effects are as before.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FrameError {
    /// No effect has this number.
    UnknownKind,
    /// Not the number of values that its kind has, or a section where there is none, or none where there is one.
    Shape,
    /// A point of a table that does not follow the one before it.
    OutOfOrder,
    /// The effect itself is refused.
    Refused(EffectError),
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownKind => f.write_str("expected the number of a kind of effect, found another one"),
            Self::Shape => f.write_str("expected the values and the section that the kind of effect has, found others"),
            Self::OutOfOrder => {
                f.write_str("expected the next point of the table of an unknown effect, found another one")
            }
            Self::Refused(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for FrameError {}

/// A parameter and its range. Refuses NaN.
pub(super) fn within(
    effect: EffectKind,
    parameter: &'static str,
    found: Real,
    least: Real,
    most: Real,
) -> Result<(), EffectError> {
    between(parameter, found, least, most).map_err(|error| EffectError::OutOfRange(effect, error))
}
