//! The simulator: what really happens, with its own equations, and what the sensors make of it.
//!
//! ```text
//! scenario -> plan of the runs -> world of a run: line + train + wind + weather + effects
//!                                   |
//!                                 driver + motion (every 0.05 s) -> trace -> sensors (every 10 s) -> samples, truth, facts
//! ```
//!
//! Nothing here uses the `rundown` crate: own equations, own integrator, plain `f64`, so an error in the estimator's
//! motion model cannot hide in the truth. Units are in the names; effort and resistance are per rotating mass, F/(γ m),
//! in N/kg. Traction is positive, brake negative; uphill positive; resistance positive against travel; headwind
//! positive.
//!
//! ```
//! use rundown_truth::scenario::{Scenario, simulate};
//!
//! let run = simulate(&Scenario::default(), 1);
//! assert_eq!(run.samples.len(), run.truth.len());
//! assert!((run.facts.stop.location_m - 32_103.0).abs() < 5.0);
//! ```
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod brake;
pub mod conditions;
pub mod driver;
pub mod effects;
pub mod facts;
pub mod habits;
pub mod line;
pub mod motion;
pub mod plan;
pub mod recorders;
pub mod regime;
pub mod scenario;
pub mod seeds;
pub mod sensors;
pub mod timetable;
pub mod train;
pub mod weather;
pub mod world;
