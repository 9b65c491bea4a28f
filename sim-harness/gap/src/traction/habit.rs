//! How drivers move the handle: the rival of a limit at low speed.
//!
//! A driver leaves the handle where it is, or moves it to a level that this driver, or others of the set, like. How
//! often, and to which levels, is read where a limit at low speed does not act: above that speed, and in the other
//! runs. A level that is common there is no evidence of a limit below.
//!
//! ```text
//! α_k  <-  ((1 - m) α_k + m p_k Σ α) density_i(k)        k: share demanded, p: levels, m: probability that the handle was moved before part i
//! ```
//!
//! (Forward algorithm of a hidden Markov model; Rabiner 1989.)

use crate::config::TractionConfig;
use crate::traction::powering::SteadyPower;
use crate::traction::shares::{Given, SHARES, Shares, over_shares, shares};

/// How often a driver moves the handle from one part of a phase to the next, and to which shares.
#[derive(Clone, Debug)]
pub struct Habit {
    /// While starting, below this speed, and above it: who starts gently always moves it.
    moves: [f64; 2],
    /// The same between phases.
    moved_between: f64,
    below_kmh: f64,
    levels: [f64; SHARES],
    at: [f64; SHARES],
}

/// Demands of a run that are no limit's.
struct Demanded {
    decisions: f64,
    levels: [f64; SHARES],
    /// Neighbours in a phase, below the speed and above it, and how many of them are of different levels.
    pairs: [f64; 2],
    moved: [f64; 2],
}

impl Demanded {
    fn of(run: &Shares<'_>, below_kmh: f64, free: impl Fn(&SteadyPower) -> f64, config: &TractionConfig) -> Self {
        let mut all = Self { decisions: 0.0, levels: [0.0; SHARES], pairs: [0.0; 2], moved: [0.0; 2] };
        for (power, densities) in run.powering.iter().zip(&run.densities) {
            let weight = free(power) * power.weight;
            if weight > 0.0 {
                all.decisions += weight;
                let sum: f64 = densities.iter().sum();
                all.levels.iter_mut().zip(densities).for_each(|(level, d)| *level += weight * d / sum);
            }
        }
        for pair in run.powering.windows(2).filter(|pair| follows(&pair[0], &pair[1])) {
            let weight = free(&pair[0]).min(free(&pair[1]));
            let known = config.alike + config.alike_sd * pair[0].sd.hypot(pair[1].sd);
            let which = which(&pair[0], below_kmh);
            all.pairs[which] += weight;
            all.moved[which] += if (pair[0].ratio - pair[1].ratio).abs() > known { weight } else { 0.0 };
        }
        all
    }
}

/// 0 below a speed, 1 above it.
fn which(power: &SteadyPower, below_kmh: f64) -> usize {
    usize::from(3.6 * power.speed_mps >= below_kmh)
}

/// In one phase, under one share.
fn follows(before: &SteadyPower, after: &SteadyPower) -> bool {
    before.number == after.number && before.by_power == after.by_power
}

/// The habit of each run, from its parts and those of all runs that are free of a limit: `free` says of a part how
/// surely it is, 0 to 1.
pub fn habits(
    runs: &[Shares<'_>],
    below_kmh: f64,
    free: impl Fn(usize, &SteadyPower) -> f64,
    config: &TractionConfig,
) -> Vec<Habit> {
    let of = |(i, run)| Demanded::of(run, below_kmh, |power| free(i, power), config);
    let each: Vec<Demanded> = runs.iter().enumerate().map(of).collect();
    let own = config.own_decisions;
    let rate = |runs: &[Demanded], which: usize, before: f64| {
        let sum = |of: &dyn Fn(&Demanded) -> f64| runs.iter().map(of).sum::<f64>();
        (sum(&|run| run.moved[which]) + own * before) / (sum(&|run| run.pairs[which]) + own)
    };
    let above = rate(&each, 1, config.moves_at_first);
    let moves = [rate(&each, 0, above), above];
    // Each run counts once, and one that may be at any level.
    let mut levels = [1.0 / SHARES as f64; SHARES];
    let telling: Vec<&Demanded> = each.iter().filter(|run| run.decisions > 0.0).collect();
    for run in &telling {
        levels.iter_mut().zip(&run.levels).for_each(|(sum, level)| *sum += level / run.decisions);
    }
    levels.iter_mut().for_each(|level| *level /= telling.len() as f64 + 1.0);
    let of_run = |run: &Demanded| Habit {
        moves: [0, 1].map(|which| rate(core::slice::from_ref(run), which, moves[which])),
        moved_between: config.moved_between,
        below_kmh,
        levels: core::array::from_fn(|k| (run.levels[k] + own * levels[k]) / (run.decisions + own)),
        at: shares(config.least_share, 1.0),
    };
    each.iter().map(of_run).collect()
}

impl Habit {
    /// Log-likelihood of the powering of a run with what a limit gives its parts.
    pub fn likelihood(&self, run: &Shares<'_>, given: &[Option<Given>]) -> f64 {
        let mut chance = self.levels;
        let mut total = 0.0;
        for (i, densities) in run.densities.iter().enumerate() {
            if let Some(before) = i.checked_sub(1) {
                let before = &run.powering[before];
                let moves = match follows(before, &run.powering[i]) {
                    true => self.moves[which(before, self.below_kmh)],
                    false => self.moved_between,
                };
                chance.iter_mut().zip(&self.levels).for_each(|(c, level)| *c = (1.0 - moves) * *c + moves * level);
            }
            let above = given[i].map_or(SHARES, |given| self.at.partition_point(|share| *share <= given.unlimited));
            let limited = given[i].map_or(0.0, |given| given.log_density.exp());
            chance[..above].iter_mut().zip(densities).for_each(|(c, density)| *c *= density);
            chance[above..].iter_mut().for_each(|c| *c *= limited);
            let sum: f64 = chance.iter().sum();
            chance.iter_mut().for_each(|c| *c /= sum);
            total += sum.ln();
        }
        total
    }
}

impl Shares<'_> {
    /// The same where the driver may as well move the handle within a phase, as is the habit. A share that is hardly
    /// above the limit is not known to be limited: the sensor, or the shares of effort and power of one place of the
    /// handle, differ by as much.
    pub fn gain_beside(&self, habit: &Habit, limit: impl Fn(&SteadyPower) -> f64) -> f64 {
        let Some(mut given) = self.given(limit) else { return 0.0 };
        given.iter_mut().flatten().for_each(|given| given.unlimited += self.config.least_scale);
        let with = |[run, phases]: [f64; 2], given: &[Option<Given>]| {
            over_shares(&[run, phases, habit.likelihood(self, given)])
        };
        let unlimited = self.unlimited();
        with(self.limited(&given), &given) - with(unlimited, &vec![None; given.len()])
    }
}
