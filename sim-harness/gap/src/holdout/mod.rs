//! The repaired model on hold-out runs: speeds, running times, energy, innovations, and the share of the gap that is
//! gone.

pub(crate) mod evaluation;
pub(crate) mod forward;
pub(crate) mod innovations;
pub(crate) mod journey;
pub(crate) mod multiples;
pub(crate) mod powered;
pub mod share;
pub(crate) mod travelled;
