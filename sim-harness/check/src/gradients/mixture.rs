//! Efforts of stretches as a mixture: coasting, speed held, everything else.
//!
//! ```text
//! p = π N(e; 0, s²) + η N(a; 0, h²) + (1 - π - η) U(width)        a: gain of kinetic energy over the way, e = a + r + δ0 + δ1 r + climb
//! δ0 ~ N(0, (0.003 N/kg)²), δ1 ~ N(0, 0.3²)                       the true resistance is not the described one
//! ```
//!
//! A driver who holds a speed gives uphill what the slope takes: the train gains nothing on any gradient, and looks
//! like one that coasts on a level line. The second part is the same for all versions of the gradients, so held speeds
//! speak for none. Fitted by expectation and maximisation.

use super::stretch::{OVERLAP, Stretch};
use std::f64::consts::TAU;

/// Width of the efforts that trains use, N/kg.
const WIDTH_N_PER_KG: f64 = 1.0;
/// How far resistance may be from its description: a part for all speeds, N/kg, and a share.
const PRIOR_SD: [f64; 2] = [0.003, 0.3];
/// Readings and gusts alone make so much, N/kg.
pub const LEAST_SD_N_PER_KG: f64 = 0.002;
/// A wider distribution is no coasting, N/kg.
pub const MOST_SD_N_PER_KG: f64 = 0.02;
/// Speeds that change more are not held, N/kg.
const MOST_HELD_SD_N_PER_KG: f64 = 0.03;
const STEPS: usize = 40;
/// The fit stands where no parameter moves by more than this share of its size.
const STANDS: f64 = 1e-3;
/// With fewer stretches nothing is said.
const FEWEST: usize = 40;

/// Parameters of the mixture.
#[derive(Clone, Copy, Debug)]
struct Mixture {
    sd: f64,
    share: f64,
    held_sd: f64,
    held_share: f64,
    deltas: [f64; 2],
}

/// A version of the gradients, fitted.
#[derive(Clone, Debug)]
pub struct MixtureFit {
    /// Scatter of coasted stretches, N/kg.
    pub sd_n_per_kg: f64,
    /// Log-likelihood of each stretch; those that overlap count once.
    pub log_likelihoods: Vec<f64>,
    /// For each stretch how surely it is coasted, 0 to 1.
    pub shares: Vec<f64>,
    deltas: [f64; 2],
}

fn effort(stretch: &Stretch, climb_n_per_kg: f64, deltas: [f64; 2]) -> f64 {
    let r = stretch.resistance_n_per_kg;
    stretch.gain_n_per_kg + r + climb_n_per_kg + deltas[0] + deltas[1] * r
}

fn normal(x: f64, sd: f64) -> f64 {
    (-0.5 * (x / sd).powi(2)).exp() / (sd * TAU.sqrt())
}

impl Mixture {
    const FIRST: Self = Self { sd: 0.01, share: 0.3, held_sd: 0.01, held_share: 0.3, deltas: [0.0; 2] };

    /// Densities of coasting, of a held speed, and of all.
    fn densities(&self, stretch: &Stretch, climb_n_per_kg: f64) -> [f64; 3] {
        let coasting = self.share * normal(effort(stretch, climb_n_per_kg, self.deltas), self.sd);
        let holding = self.held_share * normal(stretch.gain_n_per_kg, self.held_sd);
        [coasting, holding, coasting + holding + (1.0 - self.share - self.held_share) / WIDTH_N_PER_KG]
    }

    /// The next step; into `shares` how surely each stretch is coasted by this one.
    fn next(&self, stretches: &[Stretch], climbs: &[f64], sds: [f64; 2], shares: &mut [f64]) -> Self {
        let (mut held, mut held_squares) = (0.0, 0.0);
        for ((stretch, climb), coasted) in stretches.iter().zip(climbs).zip(shares.iter_mut()) {
            let [coasting, holding, density] = self.densities(stretch, *climb);
            *coasted = coasting / density;
            held += holding / density;
            held_squares += holding / density * stretch.gain_n_per_kg.powi(2);
        }
        let deltas = solved(stretches, climbs, shares, self.sd);
        let (n, coasted) = (stretches.len() as f64, shares.iter().sum::<f64>());
        let sd = (squares(stretches, climbs, shares, deltas) / coasted.max(1.0)).sqrt();
        let share = (coasted / n).clamp(0.01, 0.98);
        Self {
            sd: sd.clamp(sds[0], sds[1]),
            share,
            held_sd: (held_squares / held.max(1.0)).sqrt().clamp(LEAST_SD_N_PER_KG, MOST_HELD_SD_N_PER_KG),
            held_share: (held / n).clamp(0.005, 0.99 - share),
            deltas,
        }
    }

