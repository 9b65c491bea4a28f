//! What is put right before anything asks for forces: wheels, the age of the effort, the zero of the locations.

pub(crate) mod brakes;
pub(crate) mod delay;
pub(crate) mod kinematics;
pub mod nuisances;
pub mod offset;
pub(crate) mod wheels;
