//! Settings, each written once with its default and its range, and the refusal of a value outside.

use crate::Real;
use crate::model::bounds::Range;
pub use crate::model::bounds::{FieldName, OutOfRange};
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
        field: FieldName,
        /// What stood there, km/h.
        found: [Real; 2],
    },
    /// The brake steps are not falling, all above 0.
    StepsNotFalling {
        /// Name of the field as in the configuration file.
        field: FieldName,
        /// What stood there, km/h.
        found: [Real; 4],
    },
}

impl ConfigError {
    /// Name of the field as in the configuration file.
    pub const fn field(&self) -> FieldName {
        match *self {
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

/// Settings that are compared with their ranges, one after the other: a call and a line of a table each, for there are
/// a hundred of them. What is refused is noted and not handed up.
#[derive(Default)]
pub(crate) struct Check {
    ranges: core::slice::Iter<'static, Range>,
    refused: Option<OutOfRange>,
}

impl Check {
    /// What comes next has these ranges.
    pub(crate) fn begin(&mut self, ranges: &'static [Range]) {
        self.ranges = ranges.iter();
    }

    /// The numbers of the next setting lie in its range; NaN does not.
    #[inline(never)]
    pub(crate) fn next(&mut self, found: &[Real]) {
        // As many ranges as settings: see the macro.
        if let Some(range) = self.ranges.next()
            && self.refused.is_none()
        {
            self.refused = found.iter().find_map(|found| range.check(*found).err());
        }
    }

    /// The first setting that is outside.
    pub(crate) fn result(self) -> Result<(), OutOfRange> {
        self.refused.map_or(Ok(()), Err)
    }
}

/// A setting whose numbers have a range.
pub(crate) trait Numbers {
    fn check(&self, check: &mut Check);
}

impl Numbers for Real {
    fn check(&self, check: &mut Check) {
        check.next(core::slice::from_ref(self));
    }
}

impl Numbers for u32 {
    fn check(&self, check: &mut Check) {
        check.next(&[Real::from(*self)]);
    }
}

impl<const N: usize> Numbers for [Real; N] {
    fn check(&self, check: &mut Check) {
        check.next(self);
    }
}

/// A table of the configuration file: for each setting its type, its default, and where it has one its range, that of
/// each number of a list.
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

        impl $Name {
            /// All of them as they are without a configuration file.
            pub const DEFAULT: Self = Self { $($field: $default,)* };
        }

        impl Default for $Name {
            fn default() -> Self {
                Self::DEFAULT
            }
        }

        $crate::plain::plain! {
            struct $Name { $($field),* }
        }

        impl $Name {
            pub(crate) fn check_ranges(&self, check: &mut crate::tick::bounds::Check) {
                const RANGES: &[crate::model::bounds::Range] = &[
                    $($(crate::model::bounds::Range::new(
                        crate::model::bounds::field_name(concat!($table, ".", stringify!($field))),
                        $least,
                        $most,
                    ),)?)*
                ];
                check.begin(RANGES);
                $($(
                    let _ = $least;
                    crate::tick::bounds::Numbers::check(&self.$field, check);
                )?)*
            }
        }
    };
}
pub(crate) use settings;
