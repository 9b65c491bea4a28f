//! Traction effort capped at low speed on some days.

use super::pulls::Pull;
use super::told::Told;
use super::{FoundLimit, Limit};
use crate::fit::LOSS_AT_LIMIT;

/// What the choice of the runs costs.
const BAD_DAYS: f64 = 6.0;
/// Gain of log-likelihood below which a run says nothing of bad days.
const TELLS: f64 = 0.5;
/// What may as well act above this speed is no matter of starting, km/h.
const LOW_KMH: f64 = 75.0;
/// More runs than this are no bad days but the train.
const MOST_SLIPPERY: f64 = 0.6;

/// A limit of the effort in the runs in which the pulls at low speed show it.
pub fn adhesion(runs: &[Told<'_>]) -> Option<FoundLimit> {
    let limit = |pull: &Pull, factor: f64, below_kmh: f64| {
        if 3.6 * pull.speed_mps < below_kmh { factor * pull.effort_over_limit } else { 1.0 }
    };
    let gains = |factor: f64, below_kmh: f64| -> Vec<f64> {
        let gain = |run: &Told<'_>| run.gain(|pull| limit(pull, factor, below_kmh));
        runs.iter().map(gain).collect()
    };
    // Share of the runs on slippery days, by expectation and maximisation.
    let mixture = |gains: &[f64]| -> (f64, f64) {
        let mut share: f64 = 0.2;
        for _ in 0..30 {
            let sum: f64 = gains
                .iter()
                .map(|g| {
                    let odds = share * g.clamp(-50.0, 50.0).exp();
                    odds / (odds + 1.0 - share)
                })
                .sum();
            share = (sum / gains.len() as f64).clamp(0.5 / gains.len() as f64, MOST_SLIPPERY);
        }
        let total = gains.iter().map(|g| (share * g.clamp(-50.0, 700.0).exp() + 1.0 - share).ln()).sum();
        (share, total)
    };
    let mut best: Option<(f64, f64, f64, Vec<f64>, f64)> = None;
    for below in (3..=12).map(|i| 5.0 * f64::from(i)) {
        for factor in (3..20).map(|i| 0.05 * f64::from(i)) {
            let gains = gains(factor, below);
            let (share, total) = mixture(&gains);
            if best.as_ref().is_none_or(|b| total > b.2) {
                best = Some((factor, below, total, gains, share));
            }
        }
    }
    let (mut factor, mut below, mut total, mut of_runs, mut share) = best?;
    for step in [0.02, 0.01, 0.005, 0.0025] {
        for (f, b) in [(step, 0.0), (-step, 0.0), (0.0, 100.0 * step), (0.0, -100.0 * step)] {
            let gains = gains(factor + f, below + b);
            let (s, t) = mixture(&gains);
            if t > total {
                (factor, below, total, of_runs, share) = (factor + f, below + b, t, gains, s);
            }
        }
    }
    let slippery: Vec<usize> = of_runs
        .iter()
        .enumerate()
        // A run without a pull at low speed says nothing, whatever the share of the others.
        .filter(|(_, g)| **g > TELLS && share * g.clamp(-50.0, 50.0).exp() > 1.0 - share)
        .filter_map(|(i, _)| runs[i].pulls.first().map(|p| p.run))
        .collect();
    if slippery.is_empty() || slippery.len() as f64 > MOST_SLIPPERY * runs.len() as f64 {
        return None;
    }
    let loss = |factor, below| total - mixture(&gains(factor, below)).1;
    // As far as the log-likelihood loses no more than a 95 % limit allows.
    let reach = |step: f64, loss: &dyn Fn(f64) -> f64| {
        let steps = (1..40).map(|i| f64::from(i) * step);
        steps.take_while(|by| loss(*by) < LOSS_AT_LIMIT).last().unwrap_or(0.0)
    };
    let below_kmh = |step| below + reach(step, &|by| loss(factor, below + by));
    let below_kmh = (below_kmh(-1.0), below_kmh(1.0));
    if below_kmh.1 > LOW_KMH {
        return None;
    }
    let of_factor = reach(0.002, &|by| loss(factor + by, below)) - reach(-0.002, &|by| loss(factor + by, below));
    Some(FoundLimit {
        gain: total,
        value: total - 2.0 * 2.1 - 1.5 - BAD_DAYS,
        factor_sd: (0.25 * of_factor).max(0.005),
        edges_m: None,
        below_kmh: Some(below_kmh),
        limit: Limit::Adhesion { factor, below_kmh: below, runs: slippery },
    })
}
