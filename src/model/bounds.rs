//! Ranges of what is described or set, and the refusal of a value outside.

use crate::Real;
use rundown_wire::errors;

/// Name of a field, for messages.
#[cfg(not(target_os = "none"))]
pub type FieldName = &'static str;
/// Name of a field. A board writes no messages, and has no names: they would take 3 kB of its flash.
#[cfg(target_os = "none")]
pub use on_board::FieldName;

/// The name where there are names.
#[cfg(not(target_os = "none"))]
pub(crate) const fn field_name(name: &'static str) -> FieldName {
    name
}

#[cfg(target_os = "none")]
pub(crate) const fn field_name(_name: &'static str) -> FieldName {
    FieldName
}

#[cfg(target_os = "none")]
mod on_board {
    /// Nothing stands for a name.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct FieldName;

    impl core::fmt::Display for FieldName {
        fn fmt(&self, _: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
            Ok(())
        }
    }
}

errors! {
    /// A value lies outside its range. What was in force before stays in force.
    pub struct OutOfRange { field: FieldName, least: Real, most: Real, found: Real } =>
        "{field}: expected {least} to {most}, found {found}";
}

/// Name, least and most of a field.
pub(crate) type Range = (FieldName, Real, Real);

/// `found` lies within `least..=most`; NaN does not.
// Called from many places: inlined it takes more of the board's flash.
#[inline(never)]
pub(crate) fn between(field: FieldName, found: Real, least: Real, most: Real) -> Result<(), OutOfRange> {
    if (least..=most).contains(&found) { Ok(()) } else { Err(OutOfRange { field, least, most, found }) }
}