    fn stands(&self, next: &Self) -> bool {
        let moved = |a: f64, b: f64| (a - b).abs() > STANDS * a.abs();
        !(moved(self.sd, next.sd)
            || moved(self.share, next.share)
            || moved(self.held_sd, next.held_sd)
            || moved(self.held_share, next.held_share))
    }
}

/// Scatter that the step of the speeds makes, N/kg: stretches whose speed falls by whole steps seem to scatter by less.
pub fn rounding_sd(stretches: &[Stretch]) -> f64 {
    let squares = stretches.iter().map(|stretch| stretch.rounded_n_per_kg.powi(2)).sum::<f64>();
    (squares / stretches.len().max(1) as f64).sqrt()
}

impl MixtureFit {
    /// Coasts scatter by no more than `most_sd`, N/kg. None where there are too few stretches.
    pub fn of(stretches: &[Stretch], climbs_n_per_kg: &[f64], most_sd: f64) -> Option<Self> {
        Self::within(stretches, climbs_n_per_kg, [LEAST_SD_N_PER_KG, most_sd])
    }

    /// Coasts scatter by a standard deviation between these, N/kg.
    pub fn within(stretches: &[Stretch], climbs_n_per_kg: &[f64], sds: [f64; 2]) -> Option<Self> {
        (stretches.len() >= FEWEST).then_some(())?;
        let mut shares = vec![0.0; stretches.len()];
        let mut mixture = Mixture::FIRST;
        for _ in 0..STEPS {
            let next = mixture.next(stretches, climbs_n_per_kg, sds, &mut shares);
            let stands = mixture.stands(&next);
            mixture = next;
            if stands {
                break;
            }
        }
        let each = stretches.iter().zip(climbs_n_per_kg);
        let log = |(stretch, climb): (&Stretch, &f64)| mixture.densities(stretch, *climb)[2].ln() / OVERLAP;
        let log_likelihoods = each.map(log).collect();
        Some(Self { sd_n_per_kg: mixture.sd, log_likelihoods, shares, deltas: mixture.deltas })
    }

    /// Log-likelihood of all runs.
    pub fn log_likelihood(&self) -> f64 {
        self.log_likelihoods.iter().sum()
    }

    /// How many stretches are coasted.
    pub fn coasted(&self) -> f64 {
        self.shares.iter().sum()
    }

    /// Mean resistance of the coasted stretches, N/kg.
    pub fn resistance_n_per_kg(&self, stretches: &[Stretch]) -> f64 {
        let [constant, share] = self.deltas;
        let of =
            |(stretch, coasted): (&Stretch, &f64)| coasted * (stretch.resistance_n_per_kg * (1.0 + share) + constant);
        stretches.iter().zip(&self.shares).map(of).sum::<f64>() / self.coasted().max(1.0)
    }

    /// The coasts would have less resistance yet if the prior let them.
    pub fn has_least_resistance(&self) -> bool {
        self.deltas[1] <= -PRIOR_SD[1]
    }

    /// What effort is left of each stretch if it is coasted, N/kg.
    pub fn residuals(&self, stretches: &[Stretch], climbs_n_per_kg: &[f64]) -> Vec<f64> {
        stretches.iter().zip(climbs_n_per_kg).map(|(stretch, climb)| effort(stretch, *climb, self.deltas)).collect()
    }

    /// Scatter of stretches that another version calls coasted, N/kg.
    pub fn sd_of(&self, stretches: &[Stretch], climbs_n_per_kg: &[f64], shares: &[f64]) -> f64 {
        (squares(stretches, climbs_n_per_kg, shares, self.deltas) / shares.iter().sum::<f64>().max(1.0)).sqrt()
    }
}

