//! Readings of the paper compared: which effort, which gradient, which Table 1, recorded by which sensors, gives what
//! section 4.2 shows?
//!
//! ```text
//! scenario + seed -> one truth, recorded by each recorder -> each reading's filter -> remarks that hold, likelihood -> table, picture, page
//! ```
//!
//! | question | module |
//! |---|---|
//! | what is compared? | `reading` |
//! | what does a filter say of a run? | `pass` |
//! | which remarks of section 4.2 hold? | `remarks` |
//! | how far is Table 1 from the most likely initial deviations? | `optimum` |
//! | over seeds, or on recorded runs | `comparison`, `recorded` |
//! | where is it reported? | `outcome`, `picture` |

pub(crate) mod comparison;
pub(crate) mod optimum;
pub(crate) mod outcome;
pub(crate) mod pass;
pub(crate) mod picture;
pub(crate) mod reading;
pub(crate) mod recorded;
pub(crate) mod remarks;
