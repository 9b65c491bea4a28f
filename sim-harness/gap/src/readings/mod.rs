//! Speed against location: scale, offset and lag of all runs, and the wheel of single ones.

pub mod kinematics;
pub mod wheels;
