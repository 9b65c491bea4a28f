//! Simulated data sets: from a scenario file to a folder of run logs, with the truth beside them.
//!
//! ```text
//! scenario file -> Scenario + believed track and train -> plan -> runs -> folder
//! ```
//!
//! | file of this folder | what it makes |
//! |---|---|
//! | [`scenario_file`] | a checked scenario from a TOML file |
//! | `believed` | the track and the train as described to the estimator |
//! | [`folder`] | the run logs, the descriptions and the truth on disk |
//! | `key` | `truth.json`: what was true, for evaluation |

pub(crate) mod believed;
pub mod folder;
pub(crate) mod key;
pub mod scenario_file;
