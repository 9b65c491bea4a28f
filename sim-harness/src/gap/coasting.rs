//! Where a log without an effort column coasted: the probability of coasting of each interval, forward and backward over its run.
//!
//! The train's effort is calculated from the change of speed and the current model; each regime expects its own,
//!
//! | regime | effort expected, N/kg |
//! |---|---|
//! | coast | 0 |
//! | hold | what keeps the speed: r + g |
//! | power | 0.15 to 1.05 of the largest |
//! | brake | -0.1 to -0.8 |
//!
//! Intervals in which the regime changes lie anywhere between; so an interval counts as coasted only with neighbours that are, too.

use super::rows::Believed;
use super::runs::Interval;
use rundown::track::Direction;

/// Chance that a regime changes from one interval of 10 s to the next.
const CHANGE: f64 = 0.08;
/// Coasting is believed above this probability.
const ENOUGH: f64 = 0.85;
/// A stretch must be coasting rather than a held speed by so much, log of the odds.
const RATHER: f64 = 1.0;
/// How far a described resistance may be off when a held speed is told from coasting.
const DESCRIBED: f64 = 0.3;
/// So many neighbours on both sides must not together be a held speed by so much.
const AROUND: usize = 2;
const RATHER_NOT: f64 = 2.0;
const REGIMES: usize = 5;
/// Density of coasting far from what it should be, over that of its middle.
const FAR: f64 = 1e-5;
/// What the model has beyond the description counts up to this, N/kg: 3 permille.
const MOST_EXTRA_N_PER_KG: f64 = 0.03;

/// Which intervals of a run coasted. `extra` is what the model has beyond the believed description, N/kg, and `uncertain` its standard deviation.
pub fn coasted(
    believed: &Believed<'_>,
    direction: Direction,
    intervals: &[Interval],
    extra: &[f64],
    noise_n_per_kg: f64,
    uncertain: f64,
) -> Vec<bool> {
    let line = believed.line(direction);
    // Coasting rather than a held speed, log of the odds.
    let mut rather = Vec::with_capacity(intervals.len());
    let densities: Vec<[f64; REGIMES]> = intervals
        .iter()
        .zip(extra)
        .map(|(interval, extra)| {
            // Beyond that it would be power that drivers apply at the same place, taken for a gradient, and found there ever more.
            let extra = extra.clamp(-MOST_EXTRA_N_PER_KG, MOST_EXTRA_N_PER_KG);
            let load = super::rows::believed_load(line, interval) + extra;
            let effort = interval.acceleration_mps2() + load;
            let speed = interval.mean_speed_mps();
            let most = line.train.max_effort_n_per_kg(speed.max(1.0));
            let r = line.train.davis().resistance_n_per_kg(speed);
            let sd = (noise_n_per_kg * noise_n_per_kg + (uncertain * r).powi(2)).sqrt();
            let student = |x: f64, sd: f64| {
                let z = x / sd;
                (1.0 + z * z / 5.0).powi(-3) / sd
            };
            // Not heavier tails: one interval of power between two of coasting must cost more than to change twice.
            let coast = |z: f64| (-0.5 * z * z).exp() + FAR;
            let hold = 0.7 * student(effort - load, 1.3 * noise_n_per_kg)
                + 0.3 * student(effort - load, 3.0 * noise_n_per_kg);
            let most_hold =
                0.7 * student(0.0, 1.3 * noise_n_per_kg) + 0.3 * student(0.0, 3.0 * noise_n_per_kg);
            // By the description alone: the model must not make coasting of a speed that was held.
            let by_description = (effort - extra) / noise_n_per_kg.hypot(DESCRIBED * r);
            rather.push((coast(by_description) * most_hold / hold).ln());
            let even = |low: f64, high: f64| {
                // A broad plateau with soft edges.
                let outside = (low - effort).max(effort - high).max(0.0);
                student(outside, noise_n_per_kg) * noise_n_per_kg / (high - low)
            };
            if interval.speed_mps[0].min(interval.speed_mps[1]) < 1.5 {
                return [1e-9, 1.0, 1.0, 1.0, 1.0];
            }
            [
                coast(effort / sd) / sd,
                hold,
                even(0.15 * most, 1.1 * most),
                even(-0.8, -0.1),
                // Changing: anywhere between.
                even(-0.5, 1.05 * most) * 0.7,
            ]
        })
        .collect();
    let stay = 1.0 - CHANGE;
    let other = CHANGE / (REGIMES as f64 - 1.0);
    let step = |from: &[f64; REGIMES]| -> [f64; REGIMES] {
        let total: f64 = from.iter().sum();
        core::array::from_fn(|i| stay * from[i] + other * (total - from[i]))
    };
    let scaled = |mut p: [f64; REGIMES]| {
        let total: f64 = p.iter().sum();
        p.iter_mut().for_each(|v| *v /= total.max(1e-300));
        p
    };
    let mut forward = Vec::with_capacity(densities.len());
    let mut now = [1.0 / REGIMES as f64; REGIMES];
    for density in &densities {
        let foreseen = step(&now);
        now = scaled(core::array::from_fn(|i| foreseen[i] * density[i]));
        forward.push(now);
    }
    let mut backward = [1.0; REGIMES];
    let mut coasting = vec![0.0; densities.len()];
    for i in (0..densities.len()).rev() {
        let both = scaled(core::array::from_fn(|k| forward[i][k] * backward[k]));
        coasting[i] = both[0];
        let weighted = core::array::from_fn(|k| densities[i][k] * backward[k]);
        backward = scaled(step(&weighted));
    }
    let beyond = |i: isize| {
        usize::try_from(i)
            .ok()
            .and_then(|i| coasting.get(i))
            .is_none_or(|p| *p > 0.5)
    };
    let mut coasted: Vec<bool> = (0..coasting.len())
        .map(|i| {
            let i = i as isize;
            coasting[i as usize] > ENOUGH && beyond(i - 1) && beyond(i + 1)
        })
        .collect();
    // Down a gradient that balances the resistance a held speed looks like coasting, interval by interval; and power between two coasts must not hide in them.
    let mut at = 0;
    for stretch in coasted.chunk_by_mut(|a, b| a == b) {
        let rather = &rather[at..at + stretch.len()];
        at += stretch.len();
        let around =
            |i: usize| &rather[i.saturating_sub(AROUND)..(i + AROUND + 1).min(rather.len())];
        let all: f64 = rather.iter().sum();
        for (i, coasted) in stretch.iter_mut().enumerate() {
            *coasted &= all > RATHER && around(i).iter().sum::<f64>() > -RATHER_NOT;
        }
    }
    coasted
}
