//! The train gives another share of its description everywhere.

use super::told::Told;
use super::{FoundLimit, Limit, factor_sd, trimmed};

/// A limit nearer to the believed one is no finding.
const LEAST_SCALE: f64 = 0.03;
/// What it takes to believe that it is not all drivers who are cautious.
const CAUTION: f64 = 6.0;

fn best_factor(range: impl Iterator<Item = f64>, gain: impl Fn(f64) -> f64) -> Option<(f64, f64, f64)> {
    let mut best: Option<(f64, f64)> = None;
    for factor in range {
        let now = gain(factor);
        if best.is_none_or(|(_, most)| now > most) {
            best = Some((factor, now));
        }
    }
    let (mut factor, mut most) = best?;
    let mut step = 0.02;
    while step > 5e-4 {
        let mut moved = false;
        for other in [factor - step, factor + step] {
            let now = gain(other);
            if now > most {
                (factor, most, moved) = (other, now, true);
            }
        }
        if !moved {
            step *= 0.5;
        }
    }
    let sd = factor_sd(most, |by| gain(factor + by));
    Some((factor, most, sd))
}

/// Either drivers ask for more than the train gives, and many runs lie at the very limit; or what they ask for scales with what there is, and no run comes near the
/// described limit (which may also be caution: dearer).
pub fn scale(runs: &[Told<'_>]) -> Option<FoundLimit> {
    let capped = |factor: f64| -> Vec<f64> {
        let of_run = |run: &Told<'_>| {
            if factor < 1.0 { run.gain(|_| factor) } else { run.gain_up_to(factor) }
        };
        runs.iter().map(of_run).collect()
    };
    let scaled = |factor: f64| -> Vec<f64> { runs.iter().map(|run| run.gain_up_to(factor)).collect() };
    let sum = |gains: &[f64]| gains.iter().sum::<f64>();
    // A gauge that reads some percent wrong is no finding: what the best factor that near brings is brought by nothing.
    let near = (-6..=6).map(|i| 1.0 + LEAST_SCALE * f64::from(i) / 6.0);
    let near = near.flat_map(|factor| [capped(factor), scaled(factor)]);
    let near = near.max_by(|a, b| sum(a).total_cmp(&sum(b)))?;
    let one = |of: &dyn Fn(f64) -> Vec<f64>, cost: f64| {
        let range = (15..40).map(|i| 0.04 * f64::from(i)).filter(|f| (f - 1.0).abs() > LEAST_SCALE);
        let (factor, _, factor_sd) = best_factor(range, |factor| sum(&of(factor)))?;
        let beyond: Vec<f64> = of(factor).iter().zip(&near).map(|(gain, near)| gain - near).collect();
        let gain = trimmed(beyond.iter().copied()).min(sum(&beyond));
        ((factor - 1.0).abs() > LEAST_SCALE).then_some(FoundLimit {
            limit: Limit::Scale { factor },
            gain,
            value: gain - cost,
            factor_sd,
            edges_m: None,
            below_kmh: None,
        })
    };
    [one(&capped, 2.1), one(&scaled, 2.1 + CAUTION)].into_iter().flatten().max_by(|a, b| a.value.total_cmp(&b.value))
}
