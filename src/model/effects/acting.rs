//! The effects at work in a run: their extra resistance wherever the estimator asks for a resistance.
//!
//! In: the effects, and what the run knows beside its motion ([`Journey`]). Out: extra resistance at a point, and what
//! effort a resultant asks for.
//!
//! ```text
//! X = Σ extra (location, speed, effort, time, ...)           at the mean of the belief, the same for all sigma points
//! ```
//!
//! So the effects move the mean and add no slope to the covariance: that they damp a speed error (2 k v for a tunnel)
//! or change with an uncertain location is left out. `host-tests/tests/effects.rs` measures what it costs: 0.015 % of
//! r(v) for a tunnel that adds a third to r2 all along the line.

use super::{Effects, Moment};
use crate::Real;
use crate::extremes::Extremes;
use crate::model::line::Line;
use crate::model::point::Point;
use crate::model::resistance::Davis;
use crate::model::train::Train;
use crate::plain::plain;
use serde::{Deserialize, Serialize};

/// A train that is faster than this moves, m/s.
const MOVING_MPS: Real = 0.5;

/// What nobody measures on the train itself. What was sent holds until it is sent again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Surroundings {
    /// Ambient temperature, °C.
    pub temperature_c: Option<Real>,
    /// Date, days since 1970-01-01 UTC, or on any calendar that all effects of the model use.
    pub day: Option<Real>,
}

plain! {
    struct Surroundings { temperature_c, day }
}

impl Surroundings {
    /// Whether a train can meet them: -60 to 80 °C, a date within a million days of the origin. No number is neither.
    pub fn are_plausible(&self) -> bool {
        let within =
            |value: Option<Real>, low: Real, high: Real| value.is_none_or(|value| (low..=high).contains(&value));
        within(self.temperature_c, -60.0, 80.0) && within(self.day, -1e6, 1e6)
    }
}

/// What the effects need to know of a run beside its motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Journey {
    /// Last time before the train first moved, s; of the first measurement if it moved already.
    departure_s: Option<Real>,
    departed: bool,
    braked: bool,
    /// Since when it stands at a stop on the way, s.
    standing_since_s: Option<Real>,
    /// How long it stood at the last one, or stands there, s.
    stood_s: Option<Real>,
    pub(crate) surroundings: Surroundings,
}

plain! {
    struct Journey { departure_s, departed, braked, standing_since_s, stood_s, surroundings }
}

impl Journey {
    /// Zeros, as by default.
    pub(crate) const ZEROED: Self = Self {
        departure_s: None,
        departed: false,
        braked: false,
        standing_since_s: None,
        stood_s: None,
        surroundings: Surroundings { temperature_c: None, day: None },
    };

    /// A new run in the same surroundings.
    pub(crate) fn begin(&mut self) {
        *self = Self { surroundings: self.surroundings, ..Self::default() };
    }

    /// A measurement, before it is worked with.
    pub(crate) fn measured(&mut self, time_s: Real, speed_mps: Option<Real>) {
        let Some(moving) = speed_mps.map(|speed_mps| speed_mps > MOVING_MPS) else {
            return;
        };
        if !self.departed {
            self.departed = moving;
            if self.departure_s.is_none() || !moving {
                self.departure_s = Some(time_s);
            }
        } else if moving {
            self.standing_since_s = None;
        } else {
            self.stood_s = Some(time_s - *self.standing_since_s.get_or_insert(time_s));
        }
    }

    /// A brake application is certain.
    pub(crate) fn brake(&mut self) {
        self.braked |= self.departed;
    }

    fn since_departure_s(&self, time_s: Real) -> Real {
        self.departure_s.filter(|_| self.departed).map_or(0.0, |departure_s| (time_s - departure_s).at_least(0.0))
    }
}

/// The effects of a model in a run.
#[derive(Clone, Copy, Debug)]
pub struct Acting<'a> {
    effects: &'a Effects,
    journey: Journey,
}

impl<'a> Acting<'a> {
    /// At a tick of a run.
    pub const fn new(effects: &'a Effects, journey: Journey) -> Self {
        Self { effects, journey }
    }

    /// There are none.
    pub fn is_empty(&self) -> bool {
        self.effects.is_empty()
    }

    /// Extra resistance at a point, N/kg, under this effort per believed γ m; exactly 0 without effects.
    pub fn extra_n_per_kg(&self, line: &Line<'_>, davis: &Davis, at: &Point, effort_n_per_kg: Real) -> Real {
        if self.effects.is_empty() {
            return 0.0;
        }
        let moment = Moment {
            location_m: at.location_m,
            speed_mps: at.speed_mps.at_least(0.0),
            effort_n_per_kg,
            since_departure_s: self.journey.since_departure_s(at.time_s),
            stood_s: self.journey.stood_s,
            braked: self.journey.braked,
            temperature_c: self.journey.surroundings.temperature_c,
            day: self.journey.surroundings.day,
        };
        self.effects.resistance_n_per_kg(line, davis, &moment)
    }

    /// See [`Effects::limits_n_per_kg`].
    pub fn limits_n_per_kg(&self, train: &Train, location_m: Real, speed_mps: Real) -> (Real, Real) {
        self.effects.limits_n_per_kg(train, location_m, speed_mps)
    }

    /// Applied effort, per believed γ m, of a resultant; see [`Effects::effort_n_per_kg`].
    pub fn effort_n_per_kg(&self, resultant_n_per_kg: Real) -> Real {
        if self.effects.is_empty() {
            return resultant_n_per_kg;
        }
        self.effects.effort_n_per_kg(resultant_n_per_kg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_of_a_run_begins_when_the_train_moves() {
        let mut journey = Journey::default();
        for (time_s, speed_mps, since_s) in [
            (100.0, Some(0.0), 0.0),
            (110.0, None, 0.0),
            (120.0, Some(0.0), 0.0),
            (130.0, Some(3.0), 10.0),
            (200.0, Some(0.0), 80.0),
        ] {
            journey.measured(time_s, speed_mps);
            assert_eq!(journey.since_departure_s(time_s), since_s, "{time_s}");
        }
        let mut under_way = Journey::default();
        under_way.measured(50.0, Some(30.0));
        assert_eq!(under_way.since_departure_s(60.0), 10.0);
    }

    #[test]
    fn stops_on_the_way_are_timed_and_what_was_before_the_run_is_not() {
        let mut journey = Journey::default();
        for (time_s, speed_mps, stood_s) in [
            (0.0, Some(0.0), None),
            (600.0, Some(0.0), None),
            (610.0, Some(5.0), None),
            (700.0, Some(0.0), Some(0.0)),
            (710.0, None, Some(0.0)),
            (730.0, Some(0.1), Some(30.0)),
            (740.0, Some(4.0), Some(30.0)),
            (900.0, Some(0.0), Some(0.0)),
        ] {
            journey.measured(time_s, speed_mps);
            assert_eq!(journey.stood_s, stood_s, "{time_s}");
        }
        journey.begin();
        assert_eq!(journey.stood_s, None);
    }

    #[test]
    fn a_brake_counts_from_the_departure_and_a_new_run_forgets_it() {
        let mut journey = Journey::default();
        journey.surroundings.day = Some(7.0);
        journey.brake();
        assert!(!journey.braked);
        journey.measured(0.0, Some(3.0));
        journey.brake();
        assert!(journey.braked);
        journey.begin();
        assert!(!journey.braked && !journey.departed);
        assert_eq!(journey.surroundings.day, Some(7.0));
    }
}
