//! Do trains give less than the described power wherever it limits them, and all of the described effort below?
//!
//! No section has it, so [`section`](crate::traction::section) leaves it alone, and [`scale`](crate::traction::scale)
//! has effort and power alike. It is not named, for all drivers may demand less there; but it must not be silent.

use crate::config::TractionConfig;
use crate::traction::powering::SteadyPower;
use rundown_files::statistics::{quantile, sorted};
use std::collections::BTreeSet;

/// What trains give of the described power, where they give all of the effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LessPower {
    /// Beside the share of the effort: what both are too large by is the column's.
    pub share: f64,
    /// Where the power begins to limit, km/h.
    pub above_kmh: f64,
    pub intervals: usize,
    pub runs: usize,
}

/// None where trains give about as much of either, or too few runs show both.
pub fn less_power(powering: &[Vec<SteadyPower>], config: &TractionConfig) -> Option<LessPower> {
    let of = |by_power: bool| -> Vec<&SteadyPower> {
        powering.iter().flatten().filter(|power| power.by_power == by_power).collect()
    };
    let runs = |all: &[&SteadyPower]| all.iter().map(|power| power.run).collect::<BTreeSet<usize>>().len();
    let largest = |all: &[&SteadyPower]| -> Option<f64> {
        let are_many = all.len() >= config.shown_intervals && runs(all) >= config.shown_runs;
        quantile(&sorted(all.iter().map(|power| power.ratio)), config.largest).filter(|_| are_many)
    };
    let [by_power, by_effort] = [true, false].map(of);
    let [power, effort] = [largest(&by_power)?, largest(&by_effort)?];
    let share = power / effort.max(1.0);
    let above_kmh = 3.6 * quantile(&sorted(by_power.iter().map(|power| power.speed_mps)), 1.0 - config.largest)?;
    let (intervals, runs) = (by_power.len(), runs(&by_power));
    let is_less = |share: f64| share < 1.0 - config.less_power;
    (is_less(share) && is_less(power) && !is_less(effort)).then_some(LessPower { share, above_kmh, intervals, runs })
}

impl LessPower {
    /// For a reader.
    pub fn sentence(&self) -> String {
        format!(
            "Where the described power limits, above {:.0} km/h, trains give at most {:.2} of it ({} intervals of {} runs), though below they give all of the described tractive effort: max_power_w is that much smaller, or all drivers demand less there. No name has that, and what is simulated still has the described power.",
            self.above_kmh, self.share, self.intervals, self.runs
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::GapConfig;

    /// Ten runs that power with these shares of effort and power, a driver in three with 0.8 of both.
    fn found([effort, power]: [f64; 2], runs: usize) -> Option<f64> {
        let interval = |run: usize, i: usize| {
            let by_power = i >= 5;
            let demanded = if run.is_multiple_of(3) { 0.8_f64 } else { 1.0 };
            let ratio = demanded.min(if by_power { power } else { effort }) + 0.004 * (i as f64).sin();
            let speed_mps = 5.0 + 2.0 * i as f64;
            SteadyPower { run, speed_mps, ratio, by_power, ..SteadyPower::default() }
        };
        let powering: Vec<Vec<SteadyPower>> =
            (0..runs).map(|run| (0..12).map(|i| interval(run, i)).collect()).collect();
        less_power(&powering, &GapConfig::default().traction).map(|less| less.share)
    }

    #[test]
    fn less_power_than_described_is_seen_beside_all_of_the_effort() {
        let share = found([1.0, 0.85], 10).unwrap();
        assert!((share - 0.85).abs() < 0.01, "{share}");
        assert_eq!(found([1.0, 1.0], 10), None);
        assert_eq!(found([0.9, 0.9], 10), None, "another scale of both");
        assert_eq!(found([0.9, 0.75], 10), None, "less of both");
        assert_eq!(found([1.2, 1.0], 10), None, "all of the power");
        assert_eq!(found([1.0, 0.85], 3), None, "too few runs");
    }
}
