//! The train gives another share of its description everywhere.

use crate::config::{PenaltyConfig, TractionConfig};
use crate::fit::{ANYWHERE, Climb};
use crate::traction::limit::{FoundLimit, factor_sd, trimmed};
use crate::traction::shares::Shares;
use rundown::model::effects::{Effect, TractionScale};

/// The best of a range, made finer, with its standard deviation.
fn best_factor(range: impl Iterator<Item = f64>, gain: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let mut best: Option<(f64, f64)> = None;
    for factor in range {
        let now = gain(factor);
        if best.is_none_or(|(_, most)| now > most) {
            best = Some((factor, now));
        }
    }
    let climb = Climb {
        steps: [0.02],
        shrink: 0.5,
        rounds: 0,
        least: 5e-4,
        better: 0.0,
        first: -1.0,
        both: true,
        range: ANYWHERE,
    };
    let ([factor], most) = climb.from([best?.0], |[factor]| Some(gain(factor)));
    Some((factor, factor_sd(most, |by| gain(factor + by))))
}

/// Either drivers demand more than the train gives, and many runs lie at the very limit; or what they demand scales
/// with what there is, and no run comes near the described limit (which may also be caution: dearer).
pub fn scale(runs: &[Shares<'_>], config: &TractionConfig, penalty: &PenaltyConfig) -> Option<FoundLimit> {
    let capped = |factor: f64| -> Vec<f64> {
        let of_run = |run: &Shares<'_>| {
            if factor < 1.0 { run.gain(|_| factor) } else { run.gain_up_to(factor) }
        };
        runs.iter().map(of_run).collect()
    };
    let scaled = |factor: f64| -> Vec<f64> { runs.iter().map(|run| run.gain_up_to(factor)).collect() };
    let sum = |gains: &[f64]| gains.iter().sum::<f64>();
    let matters = |factor: f64| (factor - 1.0).abs() > config.least_scale;
    // What is left of the gain of the effort sensor is no finding: what the best factor that near brings is brought by
    // nothing.
    let near = (-6..=6).map(|i| 1.0 + config.least_scale * f64::from(i) / 6.0);
    let near = near.flat_map(|factor| [capped(factor), scaled(factor)]);
    let near = near.max_by(|a, b| sum(a).total_cmp(&sum(b)))?;
    let one = |of: &dyn Fn(f64) -> Vec<f64>, penalty: f64| {
        let range = (15..40).map(|i| 0.04 * f64::from(i)).filter(|factor| matters(*factor));
        let (factor, factor_sd) = best_factor(range, |factor| sum(&of(factor)))?;
        let beyond: Vec<f64> = of(factor).iter().zip(&near).map(|(gain, near)| gain - near).collect();
        let gain = trimmed(beyond.iter().copied()).min(sum(&beyond));
        matters(factor).then_some(FoundLimit {
            effect: Effect::TractionScale(TractionScale { factor }),
            factor,
            factor_sd,
            runs: Vec::new(),
            gain,
            value: gain - penalty,
            edges_m: None,
            below_kmh: None,
            demanded: 0.0,
        })
    };
    let found = [one(&capped, penalty.coefficient), one(&scaled, penalty.coefficient + penalty.caution)];
    found.into_iter().flatten().max_by(|a, b| a.value.total_cmp(&b.value))
}
