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

use super::fit::LOSS_AT_LIMIT;
use super::rows::Believed;
use super::runs::{Interval, Readings, Run};
use rundown::track::Direction;

/// An interval of steady power: a part of a pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Index of its run.
    pub run: usize,
    /// Location of the front half-way, m.
    pub location_m: f64,
    /// Mean speed, m/s.
    pub speed_mps: f64,
    /// Effort over believed limit.
    pub ratio: f64,
    /// Standard deviation of the ratio.
    pub sd: f64,
    /// Largest effort over the limit at this speed: above 1 where the power limits.
    pub effort_over_limit: f64,
    /// Number of the pull in its run: a driver who lets go and pulls again asks anew.
    pub number: usize,
    /// What it counts for: a driver's hand stays where it is for about 10 s, so nearer samples share one decision.
    pub weight: f64,
}

impl Pull {
    /// The power is what limits, not the effort.
    pub(super) fn by_power(&self) -> bool {
        self.effort_over_limit > BY_POWER
    }
}

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
}

/// Shares that drivers ask for: finer than what is known of a share.
const SHARES: usize = 101;
const LEAST_SHARE: f64 = 0.4;
/// Probability that an interval is not steady power after all.
const STRAY: f64 = 0.1;
/// Effort limit over power limit above which the power limits.
const BY_POWER: f64 = 1.001;
/// Effort limit over power limit up to which the corner reaches.
const CORNER: f64 = 1.35;
/// A limit nearer to the believed one is no finding.
const LEAST_SCALE: f64 = 0.03;
/// What it takes to believe that it is not all drivers who are cautious.
const CAUTION: f64 = 6.0;
/// What the choice of the runs costs.
const BAD_DAYS: f64 = 6.0;
/// Gain of log-likelihood below which a run says nothing of bad days.
const TELLS: f64 = 0.5;
/// More runs than this are no bad days but the train.
const MOST_SLIPPERY: f64 = 0.6;
const LEAST_ACCELERATION_MPS2: f64 = 0.03;
/// Speed that a pull must gain to count, m/s.
const LEAST_GAIN_MPS: f64 = 4.0;
/// Without power for so long, the next power is another pull, s.
const APART_S: f64 = 25.0;
/// A driver leaves the handle where it is for about so long, s.
const DECISION_S: f64 = 10.0;

/// Intervals of steady power of one run. `effort`: measured, or calculated from the change of speed and the model.
pub fn pulls(
    believed: &Believed<'_>,
    direction: Direction,
    intervals: &[Interval],
    effort: &[Option<f64>],
    effort_sd: f64,
) -> Vec<Pull> {
    let train = believed.line(direction).train;
    let ratios: Vec<Option<Pull>> = intervals
        .iter()
        .zip(effort)
        .map(|(interval, effort)| {
            let effort = (*effort)?;
            let limit = interval.mean(|p| train.max_effort_n_per_kg(p.speed_mps.max(0.5)));
            let most = train.max_effort_n_per_kg(0.1);
            let ratio = effort / limit;
            let slowest = interval.speed_mps[0].min(interval.speed_mps[1]);
            let pull = Pull {
                run: interval.run,
                location_m: interval.middle().location_m,
                speed_mps: interval.mean_speed_mps(),
                ratio,
                sd: (effort_sd / limit)
                    .hypot(0.008)
                    .hypot(speed_sd_mps(0.06, most / limit) / interval.mean_speed_mps().max(1.0)),
                effort_over_limit: most / limit,
                number: 0,
                weight: 1.0,
            };
            // Near the corner of effort and power a driver who asks for less effort than power is limited by neither share.
            let at_corner = (BY_POWER..CORNER).contains(&pull.effort_over_limit);
            (ratio > LEAST_SHARE - 0.1
                && !at_corner
                && slowest > 1.5
                && interval.acceleration_mps2() > LEAST_ACCELERATION_MPS2)
                .then_some(pull)
        })
        .collect();
    // Steady: like a neighbour.
    let near = |a: &Pull, b: &Option<Pull>| {
        b.is_some_and(|b| (a.ratio - b.ratio).abs() < 0.02 + 2.5 * a.sd.hypot(b.sd))
    };
    let steady = (0..ratios.len()).filter_map(|i| {
        let pull = ratios[i]?;
        let before = i > 0 && near(&pull, &ratios[i - 1]);
        let after = ratios.get(i + 1).is_some_and(|next| near(&pull, next));
        // Calculated from the change of speed, the interval in which the power is raised looks like less power.
        let raised = effort_sd > 0.0 && (i == 0 || ratios[i - 1].is_none());
        ((before || after) && !raised).then_some(Part {
            time_s: intervals[i].begin_s,
            speeds_mps: intervals[i].speed_mps,
            pull,
        })
    });
    numbered(steady)
}

