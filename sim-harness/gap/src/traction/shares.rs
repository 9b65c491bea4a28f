//! How likely the pulls of a run are under a limit, whatever shares its driver asked for.

use crate::config::TractionConfig;
use crate::traction::pulls::{Pull, by_number};

/// Shares that drivers ask for: finer than what is known of a share.
pub const SHARES: usize = 101;
/// Log density of a ratio when `given` is what the train gives.
pub fn density(pull: &Pull, given: f64, stray: f64) -> f64 {
    let z = (pull.ratio - given) / pull.sd;
    let normal = (-0.5 * z * z).exp() / (pull.sd * 2.506_628_274_631);
    pull.weight * ((1.0 - stray) * normal + stray / 0.9).ln()
}

/// The shares from a least to a largest one.
pub fn shares(least: f64, most: f64) -> [f64; SHARES] {
    core::array::from_fn(|k| least + (most - least) * k as f64 / (SHARES - 1) as f64)
}

/// Log densities of each ratio at all shares up to a largest one.
fn tables(pulls: &[Pull], most: f64, config: &TractionConfig) -> Vec<[f64; SHARES]> {
    let at = shares(config.least_share, most);
    pulls.iter().map(|pull| at.map(|share| density(pull, share, config.stray))).collect()
}

/// Log of the mean over shares of exp(log-likelihood).
pub fn over_shares(of_share: &[f64]) -> f64 {
    let most = of_share.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    most + (of_share.iter().map(|l| (l - most).exp()).sum::<f64>() / of_share.len() as f64).ln()
}

/// Parts that share what a driver asks for: of a run or of one pull, by effort or by power.
#[derive(Clone, Debug)]
struct Asked {
    /// Indices of the parts.
    parts: Vec<usize>,
    /// Log-likelihood at each share without a limit.
    at_share: [f64; SHARES],
    unlimited: f64,
}

impl Asked {
    fn new(parts: Vec<usize>, tables: &[[f64; SHARES]]) -> Self {
        let at_share = core::array::from_fn(|k| parts.iter().map(|i| tables[*i][k]).sum());
        Self { unlimited: over_shares(&at_share), at_share, parts }
    }
}

/// The pulls of a run with their log densities at all shares: a limit changes those above it only.
#[derive(Clone, Debug)]
pub struct Shares<'a> {
    /// The parts of the pulls.
    pub pulls: &'a [Pull],
    tables: Vec<[f64; SHARES]>,
    config: &'a TractionConfig,
    of_run: [Asked; 2],
    of_pulls: Vec<Asked>,
    unlimited: f64,
}

impl<'a> Shares<'a> {
    /// Of a run.
    pub fn new(pulls: &'a [Pull], config: &'a TractionConfig) -> Self {
        let tables = tables(pulls, 1.0, config);
        let asked = |number: Option<usize>, power: bool| {
            let wanted = |i: &usize| pulls[*i].by_power == power && number.is_none_or(|n| pulls[*i].number == n);
            Asked::new((0..pulls.len()).filter(wanted).collect(), &tables)
        };
        let of_run = [false, true].map(|power| asked(None, power));
        let numbers = by_number(pulls).map(|parts| parts[0].number);
        let of_pulls: Vec<Asked> = numbers
            .flat_map(|number| [false, true].map(|power| asked(Some(number), power)))
            .filter(|asked| !asked.parts.is_empty())
            .collect();
        let mut all = Self { pulls, of_run, of_pulls, unlimited: 0.0, tables, config };
        all.unlimited = all.mean(&|asked: &Asked| asked.unlimited);
        all
    }

    /// The same share all through a run, or another in each pull: both are as likely.
    fn mean(&self, of: &dyn Fn(&Asked) -> f64) -> f64 {
        let sum = |asked: &[Asked]| asked.iter().map(of).sum::<f64>();
        over_shares(&[sum(&self.of_run), sum(&self.of_pulls)])
    }

