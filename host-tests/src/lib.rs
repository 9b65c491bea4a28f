//! A small simulator with known truth, against which the tests judge estimates.
//!
//! ```text
//! scenario -> driver + truth (every 0.05 s) -> trace -> sensors (every 10 s) -> samples, truth, facts
//! ```
//!
//! Nothing that makes the truth uses the `rundown` crate (only `accuracy`, which judges it): own equations, own integrator, plain `f64`, so an error in the estimator's motion model
//! cannot hide in the truth. Units are in the names; effort and resistance are per rotating mass, F/(γ m), in N/kg.
//! Traction is positive, brake negative; uphill positive; resistance positive against travel; headwind positive.
//!
//! ```
//! use host_tests::scenario::{Scenario, simulate};
//!
//! let run = simulate(&Scenario::default(), 1);
//! assert_eq!(run.samples.len(), run.truth.len());
//! assert!((run.facts.stop.location_m - 32_103.0).abs() < 5.0);
//! ```

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod accuracy;
pub mod board;
pub mod brake;
pub mod driver;
pub mod facts;
pub mod fields;
pub mod flash;
pub mod habits;
pub mod line;
pub mod scenario;
pub mod sensors;
pub mod target;
pub mod textbook;
pub mod truth;
