//! The figures: each a function from what the estimator said to a picture.
//!
//! | function | figure of the paper |
//! |---|---|
//! | [`motion`] | 3: speed, acceleration, effort, r0, r1, r2 |
//! | [`resistance_terms`] | 5: stacked terms of the running resistance |
//! | [`regimes`] | 6: the speed profile in the colours of the regimes |
//! | [`coast_ahead`] | - |
//! | [`innovations`] | - |
//! | [`readings`] | - |
//! | [`resistance_curve`], [`vehicle_history`] | - (what Fig. 4 shows of all runs, with its uncertainty) |

mod coast_ahead;
mod motion;
mod readings;
mod regimes;
mod resistance;

pub use coast_ahead::coast_ahead;
pub use motion::motion;
pub use readings::{innovations, readings};
pub use regimes::regimes;
pub use resistance::{resistance_curve, resistance_terms, vehicle_history};

use super::RunView;
use crate::report::axis::Axis;
use rundown::Real;
use rundown::tick::estimate::{Estimate, Validity};
use rundown_pages::chart::{Drawing, Figure, Panel};

const KMH: Real = 3.6;

/// N/kg in the unit of the figures of resistance, 10⁻³ N/kg.
const MILLI: Real = 1e3;

const BAND: Real = 0.18;

const BACKGROUND: Real = 0.16;

/// Names of the two x axes of a run.
const LOCATION: &str = "location";
const TIME: &str = "time";

/// Over the location, as the paper's figures, and over the time; over the time alone where the train hardly moved.
fn over_location(run: &RunView, title: &str, description: &str, panels: impl Fn(&Axis) -> Vec<Panel>) -> Drawing {
    let (motion, time) = (Axis::of_motion(run), Axis::of_time(run));
    let figure = |axis: &Axis| Figure::new(title, description, axis.label, axis.range.clone(), panels(axis));
    match motion.is_location() {
        true => Drawing::Switched { first: (LOCATION, figure(&motion)), second: (TIME, figure(&time)) },
        false => figure(&time).into(),
    }
}

/// Over the time first: a standing train has many samples at one place.
fn over_time(run: &RunView, title: &str, description: &str, panels: impl Fn(&Axis) -> Vec<Panel>) -> Drawing {
    match over_location(run, title, description, panels) {
        Drawing::Switched { first, second } => Drawing::Switched { first: second, second: first },
        other => other,
    }
}

fn nothing_estimated(run: &RunView) -> String {
    match run.estimates.is_empty() {
        true => "no estimate: the run has no usable sample".to_owned(),
        false => "no estimate: no value is finite".to_owned(),
    }
}

/// Not where nothing can be said: there the line is broken.
fn trusted(estimate: &Estimate) -> bool {
    !matches!(estimate.validity, Validity::Invalid(_))
}
