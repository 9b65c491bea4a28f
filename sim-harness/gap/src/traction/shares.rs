//! How likely the powering phases of a run are under a limit, whatever shares its driver demanded.

use crate::config::TractionConfig;
use crate::traction::powering::{SteadyPower, by_number};

/// Shares that drivers demand: finer than what is known of a share.
pub const SHARES: usize = 101;
/// Log density of a ratio when `given` is what the train gives.
pub fn density(power: &SteadyPower, given: f64, stray: f64) -> f64 {
    let z = (power.ratio - given) / power.sd;
    let normal = (-0.5 * z * z).exp() / (power.sd * 2.506_628_274_631);
    power.weight * ((1.0 - stray) * normal + stray / 0.9).ln()
}

/// The shares from a least to a largest one.
pub fn shares(least: f64, most: f64) -> [f64; SHARES] {
    core::array::from_fn(|k| least + (most - least) * k as f64 / (SHARES - 1) as f64)
}

/// Log densities of each ratio at all shares up to a largest one.
fn tables(powering: &[SteadyPower], most: f64, config: &TractionConfig) -> Vec<[f64; SHARES]> {
    let at = shares(config.least_share, most);
    powering.iter().map(|power| at.map(|share| density(power, share, config.stray))).collect()
}

/// Log of the mean over shares of exp(log-likelihood).
pub fn over_shares(of_share: &[f64]) -> f64 {
    let most = of_share.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    most + (of_share.iter().map(|l| (l - most).exp()).sum::<f64>() / of_share.len() as f64).ln()
}

/// Parts that share what a driver demands: of a run or of one powering phase, by effort or by power.
#[derive(Clone, Debug)]
struct Demand {
    parts: Vec<usize>,
    /// Log-likelihood at each share without a limit.
    at_share: [f64; SHARES],
    unlimited: f64,
}

impl Demand {
    fn new(parts: Vec<usize>, tables: &[[f64; SHARES]]) -> Self {
        let at_share = core::array::from_fn(|k| parts.iter().map(|i| tables[*i][k]).sum());
        Self { unlimited: over_shares(&at_share), at_share, parts }
    }
}

/// What a part is given under a limit.
#[derive(Clone, Copy, Debug)]
pub struct Given {
    /// Shares up to this are given as they are demanded.
    pub unlimited: f64,
    /// Log density of the ratio at the limit.
    pub log_density: f64,
}

/// The powering phases of a run with their log densities at all shares: a limit changes those above it only.
#[derive(Clone, Debug)]
pub struct Shares<'a> {
    pub powering: &'a [SteadyPower],
    /// Log density of each ratio at each share.
    tables: Vec<[f64; SHARES]>,
    /// The same as densities.
    pub densities: Vec<[f64; SHARES]>,
    pub(super) config: &'a TractionConfig,
    of_run: [Demand; 2],
    of_phases: Vec<Demand>,
    unlimited: f64,
}

impl<'a> Shares<'a> {
    pub fn new(powering: &'a [SteadyPower], config: &'a TractionConfig) -> Self {
        let tables = tables(powering, 1.0, config);
        let demand = |number: Option<usize>, power: bool| {
            let wanted = |i: &usize| powering[*i].by_power == power && number.is_none_or(|n| powering[*i].number == n);
            Demand::new((0..powering.len()).filter(wanted).collect(), &tables)
        };
        let of_run = [false, true].map(|power| demand(None, power));
        let numbers = by_number(powering).map(|parts| parts[0].number);
        let of_phases: Vec<Demand> = numbers
            .flat_map(|number| [false, true].map(|power| demand(Some(number), power)))
            .filter(|demand| !demand.parts.is_empty())
            .collect();
        let densities = tables.iter().map(|table| table.map(f64::exp)).collect();
        let mut all = Self { powering, of_run, of_phases, unlimited: 0.0, tables, densities, config };
        all.unlimited = all.mean(&|demand: &Demand| demand.unlimited);
        all
    }

    /// The same share all through a run, or another in each powering phase.
    fn either(&self, of: &dyn Fn(&Demand) -> f64) -> [f64; 2] {
        let sum = |demand: &[Demand]| demand.iter().map(of).sum::<f64>();
        [sum(&self.of_run), sum(&self.of_phases)]
    }

    /// Both are as likely.
    fn mean(&self, of: &dyn Fn(&Demand) -> f64) -> f64 {
        over_shares(&self.either(of))
    }

