//! Effects that the believed description does not have, as they act in the truth.
//!
//! In: an effect, and where, when and how fast the train is. Out: by its [`Law`] what it adds to the resistance, what
//! it leaves of traction and brake, what it alters of line, train, wind and readings, and in which runs.
//!
//! The kinds are those of [the catalogue](rundown_wire::effects_catalogue), each with parameters and a law of its own
//! here, so that a wrong law of the estimator cannot hide; and a few that are in no catalogue: a workflow that looks
//! for named effects must say that it does not know them. Names and units of parameters are those of the model files.
//! Locations are those of the `up` direction, as in the track file.

pub mod affected;
mod check;
mod law;

pub use affected::Affected;
pub use check::{EffectError, Expect, Parameter};
use law::raised_cosine;
pub use law::{Altered, Capability, Law, Moment, Parameters, Setting, Together};

use crate::motion::Motion;
use rundown_wire::{EffectKind, effects_catalogue};
use serde::{Deserialize, Serialize};

/// The parameters of an effect: those of the catalogue in its order, after the ends of a section, before the runs in
/// which it acts.
macro_rules! parameters {
    ($Kind:ident { $($(#[$attribute:meta])* $field:ident: $type:ty),* }) => {
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $Kind {
            $($(#[$attribute])* pub $field: $type,)*
        }

        impl $Kind {
            pub(super) const FIELDS: &[&str] = &[$(stringify!($field)),*];
        }

        impl Parameters for $Kind {
            fn parameters(&self) -> Vec<(&'static str, Parameter<'_>)> {
                Self::FIELDS.iter().copied().zip([$(Parameter::from(&self.$field)),*]).collect()
            }
        }
    };
}

macro_rules! kinds {
    ([$($Own:ident $own:ident)*]
     $($number:literal $Kind:ident $name:ident $place:ident $summary:literal $parameters:tt)*) => {
        $(#[allow(missing_docs)] mod $name; pub use $name::$Kind;)*
        $(#[allow(missing_docs)] mod $own; pub use $own::$Own;)*

        /// An effect with its parameters.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "name", rename_all = "snake_case")]
        #[allow(missing_docs)]
        pub enum Effect {
            $(#[doc = $summary] $Kind($Kind),)*
            $($Own($Own),)*
        }

        impl Effect {
            /// Its kind; none if it is in no catalogue.
            pub fn kind(&self) -> Option<EffectKind> {
                match self {
                    $(Self::$Kind(_) => Some(EffectKind::$Kind),)*
                    $(Self::$Own(_) => None,)*
                }
            }

            /// Its name in files.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$Kind(_) => stringify!($name),)*
                    $(Self::$Own(_) => stringify!($own),)*
                }
            }

            /// What it does.
            pub fn law(&self) -> &dyn Law {
                match self {
                    $(Self::$Kind(effect) => effect,)*
                    $(Self::$Own(effect) => effect,)*
                }
            }

            fn law_mut(&mut self) -> &mut dyn Law {
                match self {
                    $(Self::$Kind(effect) => effect,)*
                    $(Self::$Own(effect) => effect,)*
                }
            }
        }

        $(impl From<$Kind> for Effect { fn from(effect: $Kind) -> Self { Self::$Kind(effect) } })*
        $(impl From<$Own> for Effect { fn from(effect: $Own) -> Self { Self::$Own(effect) } })*
    };
}

effects_catalogue!(named: kinds [
    CubicDrag cubic_drag
    SpeedBump speed_bump
    LocationBump location_bump
    PeriodicDrag periodic_drag
    Frost frost
    DayStep day_step
]);

impl Effect {
    /// Checks the parameters, on a line of this length; `curves` says whether it has any.
    ///
    /// # Errors
    /// [`EffectError`] names effect, parameter and what was expected.
    pub fn check(&self, curves: bool, length_m: f64) -> Result<(), EffectError> {
        let expect = Expect { effect: self.name(), curves, length_m };
        expect.all(self.kind(), &self.law().parameters())?;
        self.law().check(&expect)
    }

    /// For an effect that is in no catalogue: the coordinate it depends on.
    pub fn unknown_coordinate(&self) -> Option<&'static str> {
        self.law().unknown_coordinate()
    }

    /// The same effect for a train that travels the line of this length from its end: sections in metres from there.
    pub fn mirrored(mut self, length_m: f64) -> Self {
        if let Some([from_m, to_m]) = self.law_mut().section_mut() {
            (*from_m, *to_m) = (length_m - *to_m, length_m - *from_m);
        }
        self
    }
}

#[cfg(test)]
mod tests;
