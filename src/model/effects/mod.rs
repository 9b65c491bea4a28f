//! Named physical effects that a believed model of train and track may lack, each with its law. The gap workflow finds
//! them, the board runs them.
//!
//! In: where the train is, how fast, since when ([`Moment`]). Out, by what the effect acts on:
//!
//! | acts on | function | as |
//! |---|---|---|
//! | motion | [`Effect::resistance_n_per_kg`]: extra resistance against travel, N/kg of rotating mass γ m | [`TunnelDrag`] |
//! | limits of the train | [`Effect::limit`] | [`LowAdhesion`] |
//! | readings | [`Effect::correct`] | [`SpeedScale`] |
//! | differences between runs | [`Effects::wind_sd_mps`] | [`RunWind`] |
//!
//! ```text
//! a = u - r(v) - g(s) - Σ extra             Eq. (1) with the effects
//! ```
//!
//! Each function gives 0, or what it got, for effects that act elsewhere, so a sum over any list of effects is right.
//! Extra resistances add up; limits and corrections are applied in the order of the list. What an effect needs and
//! nobody knows (temperature, date) leaves it at 0.
//!
//! The kinds stand in [one catalogue](rundown_wire::effects_catalogue). Parameters, ranges, frames and names are
//! generated from it; what is left is a law, one file for each kind. With the feature `alloc` an effect is read and
//! written by name, as `[[effect]] name = "tunnel_drag"` in a train or track file.

#[macro_use]
mod catalogue;
mod acting;
mod effect;
mod error;
mod frame;
mod law;
mod limits;
mod list;
mod moment;
mod parameters;
mod section;

macro_rules! laws {
    ($($number:literal $Kind:ident $name:ident $place:ident $summary:literal $parameters:tt)*) => {
        $(mod $name;)*
    };
}

rundown_wire::effects_catalogue!(laws);

pub use acting::{Acting, Journey, Surroundings};
pub use catalogue::*;
pub use error::{EffectError, FrameError};
use law::{Law, Situation};
pub use limits::Limits;
pub use list::{Effects, MAX_EFFECTS};
pub use moment::Moment;
pub use rundown_wire::EffectKind;
pub use section::share_inside;
pub use unknown::{Coordinate, MAX_POINTS, Unknown};

#[cfg(test)]
mod tests;
