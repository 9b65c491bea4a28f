//! Places that ask for a lower speed: stops, and where the permitted speed falls in the direction of travel.
//!
//! In: a list of places along the track, sorted, at most [`MAX_TARGETS`]. Out: the next one ahead of a train. Where the
//! permitted speed rises there is no target: coasting to it is no advice.
//!
//! Single precision, for the board has two tracks in RAM: 12 bytes a place, 0.01 m at 100 km.

use crate::Real;
use crate::model::direction::Direction;
use crate::model::table::Table;
use crate::plain::plain;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Capacity of a track.
pub const MAX_TARGETS: usize = 192;

/// A stop, or where another speed is permitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Location, m.
    pub at_m: Real,
    /// In a track: permitted speed from here on in the `up` direction, m/s. Ahead of a train: that behind the place.
    /// `None`: a stop.
    pub limit_mps: Option<Real>,
}

plain! {
    struct Target { at_m, limit_mps }
}

/// What is permitted below and above a place along the track's locations; a stop permits 0 on both sides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct PermittedAround {
    at_m: f32,
    below_mps: f32,
    above_mps: f32,
}

plain! {
    struct PermittedAround { at_m, below_mps, above_mps }
}

/// The places of a track.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Targets {
    places: Vec<PermittedAround, MAX_TARGETS>,
}

plain! {
    struct Targets { places }
}

impl Targets {
    pub(crate) const NONE: Self = Self { places: Vec::new() };

    pub(crate) fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The first target further than `beyond_m` ahead.
    pub(crate) fn next(&self, direction: Direction, location_m: Real, beyond_m: Real) -> Option<Target> {
        let reached_m = (location_m + direction.sign() * beyond_m) as f32;
        let asks = |place: &&PermittedAround| match direction {
            Direction::Up => place.at_m > reached_m && place.is_target(place.below_mps, place.above_mps),
            Direction::Down => place.at_m < reached_m && place.is_target(place.above_mps, place.below_mps),
        };
        let (place, behind_mps) = match direction {
            Direction::Up => self.places.iter().find(asks).map(|p| (p, p.above_mps)),
            Direction::Down => self.places.iter().rev().find(asks).map(|p| (p, p.below_mps)),
        }?;
        Some(Target { at_m: Real::from(place.at_m), limit_mps: (behind_mps > 0.0).then_some(Real::from(behind_mps)) })
    }
}

impl Table for Targets {
    type Entry = Target;

    fn len(&self) -> usize {
        self.places.len()
    }

    fn clear(&mut self) {
        self.places.clear();
    }

    fn push(&mut self, target: Target) -> bool {
        let at_m = target.at_m as f32;
        let last_m = self.places.last().map_or(f32::NEG_INFINITY, |p| p.at_m);
        // Also refuses NaN.
        let good = at_m.is_finite()
            && at_m >= last_m
            && target
                .limit_mps
                .map(|limit_mps| limit_mps as f32)
                .is_none_or(|limit_mps| limit_mps.is_finite() && limit_mps > 0.0);
        // A stop does not change what is permitted.
        let limits = self.places.iter().rev().filter(|place| place.above_mps > 0.0);
        // Before the first limit nothing is known.
        let below_mps = limits.map(|place| place.above_mps).next();
        let (below_mps, above_mps) = match target.limit_mps {
            None => (0.0, 0.0),
            Some(limit_mps) => (below_mps.unwrap_or(f32::INFINITY), limit_mps as f32),
        };
        let place = PermittedAround { at_m, below_mps, above_mps };
        good && self.places.push(place).is_ok()
    }
}

impl PermittedAround {
    fn is_target(&self, before_mps: f32, behind_mps: f32) -> bool {
        behind_mps == 0.0 || behind_mps < before_mps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(at_m: Real, limit_mps: Real) -> Target {
        Target { at_m, limit_mps: Some(limit_mps) }
    }

    fn stop(at_m: Real) -> Target {
        Target { at_m, limit_mps: None }
    }

    fn line() -> Targets {
        let mut targets = Targets::NONE;
        for place in [
            stop(0.0),
            limit(0.0, 11.0),
            limit(900.0, 39.0),
            limit(5_000.0, 30.0),
            stop(6_000.0),
            limit(7_000.0, 39.0),
            limit(31_000.0, 11.0),
            stop(32_000.0),
        ] {
            assert!(targets.push(place), "{place:?}");
        }
        targets
    }

    #[test]
    fn falls_and_stops_are_targets_and_rises_are_none() {
        let line = line();
        let up = |from_m| line.next(Direction::Up, from_m, 50.0);
        assert_eq!(up(100.0), Some(limit(5_000.0, 30.0)));
        assert_eq!(up(4_951.0), Some(stop(6_000.0)), "reached");
        assert_eq!(up(6_000.0), Some(limit(31_000.0, 11.0)));
        assert_eq!(up(31_000.0), Some(stop(32_000.0)));
        assert_eq!(up(32_000.0), None);
        let down = |from_m| line.next(Direction::Down, from_m, 50.0);
        assert_eq!(down(32_100.0), Some(stop(32_000.0)));
        assert_eq!(down(31_500.0), Some(limit(7_000.0, 30.0)));
        assert_eq!(down(7_000.0), Some(stop(6_000.0)));
        assert_eq!(down(5_900.0), Some(limit(900.0, 11.0)));
        assert_eq!(down(900.0), Some(stop(0.0)));
    }

    #[test]
    fn a_limit_where_none_was_known_is_a_target_up_and_none_down() {
        let mut targets = Targets::NONE;
        assert!(targets.push(limit(500.0, 20.0)));
        assert_eq!(targets.next(Direction::Up, 0.0, 0.0), Some(limit(500.0, 20.0)));
        assert_eq!(targets.next(Direction::Down, 900.0, 0.0), None);
        assert_eq!(targets.next(Direction::Up, Real::NAN, 0.0), None);
    }

    #[test]
    fn what_is_no_place_is_refused() {
        let mut targets = Targets::NONE;
        assert!(targets.push(stop(100.0)));
        for wrong in [
            stop(99.0),
            stop(Real::NAN),
            stop(1e300),
            limit(100.0, 0.0),
            limit(100.0, -1.0),
            limit(100.0, Real::NAN),
            limit(100.0, Real::INFINITY),
        ] {
            assert!(!targets.push(wrong), "{wrong:?}");
        }
        for index in 1..MAX_TARGETS {
            assert!(targets.push(stop(100.0 + index as Real)));
        }
        assert!(!targets.push(stop(1e6)), "no room");
        assert_eq!(targets.len(), MAX_TARGETS);
    }
}
