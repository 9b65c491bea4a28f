//! The case study: section 4 of the paper on many runs, with the truth beside it where it is known.
//!
//! ```text
//! source -> gather (paper and gated mode) -> tallies -> claims ----> page -> report.html
//!                                         -> drawn runs -> figures ->     -> SVG, CSV
//! slope -> crate::bound              self-test of learning
//! ```
//!
//! | question | module |
//! |---|---|
//! | which runs? | `source`, `case`, `description`, `truth_folder` |
//! | what does the estimator say of one run, and what was true? | `view` |
//! | and of all of them? | `gather`, `tallies`, `moments` |
//! | what do the figures show? | `figures` |
//! | what does the paper claim, and is it so here? | `claims`, `clouds`, `trials`, `visible`, `verdict` |
//! | where is it reported? | `page`, `run_pages`, `write` |
//! | why did the paper see no tunnel? | `tunnel` |
//! | what does the paper leave to future work? | `experiments` |
//! | which reading of the text gives the paper's figures? | `readings` |
//! | does the estimate follow the truth, how closely could it? | `slope` |

pub(crate) mod case;
pub(crate) mod claims;
pub(crate) mod clouds;
pub(crate) mod description;
pub(crate) mod dynamics;
pub(crate) mod experiments;
pub(crate) mod fields;
pub(crate) mod figures;
pub(crate) mod gather;
pub(crate) mod moments;
pub(crate) mod page;
pub(crate) mod readings;
pub(crate) mod run_pages;
pub(crate) mod slope;
pub(crate) mod source;
pub(crate) mod tallies;
pub(crate) mod trials;
pub(crate) mod truth_folder;
pub(crate) mod tunnel;
pub(crate) mod verdict;
pub(crate) mod view;
pub(crate) mod visible;
pub(crate) mod write;

/// Why something is not studied, in words.
pub(crate) type Refused = Box<dyn std::error::Error + Send + Sync>;
