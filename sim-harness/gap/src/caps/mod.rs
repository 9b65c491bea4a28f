//! Limits of the traction: does the train give what its description says, everywhere and every day?
//!
//! In: intervals of steady power while the train gains speed, and ρ = effort over believed limit. A driver asks for a share a of the nominal effort and another of the
//! nominal power, the same all through a run or another in each pull; the train gives the smaller of that share and its true limit F:
//!
//! ```text
//! ρ_i = min(a, F(location, speed)) + noise        a unknown in each run, or in each pull, for effort and for power, even prior
//! ```
//!
//! | hypothesis | F |
//! |---|---|
//! | as believed | 1 |
//! | `traction_scale` | the factor, everywhere |
//! | `power_limit_section` | the factor, for power, inside a section |
//! | `low_adhesion` | the factor times the largest effort below a speed, in some runs |
//!
//! Compared by marginal likelihood, the shares integrated out.

mod adhesion;
mod edges;
mod exceeded;
mod pulls;
mod scale;
mod section;
mod told;

pub use exceeded::{Reading, calculated, traction};
pub use pulls::{Pull, by_number, pulls, sampled_pulls};

use adhesion::adhesion;
use exceeded::allowed;
use scale::scale;
use section::section;
use told::Told;

/// A limit that is not as believed.
#[derive(Clone, Debug, PartialEq)]
pub enum Limit {
    /// Everywhere.
    Scale {
        /// Of effort and power.
        factor: f64,
    },
    /// In a section.
    Section {
        /// From, m.
        from_m: f64,
        /// To, m.
        to_m: f64,
        /// Of the power.
        factor: f64,
    },
    /// At low speed, in some runs.
    Adhesion {
        /// Of the largest effort.
        factor: f64,
        /// Below this speed, km/h.
        below_kmh: f64,
        /// Which runs.
        runs: Vec<usize>,
    },
}

impl Limit {
    /// Name of the effect.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Scale { .. } => "traction_scale",
            Self::Section { .. } => "power_limit_section",
            Self::Adhesion { .. } => "low_adhesion",
        }
    }
}

/// A limit with what was found of it.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundLimit {
    /// The limit.
    pub limit: Limit,
    /// Gain of log-likelihood.
    pub gain: f64,
    /// The same less the cost of its freedom.
    pub value: f64,
    /// Standard deviation of the factor.
    pub factor_sd: f64,
    /// 95 % limits of the edges of a section, m: infinite where no train pulls beyond it.
    pub edges_m: Option<[(f64, f64); 2]>,
    /// 95 % limits of the speed below which adhesion is low, km/h.
    pub below_kmh: Option<(f64, f64)>,
}

/// All limits that are better than the believed one, best first. `pulls` and `traction` by run.
pub fn limits(pulls: &[Vec<Pull>], traction: &[Vec<Reading>]) -> Vec<FoundLimit> {
    let runs: Vec<Told<'_>> = pulls.iter().filter(|pulls| pulls.len() >= 2).map(|pulls| Told::new(pulls)).collect();
    if runs.len() < 3 {
        return Vec::new();
    }
    let section = section(&runs).and_then(|found| allowed(found, traction));
    let found = [scale(&runs), section, adhesion(&runs)];
    let mut found: Vec<FoundLimit> = found.into_iter().flatten().collect();
    found.sort_by(|a, b| b.value.total_cmp(&a.value));
    found
}

/// Sum without the best tenth: what rests on a few runs is no limit of the train.
fn trimmed(gains: impl Iterator<Item = f64>) -> f64 {
    let mut gains: Vec<f64> = gains.collect();
    gains.sort_by(f64::total_cmp);
    let kept = gains.len() - (gains.len() / 10).max(1);
    gains[..kept].iter().sum::<f64>() * gains.len() as f64 / kept as f64
}

/// Standard deviation of a factor from the curvature of the log-likelihood, over a step wide enough for its roughness. `gain`: what a factor brings that is by so much larger.
fn factor_sd(most: f64, gain: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 0.01;
    let curvature = (2.0 * most - gain(-STEP) - gain(STEP)) / (STEP * STEP);
    if curvature > 0.0 { 1.0 / curvature.sqrt() } else { STEP }
}
