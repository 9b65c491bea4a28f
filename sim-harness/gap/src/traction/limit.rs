//! A limit of the traction that is not as believed, and what its search needs.

use crate::config::CertaintyConfig;
use crate::named::{Named, around, beside};
use rundown::model::effects::Effect;
use rundown_files::statistics::sorted;

#[derive(Clone, Debug, PartialEq)]
pub struct FoundLimit {
    /// As the board runs it, where the data have it.
    pub effect: Effect,
    pub factor: f64,
    pub factor_sd: f64,
    /// Indices of the runs in which it acts; none: all.
    pub runs: Vec<usize>,
    /// Gain of log-likelihood.
    pub gain: f64,
    /// The same less the penalty of its freedom.
    pub value: f64,
    /// 95 % limits of the edges of a section, m: infinite where no train powers beyond it.
    pub edges_m: Option<[(f64, f64); 2]>,
    /// 95 % limits of the speed below which it acts, km/h.
    pub below_kmh: Option<(f64, f64)>,
    /// How often drivers demand about as much where it cannot act, as a share of what they demand; 0 where that is not
    /// asked.
    pub demanded: f64,
}

impl FoundLimit {
    /// By name, with the interval of its factor.
    pub fn named(&self, effect: Effect, config: &CertaintyConfig) -> Named {
        let sd = self.factor_sd.hypot(config.limit * self.factor);
        let named = Named::plain(effect, vec![around("factor", self.factor, sd)], self.gain, config.most_gain);
        Named { confidence: beside(named.confidence, config.unforeseen), ..named }
    }
}

/// Sum without the best tenth: what rests on a few runs is no limit of the train.
pub fn trimmed(gains: impl Iterator<Item = f64>) -> f64 {
    let gains = sorted(gains);
    let kept = gains.len() - (gains.len() / 10).max(1);
    gains[..kept].iter().sum::<f64>() * gains.len() as f64 / kept as f64
}

/// Standard deviation of a factor from the curvature of the log-likelihood, over a step wide enough for its roughness.
/// `gain`: what a factor brings that is by so much larger.
pub fn factor_sd(most: f64, gain: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 0.01;
    let curvature = (2.0 * most - gain(-STEP) - gain(STEP)) / (STEP * STEP);
    if curvature > 0.0 { 1.0 / curvature.sqrt() } else { STEP }
}
