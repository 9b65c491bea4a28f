//! Tuning of the paper's filter by the two criteria of section 4.2: the likelihood of the readings, and coefficients
//! that are not negative.
//!
//! ```text
//! runs -> score (likelihood, negative coefficients) <- parameters (Table 1, Q)
//!             |
//!             +-> search (Nelder-Mead) -> optimum -> surface around it, configuration, page
//! ```
//!
//! A filter that explains the readings well is not one that finds the resistance: the paper's loop stays blind to it,
//! however it is tuned. The page shows that beside the optimum.

pub(crate) mod fields;
pub(crate) mod page;
pub(crate) mod parameters;
pub(crate) mod runs;
pub(crate) mod score;
pub(crate) mod search;
pub(crate) mod surface;
