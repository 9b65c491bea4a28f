//! What the workflow reads: runs, cut into intervals, and the residual of each that counts.

pub mod believed;
pub mod cut;
pub mod interval;
pub mod load;
pub mod rows;
pub mod runs;
