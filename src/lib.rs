//! Rundown
#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod config;
pub mod effort;
pub mod elimination;
pub mod estimate;
pub mod estimator;
pub mod features;
pub mod kinematics;
pub mod learning;
pub mod measurement;
pub mod memory;
pub mod motion;
pub mod paper;
pub mod plausibility;
pub mod regime;
pub mod resistance;
pub mod state;
pub mod track;
pub mod train;
pub mod ukf;
pub mod units;

/// Number type of the whole estimator. With the spread of the paper textbook weights are near 1.7e6, so single precision is not enough.
pub type Real = f64;
