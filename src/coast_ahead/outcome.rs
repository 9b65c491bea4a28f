//! What a prediction says.

use crate::Real;
use crate::model::point::Point;
use crate::model::track::Target;
use serde::{Deserialize, Serialize};

/// Standard deviations of a 90 % interval to either side.
pub const NINETY_PERCENT: Real = 1.645;

/// What coasting from here leads to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoastAhead {
    /// Time, location and speed that it begins with.
    pub from: Point,
    /// The next stop or fall of the permitted speed within the horizon, with the speed permitted behind it.
    pub target: Option<Target>,
    /// What becomes of the train.
    pub outcome: Outcome,
}

/// What becomes of a train that coasts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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

/// At the target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
