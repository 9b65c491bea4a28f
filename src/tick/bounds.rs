//! Settings, each written once with its default and its range, and the refusal of a value outside.

use crate::Real;
pub use crate::model::bounds::OutOfRange;
use core::fmt;

/// Why a configuration was refused. The old one stays in force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ConfigError {
    /// A number lies outside its range.
    OutOfRange(OutOfRange),
    /// A window is not two speeds, the smaller first.
    Window {
        /// Name of the field as in the configuration file.
        field: &'static str,
        /// What stood there, km/h.
        found: [Real; 2],
    },
    /// The brake steps are not falling, all above 0.
    StepsNotFalling {
        /// Name of the field as in the configuration file.
        field: &'static str,
        /// What stood there, km/h.
        found: [Real; 4],
    },
}

impl ConfigError {
    /// Name of the field as in the configuration file.
    pub const fn field(&self) -> &'static str {
        match self {
            Self::OutOfRange(OutOfRange { field, .. })
            | Self::Window { field, .. }
            | Self::StepsNotFalling { field, .. } => field,
        }
    }
}

impl From<OutOfRange> for ConfigError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(error) => error.fmt(f),
            Self::Window { field, found: [lower, upper] } => {
                write!(f, "{field}: expected two speeds, the smaller first, found {lower}, {upper}")
            }
            Self::StepsNotFalling { field, found: [a, b, c, d] } => {
                write!(f, "{field}: expected falling speeds above 0, found {a}, {b}, {c}, {d}")
            }
        }
    }
}

impl core::error::Error for ConfigError {}

/// A setting whose numbers have a range.
pub(crate) trait Numbers {
    fn numbers(&self) -> impl Iterator<Item = Real>;
}

impl Numbers for Real {
    fn numbers(&self) -> impl Iterator<Item = Real> {
        core::iter::once(*self)
    }
}

impl Numbers for u32 {
    fn numbers(&self) -> impl Iterator<Item = Real> {
        core::iter::once(Real::from(*self))
    }
}

impl<const N: usize> Numbers for [Real; N] {
    fn numbers(&self) -> impl Iterator<Item = Real> {
        self.iter().copied()
    }
}

/// A table of the configuration file: for each setting its type, its default, and where it has one its range, that of each number of a list.
macro_rules! settings {
    ($(#[$attribute:meta])* $Name:ident in $table:literal { $(
        $(#[$of_field:meta])*
        $field:ident: $Type:ty = $default:expr $(, $least:literal to $most:literal)?;
    )* }) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $Name {
            $(
                $(#[$of_field])*
                $(#[doc = concat!("\n\nFrom ", stringify!($least), " to ", stringify!($most), ".")])?
                pub $field: $Type,
            )*
        }

        impl Default for $Name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        $crate::plain::plain! {
            struct $Name { $($field),* }
        }

        impl $Name {
            pub(crate) fn check_ranges(&self) -> Result<(), crate::model::bounds::OutOfRange> {
                $($(
                    for found in crate::tick::bounds::Numbers::numbers(&self.$field) {
                        crate::model::bounds::between(
                            concat!($table, ".", stringify!($field)), found, $least, $most,
                        )?;
                    }
                )?)*
                Ok(())
            }
        }
    };
}
pub(crate) use settings;
