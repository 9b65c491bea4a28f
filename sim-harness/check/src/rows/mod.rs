//! What do the rows of a log hold, whatever column is asked?
//!
//! | question | module |
//! |---|---|
//! | how much time is between rows? | [`times`] |
//! | which step do the readings have? | [`steps`] |
//! | which way do the locations grow, how far does a train go between rows? | [`ways`] |
//! | how far may a train go between two rows? | `reach` |
//! | are rows no readings, but between them? | `interpolated` |
//! | are single readings missing or impossible? | `readings` |
//! | which readings are wild? | `wild` |
//! | which stay the same? | `stuck` |
//! | which change in stairs? | `stairs` |
//! | how fast is a run where, and where does it stand? | `profile` |
//! | is a log another one again, whole or in part? | [`same`] |

pub(crate) mod interpolated;
pub(crate) mod profile;
pub(crate) mod reach;
pub(crate) mod readings;
pub mod same;
pub(crate) mod stairs;
pub mod steps;
pub(crate) mod stuck;
pub mod times;
pub mod ways;
pub(crate) mod wild;
