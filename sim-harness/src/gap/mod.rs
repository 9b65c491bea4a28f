//! The gap workflow: where simulation and measured data disagree, which effect is missing, and the gap shrinking.

pub mod analysis;
pub mod bench;
pub mod calibrate;
pub mod caps;
pub mod coasting;
pub mod evidence;
pub mod explain;
pub mod fit;
pub mod forward;
pub mod innovations;
pub mod kinematics;
pub mod load;
pub mod named;
pub mod own_wind;
pub mod report;
pub mod rows;
pub mod runs;
pub mod scan;
pub mod select;
pub mod tables;
pub mod terms;
pub mod travelled;
pub mod wheels;
pub mod whitening;
pub mod workflow;
