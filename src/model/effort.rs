//! Applied effort, calculated from the change of speed.
//!
//! In: two speeds, the Davis coefficients, the track below the train. Out: effort per mass in N/kg, traction positive, brake negative.
//!
//! ```text
//! u = (v[k] - v[j]) / Δt + r(v) + g(s) + X         Eq. (1) solved for u; X of the named effects
//! ```
//!
//! The paper takes r and g at the end of the interval ([`of_paper`]); the other modes take their mean over it ([`over_interval`]).

use crate::Real;
use crate::model::effects::Acting;
use crate::model::line::Line;
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

/// Means over the interval from `from` to `to`, which is later; the gradient by Simpson's rule.
pub fn over_interval(line: &Line<'_>, acting: &Acting<'_>, davis: &Davis, from: &Point, to: &Point) -> Effort {
    let acceleration_mps2 = (to.speed_mps - from.speed_mps) / (to.time_s - from.time_s);
    let midway_m = 0.5 * (from.location_m + to.location_m);
    let gradient_n_per_kg = (line.gradient_n_per_kg(from.location_m)
        + 4.0 * line.gradient_n_per_kg(midway_m)
        + line.gradient_n_per_kg(to.location_m))
        / 6.0;
    let midway_mps = 0.5 * (from.speed_mps + to.speed_mps);
    let resistance_n_per_kg =
        davis.resistance_n_per_kg(midway_mps) + gradient_n_per_kg + acting.extra_over_n_per_kg(line, davis, from, to);
    Effort {
        effort_n_per_kg: acting.effort_n_per_kg(acceleration_mps2 + resistance_n_per_kg),
        acceleration_mps2,
        resistance_n_per_kg,
    }
}
