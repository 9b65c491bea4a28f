//! What is wrong with the times of the rows?
//!
//! | question | module |
//! |---|---|
//! | did the clock jump, pause? | [`jumps`] |
//! | was it set by a few seconds on the way? | `set` |
//! | are rows stamped when they arrive, several at once? | `bursts` |
//! | does it lose seconds? | `lost_seconds` |

pub(crate) mod bursts;
pub mod jumps;
pub(crate) mod lost_seconds;
mod set;
