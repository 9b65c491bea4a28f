//! What sensors do to the residuals beyond what is put right: no effects of a train. In every fit, and none to be
//! found.

use crate::candidates::kit::*;
use crate::data::interval::Point;
use rundown::model::line::Line;

/// Speed read later than the effort: step of the effort over the interval's length; coefficient in s.
pub static DELAY: &dyn Candidate = &Sensor::Delay;
/// What straight lines between momentary efforts miss: their bend over the interval's length; coefficient in s.
pub static BEND: &dyn Candidate = &Sensor::Bend;
/// Location read late, beyond what was put right: the gradient of v seconds back less the one here, over 1 s.
pub static LATE_LOCATION: &dyn Candidate = &Sensor::LateLocation;

/// Locations that are shown further on along the line: the change of the gradient over 1 m, less.
pub static LOCATION_OFFSET: &dyn Candidate = &Sensor::LocationOffset;

/// Half the distance over which the change of the gradient is taken, m.
const SLOPE_M: f64 = 15.0;

enum Sensor {
    Delay,
    Bend,
    LateLocation,
    LocationOffset,
}

impl Candidate for Sensor {
    fn facts(&self) -> Facts {
        Facts::default()
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Delay => "delay",
            Self::Bend => "bend",
            Self::LateLocation => "late",
            Self::LocationOffset => "offset",
        }
    }

    fn columns(&self, _: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        vec![match self {
            Self::Delay => along(context, rows, |_, row, _| row.interval.effort_step_n_per_kg / row.interval.dt_s),
            Self::Bend => along(context, rows, |_, row, _| row.interval.effort_bend_n_per_kg / row.interval.dt_s),
            Self::LateLocation => {
                along(context, rows, |line, _, p| p.speed_mps * line.direction.sign() * slope(line, p))
            }
            Self::LocationOffset => along(context, rows, |line, _, p| -slope(line, p)),
        }]
    }

    /// It is in every fit, and never the answer.
    fn sentence(&self, _: &Named, _: &Context<'_>) -> String {
        self.name().to_owned()
    }

    /// The recorders of the simulator are its hidden ones.
    fn hidden(&self, _: &str, _: &mut Hide<'_>) -> Option<Value> {
        None
    }
}

/// Change of the gradient along the line, N/kg for each m.
fn slope(line: &Line<'_>, p: &Point) -> f64 {
    let at = |by_m: f64| line.gradient_n_per_kg(p.location_m + by_m);
    (at(SLOPE_M) - at(-SLOPE_M)) / (2.0 * SLOPE_M)
}
