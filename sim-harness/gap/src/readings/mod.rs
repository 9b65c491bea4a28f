//! Speed against location: what the diagnosis says of all runs, and the wheels of single ones.

pub mod kinematics;
pub mod wheels;
