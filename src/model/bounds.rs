//! Ranges of what is described or set, and the refusal of a value outside.

use crate::Real;
use rundown_wire::errors;

errors! {
    /// A value lies outside its range. What was in force before stays in force.
    pub struct OutOfRange { field: &'static str, least: Real, most: Real, found: Real } =>
        "{field}: expected {least} to {most}, found {found}";
}

/// `found` lies within `least..=most`; NaN does not.
// Called from many places: inlined it takes more of the board's flash.
#[inline(never)]
pub(crate) fn between(field: &'static str, found: Real, least: Real, most: Real) -> Result<(), OutOfRange> {
    if (least..=most).contains(&found) { Ok(()) } else { Err(OutOfRange { field, least, most, found }) }
}
