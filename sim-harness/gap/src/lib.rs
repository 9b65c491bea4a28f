//! The gap workflow: where simulation and measured data disagree, which effect is missing, and the gap shrinking.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod agreement;
pub mod analysis;
pub mod answer;
pub mod calibrate;
pub mod caps;
pub mod coasting;
pub mod dragging;
pub mod efforts;
pub mod evidence;
pub mod explain;
pub mod explained;
pub mod families;
pub mod files;
pub mod fit;
pub mod fitted;
pub mod forward;
pub mod innovations;
pub mod journey;
mod judge;
pub mod kinematics;
pub mod limits;
pub mod load;
pub mod named;
pub mod notes;
mod of_term;
mod on_line;
pub mod own_wind;
pub mod pulled;
pub mod report;
pub mod rivals;
pub mod rows;
pub mod runs;
pub mod scan;
pub mod select;
pub mod separates;
pub mod shape;
pub mod share;
pub mod story;
pub mod tables;
pub mod terms;
pub mod travelled;
pub mod wheels;
pub mod whitening;
pub mod workflow;
pub mod worth;