fn squares(stretches: &[Stretch], climbs_n_per_kg: &[f64], shares: &[f64], deltas: [f64; 2]) -> f64 {
    let each = stretches.iter().zip(climbs_n_per_kg).zip(shares);
    each.map(|((stretch, climb), share)| share * effort(stretch, *climb, deltas).powi(2)).sum()
}

/// The resistance that leaves coasted stretches without effort, as far as the prior lets it.
fn solved(stretches: &[Stretch], climbs_n_per_kg: &[f64], shares: &[f64], sd: f64) -> [f64; 2] {
    let [mut a, mut b, mut c] = [sd * sd / PRIOR_SD[0].powi(2), 0.0, sd * sd / PRIOR_SD[1].powi(2)];
    let [mut p, mut q] = [0.0; 2];
    for ((stretch, climb), share) in stretches.iter().zip(climbs_n_per_kg).zip(shares) {
        let (r, e) = (stretch.resistance_n_per_kg, effort(stretch, *climb, [0.0; 2]));
        a += share;
        b += share * r;
        c += share * r * r;
        p -= share * e;
        q -= share * e * r;
    }
    let determinant = a * c - b * b;
    let [both, by_r] = [(c * p - b * q) / determinant, (a * q - b * p) / determinant];
    // Many held speeds would outweigh the prior and leave no resistance at all.
    [both.clamp(-PRIOR_SD[0], PRIOR_SD[0]), by_r.clamp(-PRIOR_SD[1], PRIOR_SD[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rundown::model::direction::Direction;

    #[test]
    fn speeds_that_are_held_speak_for_no_version_of_the_gradients() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let (mut stretches, mut climbs) = (Vec::new(), Vec::new());
        for number in 0..1000 {
            let climb_n_per_kg = random.random_range(-0.06..0.06);
            let noise_n_per_kg = random.random_range(-0.012..0.012);
            // Four of five are held.
            let force_n_per_kg = if number % 5 == 0 { 0.025 + climb_n_per_kg } else { 0.0 };
            climbs.push(climb_n_per_kg);
            stretches.push(Stretch {
                gain_n_per_kg: noise_n_per_kg - force_n_per_kg,
                resistance_n_per_kg: 0.025,
                mean_powers: [25.0, 625.0],
                fronts_m: [f64::from(number) * 30.0, f64::from(number) * 30.0 + 500.0],
                way_m: 500.0,
                rounded_n_per_kg: 0.0,
                direction: Direction::Up,
                run: number as usize % 20,
            });
        }
        let described = MixtureFit::of(&stretches, &climbs, MOST_SD_N_PER_KG).unwrap();
        let level = MixtureFit::of(&stretches, &vec![0.0; 1000], MOST_SD_N_PER_KG).unwrap();
        assert!(described.log_likelihood() > level.log_likelihood() + 24.0);
        assert!((described.coasted() - 200.0).abs() < 60.0, "{}", described.coasted());
    }

    /// Whole km/h over 20 s: a train that loses 0.028 N/kg seems to do so exactly.
    #[test]
    fn coasts_scatter_by_what_the_step_of_the_speeds_makes() {
        let stretch = |number: usize| Stretch {
            gain_n_per_kg: if number.is_multiple_of(3) { 0.001 * (number % 100) as f64 } else { -0.0278 },
            resistance_n_per_kg: 0.0278,
            mean_powers: [25.0, 625.0],
            fronts_m: [0.0, 500.0],
            way_m: 500.0,
            rounded_n_per_kg: 0.0057,
            direction: Direction::Up,
            run: 0,
        };
        let stretches: Vec<Stretch> = (0..400).map(stretch).collect();
        assert!((rounding_sd(&stretches) - 0.0057).abs() < 1e-12);
        let fit = MixtureFit::within(&stretches, &[0.0; 400], [rounding_sd(&stretches), MOST_SD_N_PER_KG]).unwrap();
        assert!((fit.sd_n_per_kg - 0.0057).abs() < 2e-4, "{}", fit.sd_n_per_kg);
    }
}
