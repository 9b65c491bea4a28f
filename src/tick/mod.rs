//! The stages of a tick, from a measurement to an estimate. No stage calls the next one: [`crate::estimator`] knows
//! their order.

pub mod bounds;
pub mod digest;
pub mod effort_reading;
pub mod estimate;
pub mod foresight;
pub mod kinematics;
pub mod learning;
pub mod measurement;
pub mod memory;
pub mod paper;
pub mod plausibility;
pub mod published;
pub mod regime;
pub mod sensor;
pub mod short_hops;
pub(crate) mod snapshot;
pub mod staircase;
pub mod track_doubt;
pub mod truncation;
