//! The kinds of effects and what their numbers mean: the table of `WIRE.md` in words for a display.

use crate::downlink::EFFECT_VALUES;
use core::fmt;

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParameter {
    /// Its name in files.
    pub name: &'static str,
    /// Smallest accepted value.
    pub least: f64,
    /// Largest accepted value.
    pub most: f64,
    /// What it means.
    pub meaning: &'static str,
    /// Its unit; empty for a plain number.
    pub unit: &'static str,
}

macro_rules! kinds {
    ($($number:literal $Kind:ident $name:ident $place:ident $summary:literal { $(
        $(#[$attribute:meta])*
        $parameter:ident $(as $in_files:literal)?: $least:literal to $most:literal, $meaning:literal, $unit:literal;
    )* })*) => {
        /// A kind of effect. Not `non_exhaustive`: what handles the kinds has to handle each new one.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum EffectKind {
            $(#[doc = $summary] $Kind = $number,)*
        }

        impl EffectKind {
            /// All of them, in the order of the catalogue.
            pub const ALL: [Self; [$($number),*].len()] = [$(Self::$Kind),*];

            /// The kind of a number; none if it is newer than this library.
            pub const fn from_number(number: u8) -> Option<Self> {
                match number {
                    $($number => Some(Self::$Kind),)*
                    _ => None,
                }
            }

            /// Its name in files and tables.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$Kind => stringify!($name),)*
                }
            }

            /// What it is, in a sentence.
            pub const fn summary(self) -> &'static str {
                match self {
                    $(Self::$Kind => $summary,)*
                }
            }

            /// It acts in a section of the track only.
            pub const fn has_section(self) -> bool {
                match self {
                    $(Self::$Kind => matches!(stringify!($place).as_bytes(), b"section"),)*
                }
            }

            /// Its parameters in the order of the values of a frame. Of a table: its summary.
            ///
            /// ```
            /// use rundown_wire::{Effect, EffectKind};
            ///
            /// let effect = Effect { kind: 1, section_m: Some([500.0, 900.0]), values: [2e-5].into_iter().collect() };
            /// let kind = EffectKind::from_number(effect.kind).unwrap();
            /// assert_eq!(kind.name(), "tunnel_drag");
            /// assert_eq!((kind.parameters()[0].meaning, kind.parameters()[0].unit), ("k", "N/kg per (m/s)²"));
            /// ```
            pub const fn parameters(self) -> &'static [EffectParameter] {
                match self {
                    $(Self::$Kind => &[$(EffectParameter {
                        // The name in files, where it is another one, stands first.
                        name: [$($in_files,)? stringify!($parameter)][0],
                        least: $least,
                        most: $most,
                        meaning: $meaning,
                        unit: $unit,
                    }),*],)*
                }
            }
        }

        // A frame has room for them.
        $(const _: () = assert!(EffectKind::$Kind.parameters().len() <= EFFECT_VALUES);)*
    };
}

crate::effects_catalogue!(kinds);

impl EffectKind {
    /// Its number on the wire and in the store.
    pub const fn number(self) -> u8 {
        self as u8
    }
}

impl fmt::Display for EffectKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lead_back_to_their_kinds_and_names_differ() {
        for (index, kind) in EffectKind::ALL.into_iter().enumerate() {
            assert_eq!(EffectKind::from_number(kind.number()), Some(kind));
            assert_eq!(usize::from(kind.number()), index + 1, "{kind}");
            assert!(EffectKind::ALL[..index].iter().all(|before| before.name() != kind.name()), "{kind}");
            assert!(kind.parameters().iter().all(|parameter| parameter.least < parameter.most), "{kind}");
        }
        assert_eq!(EffectKind::from_number(0), None);
    }
}
