//! What was found, by name: each finding as the effect that the board runs, with intervals, runs and rivals.

pub mod confounded;
pub mod names;
pub mod on_line;
