//! All limits that may not be as believed, compared.

use crate::config::{PenaltyConfig, TractionConfig};
use crate::traction::adhesion::adhesion;
use crate::traction::exceeded::{Reading, allowed};
use crate::traction::limit::FoundLimit;
use crate::traction::powering::SteadyPower;
use crate::traction::scale::scale;
use crate::traction::section::section;
use crate::traction::shares::Shares;

/// All limits that are better than the believed one, best first. `powering` and `traction` by run.
pub fn limits(
    powering: &[Vec<SteadyPower>],
    traction: &[Vec<Reading>],
    config: &TractionConfig,
    penalty: &PenaltyConfig,
) -> Vec<FoundLimit> {
    let powering: Vec<&Vec<SteadyPower>> = powering.iter().filter(|powering| powering.len() >= 2).collect();
    let runs: Vec<Shares<'_>> = powering.iter().map(|powering| Shares::new(powering, config)).collect();
    if runs.len() < config.least_runs {
        return Vec::new();
    }
    let section = section(&runs, config, penalty).and_then(|found| allowed(found, traction, config));
    let found = [scale(&runs, config, penalty), section, adhesion(&powering, config, penalty)];
    let mut found: Vec<FoundLimit> = found.into_iter().flatten().collect();
    found.sort_by(|a, b| b.value.total_cmp(&a.value));
    found
}
