//! What a prediction says.

use crate::Real;
use crate::model::point::Point;
use crate::model::track::Target;
use crate::plain::{Bytes, Plain, plain};

/// Standard deviations of a 90 % interval to either side.
pub const NINETY_PERCENT: Real = 1.645;

/// What coasting from here leads to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoastAhead {
    /// Time, location and speed that it begins with.
    pub from: Point,
    /// The next stop or fall of the permitted speed within the horizon, with the speed permitted behind it.
    pub target: Option<Target>,
    /// What becomes of the train.
    pub outcome: Outcome,
}

plain! {
    struct CoastAhead { from, target, outcome }
}

/// What becomes of a train that coasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The train stands, or its state is not known well enough.
    Unknown,
    /// No target within the horizon.
    NoTarget,
    /// It reaches the target.
    Arrives(Arrival),
    /// It may reach the target or stand before it: both lie within the 90 % interval.
    MayStop,
    /// It stands before the target.
    Stops {
        /// Where, m.
        location_m: Real,
        /// Its standard deviation, m.
        sd_m: Real,
    },
}

impl Plain for Outcome {
    const START: Self = Self::Unknown;

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        let now = match self {
            Self::Unknown => 0,
            Self::NoTarget => 1,
            Self::Arrives(_) => 2,
            Self::MayStop => 3,
            Self::Stops { .. } => 4,
        };
        let chosen = bytes.choice(now, 5);
        if bytes.are_read() {
            *self = match chosen {
                1 => Self::NoTarget,
                2 => Self::Arrives(Plain::START),
                3 => Self::MayStop,
                4 => Self::Stops { location_m: 0.0, sd_m: 0.0 },
                _ => Self::Unknown,
            };
        }
        match self {
            Self::Arrives(arrival) => arrival.pass(bytes),
            Self::Stops { location_m, sd_m } => {
                location_m.pass(bytes);
                sd_m.pass(bytes);
            }
            Self::Unknown | Self::NoTarget | Self::MayStop => {}
        }
    }
}

/// At the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Speed, m/s.
    pub speed_mps: Real,
    /// Its standard deviation, m/s.
    pub speed_sd_mps: Real,
    /// Time, s.
    pub time_s: Real,
    /// Its standard deviation, s.
    pub time_sd_s: Real,
    /// How much speed at the target a metre is worth by which coasting begins later, (m/s)/m, on the level.
    pub speed_per_m: Real,
}

plain! {
    struct Arrival { speed_mps, speed_sd_mps, time_s, time_sd_s, speed_per_m }
}
