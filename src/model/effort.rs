//! Applied effort, calculated from the change of speed.
//!
//! In: two speeds, the Davis coefficients, the track below the train. Out: effort per mass in N/kg, traction positive,
//! brake negative.
//!
//! ```text
//! u = (v[k] - v[j]) / Δt + r(v) + g(s) + X         Eq. (1) solved for u; X of the named effects
//! ```
//!
//! The paper takes r and g at the end of the interval ([`of_paper`]); the other modes take their mean over it
//! ([`over_interval`]), and where it is compared with what an effort column says, in short steps ([`over_steps`]).

use crate::Real;
use crate::model::effects::Acting;
use crate::model::line::Line;
use crate::model::pieces::pieces;
use crate::model::point::Point;
use crate::model::resistance::Davis;

/// Effort and what it is made of, means over an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Applied effort, N/kg.
    pub effort_n_per_kg: Real,
    /// Acceleration, m/s².
    pub acceleration_mps2: Real,
    /// Running resistance, gradient, and effects at no effort, N/kg.
    pub resistance_n_per_kg: Real,
}

/// The paper's: acceleration of the readings, resistance and gradient at the filtered state.
pub fn of_paper(line: &Line<'_>, acting: &Acting<'_>, davis: &Davis, acceleration_mps2: Real, at: &Point) -> Real {
    let resultant = acceleration_mps2 + davis.resistance_n_per_kg(at.speed_mps) + line.gradient_n_per_kg(at.location_m);
    acting.effort_n_per_kg(resultant + acting.extra_n_per_kg(line, davis, at, 0.0))
}

/// Means over the interval from `from` to `to`, at an even acceleration and in steps of at most `step_s`.
/// [`over_interval`] sees slopes that change within 10 s at three places only: on lines of 25 to 40 permille the speed
/// that it expects was up to 0.4 m/s off.
pub fn over_steps(
    line: &Line<'_>,
    acting: &Acting<'_>,
    davis: &Davis,
    [from, to]: [&Point; 2],
    step_s: Real,
) -> Effort {
    let interval_s = to.time_s - from.time_s;
    let count = pieces(interval_s, step_s, MOST_STEPS);
    let steps = Real::from(count);
    let mean_mps = 0.5 * (from.speed_mps + to.speed_mps);
    let at = |step: Real| {
        let share = step / steps;
        let speed_mps = from.speed_mps + share * (to.speed_mps - from.speed_mps);
        // Of the way; as that of the time where the train stands.
        let run = if mean_mps > 0.0 { share * 0.5 * (from.speed_mps + speed_mps) / mean_mps } else { share };
        Point {
            time_s: from.time_s + share * interval_s,
            location_m: from.location_m + run * (to.location_m - from.location_m),
            speed_mps,
        }
    };
    let mut begin = Spot::new(line, acting, davis, *from);
    let (mut effort_n_per_kg, mut resistance_n_per_kg) = (0.0, 0.0);
    for step in 1..=count {
        let end = Spot::new(line, acting, davis, at(step.into()));
        let effort = between(line, acting, davis, [&begin, &end]);
        effort_n_per_kg += effort.effort_n_per_kg;
        resistance_n_per_kg += effort.resistance_n_per_kg;
        begin = end;
    }
    Effort {
        effort_n_per_kg: effort_n_per_kg / steps,
        acceleration_mps2: (to.speed_mps - from.speed_mps) / interval_s,
        resistance_n_per_kg: resistance_n_per_kg / steps,
    }
}

/// Of an interval that has no length to speak of.
const MOST_STEPS: u32 = 100;

/// Means over the interval from `from` to `to`, which is later; gradient and effects by Simpson's rule.
pub fn over_interval(line: &Line<'_>, acting: &Acting<'_>, davis: &Davis, from: &Point, to: &Point) -> Effort {
    let [from, to] = [from, to].map(|at| Spot::new(line, acting, davis, *at));
    between(line, acting, davis, [&from, &to])
}

/// A point, and the resistance there of all but the train itself, N/kg.
#[derive(Clone, Copy)]
struct Spot {
    at: Point,
    outside_n_per_kg: Real,
}

impl Spot {
    fn new(line: &Line<'_>, acting: &Acting<'_>, davis: &Davis, at: Point) -> Self {
        let gradient_n_per_kg = line.gradient_n_per_kg(at.location_m);
        Self { at, outside_n_per_kg: gradient_n_per_kg + acting.extra_n_per_kg(line, davis, &at, 0.0) }
    }
}

fn between(line: &Line<'_>, acting: &Acting<'_>, davis: &Davis, [from, to]: [&Spot; 2]) -> Effort {
    let acceleration_mps2 = (to.at.speed_mps - from.at.speed_mps) / (to.at.time_s - from.at.time_s);
    let midway = Point {
        time_s: 0.5 * (from.at.time_s + to.at.time_s),
        location_m: 0.5 * (from.at.location_m + to.at.location_m),
        speed_mps: 0.5 * (from.at.speed_mps + to.at.speed_mps),
    };
    let midway = Spot::new(line, acting, davis, midway);
    let outside_n_per_kg = (from.outside_n_per_kg + 4.0 * midway.outside_n_per_kg + to.outside_n_per_kg) / 6.0;
    let resistance_n_per_kg = davis.resistance_n_per_kg(midway.at.speed_mps) + outside_n_per_kg;
    Effort {
        effort_n_per_kg: acting.effort_n_per_kg(acceleration_mps2 + resistance_n_per_kg),
        acceleration_mps2,
        resistance_n_per_kg,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::direction::Direction;
    use crate::model::effects::{Effects, Journey};
    use crate::model::track::{Gradient, Track};
    use crate::model::train::{Train, TrainDescription};

    /// Three places see a slope that begins after a quarter of the way over five sixths of it.
    #[test]
    fn a_slope_that_begins_within_an_interval_is_seen_from_where_it_begins() {
        let train = Train::try_new(TrainDescription { length_m: 1.0, ..TrainDescription::CASE_STUDY }).unwrap();
        let gradients = [(0.0, 0.0), (1050.0, 40.0)].map(|(from_m, permille)| Gradient { from_m, permille });
        let track = Track::try_new(5e3, gradients).unwrap();
        let line = Line { train: &train, track: &track, direction: Direction::Up };
        let effects = Effects::default();
        let acting = Acting::new(&effects, Journey::default());
        let davis = Davis { r0: 0.0, r1: 0.0, r2: 0.0 };
        let at = |time_s: Real| Point { time_s, location_m: 1000.0 + 20.0 * time_s, speed_mps: 20.0 };
        let of_slope = |step_s| {
            let effort = over_steps(&line, &acting, &davis, [&at(0.0), &at(10.0)], step_s);
            effort.effort_n_per_kg / line.gradient_n_per_kg(1100.0)
        };
        assert!((of_slope(10.0) - 5.0 / 6.0).abs() < 1e-6, "{}", of_slope(10.0));
        assert!((of_slope(2.5) - 0.75).abs() < 0.05, "{}", of_slope(2.5));
    }
}