/// A part of a pull with its time and the speeds around it, m/s.
struct Part {
    time_s: f64,
    speeds_mps: [f64; 2],
    pull: Pull,
}

/// With the numbers of their pulls. A pull that gains little speed keeps a speed rather than reaching one, and says what the driver likes, not what the train gives.
fn numbered(parts: impl Iterator<Item = Part>) -> Vec<Pull> {
    let parts: Vec<Part> = parts.collect();
    let of_pulls = parts.chunk_by(|a, b| b.time_s - a.time_s <= APART_S);
    let wanted = of_pulls.filter(|parts| match parts {
        [first, .., last] => last.speeds_mps[1] - first.speeds_mps[0] > LEAST_GAIN_MPS,
        [only] => only.speeds_mps[1] - only.speeds_mps[0] > LEAST_GAIN_MPS,
        [] => false,
    });
    let numbered = wanted.enumerate().flat_map(|(number, parts)| {
        let pulls = parts.iter().map(|part| part.pull);
        pulls.map(move |pull| Pull { number, ..pull })
    });
    numbered.collect()
}

/// The parts of each pull.
pub(super) fn by_number(pulls: &[Pull]) -> impl Iterator<Item = &[Pull]> {
    pulls.chunk_by(|a, b| a.number == b.number)
}

/// What the reading of the speed is to the ratio, m/s: where the effort is what limits, the limit does not depend on the speed, and only a rise of the effort does.
fn speed_sd_mps(at_power: f64, effort_over_limit: f64) -> f64 {
    if effort_over_limit > BY_POWER {
        at_power
    } else {
        0.03
    }
}

/// Intervals of steady power where the effort is measured at the moments of its samples: no mean over an interval is needed, and a fast log shows more of the first
/// seconds.
pub fn sampled_pulls(
    believed: &Believed<'_>,
    index: usize,
    run: &Run,
    readings: &Readings,
) -> Vec<Pull> {
    /// Samples nearer than this say the same, s.
    const LEAST_S: f64 = 3.0;
    /// Neighbours are at least so far, s: a full acceleration moves the rounded speed by more than its step.
    const NEIGHBOUR_S: f64 = 8.0;
    /// So long after the power is raised it may still rise, s.
    const RISE_S: f64 = 6.0;
    let train = believed.line(run.direction).train;
    let most = train.max_effort_n_per_kg(0.1);
    let read: Vec<(f64, Pull)> = run
        .samples
        .iter()
        .filter_map(|s| {
            let speed_mps = (s.speed_mps? + readings.speed_offset_mps) / readings.speed_scale;
            let limit = train.max_effort_n_per_kg(speed_mps.max(0.5));
            let pull = Pull {
                run: index,
                location_m: s.location_m?,
                speed_mps,
                ratio: s.effort_n_per_kg? / limit,
                sd: 0.008_f64.hypot(speed_sd_mps(0.08, most / limit) / speed_mps.max(1.0)),
                effort_over_limit: most / limit,
                number: 0,
                weight: 1.0,
            };
            Some((s.time_s, pull))
        })
        .collect();
    let mut pulls: Vec<Part> = Vec::new();
    let mut last_s = f64::NEG_INFINITY;
    for (i, (time_s, pull)) in read.iter().enumerate() {
        // Neighbours far enough for a rounded speed to have changed, and for a rising effort to have risen.
        let (before, after) = (&read[..i], &read[i + 1..]);
        let before = before.iter().rfind(|b| time_s - b.0 >= NEIGHBOUR_S);
        let after = after.iter().find(|a| a.0 - time_s >= NEIGHBOUR_S);
        let (Some(before), Some(after)) = (before, after) else {
            continue;
        };
        let near = |other: &(f64, Pull)| (other.1.ratio - pull.ratio).abs() < 0.02 + 2.5 * pull.sd;
        let gains = (after.1.speed_mps - before.1.speed_mps) / (after.0 - before.0);
        // The power was raised since the reading before: by the speed gained, long enough ago?
        let rises_mps = RISE_S * (after.1.speed_mps - pull.speed_mps) / (after.0 - time_s);
        if !near(before) && pull.speed_mps - before.1.speed_mps < rises_mps {
            continue;
        }
        if pull.ratio > LEAST_SHARE - 0.1
            && !(BY_POWER..CORNER).contains(&pull.effort_over_limit)
            && pull.speed_mps > 1.5
            && gains > LEAST_ACCELERATION_MPS2
            && (near(before) || near(after))
            && time_s - last_s >= LEAST_S
        {
            let weight = ((time_s - last_s) / DECISION_S).min(1.0);
            pulls.push(Part {
                time_s: *time_s,
                speeds_mps: [before.1.speed_mps, after.1.speed_mps],
                pull: Pull { weight, ..*pull },
            });
            last_s = *time_s;
        }
    }
    numbered(pulls.into_iter())
}

