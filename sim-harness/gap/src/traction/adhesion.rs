//! Traction effort capped at low speed on some days.

use crate::config::{PenaltyConfig, TractionConfig};
use crate::fit::{ANYWHERE, Climb, LOSS_AT_LIMIT, mixed_share};
use crate::traction::{limit::FoundLimit, powering::SteadyPower, shares::Shares};
use rundown::model::effects::{Effect, LowAdhesion};

/// Share of the runs on slippery days, by expectation and maximisation, and the log-likelihood of all runs.
fn mixture(gains: &[f64], most_slippery: f64) -> (f64, f64) {
    let share = mixed_share(gains.len(), 30, most_slippery, |share| {
        let slippery = |g: &f64| {
            let odds = share * g.clamp(-50.0, 50.0).exp();
            odds / (odds + 1.0 - share)
        };
        gains.iter().map(slippery).sum()
    });
    let total = gains.iter().map(|g| (share * g.clamp(-50.0, 700.0).exp() + 1.0 - share).ln()).sum();
    (share, total)
}

/// A limit of the effort in the runs in which the powering phases at low speed show it.
pub fn adhesion(runs: &[Shares<'_>], config: &TractionConfig, penalty: &PenaltyConfig) -> Option<FoundLimit> {
    let limit = |power: &SteadyPower, factor: f64, below_kmh: f64| {
        if 3.6 * power.speed_mps < below_kmh { factor * power.effort_over_limit } else { 1.0 }
    };
    let gains = |factor: f64, below_kmh: f64| -> Vec<f64> {
        let gain = |run: &Shares<'_>| run.gain(|power| limit(power, factor, below_kmh));
        runs.iter().map(gain).collect()
    };
    let total_of = |factor: f64, below_kmh: f64| mixture(&gains(factor, below_kmh), config.most_slippery).1;
    let mut best: Option<([f64; 2], f64)> = None;
    for below in (3..=12).map(|i| 5.0 * f64::from(i)) {
        for factor in (3..20).map(|i| 0.05 * f64::from(i)) {
            let total = total_of(factor, below);
            if best.is_none_or(|(_, most)| total > most) {
                best = Some(([factor, below], total));
            }
        }
    }
    let climb = Climb {
        steps: [0.02, 2.0],
        shrink: 0.5,
        rounds: 4,
        least: 0.0,
        better: 0.0,
        first: 1.0,
        both: false,
        range: ANYWHERE,
    };
    let ([factor, below], total) = climb.from(best?.0, |[factor, below]| Some(total_of(factor, below)));
    let of_runs = gains(factor, below);
    let (share, _) = mixture(&of_runs, config.most_slippery);
    // A run without powering at low speed says nothing, whatever the share of the others.
    let slips = |g: f64| g > config.slippery_gain && share * g.clamp(-50.0, 50.0).exp() > 1.0 - share;
    let slippery = runs.iter().zip(&of_runs).filter(|(_, g)| slips(**g));
    let slippery: Vec<usize> = slippery.filter_map(|(run, _)| run.powering.first().map(|p| p.run)).collect();
    if slippery.is_empty() || slippery.len() as f64 > config.most_slippery * runs.len() as f64 {
        return None;
    }
    // As far as the log-likelihood loses no more than a 95 % limit allows.
    let reach = |step: f64, total_at: &dyn Fn(f64) -> f64| {
        let steps = (1..40).map(|i| f64::from(i) * step);
        steps.take_while(|by| total - total_at(*by) < LOSS_AT_LIMIT).last().unwrap_or(0.0)
    };
    let below_kmh = [-1.0, 1.0].map(|step| below + reach(step, &|by| total_of(factor, below + by)));
    if below_kmh[1] > config.low_kmh {
        return None;
    }
    let [up, down] = [0.002, -0.002].map(|step| reach(step, &|by| total_of(factor + by, below)));
    Some(FoundLimit {
        effect: Effect::LowAdhesion(LowAdhesion { factor, below_kmh: below }),
        factor,
        factor_sd: (0.25 * (up - down)).max(config.least_factor_sd),
        runs: slippery,
        gain: total,
        value: total - 2.0 * penalty.coefficient - penalty.shape - penalty.bad_days,
        edges_m: None,
        below_kmh: Some((below_kmh[0], below_kmh[1])),
    })
}
