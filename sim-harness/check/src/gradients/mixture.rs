//! Efforts of stretches as a narrow normal distribution, coasting, within a broad uniform one, everything else.
//!
//! ```text
//! e ~ π N(-δ0 - δ1 r, s²) + (1 - π) U(width)        δ0 ~ N(0, (0.003 N/kg)²), δ1 ~ N(0, 0.3²): the true resistance is not the described one
//! ```
//!
//! Fitted by expectation and maximisation.

use super::stretch::{OVERLAP, Stretch};
use std::f64::consts::TAU;

/// Width of the efforts that trains use, N/kg.
const WIDTH_N_PER_KG: f64 = 1.0;
/// How far resistance may be from its description: a part for all speeds, N/kg, and a share.
const PRIOR_SD: [f64; 2] = [0.003, 0.3];
/// Readings and gusts alone make so much, N/kg.
const LEAST_SD_N_PER_KG: f64 = 0.002;
/// A wider distribution is no coasting, N/kg.
pub const MOST_SD_N_PER_KG: f64 = 0.02;
const FIRST_SD_N_PER_KG: f64 = 0.01;
const STEPS: usize = 40;
/// With fewer stretches nothing is said.
const FEWEST: usize = 40;

/// A version of the gradients, fitted.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Scatter of coasted stretches, N/kg.
    pub sd_n_per_kg: f64,
    /// Log-likelihood of each half of the runs; stretches that overlap count once.
    pub by_half: [f64; 2],
    /// For each stretch how surely it is coasted, 0 to 1.
    pub shares: Vec<f64>,
    deltas: [f64; 2],
}

fn effort(stretch: &Stretch, climb_n_per_kg: f64, deltas: [f64; 2]) -> f64 {
    let r = stretch.resistance_n_per_kg;
    stretch.gain_n_per_kg + r + climb_n_per_kg + deltas[0] + deltas[1] * r
}

impl Fit {
    /// None where there are too few stretches.
    pub fn of(stretches: &[Stretch], climbs_n_per_kg: &[f64]) -> Option<Self> {
        let (mut sd, mut share, mut deltas) = (FIRST_SD_N_PER_KG, 0.3, [0.0; 2]);
        let mut fit = Self { sd_n_per_kg: sd, by_half: [0.0; 2], shares: vec![0.0; stretches.len()], deltas };
        (stretches.len() >= FEWEST).then_some(())?;
        for _ in 0..STEPS {
            fit.by_half = [0.0; 2];
            for ((stretch, climb), coasted) in stretches.iter().zip(climbs_n_per_kg).zip(&mut fit.shares) {
                let e = effort(stretch, *climb, deltas);
                let normal = share * (-0.5 * (e / sd).powi(2)).exp() / (sd * TAU.sqrt());
                let density = normal + (1.0 - share) / WIDTH_N_PER_KG;
                *coasted = normal / density;
                fit.by_half[stretch.half] += density.ln() / OVERLAP;
            }
            (fit.sd_n_per_kg, fit.deltas) = (sd, deltas);
            deltas = solved(stretches, climbs_n_per_kg, &fit.shares, sd);
            let coasted = fit.coasted().max(1.0);
            let squares = squares(stretches, climbs_n_per_kg, &fit.shares, deltas);
            sd = (squares / coasted).sqrt().clamp(LEAST_SD_N_PER_KG, MOST_SD_N_PER_KG);
            share = (coasted / stretches.len() as f64).clamp(0.01, 0.99);
        }
        Some(fit)
    }

    /// Log-likelihood of all runs.
    pub fn log_likelihood(&self) -> f64 {
        self.by_half.iter().sum()
    }

    /// How many stretches are coasted.
    pub fn coasted(&self) -> f64 {
        self.shares.iter().sum()
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