/// Log density of a ratio when `given` is what the train gives.
fn density(pull: &Pull, given: f64) -> f64 {
    let z = (pull.ratio - given) / pull.sd;
    let normal = (-0.5 * z * z).exp() / (pull.sd * 2.506_628_274_631);
    pull.weight * ((1.0 - STRAY) * normal + STRAY / 0.9).ln()
}

fn shares(most: f64) -> impl Iterator<Item = f64> {
    (0..SHARES).map(move |k| LEAST_SHARE + (most - LEAST_SHARE) * k as f64 / (SHARES - 1) as f64)
}

/// Log of the mean over shares of exp(log-likelihood).
fn over_shares(of_share: &[f64]) -> f64 {
    let most = of_share.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    most + (of_share.iter().map(|l| (l - most).exp()).sum::<f64>() / of_share.len() as f64).ln()
}

fn run_likelihood(pulls: &[Pull], most_share: f64, limit: impl Fn(&Pull) -> f64) -> f64 {
    let one_share = |parts: &[Pull], power: bool| {
        let parts = || parts.iter().filter(|part| part.by_power() == power);
        let of_share: Vec<f64> = shares(most_share)
            .map(|share| {
                parts()
                    .map(|part| density(part, share.min(limit(part))))
                    .sum()
            })
            .collect();
        over_shares(&of_share)
    };
    let of = |parts: &[Pull]| one_share(parts, false) + one_share(parts, true);
    over_shares(&[of(pulls), by_number(pulls).map(of).sum()])
}

