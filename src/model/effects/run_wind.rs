//! Run wind: the wind along the line differs from run to run.
//!
//! ```text
//! wind of a run ~ N(0, sd²)            acts as steady_wind does, within its run
//! ```
//!
//! What it will be in a run to come nobody knows, so its known extra resistance is 0. What it says is how far a run may
//! differ from its vehicle: `sd_mps` takes the place of
//! [`MemoryConfig::wind_sd_mps`](crate::tick::memory::MemoryConfig::wind_sd_mps) in the two-level memory.

use super::{Law, RunWind};
use crate::Real;

impl RunWind {
    /// Standard deviation of its extra resistance at a speed, to first order, N/kg: 2 r2 v sd.
    ///
    /// ```
    /// use rundown::model::effects::RunWind;
    ///
    /// assert!((RunWind { sd_mps: 2.0 }.resistance_sd_n_per_kg(2.8e-5, 30.0) - 3.36e-3).abs() < 1e-15);
    /// ```
    pub fn resistance_sd_n_per_kg(&self, r2: Real, speed_mps: Real) -> Real {
        2.0 * r2 * speed_mps * self.sd_mps
    }
}

impl Law for RunWind {
    fn wind_between_runs_mps(&self) -> Option<Real> {
        Some(self.sd_mps)
    }
}
