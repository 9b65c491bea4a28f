//! Do coasts follow the described resistance, or what it would be in other units?
//!
//! In: runs whose readings are put right, train and track as described. Out: the conversion of the Davis coefficients
//! that explains the coasts clearly better, in both halves of the runs and over the places of the line.
//!
//! Asked as of the gradients: with the right resistance many stretches have no effort at all. What is learned cannot
//! say it where a description is so far off that no coast teaches, or where there are hardly any. A description that is
//! a multiple of the truth is in no other units: it comes out as a multiple.

use super::doubt::explains;
use super::mixture::{MOST_SD_N_PER_KG, MixtureFit};
use super::stretch::Stretch;
use super::{AsDescribed, Coasts, LEAST_GAIN, LEAST_SEEN, LEAST_STRETCHES, LEAST_Z, places};
use rundown::model::resistance::Davis;
use serde::Serialize;
use std::fmt;

/// By what described coefficients have to be multiplied if they were written in other units.
pub const CONVERSIONS: [(&str, [f64; 3]); 6] = [
    ("r1 and r2 per km/h and (km/h)²: r1 x 3.6, r2 x 12.96", [1.0, 3.6, 12.96]),
    (
        "r1 and r2 multiplied by 3.6 and 12.96 although they were per m/s: r1 / 3.6, r2 / 12.96",
        [1.0, 1.0 / 3.6, 1.0 / 12.96],
    ),
    ("r2 a hundred times too large: r2 / 100", [1.0, 1.0, 0.01]),
    ("r2 a hundred times too small: r2 x 100", [1.0, 1.0, 100.0]),
    ("N/t in place of N/kg: all / 1000", [1e-3; 3]),
    ("kN/kg in place of N/kg: all x 1000", [1e3; 3]),
];

/// Trains that are not in other units: all coefficients times as much.
const MULTIPLES: [f64; 10] = [0.25, 0.4, 0.5, 0.63, 0.8, 1.25, 1.6, 2.0, 2.5, 4.0];
/// By what descriptions of the right train are off: where one of them has coasts, a conversion that makes less of the
/// resistance is none.
const PLAIN: [f64; 3] = [0.75, 1.0, 1.35];
/// By so much log-likelihood a conversion is better than all of these.
const LEAST_BEYOND: f64 = 6.0;
/// A conversion that changes the resistance of the coasts by less is not looked for: natural logarithm of the ratio.
const LEAST_RATIO: f64 = 0.25;

/// The described resistance with these factors on its coefficients.
pub fn converted(described: &Davis, factors: [f64; 3]) -> Davis {
    let Davis { r0, r1, r2 } = *described;
    Davis { r0: r0 * factors[0], r1: r1 * factors[1], r2: r2 * factors[2] }
}

/// The described resistance looks as if it were in other units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OtherUnits {
    /// The conversion that explains the coasts best.
    pub conversion: &'static str,
    /// Mean resistance of the coasted stretches over the described one.
    pub ratio: f64,
    /// Scatter of coasted stretches with it, standard deviation, N/kg.
    pub sd_n_per_kg: f64,
    /// Its log-likelihood less that of the description.
    pub log_likelihood: f64,
    /// By how many standard errors over the places of the line.
    pub z: f64,
    /// Stretches of 20 s that are coasted.
    pub stretches: usize,
}

impl Coasts {
    /// The conversion of the described resistance that explains the coasts; none where the description does, or nothing
    /// can be said.
    pub(super) fn other_units(&self, davis: &Davis, described: &AsDescribed) -> Option<OtherUnits> {
        let with = |factors| -> Vec<Stretch> {
            let davis = converted(davis, factors);
            self.stretches.iter().map(|stretch| stretch.with(&davis)).collect()
        };
        let fit = |factors| MixtureFit::of(&with(factors), &described.climbs_n_per_kg, MOST_SD_N_PER_KG);
        let described = described.fit.as_ref()?;
        let tried = CONVERSIONS.into_iter().filter_map(|(words, factors)| Some((words, factors, fit(factors)?)));
        let (conversion, factors, best) = tried.max_by(|a, b| a.2.log_likelihood().total_cmp(&b.2.log_likelihood()))?;
        let [one, two] = self.gains(&best, described);
        if one.min(two) < LEAST_GAIN || !explains(best.sd_n_per_kg) || best.coasted() < LEAST_STRETCHES {
            return None;
        }
        let resistance_n_per_kg = best.resistance_n_per_kg(&with(factors));
        let shares = || self.stretches.iter().zip(&best.shares);
        let of_description: f64 = shares().map(|(stretch, share)| share * stretch.resistance_n_per_kg).sum();
        let ratio = resistance_n_per_kg * best.coasted() / of_description;
        let sees = resistance_n_per_kg > LEAST_SEEN * best.sd_n_per_kg && ratio.ln().abs() > LEAST_RATIO;
        let z = places::better_by(&self.stretches, &best, described);
        let beyond = |multiple: f64| {
            fit([multiple; 3]).is_none_or(|fit| best.log_likelihood() > fit.log_likelihood() + LEAST_BEYOND)
        };
        // Speeds that are held roughly look like coasts of next to no resistance.
        let has_coasts = |factor: f64| fit([factor; 3]).is_some_and(|fit| shows_coasts(&fit, &with([factor; 3])));
        let is_held = ratio < 1.0 && PLAIN.into_iter().any(has_coasts);
        let is_clear = sees && z > LEAST_Z && !is_held && MULTIPLES.into_iter().all(beyond);
        is_clear.then(|| OtherUnits {
            conversion,
            ratio,
            sd_n_per_kg: best.sd_n_per_kg,
            log_likelihood: one + two,
            z,
            stretches: best.coasted().round() as usize,
        })
    }
}

