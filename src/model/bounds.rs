//! Ranges of what is described or set, and the refusal of a value outside.

use crate::Real;
use core::fmt;

/// A value lies outside its range. What was in force before stays in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// Name of the field as in files.
    pub field: &'static str,
    /// Smallest accepted value.
    pub least: Real,
    /// Largest accepted value.
    pub most: Real,
    /// What stood there.
    pub found: Real,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { field, least, most, found } = self;
        write!(f, "{field}: expected {least} to {most}, found {found}")
    }
}

impl core::error::Error for OutOfRange {}

/// `found` lies within `least..=most`; NaN does not.
// Called a hundred times: inlined it took 1.4 kB more of the board's flash.
#[inline(never)]
pub(crate) fn between(field: &'static str, found: Real, least: Real, most: Real) -> Result<(), OutOfRange> {
    if (least..=most).contains(&found) { Ok(()) } else { Err(OutOfRange { field, least, most, found }) }
}
