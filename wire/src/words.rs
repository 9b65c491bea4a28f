//! Words that the board and the display share: regime, cause, validity.

use core::fmt;
use serde::{Deserialize, Serialize};

/// What the driver does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Regime {
    /// The train stands.
    #[default]
    Standstill,
    /// Effort applied to gain speed.
    Traction,
    /// Effort applied to hold the speed.
    Cruise,
    /// No effort applied.
    Coast,
    /// Brake applied.
    Brake,
}

impl Regime {
    /// All regimes, in the order of their frames and of arrays indexed by `as usize`.
    pub const ALL: [Self; 5] = [Self::Standstill, Self::Traction, Self::Cruise, Self::Coast, Self::Brake];

    /// The word used in every output.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Standstill => "standstill",
            Self::Traction => "traction",
            Self::Cruise => "cruise",
            Self::Coast => "coast",
            Self::Brake => "brake",
        }
    }
}

impl fmt::Display for Regime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// How far an estimate may be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Validity {
    /// Location and speed were measured and agree.
    #[default]
    Valid,
    /// A reading is missing or was not believed; its value is carried on from before.
    Held(Cause),
    /// Too long without a believable reading, or the readings contradict each other.
    Invalid(Cause),
}

impl Validity {
    /// The word used in every output: `valid`, `held` or `invalid`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Valid => "valid",
            Self::Held(_) => "held",
            Self::Invalid(_) => "invalid",
        }
    }

    /// Why it is not valid.
    pub const fn cause(self) -> Option<Cause> {
        match self {
            Self::Valid => None,
            Self::Held(cause) | Self::Invalid(cause) => Some(cause),
        }
    }
}

/// Why a reading was not used, or an estimate is not valid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The location was not sent.
    NoLocation,
    /// The speed was not sent.
    NoSpeed,
    /// Location not finite, or off the track.
    LocationOutOfRange,
    /// Speed not finite, negative or faster than any train.
    SpeedOutOfRange,
    /// Location far from where the speed leads.
    LocationJump,
    /// Speed changed faster than a train can.
    SpeedJump,
    /// Speed stays the same while the location says otherwise.
    StuckSpeed,
    /// Location stays the same while the train runs.
    StuckLocation,
    /// The train runs against its direction of travel.
    Reversing,
    /// Locations that the speed does not lead to agreed with each other: the location was taken up anew.
    Contradiction,
    /// No measurement for so long that location and speed were taken up anew.
    LongGap,
    /// The covariance was repaired.
    Numerics,
}

impl Cause {
    /// All causes, in the order of the counters.
    pub const ALL: [Self; 12] = [
        Self::NoLocation,
        Self::NoSpeed,
        Self::LocationOutOfRange,
        Self::SpeedOutOfRange,
        Self::LocationJump,
        Self::SpeedJump,
        Self::StuckSpeed,
        Self::StuckLocation,
        Self::Reversing,
        Self::Contradiction,
        Self::LongGap,
        Self::Numerics,
    ];

    /// The word used in every output.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::NoLocation => "no_location",
            Self::NoSpeed => "no_speed",
            Self::LocationOutOfRange => "location_out_of_range",
            Self::SpeedOutOfRange => "speed_out_of_range",
            Self::LocationJump => "location_jump",
            Self::SpeedJump => "speed_jump",
            Self::StuckSpeed => "stuck_speed",
            Self::StuckLocation => "stuck_location",
            Self::Reversing => "reversing",
            Self::Contradiction => "contradiction",
            Self::LongGap => "long_gap",
            Self::Numerics => "numerics",
        }
    }
}
