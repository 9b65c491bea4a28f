//! What the paper leaves to future work (section 5, and remarks of sections 2 to 4), as experiments on runs whose truth
//! is known.
//!
//! ```text
//! experiment -> variants (scenario, description, settings) x sets of runs -> modes -> metrics against the truth -> one table, one figure
//! ```
//!
//! | question | module |
//! |---|---|
//! | which experiments are there? | `catalogue` |
//! | what is one point of an experiment? | `variant` |
//! | what is compared with the truth, and how? | `look`, `metrics` |
//! | many variants in several modes | `sweep`, `swept` |
//! | the recognised regime as an input of the paper's filter | `feedback` |
//! | do units or drivers differ by more than their runs? | `units`, `styles`, `groups` |
//! | how much is simulated, what comes out | `plan`, `answer`, `page`, `markdown` |
//!
//! Each set of runs is of a vehicle of its own, 15 % of resistance around what is described; the variants of an
//! experiment share vehicles, drivers and weather, so that they differ in what the experiment changes alone.

pub(crate) mod answer;
pub(crate) mod catalogue;
pub(crate) mod look;
pub(crate) mod markdown;
pub(crate) mod metrics;
pub(crate) mod page;
pub(crate) mod plan;
pub(crate) mod sweep;
pub(crate) mod variant;

mod feedback;
mod groups;
mod styles;
mod swept;
mod units;

use super::Refused;
use answer::Answer;
use plan::Plan;
use sweep::Sweep;

/// One question that the paper leaves open, and what answers it.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// As on the command line.
    pub name: &'static str,
    /// Where the paper raises it.
    pub place: &'static str,
    pub question: &'static str,
    pub by: By,
}

/// How an experiment is answered.
#[derive(Clone, Copy, Debug)]
pub enum By {
    /// Variants in several modes.
    Sweep(fn() -> Result<Sweep, Refused>),
    /// In a way of its own.
    Own(fn(&Plan<'_>) -> Result<Answer, Refused>),
}

impl Experiment {
    /// With its own variants, or at these values; none where it has no values.
    pub fn answer(&self, plan: &Plan<'_>, values: Option<&[f64]>) -> Result<Option<Answer>, Refused> {
        match (self.by, values) {
            (By::Sweep(sweep), Some(values)) => {
                sweep()?.with_values(values)?.map(|sweep| sweep.answer(plan)).transpose()
            }
            (By::Sweep(sweep), None) => sweep()?.answer(plan).map(Some),
            (By::Own(answer), None) => answer(plan).map(Some),
            (By::Own(_), Some(_)) => Ok(None),
        }
    }
}