    /// The parts of each powering phase in which the power limits.
    pub fn by_power(&self) -> impl Iterator<Item = ByPower<'_>> {
        let by_power = |demand: &&Demand| self.powering[demand.parts[0]].by_power;
        self.of_phases.iter().filter(by_power).map(|demand| ByPower { of: self, demand })
    }

    /// What a limit adds to the log-likelihood.
    pub fn gain(&self, limit: impl Fn(&SteadyPower) -> f64) -> f64 {
        self.given(limit).map_or(0.0, |given| over_shares(&self.limited(&given)) - self.unlimited)
    }

    /// Without a limit: the same share all through a run, and another in each phase.
    pub(super) fn unlimited(&self) -> [f64; 2] {
        self.either(&|demand: &Demand| demand.unlimited)
    }

    /// What each part is given under a limit; `None` where it limits nothing.
    pub(super) fn given(&self, limit: impl Fn(&SteadyPower) -> f64) -> Option<Vec<Option<Given>>> {
        let of = |power: &SteadyPower| {
            let limit = limit(power);
            (limit < 1.0).then(|| Given { unlimited: limit, log_density: density(power, limit, self.config.stray) })
        };
        let given: Vec<Option<Given>> = self.powering.iter().map(of).collect();
        given.iter().any(Option::is_some).then_some(given)
    }

    /// Log-likelihood under a limit.
    pub(super) fn limited(&self, given: &[Option<Given>]) -> [f64; 2] {
        let at = shares(self.config.least_share, 1.0);
        self.either(&|demand: &Demand| {
            let acting = || demand.parts.iter().filter_map(|i| Some((*i, given[*i]?)));
            if acting().next().is_none() {
                return demand.unlimited;
            }
            let mut at_share = demand.at_share;
            for (i, Given { unlimited, log_density }) in acting() {
                let above = at.partition_point(|share| *share <= unlimited);
                for (sum, without) in at_share[above..].iter_mut().zip(&self.tables[i][above..]) {
                    *sum += log_density - without;
                }
            }
            over_shares(&at_share)
        })
    }

    /// The same if drivers demand another largest share, and the train gives it.
    pub fn gain_up_to(&self, most: f64) -> f64 {
        let tables = tables(self.powering, most, self.config);
        let of = |demand: &Demand| Demand::new(demand.parts.clone(), &tables).unlimited;
        self.mean(&of) - self.unlimited
    }
}

/// The parts of a powering phase in which the power limits.
pub struct ByPower<'a> {
    of: &'a Shares<'a>,
    demand: &'a Demand,
}

impl ByPower<'_> {
    /// Each part with its log densities at all shares.
    pub fn parts(&self) -> impl Iterator<Item = (&SteadyPower, &[f64; SHARES])> {
        let parts = self.demand.parts.iter();
        parts.map(|i| (&self.of.powering[*i], &self.of.tables[*i]))
    }

    /// Log-likelihood at each share without a limit.
    pub fn at_share(&self) -> &[f64; SHARES] {
        &self.demand.at_share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power(number: usize, ratio: f64, power: bool) -> SteadyPower {
        SteadyPower {
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
    fn likelihood(powering: &[SteadyPower], limit: impl Fn(&SteadyPower) -> f64) -> f64 {
        let one_share = |parts: &[SteadyPower], power: bool| {
            let parts = || parts.iter().filter(|part| part.by_power == power);
            let at = |share: f64| {
                parts().map(|part| density(part, share.min(limit(part)), TractionConfig::default().stray)).sum()
            };
            over_shares(&shares(TractionConfig::default().least_share, 1.0).map(at))
        };
        let of = |parts: &[SteadyPower]| one_share(parts, false) + one_share(parts, true);
        over_shares(&[of(powering), by_number(powering).map(of).sum()])
    }

    #[test]
    fn tables_say_what_the_definition_says() {
        let powering = [
            power(0, 0.98, false),
            power(0, 0.71, true),
            power(0, 0.70, true),
            power(1, 0.95, true),
            power(1, 0.72, true),
        ];
        let config = TractionConfig::default();
        let shares = Shares::new(&powering, &config);
        let none = likelihood(&powering, |_| 1.0);
        for factor in [0.3, 0.7, 0.72, 0.9, 1.0, 1.2] {
            let limit = |power: &SteadyPower| if power.by_power { factor } else { 1.0 };
            let defined = likelihood(&powering, limit) - none;
            assert!((shares.gain(limit) - defined).abs() < 1e-9, "{factor}");
        }
        assert!(shares.gain_up_to(1.0).abs() < 1e-12);
        assert!(shares.gain(|_| 0.71) > shares.gain(|_| 0.5));
    }
}
