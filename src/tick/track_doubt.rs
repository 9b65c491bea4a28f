//! How far the described gradients may be off.
//!
//! In: the standard deviation of a gradient, more at the ends of the line, and over which length errors of neighbouring gradients are one. Out: the density of the
//! acceleration that follows from it.
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
        /// The same beside it where the line begins and ends, permille: platforms and sidings are seldom described.
        ends_sd_permille: Real = 0.0, 0.0 to 100.0;
        /// So far from either end of the line, m.
        ends_m: Real = 1000.0, 0.0 to 1e5;
    }
}

impl TrackDoubtConfig {
    /// Spectral density of the acceleration by unknown gradients at a place of the line, m²/s³. `gravity_n_per_kg`: force along the line per gradient of 1, N/kg.
    #[inline(never)]
    pub fn density(&self, gravity_n_per_kg: Real, speed_mps: Real, place: &Place) -> Real {
        let sd = self.sd_n_per_kg(gravity_n_per_kg, place);
        if sd == 0.0 {
            return 0.0;
        }
        2.0 * self.alike_m * sd * sd / speed_mps.max(SLOWEST_MPS)
    }

    /// Standard deviation of the mean force of the gradients over a time, N/kg.
    #[inline(never)]
    pub fn mean_sd_n_per_kg(&self, gravity_n_per_kg: Real, speed_mps: Real, time_s: Real, place: &Place) -> Real {
        let density = self.density(gravity_n_per_kg, speed_mps, place);
        if density > 0.0 { libm::sqrt(density / time_s).min(self.sd_n_per_kg(gravity_n_per_kg, place)) } else { 0.0 }
    }

    /// Standard deviation of the force of one gradient, N/kg.
    fn sd_n_per_kg(&self, gravity_n_per_kg: Real, place: &Place) -> Real {
        let at_the_end = place.at_m < self.ends_m || place.at_m > place.length_m - self.ends_m;
        let permille = match at_the_end && self.ends_sd_permille > 0.0 {
            true => libm::hypot(self.gradient_sd_permille, self.ends_sd_permille),
            false => self.gradient_sd_permille,
        };
        1e-3 * permille * gravity_n_per_kg
    }
}

/// A place of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Location, m.
    pub at_m: Real,
    /// Length of the line, m.
    pub length_m: Real,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_doubt_is_larger_at_the_ends_of_a_line() {
        let config = TrackDoubtConfig {
            gradient_sd_permille: 3.0,
            ends_sd_permille: 4.0,
            ends_m: 800.0,
            ..TrackDoubtConfig::default()
        };
        let sd = |at_m| config.sd_n_per_kg(10.0, &Place { at_m, length_m: 9000.0 });
        assert_eq!([-50.0, 799.0, 8201.0, 9100.0].map(sd), [0.05; 4]);
        assert_eq!([801.0, 4500.0, 8199.0].map(sd), [0.03; 3]);
    }
}
