//! Why an effect, or its frame, was refused.

use crate::Real;
use crate::model::bounds::{OutOfRange, Range};
use rundown_wire::EffectKind;
use rundown_wire::errors;

errors! {
    /// Why an effect was refused. What was in force before stays in force.
    #[non_exhaustive]
    pub enum EffectError {
        OutOfRange(effect: EffectKind, error: OutOfRange) => "{effect}.{error}",
        Section { effect: EffectKind, from_m: Real, to_m: Real } =>
            "{effect}.to_m: expected beyond from_m = {from_m}, found {to_m}",
        /// Point `index` of a table is not finite, out of range, or not behind the one before it.
        Point { index: usize } =>
            "unknown.table: expected finite points, each beyond the one before it and within 1 N/kg, found another in point {index}",
        NoPoints => "unknown.table: expected a point, found none",
        TooMany { most: usize } => "effect: expected at most {most}, found one more",
        Twice { effect: EffectKind } => "effect: expected {effect} once, found it twice",
    }

    /// Why an effect frame was refused; the effects are as before.
    #[non_exhaustive]
    pub enum FrameError {
        UnknownKind => "kind: expected the number of a kind of effect, found another one",
        Shape => "values: expected the values and the section that the kind of effect has, found others",
        OutOfOrder => "point: expected the next point of the table of an unknown effect, found another one",
        Refused(error: EffectError) => "{error}",
    }
}

/// A parameter and its range. Refuses NaN.
pub(super) fn within(effect: EffectKind, range: &Range, found: Real) -> Result<(), EffectError> {
    range.check(found).map_err(|error| EffectError::OutOfRange(effect, error))
}