/// All limits that are better than the believed one, best first. `pulls` by run.
pub fn limits(pulls: &[Vec<Pull>]) -> Vec<FoundLimit> {
    let runs: Vec<&[Pull]> = pulls
        .iter()
        .map(Vec::as_slice)
        .filter(|p| p.len() >= 2)
        .collect();
    if runs.len() < 3 {
        return Vec::new();
    }
    let believed: Vec<f64> = runs
        .iter()
        .map(|p| run_likelihood(p, 1.0, |_| 1.0))
        .collect();
    let mut found = Vec::new();
    found.extend(scale(&runs, &believed));
    found.extend(section(&runs, &believed));
    found.extend(adhesion(&runs, &believed));
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

fn best_factor(
    range: impl Iterator<Item = f64>,
    gain: impl Fn(f64) -> f64,
) -> Option<(f64, f64, f64)> {
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
    // Curvature of the log-likelihood, over a step wide enough for its roughness.
    let h = 0.01;
    let curvature = (2.0 * most - gain(factor - h) - gain(factor + h)) / (h * h);
    let sd = if curvature > 0.0 {
        1.0 / curvature.sqrt()
    } else {
        h
    };
    Some((factor, most, sd))
}

/// The train gives another share of its description everywhere. Either drivers ask for more than it gives, and many runs lie at the very limit; or what they ask
/// for scales with what there is, and no run comes near the described limit (which may also be caution: dearer).
fn scale(runs: &[&[Pull]], believed: &[f64]) -> Option<FoundLimit> {
    let capped = |factor: f64| -> Vec<f64> {
        runs.iter()
            .zip(believed)
            .map(|(p, b)| run_likelihood(p, factor.max(1.0), |_| factor) - b)
            .collect()
    };
    let scaled = |factor: f64| -> Vec<f64> {
        runs.iter()
            .zip(believed)
            .map(|(p, b)| run_likelihood(p, factor, |_| factor) - b)
            .collect()
    };
    let one = |of: &dyn Fn(f64) -> Vec<f64>, cost: f64| {
        let range = (15..40)
            .map(|i| 0.04 * f64::from(i))
            .filter(|f| (f - 1.0).abs() > LEAST_SCALE);
        let (factor, _, factor_sd) = best_factor(range, |factor| of(factor).iter().sum())?;
        let gain = trimmed(of(factor).into_iter()).min(of(factor).iter().sum());
        ((factor - 1.0).abs() > LEAST_SCALE).then_some(FoundLimit {
            limit: Limit::Scale { factor },
            gain,
            value: gain - cost,
            factor_sd,
            edges_m: None,
        })
    };
    [one(&capped, 2.1), one(&scaled, 2.1 + CAUTION)]
        .into_iter()
        .flatten()
        .max_by(|a, b| a.value.total_cmp(&b.value))
}

/// Edges of sections lie on this grid before they are refined, m.
const EDGE_M: f64 = 250.0;
const FACTORS: usize = 14;

fn section(runs: &[&[Pull]], believed: &[f64]) -> Option<FoundLimit> {
    let at = || runs.iter().flat_map(|p| p.iter().map(|p| p.location_m));
    let low = at().fold(f64::INFINITY, f64::min) - EDGE_M;
    let high = at().fold(f64::NEG_INFINITY, f64::max) + EDGE_M;
    let bins = (((high - low) / EDGE_M).ceil() as usize).clamp(2, 160);
    let width = (high - low) / bins as f64;
    let bin = |pull: &Pull| (((pull.location_m - low) / width) as usize).min(bins - 1);
    let mut gains = vec![0.0; FACTORS * (bins + 1) * (bins + 1)];
    // Searched pull by pull, judged run by run.
    for pulls in runs.iter().flat_map(|run| by_number(run)) {
        let touched: Vec<bool> = {
            let mut touched = vec![false; bins];
            pulls.iter().for_each(|p| touched[bin(p)] = true);
            touched
        };
        // A section limits the power only.
        let pulls: Vec<&Pull> = pulls.iter().filter(|p| p.by_power()).collect();
        // Log density of each part at each share.
        let at_share: Vec<Vec<f64>> = shares(1.0)
            .map(|share| pulls.iter().map(|p| density(p, share)).collect())
            .collect();
        let all: Vec<f64> = at_share.iter().map(|parts| parts.iter().sum()).collect();
        let believed = over_shares(&all);
        for f in 0..FACTORS {
            let factor = 0.3 + 0.05 * f as f64;
            let at_factor: Vec<f64> = pulls.iter().map(|p| density(p, factor)).collect();
            // Cumulative change of log-likelihood by bin, for each share.
            let mut cumulative = vec![[0.0; SHARES]; bins + 1];
            for (k, share) in shares(1.0).enumerate() {
                let mut change = vec![0.0; bins];
                // A share below the factor is not limited.
                if share > factor {
                    for (i, pull) in pulls.iter().enumerate() {
                        change[bin(pull)] += at_factor[i] - at_share[k][i];
                    }
                }
                for b in 0..bins {
                    cumulative[b + 1][k] = cumulative[b][k] + change[b];
                }
            }
            for a in 0..bins {
                let mut last = 0.0;
                for b in a + 1..=bins {
                    if touched[b - 1] {
                        let of_share: [f64; SHARES] =
                            core::array::from_fn(|k| all[k] + cumulative[b][k] - cumulative[a][k]);
                        last = over_shares(&of_share) - believed;
                    }
                    gains[(f * (bins + 1) + a) * (bins + 1) + b] += last;
                }
            }
        }
    }
    let best = (0..gains.len()).max_by(|a, b| gains[*a].total_cmp(&gains[*b]))?;
    let (f, a, b) = (
        best / ((bins + 1) * (bins + 1)),
        best / (bins + 1) % (bins + 1),
        best % (bins + 1),
    );
    let total: f64 = believed.iter().sum();
    let likelihood = |pulls: &[Pull], from: f64, to: f64, factor: f64| {
        run_likelihood(pulls, 1.0, |pull| {
            if (from..to).contains(&pull.location_m) && pull.by_power() {
                factor
            } else {
                1.0
            }
        })
    };
    let gain_of = |from: f64, to: f64, factor: f64| {
        let of_runs = runs.iter().map(|p| likelihood(p, from, to, factor));
        of_runs.sum::<f64>() - total
    };
    let (mut from, mut to) = (low + a as f64 * width, low + b as f64 * width);
    let mut factor = 0.3 + 0.05 * f as f64;
    let mut most = gain_of(from, to, factor);
    let mut step = [0.5 * width, 0.5 * width, 0.025];
    for _ in 0..8 {
        for (which, step) in step.iter().enumerate() {
            for by in [*step, -*step] {
                let mut other = [from, to, factor];
                other[which] += by;
                let now = gain_of(other[0], other[1], other[2]);
                if now > most + 1e-9 && other[1] > other[0] {
                    [from, to, factor] = other;
                    most = now;
                }
            }
        }
        step.iter_mut().for_each(|s| *s *= 0.6);
    }
    let mut pulled: Vec<f64> = at_power(runs).collect();
    pulled.sort_by(f64::total_cmp);
    let edges = edges(&pulled, [from, to], most, |[from, to]| {
        gain_of(from, to, factor)
    });
    [from, to] = edges.likely_m;
    let h = 0.01;
    let curvature =
        (2.0 * most - gain_of(from, to, factor - h) - gain_of(from, to, factor + h)) / (h * h);
    let of_runs = runs.iter().zip(believed);
    let of_runs = of_runs.map(|(p, believed)| likelihood(p, from, to, factor) - believed);
    let gain = most.min(trimmed(of_runs));
    Some(FoundLimit {
        limit: Limit::Section {
            from_m: from,
            to_m: to,
            factor,
        },
        gain,
        value: gain - 2.1 - 5.0,
        factor_sd: if curvature > 0.0 {
            1.0 / curvature.sqrt()
        } else {
            h
        },
        edges_m: Some(edges.limits_m),
    })
}

/// Locations at which the power limits.
fn at_power(runs: &[&[Pull]]) -> impl Iterator<Item = f64> {
    let parts = runs.iter().flat_map(|run| run.iter());
    parts.filter(|p| p.by_power()).map(|p| p.location_m)
}

/// Where the edges of a section may lie.
struct Edges {
    likely_m: [f64; 2],
    limits_m: [(f64, f64); 2],
}

/// Moves each edge from pull to pull until the log-likelihood has lost what a 95 % limit allows. `pulled`: locations of the pulls, rising.
///
/// Where trains pull on both sides the edge lies half-way between the last pull that is limited and the first that is not. Where they do not, the section is taken to end soon
/// after the last one that is.
fn edges(pulled: &[f64], best_m: [f64; 2], most: f64, gain: impl Fn([f64; 2]) -> f64) -> Edges {
    /// A loss that is none.
    const SAME: f64 = 0.3;
    /// Nearer pulls are not tried one by one, m.
    const STEP_M: f64 = 50.0;
    /// How far beyond the last pull an edge is put at most, m.
    const SOON_M: f64 = 500.0;
    let reach = |edge: usize, outwards: bool, loss: f64| {
        let up = (edge == 1) == outwards;
        let mut reached = best_m[edge];
        let beyond = |at: f64, last: f64| if up { at > last } else { at < last };
        let mut tried = reached;
        let ahead: Vec<f64> = if up {
            pulled.to_vec()
        } else {
            pulled.iter().rev().copied().collect()
        };
        for at in ahead.into_iter().filter(|at| beyond(*at, best_m[edge])) {
            if (at - tried).abs() < STEP_M {
                continue;
            }
            // Just past the pull: it has changed sides.
            tried = if up { at + 1.0 } else { at - 1.0 };
            let mut moved = best_m;
            moved[edge] = tried;
            if moved[0] >= moved[1] || gain(moved) < most - loss {
                // Up to this pull nothing was lost.
                return at;
            }
            reached = tried;
        }
        match (outwards, up) {
            (true, true) => f64::INFINITY,
            (true, false) => f64::NEG_INFINITY,
            (false, _) => reached,
        }
    };
    let edge = |edge: usize| {
        let [inner, outer] = [false, true].map(|outwards| reach(edge, outwards, SAME));
        let half = (0.5 * (outer - inner)).clamp(-SOON_M, SOON_M);
        let limits = [false, true].map(|outwards| reach(edge, outwards, LOSS_AT_LIMIT));
        (
            inner + half,
            (limits[0].min(limits[1]), limits[0].max(limits[1])),
        )
    };
    let (from, to) = (edge(0), edge(1));
    Edges {
        likely_m: [from.0, to.0],
        limits_m: [from.1, to.1],
    }
}

fn adhesion(runs: &[&[Pull]], believed: &[f64]) -> Option<FoundLimit> {
    let limit = |pull: &Pull, factor: f64, below_kmh: f64| {
        if 3.6 * pull.speed_mps < below_kmh {
            factor * pull.effort_over_limit
        } else {
            1.0
        }
    };
    let gains = |factor: f64, below_kmh: f64| -> Vec<f64> {
        runs.iter()
            .zip(believed)
            .map(|(p, believed)| {
                run_likelihood(p, 1.0, |pull| limit(pull, factor, below_kmh)) - believed
            })
            .collect()
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
        let total = gains
            .iter()
            .map(|g| (share * g.clamp(-50.0, 700.0).exp() + 1.0 - share).ln())
            .sum();
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
        for (f, b) in [
            (step, 0.0),
            (-step, 0.0),
            (0.0, 100.0 * step),
            (0.0, -100.0 * step),
        ] {
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
        .filter_map(|(i, _)| runs[i].first().map(|p| p.run))
        .collect();
    if slippery.is_empty() || slippery.len() as f64 > MOST_SLIPPERY * runs.len() as f64 {
        return None;
    }
    Some(FoundLimit {
        limit: Limit::Adhesion {
            factor,
            below_kmh: below,
            runs: slippery,
        },
        gain: total,
        value: total - 2.0 * 2.1 - 1.5 - BAD_DAYS,
        factor_sd: 0.01,
        edges_m: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Trains pull every 100 m from 1 to 4 km; the section begins at 2 km, and at `to_m` it ends.
    fn found(to_m: f64) -> Edges {
        let pulled: Vec<f64> = (10..=40).map(|i| 100.0 * f64::from(i)).collect();
        let wrong = |[from, end]: [f64; 2]| {
            let at = |section: (f64, f64), at: f64| section.0 <= at && at < section.1;
            let differs = |p: &&f64| at((from, end), **p) != at((2_000.0, to_m), **p);
            pulled.iter().filter(differs).count() as f64
        };
        edges(&pulled, [1_990.0, to_m.min(4_050.0)], 0.0, |section| {
            -10.0 * wrong(section)
        })
    }

    #[test]
    fn an_edge_lies_between_the_pulls_that_tell() {
        let found = found(3_000.0);
        assert!((found.likely_m[0] - 1_950.0).abs() < 60.0);
        assert!((found.likely_m[1] - 2_950.0).abs() < 60.0);
        assert!(found.limits_m[0].0 <= 2_000.0 && found.limits_m[0].1 >= 1_900.0);
        assert!(found.limits_m[1].1 - found.limits_m[1].0 < 300.0);
    }

    #[test]
    fn where_no_train_pulls_a_section_ends_soon_after_the_last_pull() {
        let found = found(9_000.0);
        assert!((4_000.0..=4_600.0).contains(&found.likely_m[1]));
        assert_eq!(found.limits_m[1].1, f64::INFINITY);
    }
}
