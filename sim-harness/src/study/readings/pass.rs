//! The paper's loop over one run, with nothing around it: no judging of readings, no regimes, no memory.
//!
//! In: a filter, a line, a run. Out: what the figures of section 4.2 show of it. The `paper` mode of the estimator
//! gives the same beliefs on runs without faults, to the tenth digit, which a test holds.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rundown::filter::gaussian::Gaussian;
use rundown::model::effects::{Acting, Effects, Journey};
use rundown::model::line::Line;
use rundown::model::state::{LOCATION, R0, SIZE, SPEED};
use rundown::tick::paper::{PaperConfig, PaperLoop};
use rundown_files::recording::Recording;

/// "Small noise in the running resistance parameters' equations": what r0 gains a step, N/kg. Over a run it adds up to
/// 4 % of r0.
pub const R0_NOISE: f64 = 3e-5;

/// A filter: its settings, and a noise of the coefficients that the mode of the estimator does not have.
#[derive(Clone, Copy, Debug)]
pub struct Filter {
    pub config: PaperConfig,
    /// Standard deviation that each coefficient gains a step (the diagonal of Q), SI units.
    pub davis_noise: [f64; 3],
    /// Standard deviation of a noise that is drawn and added to the acceleration of each step, m/s²: section 4.2's
    /// "additive noise" read as a signal, not as Q.
    pub drawn_mps2: f64,
    /// The same of r0, N/kg a step.
    pub drawn_r0: f64,
}

impl From<PaperConfig> for Filter {
    fn from(config: PaperConfig) -> Self {
        Self { config, davis_noise: [0.0; 3], drawn_mps2: 0.0, drawn_r0: 0.0 }
    }
}

/// One run through a filter; a row for each sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pass {
    pub davis: Vec<[f64; 3]>,
    pub speed_mps: Vec<f64>,
    pub location_m: Vec<f64>,
    /// Filtered less read speed, m/s.
    pub off_mps: Vec<f64>,
    /// Logarithm of the likelihood of both readings, of each sample that has them.
    pub log_likelihood: Vec<f64>,
    /// Samples at which the covariance was of no use and the filter began again.
    pub restarts: u64,
}

impl Filter {
    pub fn pass(&self, line: &Line<'_>, run: &Recording) -> Pass {
        let effects = Effects::NONE;
        let acting = Acting::new(&effects, Journey::default());
        let davis = line.train.davis();
        let start = Gaussian::independent([davis.r0, davis.r1, davis.r2], self.config.initial_davis_sd);
        let begin = |time_s, readings: [Option<f64>; 2]| {
            PaperLoop::begin(&self.config, line, &acting, time_s, &start, readings[0], readings[1])
        };
        let mut pass = Pass::default();
        // Each run has a noise of its own, and the same again.
        let seed = run.name.bytes().fold(17_u64, |seed, byte| seed.wrapping_mul(31).wrapping_add(u64::from(byte)));
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut of_r0 = ChaCha8Rng::seed_from_u64(!seed);
        let mut last: Option<(f64, PaperLoop)> = None;
        for row in &run.rows {
            let readings = [row.location_m, row.speed_mps];
            let now = match last {
                None => begin(row.time_s, readings),
                Some((before_s, mut filter)) => {
                    let dt_s = row.time_s - before_s;
                    let unit: f64 = StandardNormal.sample(&mut rng);
                    shake(&mut filter, self.drawn_mps2 * unit, dt_s * line.direction.sign(), dt_s);
                    let unit: f64 = StandardNormal.sample(&mut of_r0);
                    filter.belief.mean[R0] += self.drawn_r0 * unit;
                    match filter.step(&self.config, line, &acting, row.time_s, dt_s, readings) {
                        Ok(innovation) => {
                            if readings.iter().all(Option::is_some) {
                                pass.log_likelihood.push(innovation.log_likelihood());
                            }
                            filter
                        }
                        Err(_) => {
                            pass.restarts += 1;
                            begin(row.time_s, readings)
                        }
                    }
                }
            };
            let now = self.noisy(now);
            pass.add(&now.belief, row.speed_mps);
            last = Some((row.time_s, now));
        }
        pass
    }

