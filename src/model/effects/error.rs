//! Why an effect was refused.

use crate::Real;
use core::fmt;
use rundown_wire::EffectKind;

/// Why an effect was refused. What was in force before stays in force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum EffectError {
    /// A parameter is out of range.
    OutOfRange {
        /// Which effect.
        effect: EffectKind,
        /// Name of the parameter, as in files.
        parameter: &'static str,
        /// Smallest accepted value.
        least: Real,
        /// Largest accepted value.
        most: Real,
        /// What stood there.
        found: Real,
    },
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
            Self::OutOfRange { effect, parameter, least, most, found } => {
                write!(f, "effect {effect}: {parameter} must be {least} to {most}, found {found}")
            }
            Self::Section { effect, from_m, to_m } => {
                write!(f, "effect {effect}: to_m must be beyond from_m = {from_m}, found {to_m}")
            }
            Self::Point { index } => write!(
                f,
                "effect unknown: point {index} of the table must be finite, within 1 N/kg and behind the one before it"
            ),
            Self::NoPoints => write!(f, "effect unknown: the table must have a point, found none"),
            Self::TooMany { most } => write!(f, "at most {most} effects, found one more"),
            Self::Twice { effect } => write!(f, "effect {effect}: found twice, may stand once"),
        }
    }
}

impl core::error::Error for EffectError {}

/// A parameter and its range. Refuses NaN.
// Called thirty times: inlined it took 1.4 kB more of the board's flash.
#[inline(never)]
pub(super) fn within(
    effect: EffectKind,
    parameter: &'static str,
    found: Real,
    least: Real,
    most: Real,
) -> Result<(), EffectError> {
    if (least..=most).contains(&found) {
        return Ok(());
    }
    Err(EffectError::OutOfRange { effect, parameter, least, most, found })
}
