//! What one tick says: the estimate with its standard deviations, its regime, and how far it may be trusted.

use crate::Real;
use crate::regime::Regime;
use crate::resistance::Davis;
use crate::state::{self, Gaussian, SIZE};
use crate::ukf::Innovation;
use serde::{Deserialize, Serialize};

/// The answer to one measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Time of the measurement, s.
    pub time_s: Real,
    /// Time since the last accepted measurement, s; 0 at the first one.
    pub dt_s: Real,
    /// State (s, v, r0, r1, r2) and its covariance, this run's train.
    pub belief: Gaussian<SIZE>,
    /// Applied effort, N/kg, traction positive, brake negative: mean since the last measurement.
    pub effort_n_per_kg: Option<Real>,
    /// Acceleration, m/s²: mean since the last measurement.
    pub acceleration_mps2: Option<Real>,
    /// Resistance of the gradient under the train, N/kg, uphill positive.
    pub gradient_n_per_kg: Real,
    /// Regime as far as it is known at this tick.
    pub regime: Regime,
    /// Regime of the tick before, now that one more sample is known.
    pub confirmed: Option<Regime>,
    /// The resistance was learned from this measurement.
    pub learning: bool,
    /// Measured minus expected (location, speed), when something was expected.
    pub innovation: Option<Innovation<2>>,
    /// How far location and speed may be trusted.
    pub validity: Validity,
}

impl Estimate {
    /// The Davis coefficients of this run's train.
    pub fn davis(&self) -> Davis {
        state::davis(&self.belief.mean)
    }
}

/// How far an estimate may be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
    /// Location and speed contradict each other in another way.
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

/// How often each cause occurred in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    counts: [u32; Cause::ALL.len()],
    /// Measurements dropped because their time did not increase.
    pub time_not_increasing: u32,
}

impl Counters {
    /// Adds one.
    pub fn count(&mut self, cause: Cause) {
        let index = cause as usize;
        if let Some(count) = self.counts.get_mut(index) {
            *count = count.saturating_add(1);
        }
    }

    /// How often `cause` occurred.
    pub fn of(&self, cause: Cause) -> u32 {
        self.counts.get(cause as usize).copied().unwrap_or(0)
    }

    /// All causes with their counts.
    pub fn iter(&self) -> impl Iterator<Item = (Cause, u32)> + '_ {
        Cause::ALL.into_iter().zip(self.counts)
    }
}
