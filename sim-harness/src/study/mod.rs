//! The case study: section 4 of the paper on many runs, with the truth beside it where it is known.
//!
//! ```text
//! source -> gather (paper and gated mode) -> tallies -> claims ----> page -> report.html
//!                                         -> drawn runs -> figures ->     -> SVG, CSV
//! slope -> bound                     self-test of learning
//! ```
//!
//! | question | module |
//! |---|---|
//! | which runs? | [`source`], [`case`], [`description`], [`truth_folder`] |
//! | what does the estimator say of one run, and what was true? | [`view`] |
//! | and of all of them? | [`gather`], [`tallies`], [`moments`] |
//! | what do the figures show? | [`figures`] |
//! | what does the paper claim, and is it so here? | [`claims`], [`trials`], [`sensitivity`] |
//! | where is it told? | [`page`], [`write`](mod@write) |
//! | does the estimate follow the truth, how closely could it? | [`slope`], [`bound`] |

pub mod bound;
pub mod case;
pub mod claims;
pub mod description;
pub mod figures;
pub mod gather;
pub mod moments;
pub mod page;
pub mod sensitivity;
pub mod slope;
pub mod source;
pub mod tallies;
pub mod trials;
pub mod truth_folder;
pub mod view;
pub mod write;
