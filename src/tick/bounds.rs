//! Ranges of settings, and the refusal of a value outside.

use crate::Real;
use core::fmt;

/// Why a configuration was refused. The old one stays in force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ConfigError {
    /// `field` was `found`, outside `least..=most`.
    OutOfRange {
        /// Name of the field as in the configuration file.
        field: &'static str,
        /// Smallest accepted value.
        least: Real,
        /// Largest accepted value.
        most: Real,
        /// What stood there.
        found: Real,
    },
    /// A window is not two speeds, the smaller first.
    Window {
        /// Name of the field.
        field: &'static str,
        /// What stood there, km/h.
        found: [Real; 2],
    },
    /// The brake steps are not falling, all above 0.
    StepsNotFalling {
        /// Name of the field.
        field: &'static str,
        /// What stood there, km/h.
        found: [Real; 4],
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { field, least, most, found } => {
                write!(f, "configuration: {field} must be {least} to {most}, found {found}")
            }
            Self::Window { field, found: [lower, upper] } => {
                write!(f, "configuration: {field} must be two speeds, the smaller first, found {lower}, {upper}")
            }
            Self::StepsNotFalling { field, found: [a, b, c, d] } => {
                write!(f, "configuration: {field} must be falling and above 0, found {a}, {b}, {c}, {d}")
            }
        }
    }
}

impl core::error::Error for ConfigError {}

/// `found` lies within `least..=most`; NaN does not.
pub(crate) fn between(field: &'static str, found: Real, least: Real, most: Real) -> Result<(), ConfigError> {
    if (least..=most).contains(&found) { Ok(()) } else { Err(ConfigError::OutOfRange { field, least, most, found }) }
}
