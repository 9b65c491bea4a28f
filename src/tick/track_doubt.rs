//! How far the described gradients may be off.
//!
//! In: the standard deviation of a gradient, and over which length errors of neighbouring gradients are one. Out: the density of the acceleration that follows from it.
//!
//! A coasting train takes the error of the gradient for resistance. Passing through errors of standard deviation σ that are alike over L, its mean
//! acceleration over a distance D is off by g σ √(2 L / D): white noise of the density
//!
//! ```text
//! S = 2 L (g σ)² / v          m²/s³; with γ of the rotating masses g/γ
//! ```
//!
//! The runs over a line share it, so more runs do not average it: what earlier runs said is forgotten by the share that it has in what is not known
//! ([`Vehicle::learn`](crate::tick::memory::Vehicle::learn)).

use crate::Real;
use crate::tick::bounds::settings;

/// Below, S would grow without a bound, m/s.
const SLOWEST_MPS: Real = 3.0;

settings! {
    /// How far the described gradients may be off.
    TrackDoubtConfig in "track_doubt" {
        /// Standard deviation of a described gradient, permille; of every gradient where none is described.
        gradient_sd_permille: Real = 0.0, 0.0 to 100.0;
        /// Length over which errors of gradients are alike, m.
        alike_m: Real = 500.0, 1.0 to 1e5;
    }
}

impl TrackDoubtConfig {
    /// Spectral density of the acceleration by unknown gradients, m²/s³. `gravity_n_per_kg`: force along the line per gradient of 1, N/kg.
    #[inline(never)]
    pub fn density(&self, gravity_n_per_kg: Real, speed_mps: Real) -> Real {
        if self.gradient_sd_permille == 0.0 {
            return 0.0;
        }
        let sd = self.sd_n_per_kg(gravity_n_per_kg);
        2.0 * self.alike_m * sd * sd / speed_mps.max(SLOWEST_MPS)
    }

    /// Standard deviation of the mean force of the gradients over a time, N/kg.
    #[inline(never)]
    pub fn mean_sd_n_per_kg(&self, gravity_n_per_kg: Real, speed_mps: Real, time_s: Real) -> Real {
        let density = self.density(gravity_n_per_kg, speed_mps);
        if density > 0.0 { libm::sqrt(density / time_s).min(self.sd_n_per_kg(gravity_n_per_kg)) } else { 0.0 }
    }

    /// Standard deviation of the force of one gradient, N/kg.
    pub fn sd_n_per_kg(&self, gravity_n_per_kg: Real) -> Real {
        1e-3 * self.gradient_sd_permille * gravity_n_per_kg
    }
}
