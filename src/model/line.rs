//! What is the same in every step of a run: train, track, direction.

use super::direction::Direction;
use super::profile::UnderTrain;
use super::track::Track;
use super::train::Train;
use crate::Real;

/// What is the same in every step of a run: train, track, direction.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// The train.
    pub train: &'a Train,
    /// The track.
    pub track: &'a Track,
    /// Direction of travel.
    pub direction: Direction,
}

impl<'a> Line<'a> {
    /// Gravity's part of the resistance at a location, g(s) of Eq. (1), N/kg, uphill positive.
    pub fn gradient_n_per_kg(&self, location_m: Real) -> Real {
        self.train.gravity_n_per_kg_m() * self.under_train(location_m).rise_m()
    }

    #[inline(always)]
    pub(super) fn under_train(&self, location_m: Real) -> UnderTrain<'a> {
        UnderTrain::new(&self.track.profile, location_m, self.train.length_m(), self.direction)
    }
}
