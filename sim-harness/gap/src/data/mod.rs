//! What the workflow reads: runs, cut into intervals, and the residual of each that counts.

pub mod believed;
pub mod cut;
mod efforts;
pub mod interval;
pub mod load;
mod nodes;
pub mod rows;
pub mod runs;
