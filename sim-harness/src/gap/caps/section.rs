//! Power capped in a feeding section.

use super::edges::edges;
use super::pulls::Pull;
use super::told::{SHARES, Told, density, over_shares, shares};
use super::{FoundLimit, Limit, factor_sd, trimmed};

/// Edges of sections lie on this grid before they are refined, m.
const EDGE_M: f64 = 250.0;
const FACTORS: usize = 14;

/// The line in bins.
struct Bins {
    low: f64,
    width: f64,
    count: usize,
}

impl Bins {
    fn of(runs: &[Told<'_>]) -> Self {
        let at = || {
            runs.iter()
                .flat_map(|run| run.pulls.iter().map(|p| p.location_m))
        };
        let low = at().fold(f64::INFINITY, f64::min) - EDGE_M;
        let high = at().fold(f64::NEG_INFINITY, f64::max) + EDGE_M;
        let count = (((high - low) / EDGE_M).ceil() as usize).clamp(2, 160);
        Self {
            low,
            width: (high - low) / count as f64,
            count,
        }
    }

    fn bin(&self, pull: &Pull) -> usize {
        (((pull.location_m - self.low) / self.width) as usize).min(self.count - 1)
    }

    fn edge_m(&self, bin: usize) -> f64 {
        self.low + bin as f64 * self.width
    }
}

fn factor(step: usize) -> f64 {
    0.3 + 0.05 * step as f64
}

/// The best section on the grid, each pull judged for itself: from, to, factor.
fn searched(runs: &[Told<'_>], bins: &Bins) -> [f64; 3] {
    // Changes of the gain as the edges move, summed up in both at the end.
    let side = bins.count + 2;
    let mut changes = vec![0.0; FACTORS * side * side];
    let at = shares(1.0);
    for asked in runs.iter().flat_map(Told::by_power) {
        let mut touched: Vec<usize> = asked.parts().map(|(pull, _)| bins.bin(pull)).collect();
        touched.sort_unstable();
        touched.dedup();
        for step in 0..FACTORS {
            // What each touched bin changes at each share.
            let mut of_bins = vec![[0.0; SHARES]; touched.len()];
            let above = at.partition_point(|share| *share <= factor(step));
            for (pull, table) in asked.parts() {
                let limited = density(pull, factor(step));
                let bin = touched.partition_point(|bin| *bin < bins.bin(pull));
                for k in above..SHARES {
                    of_bins[bin][k] += limited - table[k];
                }
            }
            for first in 0..touched.len() {
                let mut at_share = *asked.at_share();
                for last in first..touched.len() {
                    let with = at_share.iter_mut().zip(&of_bins[last]);
                    with.for_each(|(sum, change)| *sum += change);
                    let gain = over_shares(&at_share) - asked.unlimited();
                    // All sections that begin after the bin touched before and end before the one touched next.
                    let begin = if first == 0 {
                        0
                    } else {
                        touched[first - 1] + 1
                    };
                    let end = touched
                        .get(last + 1)
                        .map_or(bins.count + 1, |next| next + 1);
                    let mut add = |a: usize, b: usize, gain: f64| {
                        changes[(step * side + a) * side + b] += gain
                    };
                    add(begin, touched[last] + 1, gain);
                    add(begin, end, -gain);
                    add(touched[first] + 1, touched[last] + 1, -gain);
                    add(touched[first] + 1, end, gain);
                }
            }
        }
    }
    let mut best = (f64::NEG_INFINITY, [0.0; 3]);
    for step in 0..FACTORS {
        let mut before = vec![0.0; side];
        for a in 0..bins.count {
            let mut along = 0.0;
            for b in 0..side {
                along += changes[(step * side + a) * side + b];
                before[b] += along;
                if b > a && b <= bins.count && before[b] > best.0 {
                    best = (before[b], [bins.edge_m(a), bins.edge_m(b), factor(step)]);
                }
            }
        }
    }
    best.1
}

/// A section of the line in which the power is capped.
pub fn section(runs: &[Told<'_>]) -> Option<FoundLimit> {
    let bins = Bins::of(runs);
    let [mut from, mut to, mut factor] = searched(runs, &bins);
    let gain = |run: &Told<'_>, from: f64, to: f64, factor: f64| {
        run.gain(|pull| {
            if (from..to).contains(&pull.location_m) && pull.by_power() {
                factor
            } else {
                1.0
            }
        })
    };
    let gain_of = |from: f64, to: f64, factor: f64| {
        runs.iter()
            .map(|run| gain(run, from, to, factor))
            .sum::<f64>()
    };
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
    let mut pulled: Vec<f64> = at_power(runs).collect();
    pulled.sort_by(f64::total_cmp);
    let edges = edges(&pulled, [from, to], most, |[from, to]| {
        gain_of(from, to, factor)
    });
    [from, to] = edges.likely_m;
    let gain = most.min(trimmed(runs.iter().map(|run| gain(run, from, to, factor))));
    Some(FoundLimit {
        limit: Limit::Section {
            from_m: from,
            to_m: to,
            factor,
        },
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
