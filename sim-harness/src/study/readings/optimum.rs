//! How far Table 1 is from the most likely initial deviations, the criterion by which the paper chose them (section
//! 4.2).
//!
//! In: runs, and a filter with Table 1. Out: what the best initial deviations of location, speed, r0, r1 and r2 add to
//! the logarithm of the likelihood of a sample, among those without a negative coefficient. α, β and κ stay: with them
//! the mean moves by less than rounding. The noise of the readings is stated in the text and stays.

use super::pass::{Filter, Pass};
use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::neldermead::NelderMead;
use rundown::tick::paper::PaperConfig;
use rundown_files::statistics::mean_of;

const COUNT: usize = 5;
/// First step of the simplex, decades.
const STEP: f64 = 1.0;
/// Least and most, decades from Table 1.
const REACH: f64 = 4.0;
const STEPS: u64 = 70;
/// Cost of a share of runs with a negative coefficient, nats a sample; no likelihood of these runs differs by as much.
const NEGATIVE: f64 = 1e5;

struct LikelihoodProblem<'a, F> {
    filter: &'a Filter,
    passes: &'a F,
}

fn moved(printed: &PaperConfig, decades: &[f64]) -> PaperConfig {
    let factor = |index: usize| 10_f64.powf(decades[index].clamp(-REACH, REACH));
    let sd = printed.initial_davis_sd;
    PaperConfig {
        initial_location_sd_m: printed.initial_location_sd_m * factor(0),
        initial_speed_sd_kmh: printed.initial_speed_sd_kmh * factor(1),
        initial_davis_sd: std::array::from_fn(|index| sd[index] * factor(2 + index)),
        ..*printed
    }
}

/// Share of the runs with a negative coefficient or a restart.
fn bad(passes: &[Pass]) -> f64 {
    passes.iter().filter(|pass| pass.is_negative() || pass.restarts > 0).count() as f64 / passes.len() as f64
}

/// Logarithm of the likelihood a sample, nats.
fn likelihood(passes: &[Pass]) -> f64 {
    mean_of(passes.iter().flat_map(|pass| &pass.log_likelihood))
}

/// Negative logarithm of the likelihood a sample, nats, with the cost of negative coefficients and restarts.
fn cost(passes: &[Pass]) -> f64 {
    let cost = NEGATIVE * bad(passes) - likelihood(passes);
    if cost.is_finite() { cost } else { NEGATIVE }
}

impl<F: Fn(&Filter) -> Vec<Pass>> CostFunction for LikelihoodProblem<'_, F> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, decades: &Vec<f64>) -> Result<f64, Error> {
        let filter = Filter { config: moved(&self.filter.config, decades), ..*self.filter };
        let beyond: f64 = decades.iter().map(|decade| (decade.abs() - REACH).max(0.0)).sum();
        Ok(cost(&(self.passes)(&filter)) + beyond)
    }
}

/// What the best initial deviations add to the log-likelihood of a sample, nats; `passes` are the runs through a
/// filter. Zero where the search finds none better; not a number where it fails, or where it finds none without a
/// negative coefficient.
pub fn gain_per_sample(filter: &Filter, passes: impl Fn(&Filter) -> Vec<Pass>) -> f64 {
    let printed = likelihood(&passes(filter));
    let corner = |index: usize| {
        let mut place = vec![0.0; COUNT];
        if let Some(index) = index.checked_sub(1) {
            place[index] = STEP;
        }
        place
    };
    let solver = NelderMead::new((0..=COUNT).map(corner).collect());
    let problem = LikelihoodProblem { filter, passes: &passes };
    let found = Executor::new(problem, solver).configure(|state| state.max_iters(STEPS)).timer(false).run();
    let best = found.ok().and_then(|found| found.state().best_param.clone());
    let best = best.map(|decades| passes(&Filter { config: moved(&filter.config, &decades), ..*filter }));
    best.filter(|passes| bad(passes) == 0.0).map_or(f64::NAN, |passes| likelihood(&passes) - printed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_is_that_of_the_best_deviations() {
        // A likelihood with its top at ten times the initial deviation of r0 and a tenth of that of the speed.
        let passes = |filter: &Filter| {
            let r0 = (filter.config.initial_davis_sd[0] / 1e-6).log10() - 1.0;
            let speed = (filter.config.initial_speed_sd_kmh / 0.0018).log10() + 1.0;
            vec![Pass { log_likelihood: vec![-3.0 * r0 * r0 - speed * speed], ..Pass::default() }]
        };
        let gain = gain_per_sample(&Filter::from(PaperConfig::default()), passes);
        assert!((gain - 4.0).abs() < 0.05, "{gain}");
    }

    #[test]
    fn negative_coefficients_are_no_optimum() {
        let passes = |filter: &Filter| {
            let wide = filter.config.initial_davis_sd[0] > 1.5e-6;
            vec![Pass {
                log_likelihood: vec![if wide { 100.0 } else { 0.0 }],
                davis: vec![[if wide { -1.0 } else { 1.0 }, 1.0, 1.0]],
                ..Pass::default()
            }]
        };
        assert!(gain_per_sample(&Filter::from(PaperConfig::default()), passes) < 1e-9);
    }
}
