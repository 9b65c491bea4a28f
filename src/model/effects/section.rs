//! Sections of the track, and the part of a train that is inside.

use super::EffectError;
use super::error::within;
use crate::Real;
use crate::extremes::Extremes;
use crate::model::bounds::{FAR_M, Range, field_name};
use crate::model::direction::Direction;
use rundown_wire::EffectKind;

/// The share (0 to 1) of a train that stands between `from_m` and `to_m`. Its front is at `front_m`, its tail behind in
/// the direction of travel.
///
/// ```
/// use rundown::model::direction::Direction;
/// use rundown::model::effects::share_inside;
///
/// // A quarter of the train is in, the rest still outside; then the same seen from the other side.
/// assert_eq!(share_inside(1000.0, 2000.0, 1040.0, 160.0, Direction::Up), 0.25);
/// assert_eq!(share_inside(1000.0, 2000.0, 1960.0, 160.0, Direction::Down), 0.25);
/// ```
pub fn share_inside(from_m: Real, to_m: Real, front_m: Real, train_length_m: Real, direction: Direction) -> Real {
    let (rear_m, ahead_m) = match direction {
        Direction::Up => (front_m - train_length_m, front_m),
        Direction::Down => (front_m, front_m + train_length_m),
    };
    // NaN is nowhere: the comparisons of min and max drop it.
    let inside_m = ahead_m.at_most(to_m) - rear_m.at_least(from_m);
    (inside_m / train_length_m).clamp(0.0, 1.0)
}

/// The ends of a section.
pub(super) fn check(effect: EffectKind, from_m: Real, to_m: Real) -> Result<(), EffectError> {
    const FROM: Range = Range::new(field_name("from_m"), -FAR_M, FAR_M);
    const TO: Range = Range::new(field_name("to_m"), -FAR_M, FAR_M);
    within(effect, &FROM, from_m)?;
    within(effect, &TO, to_m)?;
    if to_m > from_m { Ok(()) } else { Err(EffectError::Section { effect, from_m, to_m }) }
}