/// There are coasts of this resistance, and they scatter by less than it.
fn shows_coasts(fit: &MixtureFit, stretches: &[Stretch]) -> bool {
    let is_seen = fit.resistance_n_per_kg(stretches) > LEAST_SEEN * fit.sd_n_per_kg;
    is_seen && explains(fit.sd_n_per_kg) && fit.coasted() >= LEAST_STRETCHES
}

impl fmt::Display for OtherUnits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { conversion, ratio, sd_n_per_kg: sd, log_likelihood, stretches, .. } = self;
        write!(
            f,
            "the described resistance looks wrong: {stretches} stretches of 20 s that look like coasts have {ratio:.2} times \
             as much, and scatter by {sd:.4} N/kg, if it is {conversion}; log-likelihood ratio {log_likelihood:.0}, and both \
             halves of the runs agree"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rundown::model::direction::Direction;

    /// One of 60 stretches of 300 m of a run.
    fn stretch(number: u32, mps: f64, gain_n_per_kg: f64) -> Stretch {
        let from_m = f64::from(number % 60) * 300.0;
        Stretch {
            gain_n_per_kg,
            resistance_n_per_kg: 0.0,
            mean_powers: [mps, mps * mps],
            fronts_m: [from_m, from_m + 300.0],
            way_m: 300.0,
            rounded_n_per_kg: 0.0,
            direction: Direction::Up,
            run: number as usize / 60,
        }
    }

    const SUBURBAN: Davis = Davis { r0: 0.0094, r1: 1.6e-4, r2: 2.6e-5 };
    const TRAM: Davis = Davis { r0: 0.021, r1: 3.4e-4, r2: 5.1e-5 };

    /// Runs of a train of which one stretch in four coasts at speeds up to `top_mps`, one holds its speed, and the
    /// others do anything.
    fn found(truth: &Davis, top_mps: f64, described: &Davis, seed: u64) -> Option<OtherUnits> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mut coasts, mut climbs) = (Coasts::default(), Vec::new());
        for number in 0..1200 {
            let mps = random.random_range(0.35 * top_mps..top_mps);
            let climb = random.random_range(-0.05..0.05);
            let noise = random.random_range(-0.008..0.008);
            let gain_n_per_kg = match number % 4 {
                0 => noise - climb - truth.resistance_n_per_kg(mps),
                1 => noise,
                _ => random.random_range(-0.35..0.35),
            };
            climbs.push(climb);
            coasts.stretches.push(stretch(number, mps, gain_n_per_kg).with(described));
        }
        let on_climbs = AsDescribed::of(&coasts.stretches, climbs);
        coasts.other_units(described, &on_climbs)
    }

    #[test]
    fn coefficients_in_other_units_are_recognised_from_few_coasts() {
        for seed in 0..5 {
            for (words, factors) in &CONVERSIONS[..4] {
                let described = converted(&SUBURBAN, factors.map(f64::recip));
                let found = found(&SUBURBAN, 30.0, &described, seed).unwrap();
                assert_eq!(found.conversion, *words, "{seed} {found:?}");
            }
        }
    }

    #[test]
    fn a_right_description_and_one_that_is_a_multiple_of_the_truth_are_not_accused() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        for (truth, top_mps) in [(SUBURBAN, 30.0), (TRAM, 15.0)] {
            for seed in 0..5 {
                let near = [0; 3].map(|_| random.random_range(0.75..1.3));
                for factors in [[1.0; 3], near, [0.5; 3], [2.0; 3]] {
                    let said = found(&truth, top_mps, &converted(&truth, factors), seed);
                    assert_eq!(said, None, "{seed} {factors:?}");
                }
            }
        }
    }

    /// On a level line a speed that is held in notches falls a little between them, as a coast of a third of the
    /// resistance would have it.
    #[test]
    fn speeds_that_are_held_roughly_beside_coasts_are_no_other_unit() {
        let described = converted(&SUBURBAN, [1.0 / 1.37; 3]);
        let falling = converted(&described, [1.0, 1.0, 0.01]);
        for seed in 0..5 {
            let mut random = ChaCha8Rng::seed_from_u64(40 + seed);
            let mut coasts = Coasts::default();
            for number in 0..1200 {
                let mps = random.random_range(10.0..30.0);
                let resistance = SUBURBAN.resistance_n_per_kg(mps);
                let noise = random.random_range(-0.003..0.003);
                let gain_n_per_kg = match number % 8 {
                    0 => noise - resistance,
                    1..=4 => 0.3 * noise - falling.resistance_n_per_kg(mps),
                    _ => random.random_range(-0.35..0.35),
                };
                coasts.stretches.push(stretch(number, mps, gain_n_per_kg).with(&described));
            }
            let level = AsDescribed::of(&coasts.stretches, vec![0.0; 1200]);
            assert_eq!(coasts.other_units(&described, &level), None, "{seed}");
        }
    }
}
