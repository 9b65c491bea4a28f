//! How far the described gradients may be off.
//!
//! In: the standard deviation of a gradient, and over which length errors of neighbouring gradients are one. Out: the
//! density of the acceleration that follows from it.
//!
//! A coasting train takes the error of the gradient for resistance. Passing through errors of standard deviation σ that
//! are alike over L, its mean acceleration over a distance D is off by g σ √(2 L / D): white noise of the density
//!
//! ```text
//! S = 2 L (g σ)² / v          m²/s³; with γ of the rotating masses g/γ
//! ```
//!
//! Within a kilometre of the ends of a line σ is twice as large: platforms and sidings have slopes of their own, and
//! the gradient at the edge of a description is often one that was carried on.
//!
//! The runs over a line share it, so more runs do not average it: what earlier runs said is forgotten by the share that
//! it has in what is not known ([`Vehicle::learn`](crate::tick::memory::Vehicle::learn)).

use crate::Real;
use crate::extremes::Extremes;
use crate::model::line::Line;
use crate::tick::bounds::settings;

/// Below, S would grow without a bound, m/s.
const SLOWEST_MPS: Real = 3.0;
/// This close to an end of the line, m ...
const ENDS_M: Real = 1000.0;
/// ... the standard deviation is so many times as large. A judgement.
const AT_ENDS: Real = 2.0;

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
    /// Spectral density of the acceleration by unknown gradients where a train is, m²/s³.
    #[inline(never)]
    pub fn density(&self, line: &Line<'_>, location_m: Real, speed_mps: Real) -> Real {
        if self.gradient_sd_permille == 0.0 {
            return 0.0;
        }
        let sd = self.sd_n_per_kg(line, location_m);
        2.0 * self.alike_m * sd * sd / speed_mps.at_least(SLOWEST_MPS)
    }

    /// Standard deviation of the mean force of the gradients over a time, N/kg.
    #[inline(never)]
    pub fn mean_sd_n_per_kg(&self, line: &Line<'_>, location_m: Real, speed_mps: Real, time_s: Real) -> Real {
        let density = self.density(line, location_m, speed_mps);
        if density > 0.0 {
            crate::roots::square_root(density / time_s).at_most(self.sd_n_per_kg(line, location_m))
        } else {
            0.0
        }
    }

    /// Standard deviation of the force of one gradient, N/kg.
    fn sd_n_per_kg(&self, line: &Line<'_>, location_m: Real) -> Real {
        let is_inside = (ENDS_M..=line.track.length_m() - ENDS_M).contains(&location_m);
        let times = if is_inside { 1.0 } else { AT_ENDS };
        1e-3 * times * self.gradient_sd_permille * line.train.gravity_n_per_kg()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::direction::Direction;
    use crate::model::track::Track;
    use crate::model::train::{Train, TrainDescription};

    #[test]
    fn gradients_are_known_worse_at_the_ends_of_a_line_and_well_where_nothing_is_doubted() {
        let (train, track) = (Train::try_new(TrainDescription::CASE_STUDY).unwrap(), Track::try_new(10e3, []).unwrap());
        let line = Line { train: &train, track: &track, direction: Direction::Up };
        let doubt = TrackDoubtConfig { gradient_sd_permille: 2.0, ..TrackDoubtConfig::default() };
        let inside = doubt.density(&line, 5e3, 20.0);
        for (location_m, times) in [(-100.0, 4.0), (999.0, 4.0), (1001.0, 1.0), (8999.0, 1.0), (9001.0, 4.0)] {
            let ratio = doubt.density(&line, location_m, 20.0) / inside;
            assert!((ratio - times).abs() < 1e-12, "{ratio} at {location_m} m");
        }
        assert_eq!(TrackDoubtConfig::default().density(&line, 0.0, 20.0), 0.0);
    }
}
