//! Nelder and Mead's simplex over the parameters, from Table 1 and from a spread of the points that double precision
//! can carry.

use super::parameters::{COUNT, PARAMETERS, Place, place};
use super::score::Bench;
use argmin::core::{CostFunction, Error, Executor, State, TerminationReason};
use argmin::solver::neldermead::NelderMead;
use rundown::{filter::ukf::Spread, tick::paper::PaperConfig};
use std::cell::Cell;

/// First step of the simplex in each coordinate; a step of 1 is a factor of 10.
const STEP: f64 = 0.5;
/// Standard deviation of the costs of the simplex at which the search ends.
const TOLERANCE: f64 = 1e-6;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    pub place: Place,
    pub cost: f64,
    pub evaluations: u64,
    /// Searches that ended because the evaluations did, before their simplex had settled: what was found is no optimum
    /// then.
    pub unsettled: usize,
    /// By how much the second half of the trials made the cost less: how far the optimum may still be.
    pub late_gain: f64,
}

#[derive(Debug, thiserror::Error)]
#[error("the search ended without a result: {0}")]
pub struct SearchError(String);

struct Problem<'a, F> {
    bench: &'a Bench,
    done: &'a F,
    /// Trials after which the search is half over, those that were made, and the least cost until then.
    half: u64,
    tried: &'a Cell<u64>,
    of_half: &'a Cell<f64>,
}

impl Minimum {
    /// Why it is no optimum, for people; none where it is one.
    pub fn caveat(&self) -> Option<String> {
        let (unsettled, all) = (self.unsettled, starts().len());
        (unsettled > 0).then(|| {
            format!(
                "{unsettled} of {all} searches ended with the {} configurations, before an optimum: what stands here as one is the best that was tried, and the second half of the trials gained {:.2e} of log-likelihood a sample; --evaluations takes more",
                self.evaluations, self.late_gain
            )
        })
    }
}

impl<F: Fn()> CostFunction for Problem<'_, F> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, place: &Vec<f64>) -> Result<f64, Error> {
        (self.done)();
        let place = Place::try_from(place.as_slice())?;
        // Beyond the ranges the cost rises, or the simplex would wander where nothing changes.
        let beyond: f64 = (0..COUNT)
            .map(|i| {
                let [least, most] = PARAMETERS[i].ends();
                (least - place[i]).max(place[i] - most).max(0.0)
            })
            .sum();
        let cost = self.bench.cost(&place) + beyond;
        self.tried.set(self.tried.get() + 1);
        if self.tried.get() <= self.half {
            self.of_half.set(self.of_half.get().min(cost));
        }
        Ok(cost)
    }
}

pub fn starts() -> [Place; 2] {
    let wide = PaperConfig {
        spread: Spread::WIDE,
        initial_speed_sd_kmh: 1.0,
        acceleration_noise_mps2: 0.01,
        ..PaperConfig::default()
    };
    [place(&PaperConfig::default()), place(&wide)]
}

/// Searches from each start with about this many evaluations in all; `done` is called at each.
pub fn search(bench: &Bench, evaluations: u64, done: impl Fn()) -> Result<Minimum, SearchError> {
    let failed = |error: Error| SearchError(error.to_string());
    let starts = starts();
    let of_start = evaluations / starts.len() as u64;
    let mut best: Option<Minimum> = None;
    let (mut all, mut unsettled) = (0, 0);
    for start in starts {
        let simplex = (0..=COUNT).map(|corner| {
            let mut place = start.to_vec();
            if let Some(index) = corner.checked_sub(1) {
                let [least, most] = PARAMETERS[index].ends();
                // Towards the middle of the range, so that no corner begins outside.
                let inwards = if place[index] > 0.5 * (least + most) { -STEP } else { STEP };
                place[index] += inwards;
            }
            place
        });
        let solver = NelderMead::new(simplex.collect()).with_sd_tolerance(TOLERANCE).map_err(failed)?;
        let (tried, of_half) = (Cell::new(0), Cell::new(f64::INFINITY));
        let problem = Problem { bench, done: &done, half: of_start / 2, tried: &tried, of_half: &of_half };
        // A step of the simplex asks for one or two costs.
        let steps = (of_start.saturating_sub(COUNT as u64 + 1) / 2).max(1);
        let result = Executor::new(problem, solver)
            .configure(|state| state.max_iters(steps))
            .timer(false)
            .run()
            .map_err(failed)?;
        all += result.problem.counts.get("cost_count").copied().unwrap_or(0);
        let state = result.state();
        unsettled += usize::from(state.get_termination_reason() != Some(&TerminationReason::SolverConverged));
        let place = state.get_best_param();
        let place = place.and_then(|place| Place::try_from(place.as_slice()).ok());
        let place = place.ok_or_else(|| SearchError("no best place".to_owned()))?;
        let cost = state.get_best_cost();
        if best.is_none_or(|best| cost < best.cost) {
            best = Some(Minimum { place, cost, evaluations: 0, unsettled: 0, late_gain: of_half.get() - cost });
        }
    }
    best.map(|best| Minimum { evaluations: all, unsettled, ..best }).ok_or_else(|| SearchError("no start".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::super::score::tests::bench;
    use super::*;

    #[test]
    fn the_optimum_is_better_than_both_starts_and_found_again() {
        let bench = bench(2);
        let found = search(&bench, 160, || ()).unwrap();
        for start in starts() {
            assert!(found.cost < bench.cost(&start), "{found:?}");
        }
        assert_eq!(search(&bench, 160, || ()).unwrap(), found);
        let caveat = found.caveat().unwrap();
        assert!(found.unsettled == 2 && caveat.starts_with("2 of 2 searches ended with the "), "{caveat}");
        assert_eq!(bench.score(&found.place).unwrap().negative_samples, 0);
    }

    #[test]
    fn a_search_that_settles_has_no_caveat() {
        let bench = bench(1);
        let found = search(&bench, 8000, || ()).unwrap();
        assert!(found.unsettled == 0 && found.caveat().is_none() && found.evaluations < 8000, "{found:?}");
        let few = search(&bench, 200, || ()).unwrap();
        assert!(few.cost > found.cost && few.late_gain > 0.0, "{few:?} {found:?}");
    }
}
