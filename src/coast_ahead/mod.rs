//! Coast ahead: the speed and the time at the next target if the train coasts from here on.
//!
//! In: the estimate of a tick with its covariance, the track with its targets (stops, falls of the permitted speed),
//! the effects that act. Out: a [`CoastAhead`].
//!
//! ```text
//! d(v²)/ds = -2 (r(v) + g(s) + X)        dt/ds = 1/v                      Eq. (1), (2) at no effort, over distance instead of over time
//! ```
//!
//! The gradient's part is a difference of heights under the train, exact whatever the steps; so a few steps of some
//! hundred metres do (`way.rs`). Beside the mean they carry how v² and t at the target answer to the speed here and to
//! r0, r1, r2; with the estimate's covariance that gives the standard deviations, to which the noise of the
//! acceleration beyond the model (`learning.acceleration_noise_mps2`) adds over the distance. r is that of the running
//! run, so what is not known of the day's wind and load is in its covariance.
//!
//! A train that may stand before the target gets no speed there: [`Outcome::MayStop`], [`Outcome::Stops`]. What is not
//! known well enough is [`Outcome::Unknown`]: a train that stands, an invalid location or speed, a resistance that is
//! not above 0, numbers that are none.
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
use crate::tick::bounds::settings;

settings! {
    /// How far ahead, and when a prediction is another one.
    CoastConfig in "coast" {
        /// Furthest target, m. A train that coasts for longer is rare.
        horizon_m: Real = 25e3, 100.0 to 1e5;
        /// Standard deviation by which the mean wind along the line ahead differs from that so far, m/s: gusts of some
        /// minutes, woods and banks, the line's bends.
        wind_change_mps: Real = 0.3, 0.0 to 20.0;
        /// A prediction is published again when it moves the coasting point by more than this, m: where coasting must
        /// begin for the same speed at the target, on the level.
        coasting_point_m: Real = 150.0, 0.0 to 1e5;
        /// The same for the arrival at the target, s.
        arrival_s: Real = 3.0, 0.0 to 3600.0;
    }
}
