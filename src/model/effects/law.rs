//! What the law of a kind of effect may change in the believed model.

use super::{Limits, Moment, share_inside};
use crate::Real;
use crate::model::line::Line;
use crate::model::resistance::Davis;

/// Where and when the train is, and what the model believes of train and track.
pub(super) struct Situation<'a> {
    /// The believed one.
    pub line: &'a Line<'a>,
    /// The coefficients that the model has at this moment, learned or described.
    pub davis: &'a Davis,
    pub moment: &'a Moment,
}

impl Situation<'_> {
    /// Share of the believed train between two locations.
    pub fn share_inside(&self, from_m: Real, to_m: Real) -> Real {
        share_inside(from_m, to_m, self.moment.location_m, self.line.train.length_m(), self.line.direction)
    }

    /// g / γ.
    pub fn gravity_n_per_kg(&self) -> Real {
        self.line.train.gravity_n_per_kg()
    }

    /// +1 for up.
    pub fn direction_sign(&self) -> Real {
        self.line.direction.sign()
    }
}

/// The law of a kind of effect. What it does not state, it leaves as it is.
pub(super) trait Law {
    /// Extra resistance against travel, N/kg.
    fn extra_n_per_kg(&self, _at: &Situation<'_>) -> Real {
        0.0
    }

    /// The slope of the extra resistance over the applied effort, in which it is linear.
    fn slope_over_effort(&self) -> Real {
        0.0
    }

    /// What is left of the limits of the train.
    fn limits_left(&self, limits: &Limits, _location_m: Real, _speed_mps: Real) -> Limits {
        *limits
    }

    /// Location and speed as they are, from the readings.
    fn corrected(&self, _direction_sign: Real, location_m: Real, speed_mps: Real) -> (Real, Real) {
        (location_m, speed_mps)
    }

    /// Standard deviation of the wind between runs, m/s, where it is stated.
    fn wind_between_runs_mps(&self) -> Option<Real> {
        None
    }
}
