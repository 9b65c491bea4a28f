//! What the frames share: the words of regime, cause and validity, and a value with its standard deviation.

use core::fmt;
use serde::{Deserialize, Serialize};

/// An enum whose values have a word for every output.
macro_rules! words {
    ($(#[$of_all:meta])* $name:ident { $($(#[$of_one:meta])* $value:ident $word:literal,)* }) => {
        $(#[$of_all])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[serde(rename_all = "snake_case")]
        pub enum $name {
            $($(#[$of_one])* $value,)*
        }

        impl $name {
            /// All of them, in the order of their frames, of counters and of arrays indexed by `as usize`.
            pub const ALL: [Self; [$($word),*].len()] = [$(Self::$value),*];

            /// The word used in every output.
            pub const fn as_str(self) -> &'static str {
                match self {
                    $(Self::$value => $word,)*
                }
            }
        }
    };
}
pub(crate) use words;

words! {
    /// What the driver does.
    #[derive(Default)]
    Regime {
        /// The train stands.
        #[default]
        Standstill "standstill",
        /// Effort applied to gain speed.
        Traction "traction",
        /// Effort applied to hold the speed.
        Cruise "cruise",
        /// No effort applied.
        Coast "coast",
        /// Brake applied.
        Brake "brake",
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

words! {
    /// Why a reading was not used, or an estimate is not valid.
    #[non_exhaustive]
    Cause {
        /// The location was not sent.
        NoLocation "no_location",
        /// The speed was not sent.
        NoSpeed "no_speed",
        /// Location not finite, or off the track.
        LocationOutOfRange "location_out_of_range",
        /// Speed not finite, negative or faster than any train.
        SpeedOutOfRange "speed_out_of_range",
        /// Location far from where the speed leads.
        LocationJump "location_jump",
        /// Speed changed faster than a train can.
        SpeedJump "speed_jump",
        /// Speed stays the same while the location says otherwise.
        StuckSpeed "stuck_speed",
        /// Location stays the same while the train runs.
        StuckLocation "stuck_location",
        /// The train runs against its direction of travel.
        Reversing "reversing",
        /// Locations that the speed does not lead to agreed with each other: the location was reset to them.
        Contradiction "contradiction",
        /// No measurement for so long that location and speed were reset.
        LongGap "long_gap",
        /// The covariance was repaired.
        Numerics "numerics",
    }
}

/// A value and its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Value {
    /// The value.
    pub value: f32,
    /// Its standard deviation.
    pub sd: f32,
}
