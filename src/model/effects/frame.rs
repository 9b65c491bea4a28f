//! Effects on the wire and in the store: a number, a section, and at most four values in the order of the table of
//! `WIRE.md`.
//!
//! The table of an [`Unknown`] does not fit into four values. It comes point by point, each in a frame of its own with
//! values (coordinate, number of the point, where, N/kg); point 0 begins a new table. What the board says of it is a
//! summary: (coordinate, number of points, smallest, largest N/kg).

use super::error::FrameError;
use super::parameters::Parameters;
use super::{Coordinate, Effect, MAX_POINTS, Unknown};
use crate::Real;
use crate::listed::listed;
use rundown_wire::{self as wire, EffectKind};

impl Effect {
    /// Its frame, as the board publishes it. Of an unknown effect a summary.
    pub fn to_frame(&self) -> wire::Effect {
        wire::Effect {
            kind: self.kind().number(),
            section_m: self.section_m().map(|(from_m, to_m)| [from_m, to_m]),
            values: for_kind!(self, effect => effect.values()),
        }
    }

    /// The frames that bring it to a board: one, or one for each point of an unknown effect.
    pub fn parts(&self) -> impl Iterator<Item = wire::Effect> {
        let points = self.table().map_or(1, |unknown| unknown.table.len());
        (0..points).map(|index| match self.table() {
            Some(unknown) => {
                let kind = EffectKind::Unknown.number();
                wire::Effect { kind, section_m: None, values: listed(point(unknown, index)) }
            }
            None => self.to_frame(),
        })
    }
}

/// A point of a table: coordinate, where, N/kg, and its number.
pub(super) fn point_of(frame: &wire::Effect) -> Result<(Coordinate, usize, (f32, f32)), FrameError> {
    let [coordinate, index, at, n_per_kg] = *frame.values.as_array().ok_or(FrameError::Shape)?;
    let number = |value: Real| (0..MAX_POINTS).find(|index| *index as Real == value);
    let coordinate = number(coordinate).and_then(|number| Coordinate::ALL.get(number).copied());
    match (coordinate, number(index), frame.section_m) {
        (Some(coordinate), Some(index), None) => Ok((coordinate, index, (at as f32, n_per_kg as f32))),
        _ => Err(FrameError::Shape),
    }
}

fn point(unknown: &Unknown, index: usize) -> [Real; 4] {
    let (at, n_per_kg) = unknown.table.get(index).copied().unwrap_or_default();
    [Real::from(unknown.coordinate as u8), index as Real, Real::from(at), Real::from(n_per_kg)]
}
