//! Unknown: something that no named effect explains, as a table over one coordinate.
//!
//! ```text
//! extra = table(coordinate)            linear between the points, constant outside
//! ```
//!
//! It acts against travel in either direction. Where the coordinate is not known (no temperature, no date) nothing is
//! added. Points are in single precision: the board keeps the table in RAM and flash, and 0.01 m at 100 km and 1e-9
//! N/kg are enough.

use super::parameters::Parameters;
use super::{EffectError, FrameError, Law, Moment, Situation};
use crate::Real;
use crate::listed::listed;
use crate::model::bounds::Range;
use crate::plain::plain;
use heapless::Vec;
use rundown_wire::{self as wire, EFFECT_VALUES};
use serde::{Deserialize, Serialize};

/// Most points of a table.
pub const MAX_POINTS: usize = 24;
/// No resistance of a train is larger, N/kg.
const MOST_N_PER_KG: f32 = 1.0;

/// What the resistance was found to depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Coordinate {
    /// 0: location of the front, m.
    Location,
    /// 1: speed, m/s.
    Speed,
    /// 2: time since the departure, s.
    Time,
    /// 3: ambient temperature, °C.
    Temperature,
    /// 4: date, as [`Moment::day`].
    Day,
}

plain! {
    enum Coordinate { Location, Speed, Time, Temperature, Day }
}

impl Coordinate {
    /// All, in the order of their numbers on the wire.
    pub const ALL: [Self; 5] = [Self::Location, Self::Speed, Self::Time, Self::Temperature, Self::Day];

    /// Its value at a moment, if it is known.
    pub const fn at(self, moment: &Moment) -> Option<Real> {
        match self {
            Self::Location => Some(moment.location_m),
            Self::Speed => Some(moment.speed_mps),
            Self::Time => Some(moment.since_departure_s),
            Self::Temperature => moment.temperature_c,
            Self::Day => moment.day,
        }
    }
}

/// None of the named effects: a table over one coordinate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unknown {
    /// What the table is over.
    pub coordinate: Coordinate,
    /// Points (coordinate, extra resistance in N/kg), the coordinate growing; 1 to [`MAX_POINTS`].
    pub table: Vec<(f32, f32), MAX_POINTS>,
}

plain! {
    struct Unknown { coordinate, table }
}

impl Unknown {
    /// Extra resistance in N/kg at a moment.
    ///
    /// ```
    /// use rundown::model::effects::{Coordinate, Moment, Unknown};
    ///
    /// let found = Unknown {
    ///     coordinate: Coordinate::Speed,
    ///     table: [(10.0, 0.0), (20.0, 2e-3), (40.0, 1e-3)].into_iter().collect(),
    /// };
    /// let at = |speed_mps| found.resistance_n_per_kg(&Moment { speed_mps, ..Moment::default() });
    /// assert_eq!(at(5.0), 0.0);
    /// assert!((at(15.0) - 1e-3).abs() < 1e-9);
    /// assert!((at(50.0) - 1e-3).abs() < 1e-9);
    /// ```
    pub fn resistance_n_per_kg(&self, moment: &Moment) -> Real {
        self.coordinate.at(moment).map_or(0.0, |at| self.interpolate(at))
    }

    /// The points are in order, and none of them is more than a train can have.
    pub(super) fn check(&self) -> Result<(), EffectError> {
        if self.table.is_empty() {
            return Err(EffectError::NoPoints);
        }
        let mut before = f32::NEG_INFINITY;
        for (index, &(at, n_per_kg)) in self.table.iter().enumerate() {
            // NaN is refused by each of these.
            let good = at > before && at.is_finite() && n_per_kg.abs() <= MOST_N_PER_KG;
            if !good {
                return Err(EffectError::Point { index });
            }
            before = at;
        }
        Ok(())
    }

    fn interpolate(&self, at: Real) -> Real {
        let mut before: Option<(Real, Real)> = None;
        for &(x, y) in &self.table {
            let (x, y) = (Real::from(x), Real::from(y));
            if at < x {
                return before.map_or(y, |(x0, y0)| y0 + (y - y0) * (at - x0) / (x - x0));
            }
            before = Some((x, y));
        }
        before.map_or(0.0, |(_, y)| y)
    }
}

impl Law for Unknown {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.moment)
    }
}

impl Parameters for Unknown {
    fn section_m(&self) -> Option<(Real, Real)> {
        None
    }

    /// A point of a table says of itself where it has to lie: see [`Unknown::check`].
    fn ranges(&self) -> &'static [Range] {
        &[]
    }

    /// A summary; its points are [`Effect::parts`](super::Effect::parts).
    fn values(&self) -> Vec<Real, EFFECT_VALUES> {
        let values = || self.table.iter().map(|(_, n_per_kg)| *n_per_kg);
        listed([
            Real::from(self.coordinate as u8),
            self.table.len() as Real,
            Real::from(values().fold(f32::INFINITY, f32::min)),
            Real::from(values().fold(f32::NEG_INFINITY, f32::max)),
        ])
    }

    /// A frame does not hold it.
    fn from_frame(_: &wire::Effect) -> Result<Self, FrameError> {
        Err(FrameError::UnknownKind)
    }
}
