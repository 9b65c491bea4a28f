//! Power capped in a feeding section.

use crate::config::{PenaltyConfig, TractionConfig};
use crate::fit::{ANYWHERE, Climb};
use crate::traction::limit::{FoundLimit, factor_sd, trimmed};
use crate::traction::shares::{ByPower, SHARES, Shares, density, over_shares, shares};
use crate::traction::{edges::edges, powering::SteadyPower};
use rundown::model::effects::{Effect, PowerLimitSection};
use rundown_files::statistics::{extremes, sorted};

struct Bins {
    low: f64,
    width: f64,
    count: usize,
}

impl Bins {
    fn of(runs: &[Shares<'_>], edge_m: f64) -> Self {
        let (first, last) = extremes(runs.iter().flat_map(|run| run.powering.iter().map(|p| p.location_m)));
        let (low, high) = (first - edge_m, last + edge_m);
        let count = (((high - low) / edge_m).ceil() as usize).clamp(2, 160);
        Self { low, width: (high - low) / count as f64, count }
    }

    fn bin(&self, power: &SteadyPower) -> usize {
        (((power.location_m - self.low) / self.width) as usize).min(self.count - 1)
    }

    fn edge_m(&self, bin: usize) -> f64 {
        self.low + bin as f64 * self.width
    }
}

/// The factors that most phases come near to: under a limit many do. A grid fine enough for the few phases that miss it
/// by three deviations would be dear.
fn factors(runs: &[Shares<'_>], count: usize) -> Vec<f64> {
    const LEAST: f64 = 0.3;
    const STEP: f64 = 0.005;
    const STEPS: usize = 136;
    /// Phases within this of a factor are near, a standard deviation.
    const NEAR: f64 = 0.01;
    // A short section holds a part of a powering phase only.
    let of_phase = |demand: ByPower<'_>| demand.parts().map(|(power, _)| power.ratio).collect();
    let ratios: Vec<Vec<f64>> = runs.iter().flat_map(Shares::by_power).map(of_phase).collect();
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
    peaks.into_iter().take(count).map(factor).collect()
}

/// The best section on the grid for each factor, each phase for itself: from, to, factor.
fn searched(runs: &[Shares<'_>], bins: &Bins, config: &TractionConfig) -> Vec<[f64; 3]> {
    let factors = factors(runs, config.factors);
    // Changes of the gain as the edges move, summed up in both at the end.
    let side = bins.count + 2;
    let mut changes = vec![0.0; factors.len() * side * side];
    let at = shares(config.least_share, 1.0);
    for demand in runs.iter().flat_map(Shares::by_power) {
        let at_any = demand.at_share().map(|sum| config.shared * sum);
        let unlimited = over_shares(&at_any);
        let mut touched: Vec<usize> = demand.parts().map(|(power, _)| bins.bin(power)).collect();
        touched.sort_unstable();
        touched.dedup();
        for (step, factor) in factors.iter().enumerate() {
            // What each touched bin changes at each share.
            let mut of_bins = vec![[0.0; SHARES]; touched.len()];
            let above = at.partition_point(|share| share <= factor);
            for (power, table) in demand.parts() {
                let limited = density(power, *factor, config.stray);
                let bin = touched.partition_point(|bin| *bin < bins.bin(power));
                for k in above..SHARES {
                    of_bins[bin][k] += config.shared * (limited - table[k]);
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
pub fn section(runs: &[Shares<'_>], config: &TractionConfig, penalty: &PenaltyConfig) -> Option<FoundLimit> {
    let bins = Bins::of(runs, config.edge_m);
    let gain = |run: &Shares<'_>, from: f64, to: f64, factor: f64| {
        run.gain(|power| if (from..to).contains(&power.location_m) && power.by_power { factor } else { 1.0 })
    };
    let gain_of = |from: f64, to: f64, factor: f64| runs.iter().map(|run| gain(run, from, to, factor)).sum::<f64>();
    let half = 0.5 * bins.width;
    let climb = Climb {
        steps: [half, half, 0.025],
        shrink: 0.6,
        rounds: 8,
        least: 0.0,
        better: 1e-9,
        first: 1.0,
        both: false,
        range: ANYWHERE,
    };
    let mut starts: Vec<(f64, [f64; 3])> =
        searched(runs, &bins, config).into_iter().map(|start| (gain_of(start[0], start[1], start[2]), start)).collect();
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let climbed = starts
        .iter()
        .take(config.starts)
        .map(|(_, start)| climb.from(*start, |[from, to, factor]| (to > from).then(|| gain_of(from, to, factor))));
    let ([mut from, mut to, factor], most) = climbed.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let powered_m = sorted(at_power(runs));
    let edges = edges(&powered_m, [from, to], most, |[from, to]| gain_of(from, to, factor), config);
    [from, to] = edges.likely_m;
    let inside = powered_m.iter().filter(|at| (from..to).contains(*at)).count();
    if inside as f64 > config.most_inside * powered_m.len() as f64 {
        return None;
    }
    let gain = most.min(trimmed(runs.iter().map(|run| gain(run, from, to, factor))));
    Some(FoundLimit {
        effect: Effect::PowerLimitSection(PowerLimitSection { from_m: from, to_m: to, factor }),
        factor,
        runs: Vec::new(),
        gain,
        value: gain - penalty.coefficient - penalty.section,
        factor_sd: factor_sd(most, |by| gain_of(from, to, factor + by)),
        edges_m: Some(edges.limits_m),
        below_kmh: None,
        demanded: 0.0,
    })
}

/// Locations at which the power limits.
fn at_power(runs: &[Shares<'_>]) -> impl Iterator<Item = f64> {
    let parts = runs.iter().flat_map(|run| run.powering);
    parts.filter(|p| p.by_power).map(|p| p.location_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::GapConfig;

    /// The section that is found where trains that power at each of ten kilometres reach 85 % in so many of them.
    fn found(limited: usize) -> Option<FoundLimit> {
        let part = |run: usize, number: usize| SteadyPower {
            run,
            location_m: 1_000.0 * number as f64,
            speed_mps: 25.0,
            ratio: if number < limited { 0.85 } else { 1.0 } + 0.01 * ((run * 7 + number) as f64).sin(),
            sd: 0.01,
            effort_over_limit: 2.0,
            by_power: true,
            number,
            weight: 1.0,
        };
        let powering: Vec<Vec<SteadyPower>> = (0..20).map(|run| (0..10).map(|at| part(run, at)).collect()).collect();
        let GapConfig { traction, penalty, .. } = GapConfig::default();
        let runs: Vec<Shares<'_>> = powering.iter().map(|powering| Shares::new(powering, &traction)).collect();
        section(&runs, &traction, &penalty)
    }

    #[test]
    fn a_section_that_holds_all_of_the_power_is_the_train() {
        assert_eq!([4, 8, 10].map(|limited| found(limited).is_some()), [true, true, false]);
    }
}
