//! Power capped in a feeding section.

use super::edges::edges;
use super::pulls::Pull;
use super::told::{ByPower, SHARES, Told, density, over_shares, shares};
use super::{FoundLimit, Limit, factor_sd, trimmed};

/// Edges of sections lie on this grid before they are refined, m.
const EDGE_M: f64 = 250.0;
/// Factors that are tried, and how many of their sections are refined.
const FACTORS: usize = 14;
const STARTS: usize = 3;

/// The line in bins.
struct Bins {
    low: f64,
    width: f64,
    count: usize,
}

impl Bins {
    fn of(runs: &[Told<'_>]) -> Self {
        let at = || runs.iter().flat_map(|run| run.pulls.iter().map(|p| p.location_m));
        let low = at().fold(f64::INFINITY, f64::min) - EDGE_M;
        let high = at().fold(f64::NEG_INFINITY, f64::max) + EDGE_M;
        let count = (((high - low) / EDGE_M).ceil() as usize).clamp(2, 160);
        Self { low, width: (high - low) / count as f64, count }
    }

    fn bin(&self, pull: &Pull) -> usize {
        (((pull.location_m - self.low) / self.width) as usize).min(self.count - 1)
    }

    fn edge_m(&self, bin: usize) -> f64 {
        self.low + bin as f64 * self.width
    }
}

/// The factors that most pulls come near to: under a limit many do. A grid fine enough for the few pulls that miss it by three deviations would be dear.
fn factors(runs: &[Told<'_>]) -> Vec<f64> {
    const LEAST: f64 = 0.3;
    const STEP: f64 = 0.005;
    const STEPS: usize = 136;
    /// Pulls within this of a factor are near, a standard deviation.
    const NEAR: f64 = 0.01;
    // A short section holds a part of a pull only.
    let of_pull = |asked: ByPower<'_>| asked.parts().map(|(pull, _)| pull.ratio).collect();
    let ratios: Vec<Vec<f64>> = runs.iter().flat_map(Told::by_power).map(of_pull).collect();
    let factor = |step: usize| LEAST + STEP * step as f64;
    let near = |step: usize| -> f64 {
        let nearest = |parts: &Vec<f64>| {
            let off = parts.iter().map(|ratio| (ratio - factor(step)) / NEAR);
            off.map(|z| (-0.5 * z * z).exp()).fold(0.0, f64::max)
        };
        ratios.iter().map(nearest).sum()
    };
    let near: Vec<f64> = (0..STEPS).map(near).collect();
    let is_peak = |i: &usize| {
        let below = |j: Option<usize>| j.and_then(|j| near.get(j)).is_none_or(|n| *n <= near[*i]);
        near[*i] > 0.0 && below(i.checked_sub(1)) && below(Some(i + 1))
    };
    let mut peaks: Vec<usize> = (0..STEPS).filter(is_peak).collect();
    peaks.sort_by(|a, b| near[*b].total_cmp(&near[*a]));
    peaks.into_iter().take(FACTORS).map(factor).collect()
}

/// What a pull's parts share counts once: of the gauge, and of the speed. So a part counts for less in the search, and a factor need not be met to the last digit.
const SHARED: f64 = 0.25;

/// The best section on the grid for each factor, each pull judged for itself: from, to, factor.
fn searched(runs: &[Told<'_>], bins: &Bins) -> Vec<[f64; 3]> {
    let factors = factors(runs);
    // Changes of the gain as the edges move, summed up in both at the end.
    let side = bins.count + 2;
    let mut changes = vec![0.0; factors.len() * side * side];
    let at = shares(1.0);
    for asked in runs.iter().flat_map(Told::by_power) {
        let at_any = asked.at_share().map(|sum| SHARED * sum);
        let unlimited = over_shares(&at_any);
        let mut touched: Vec<usize> = asked.parts().map(|(pull, _)| bins.bin(pull)).collect();
        touched.sort_unstable();
        touched.dedup();
        for (step, factor) in factors.iter().enumerate() {
            // What each touched bin changes at each share.
            let mut of_bins = vec![[0.0; SHARES]; touched.len()];
            let above = at.partition_point(|share| share <= factor);
            for (pull, table) in asked.parts() {
                let limited = density(pull, *factor);
                let bin = touched.partition_point(|bin| *bin < bins.bin(pull));
                for k in above..SHARES {
                    of_bins[bin][k] += SHARED * (limited - table[k]);
                }
            }
            for first in 0..touched.len() {
                let mut at_share = at_any;
                for last in first..touched.len() {
                    let with = at_share.iter_mut().zip(&of_bins[last]);
                    with.for_each(|(sum, change)| *sum += change);
                    let gain = over_shares(&at_share) - unlimited;
                    // All sections that begin after the bin touched before and end before the one touched next.
                    let begin = if first == 0 { 0 } else { touched[first - 1] + 1 };
                    let end = touched.get(last + 1).map_or(bins.count + 1, |next| next + 1);
                    let mut add = |a: usize, b: usize, gain: f64| changes[(step * side + a) * side + b] += gain;
                    add(begin, touched[last] + 1, gain);
                    add(begin, end, -gain);
                    add(touched[first] + 1, touched[last] + 1, -gain);
                    add(touched[first] + 1, end, gain);
                }
            }
        }
    }
    let best_of = |(step, factor): (usize, &f64)| {
        let mut best = (f64::NEG_INFINITY, [0.0; 3]);
        let mut before = vec![0.0; side];
        for a in 0..bins.count {
            let mut along = 0.0;
            for b in 0..side {
                along += changes[(step * side + a) * side + b];
                before[b] += along;
                if b > a && b <= bins.count && before[b] > best.0 {
                    best = (before[b], [bins.edge_m(a), bins.edge_m(b), *factor]);
                }
            }
        }
        best.1
    };
    factors.iter().enumerate().map(best_of).collect()
}

/// A section of the line in which the power is capped.
pub fn section(runs: &[Told<'_>]) -> Option<FoundLimit> {
    let bins = Bins::of(runs);
    let gain = |run: &Told<'_>, from: f64, to: f64, factor: f64| {
        run.gain(|pull| if (from..to).contains(&pull.location_m) && pull.by_power() { factor } else { 1.0 })
    };
    let gain_of = |from: f64, to: f64, factor: f64| runs.iter().map(|run| gain(run, from, to, factor)).sum::<f64>();
    let climbed = |[mut from, mut to, mut factor]: [f64; 3]| {
        let mut most = gain_of(from, to, factor);
        let mut step = [0.5 * bins.width, 0.5 * bins.width, 0.025];
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
        (most, [from, to, factor])
    };
    let mut starts: Vec<(f64, [f64; 3])> =
        searched(runs, &bins).into_iter().map(|start| (gain_of(start[0], start[1], start[2]), start)).collect();
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let climbed = starts.iter().take(STARTS).map(|(_, start)| climbed(*start));
    let (most, [mut from, mut to, factor]) = climbed.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let mut pulled: Vec<f64> = at_power(runs).collect();
    pulled.sort_by(f64::total_cmp);
    let edges = edges(&pulled, [from, to], most, |[from, to]| gain_of(from, to, factor));
    [from, to] = edges.likely_m;
    let gain = most.min(trimmed(runs.iter().map(|run| gain(run, from, to, factor))));
    Some(FoundLimit {
        limit: Limit::Section { from_m: from, to_m: to, factor },
        gain,
        value: gain - 2.1 - 5.0,
        factor_sd: factor_sd(most, |by| gain_of(from, to, factor + by)),
        edges_m: Some(edges.limits_m),
        below_kmh: None,
    })
}

/// Locations at which the power limits.
fn at_power(runs: &[Told<'_>]) -> impl Iterator<Item = f64> {
    let parts = runs.iter().flat_map(|run| run.pulls);
    parts.filter(|p| p.by_power()).map(|p| p.location_m)
}