    /// The parts of each pull in which the power limits.
    pub fn by_power(&self) -> impl Iterator<Item = ByPower<'_>> {
        let by_power = |asked: &&Asked| self.pulls[asked.parts[0]].by_power;
        self.of_pulls.iter().filter(by_power).map(|asked| ByPower { of: self, asked })
    }

    /// What a limit adds to the log-likelihood.
    pub fn gain(&self, limit: impl Fn(&Pull) -> f64) -> f64 {
        let given: Vec<Option<(f64, f64)>> = self
            .pulls
            .iter()
            .map(|pull| {
                let limit = limit(pull);
                (limit < 1.0).then(|| (limit, density(pull, limit, self.config.stray)))
            })
            .collect();
        if given.iter().all(Option::is_none) {
            return 0.0;
        }
        let at = shares(self.config.least_share, 1.0);
        let limited = |asked: &Asked| {
            let acting = || asked.parts.iter().filter_map(|i| Some((*i, given[*i]?)));
            if acting().next().is_none() {
                return asked.unlimited;
            }
            let mut at_share = asked.at_share;
            for (i, (limit, density)) in acting() {
                let above = at.partition_point(|share| *share <= limit);
                for (sum, without) in at_share[above..].iter_mut().zip(&self.tables[i][above..]) {
                    *sum += density - without;
                }
            }
            over_shares(&at_share)
        };
        self.mean(&limited) - self.unlimited
    }

    /// The same if drivers ask for another largest share, and the train gives it.
    pub fn gain_up_to(&self, most: f64) -> f64 {
        let tables = tables(self.pulls, most, self.config);
        let of = |asked: &Asked| Asked::new(asked.parts.clone(), &tables).unlimited;
        self.mean(&of) - self.unlimited
    }
}

/// The parts of a pull in which the power limits.
pub struct ByPower<'a> {
    of: &'a Shares<'a>,
    asked: &'a Asked,
}

impl ByPower<'_> {
    /// Each part with its log densities at all shares.
    pub fn parts(&self) -> impl Iterator<Item = (&Pull, &[f64; SHARES])> {
        let parts = self.asked.parts.iter();
        parts.map(|i| (&self.of.pulls[*i], &self.of.tables[*i]))
    }

    /// Log-likelihood at each share without a limit.
    pub fn at_share(&self) -> &[f64; SHARES] {
        &self.asked.at_share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pull(number: usize, ratio: f64, power: bool) -> Pull {
        Pull {
            run: 0,
            location_m: 0.0,
            speed_mps: 20.0,
            ratio,
            sd: 0.01,
            effort_over_limit: if power { 2.0 } else { 1.0 },
            by_power: power,
            number,
            weight: 1.0,
        }
    }

    /// The definition, share by share.
    fn likelihood(pulls: &[Pull], limit: impl Fn(&Pull) -> f64) -> f64 {
        let one_share = |parts: &[Pull], power: bool| {
            let parts = || parts.iter().filter(|part| part.by_power == power);
            let at = |share: f64| {
                parts().map(|part| density(part, share.min(limit(part)), TractionConfig::default().stray)).sum()
            };
            over_shares(&shares(TractionConfig::default().least_share, 1.0).map(at))
        };
        let of = |parts: &[Pull]| one_share(parts, false) + one_share(parts, true);
        over_shares(&[of(pulls), by_number(pulls).map(of).sum()])
    }

    #[test]
    fn tables_say_what_the_definition_says() {
        let pulls =
            [pull(0, 0.98, false), pull(0, 0.71, true), pull(0, 0.70, true), pull(1, 0.95, true), pull(1, 0.72, true)];
        let config = TractionConfig::default();
        let told = Shares::new(&pulls, &config);
        let none = likelihood(&pulls, |_| 1.0);
        for factor in [0.3, 0.7, 0.72, 0.9, 1.0, 1.2] {
            let limit = |pull: &Pull| if pull.by_power { factor } else { 1.0 };
            let defined = likelihood(&pulls, limit) - none;
            assert!((told.gain(limit) - defined).abs() < 1e-9, "{factor}");
        }
        assert!(told.gain_up_to(1.0).abs() < 1e-12);
        assert!(told.gain(|_| 0.71) > told.gain(|_| 0.5));
    }
}
