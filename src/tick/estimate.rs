//! What one tick says: the estimate with its standard deviations, its regime, and how far it may be trusted.

use crate::Real;
use crate::filter::gaussian::Gaussian;
use crate::filter::ukf::Innovation;
use crate::model::resistance::Davis;
use crate::model::state::{self, SIZE};
use crate::plain::plain;
use crate::tick::regime::Regime;
pub use rundown_wire::{Cause, Validity};
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
    /// Applied effort, N/kg, traction positive, brake negative: mean since the last measurement; in the `paper` mode
    /// since the last speed, and held where there is none.
    pub effort_n_per_kg: Option<Real>,
    /// Acceleration, m/s²: mean since the last measurement; in the `paper` mode that of the filtered speed since the
    /// last speed that was read.
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

/// How often each cause occurred in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    counts: [u32; Cause::ALL.len()],
    /// Measurements dropped because their time did not increase.
    pub time_not_increasing: u32,
}

plain! {
    struct Counters { counts, time_not_increasing }
}

impl Counters {
    /// Nothing has occurred.
    pub const ZEROED: Self = Self { counts: [0; Cause::ALL.len()], time_not_increasing: 0 };

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
