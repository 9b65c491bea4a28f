//! What the file of a candidate needs.

pub use crate::axis::{Axis, km, kmh};
pub use crate::candidate::{
    Candidate, Dial, Facts, Family, Fitted, Hide, Naming, Nature, Odds, Offer, Prior, Shape, ShowsIn, Side, Size, Term,
    range,
};
pub use crate::columns::{along, share};
pub use crate::config::PenaltyConfig;
pub use crate::data::believed::{Context, described};
pub use crate::data::rows::Row;
pub use crate::explained::extra;
pub use crate::named::{Interval95, Named, around};
pub use crate::traction::limit::FoundLimit;
pub use crate::wording::{place, scaled, section, short, side, with_unit};
pub use rand::RngExt;
pub use rundown::model::effects::{Coordinate, Effect, EffectKind};
pub use rundown_pages::numbers::number;
pub use serde_json::{Value, json};
