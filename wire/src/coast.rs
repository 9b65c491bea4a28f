//! What coasting from here leads to, as a driver advisory needs it: the speed and the time at the next place that asks
//! for a lower speed.

use crate::words::Value;
use serde::{Deserialize, Serialize};

/// The prediction and where it begins. Sent when it has moved by more than the configuration allows, and once a minute
/// as it was sent last.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoastAhead {
    /// Time of the estimate that it begins with, s, on the sender's clock.
    pub from_time_s: f64,
    /// Location there, m.
    pub from_location_m: f32,
    /// Speed there, m/s.
    pub from_speed_mps: f32,
    /// The next stop or fall of the permitted speed, if there is one within the horizon.
    pub target: Option<CoastTarget>,
    /// What becomes of the train.
    pub outcome: CoastOutcome,
}

/// A place that asks for a lower speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoastTarget {
    /// Location, m.
    pub at_m: f32,
    /// Speed permitted behind it, m/s; none: a stop.
    pub limit_mps: Option<f32>,
}

/// What becomes of a train that coasts from here on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CoastOutcome {
    /// The train stands, or its state is not known well enough: what was said before no longer holds.
    #[default]
    Unknown,
    /// No target within the horizon.
    NoTarget,
    /// It reaches the target.
    Arrives(CoastArrival),
    /// It may reach the target or stand before it: both lie within the 90 % interval.
    MayStop,
    /// It stands before the target, here.
    Stops(Value),
}

impl CoastOutcome {
    /// The word used in every output.
    pub const fn as_str(&self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::NoTarget => "no_target",
            Self::Arrives(_) => "arrives",
            Self::MayStop => "may_stop",
            Self::Stops(_) => "stops",
        }
    }
}

/// Speed and time at the target. A 90 % interval is 1.645 standard deviations to either side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoastArrival {
    /// Speed, m/s.
    pub speed_mps: Value,
    /// Time, s, on the sender's clock.
    pub time_s: f64,
    /// Its standard deviation, s.
    pub time_sd_s: f32,
}
