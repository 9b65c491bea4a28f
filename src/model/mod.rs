//! What is known of a train on its track, and how it moves: descriptions, the equation of motion, effects that a
//! description may lack.

pub mod bounds;
pub mod curves;
pub mod direction;
pub mod effects;
pub mod effort;
pub mod line;
pub mod motion;
pub(crate) mod pieces;
pub mod point;
mod profile;
pub mod resistance;
pub mod state;
pub(crate) mod table;
pub mod targets;
pub mod track;
pub mod train;
pub mod units;