    /// Q after the update is Q after the propagation, for Eq. (12)-(15) as printed leave it out of the gain.
    fn noisy(&self, mut filter: PaperLoop) -> PaperLoop {
        for (index, sd) in self.davis_noise.into_iter().enumerate() {
            filter.belief.covariance[(R0 + index, R0 + index)] += sd * sd;
        }
        filter
    }
}

/// The step that follows ends where it would with this acceleration on top; `along_s` is its length, negative towards
/// falling locations.
fn shake(filter: &mut PaperLoop, mps2: f64, along_s: f64, dt_s: f64) {
    filter.belief.mean[SPEED] += mps2 * dt_s;
    filter.belief.mean[LOCATION] -= 0.5 * mps2 * along_s * dt_s;
}

impl Pass {
    fn add(&mut self, belief: &Gaussian<SIZE>, read_mps: Option<f64>) {
        let mean = &belief.mean;
        self.davis.push([mean[R0], mean[R0 + 1], mean[R0 + 2]]);
        self.speed_mps.push(mean[SPEED]);
        self.location_m.push(mean[LOCATION]);
        self.off_mps.extend(read_mps.map(|read_mps| mean[SPEED] - read_mps));
    }

    /// Whether a coefficient fell below zero.
    pub fn is_negative(&self) -> bool {
        self.davis.iter().flatten().any(|value| *value < 0.0)
    }
}

/// What r0 covers, up and down.
pub fn way(passes: &[Pass]) -> f64 {
    passes.iter().flat_map(|pass| pass.davis.windows(2)).map(|pair| (pair[1][0] - pair[0][0]).abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::case::{case_study, fleet_run};
    use crate::study::description;
    use rundown::estimator::Estimator;
    use rundown::estimator::config::{Config, Mode};
    use rundown::tick::paper::Difference;
    use rundown_files::replay::{Tick, replay};

    #[test]
    fn a_pass_is_the_paper_mode_of_the_estimator() {
        let simulation = case_study().unwrap();
        let described = description::of(&simulation).unwrap();
        let run = fleet_run(&simulation, 5, 3).unwrap().recording;
        for difference in [Difference::Backward, Difference::Forward] {
            let paper = PaperConfig { difference, ..PaperConfig::default() };
            let config = Config { mode: Mode::Paper, paper, ..Config::default() };
            let estimator = Estimator::try_new(config, described.train, described.track.clone()).unwrap();
            let replayed = replay(&estimator, &mut estimator.new_vehicle(), &run, Tick::EverySample);
            let line = Line { train: &described.train, track: &described.track, direction: run.direction };
            let pass = Filter::from(paper).pass(&line, &run);
            assert_eq!((pass.davis.len(), pass.restarts), (replayed.estimates.len(), 0));
            for (index, estimate) in replayed.estimates.iter().enumerate() {
                let mean = estimate.belief.mean;
                // The estimator keeps the coefficients with a reference between runs, which costs a last bit.
                let pairs = pass.davis[index].into_iter().zip([mean[R0], mean[R0 + 1], mean[R0 + 2]]);
                for (a, b) in pairs.chain([(pass.speed_mps[index], mean[SPEED])]) {
                    assert!((a - b).abs() <= 1e-10 * b.abs(), "{difference:?} at {index}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn noise_of_the_coefficients_moves_them_further() {
        let simulation = case_study().unwrap();
        let described = description::of(&simulation).unwrap();
        let run = fleet_run(&simulation, 5, 0).unwrap().recording;
        let line = Line { train: &described.train, track: &described.track, direction: run.direction };
        let range = |davis_noise, drawn_r0| {
            let filter = Filter { davis_noise, drawn_r0, ..Filter::from(PaperConfig::default()) };
            let r0: Vec<f64> = filter.pass(&line, &run).davis.iter().map(|davis| davis[0]).collect();
            r0.iter().copied().fold(0.0, f64::max) - r0.iter().copied().fold(1.0, f64::min)
        };
        let still = range([0.0; 3], 0.0);
        for moved in [range([1e-5, 0.0, 0.0], 0.0), range([0.0; 3], 1e-5)] {
            assert!(moved > 3.0 * still, "{moved} {still}");
        }
    }
}
