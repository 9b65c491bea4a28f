//! The kinds of effects, generated from [`rundown_wire::effects_catalogue`]: for each a struct with its checked
//! parameters, and the enum of all.
//!
//! A parameter is written once, in the catalogue. From it come field, name in files, accepted range, and place in the
//! frame.

use super::Unknown;
use super::error::FrameError;
use super::parameters::Parameters;
use crate::Real;
use crate::listed::listed;
use crate::model::bounds::{Range, field_name};
use heapless::Vec;
use rundown_wire as wire;
use rundown_wire::{EFFECT_VALUES, EffectKind, effects_catalogue};
use serde::{Deserialize, Serialize};

/// Default of [`SeasonalDrift::period_days`].
const fn a_year() -> Real {
    365.0
}

macro_rules! parameters {
    // Beside its law.
    ($Kind:ident table $($more:tt)*) => {};
    ($Kind:ident everywhere $($more:tt)*) => { parameters! { @ $Kind [] $($more)* } };
    ($Kind:ident section $($more:tt)*) => { parameters! { @ $Kind [from_m to_m] $($more)* } };
    (@ $Kind:ident [$($end:ident)*] $summary:literal { $(
        $(#[$attribute:meta])*
        $parameter:ident $(as $in_files:literal)?: $least:literal to $most:literal, $meaning:literal, $unit:literal;
    )* }) => {
        #[doc = $summary]
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $Kind {
            $(
                /// End of the section, m.
                pub $end: Real,
            )*
            $(
                #[doc = concat!($meaning, ": ", stringify!($least), " to ", stringify!($most), " ", $unit)]
                $(#[$attribute])*
                $(#[serde(rename = $in_files)])?
                pub $parameter: Real,
            )*
        }

        impl Parameters for $Kind {
            fn section_m(&self) -> Option<(Real, Real)> {
                let ends: &[Real] = &[$(self.$end),*];
                if let [from_m, to_m] = *ends { Some((from_m, to_m)) } else { None }
            }

            fn ranges(&self) -> &'static [Range] {
                // The name in files, where it is another one, stands first.
                const { &[$(Range::new(field_name([$($in_files,)? stringify!($parameter)][0]), $least, $most)),*] }
            }

            fn values(&self) -> Vec<Real, EFFECT_VALUES> {
                listed([$(self.$parameter),*])
            }

            fn from_frame(frame: &wire::Effect) -> Result<Self, FrameError> {
                let ends = frame.section_m.as_ref().map_or(&[][..], |ends| ends);
                let [$($end),*] = *ends.as_array().ok_or(FrameError::Shape)?;
                let [$($parameter),*] = *frame.values.as_array().ok_or(FrameError::Shape)?;
                Ok(Self { $($end,)* $($parameter,)* })
            }
        }
    };
}

macro_rules! kinds {
    ($($number:literal $Kind:ident $name:ident $place:ident $summary:literal $parameters:tt)*) => {
        /// An effect with its parameters. Not `non_exhaustive`: what handles the kinds has to handle each new one.
        #[derive(Clone, Debug, PartialEq)]
        #[cfg_attr(feature = "alloc", derive(Serialize, Deserialize), serde(tag = "name", rename_all = "snake_case"))]
        pub enum Effect {
            $(
                #[doc = concat!(stringify!($number), ": ", $summary)]
                $Kind($Kind),
            )*
        }

        $(
            parameters! { $Kind $place $summary $parameters }

            impl From<$Kind> for Effect {
                fn from(effect: $Kind) -> Self {
                    Self::$Kind(effect)
                }
            }
        )*

        impl Effect {
            /// Its kind, with name and number.
            pub const fn kind(&self) -> EffectKind {
                match self {
                    $(Self::$Kind(_) => EffectKind::$Kind,)*
                }
            }

            /// From a frame; not of an unknown effect, whose points belong together.
            ///
            /// # Errors
            /// [`FrameError`].
            ///
            /// ```
            /// use rundown::model::effects::{Effect, WarmUp};
            ///
            /// let effect = Effect::WarmUp(WarmUp { amplitude: 3e-3, tau_s: 300.0 });
            /// assert_eq!(Effect::from_frame(&effect.to_frame()), Ok(effect));
            /// ```
            pub fn from_frame(frame: &wire::Effect) -> Result<Self, FrameError> {
                let effect = match EffectKind::from_number(frame.kind).ok_or(FrameError::UnknownKind)? {
                    $(EffectKind::$Kind => Self::$Kind(Parameters::from_frame(frame)?),)*
                };
                effect.check().map_err(FrameError::Refused)?;
                Ok(effect)
            }
        }
    };
}

effects_catalogue!(kinds);

macro_rules! of_kind {
    (($effect:expr, $of:ident => $call:expr)
     $($number:literal $Kind:ident $name:ident $place:ident $summary:literal $parameters:tt)*) => {
        match $effect {
            $(Effect::$Kind($of) => $call,)*
        }
    };
}

/// `of_kind!(effect, of => expression)`: the expression with what an effect of any kind has.
macro_rules! for_kind {
    ($($argument:tt)*) => { rundown_wire::effects_catalogue!(of_kind ($($argument)*)) };
}
