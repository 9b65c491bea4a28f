//! Coast ahead: the speed and the time at the next target if the train coasts from here on.
//!
//! In: the estimate of a tick with its covariance, the track with its targets (stops, falls of the permitted speed), the effects that act. Out: a [`CoastAhead`].
//!
//! ```text
//! d(v²)/ds = -2 (r(v) + g(s) + X)        dt/ds = 1/v                      Eq. (1), (2) at no effort, over the way instead of over time
//! ```
//!
//! The gradient's part is a difference of heights under the train, exact whatever the steps; so a few steps of some hundred metres do (`way.rs`). Beside the mean they carry how v² and t at
//! the target answer to the speed here and to r0, r1, r2; with the estimate's covariance that gives the standard deviations, to which the noise of
//! the acceleration beyond the model (`learning.acceleration_noise_mps2`) adds on the way. r is that of the running run, so what is not known of the day's wind and load is in its covariance.
//!
//! A train that may stand before the target gets no speed there: [`Outcome::MayStop`], [`Outcome::Stops`]. What is not known well enough is [`Outcome::Unknown`]: a train that stands, an
//! invalid location or speed, a resistance that is not above 0, numbers that are none.
//!
//! Advice must stand still: [`Steady`] says when a prediction is another one.

mod outcome;
mod predict;
mod steady;
mod way;

pub use outcome::{Arrival, CoastAhead, NINETY_PERCENT, Outcome};
pub(crate) use predict::predict;
pub use steady::Steady;

use crate::Real;
use crate::tick::bounds::{ConfigError, between};
use serde::{Deserialize, Serialize};

/// How far ahead, and when a prediction is another one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CoastConfig {
    /// Furthest target, m. A train that coasts for longer is rare.
    pub horizon_m: Real,
    /// Standard deviation by which the mean wind along the way ahead differs from that so far, m/s: gusts of some minutes, woods and banks, the line's bends.
    pub wind_change_mps: Real,
    /// A prediction is published again when it moves the coasting point by more than this, m: where coasting must begin for the same speed at the target, on the level.
    pub coasting_point_m: Real,
    /// The same for the arrival at the target, s.
    pub arrival_s: Real,
}

impl Default for CoastConfig {
    fn default() -> Self {
        Self { horizon_m: 25e3, wind_change_mps: 0.3, coasting_point_m: 150.0, arrival_s: 3.0 }
    }
}

impl CoastConfig {
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        between("coast.horizon_m", self.horizon_m, 100.0, 1e5)?;
        between("coast.wind_change_mps", self.wind_change_mps, 0.0, 20.0)?;
        between("coast.coasting_point_m", self.coasting_point_m, 0.0, 1e5)?;
        between("coast.arrival_s", self.arrival_s, 0.0, 3600.0)
    }
}
