//! Places along the line: whether many of them say the same, and how much of the scatter of coasts belongs to its
//! place.
//!
//! ```text
//! z = Σ x / √(Σ x²)                        x of each place: stretches at one place share what drivers do there and what is wrong with the slope there
//! σ² = mean of e_i e_j over pairs          of coasted stretches at one place in different runs, uphill as the chainage grows
//! ```
//!
//! Wind, load and readings differ from run to run and leave no product; a slope that is not described does, and no
//! shape of it is asked for.

use super::mixture::{LEAST_SD_N_PER_KG, MixtureFit, rounding_sd};
use super::stretch::Stretch;
use nalgebra::{Matrix4, Vector4};
use std::collections::BTreeMap;

/// Extent of a place, m: a stretch at 90 km/h is as long.
pub const PLACE_M: f64 = 500.0;
/// With fewer places nothing is said.
const FEWEST: usize = 5;
/// Small errors are asked of coasts that lose speed by so many times their scatter: those that hardly lose any, as down
/// gentle slopes, look like held speeds, and of those that gain some by chance only the others would count.
const LOSES_CLEARLY: f64 = 2.0;

/// What is asked of the coasts at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtPlaces {
    /// Slopes that the description does not have at all.
    OtherSlopes,
    /// Small errors of slopes that are right but for them.
    SmallErrors,
}

impl AtPlaces {
    /// Whether a coast there, which loses so much, N/kg, may count.
    fn loses(self, coast_n_per_kg: f64, sd_n_per_kg: f64) -> bool {
        match self {
            Self::OtherSlopes => true,
            Self::SmallErrors => coast_n_per_kg > LOSES_CLEARLY * sd_n_per_kg,
        }
    }

    /// Coasts scatter by no less, N/kg.
    pub fn least_sd(self, stretches: &[Stretch]) -> f64 {
        match self {
            Self::OtherSlopes => LEAST_SD_N_PER_KG,
            Self::SmallErrors => rounding_sd(stretches).max(LEAST_SD_N_PER_KG),
        }
    }

    /// What follows the described climb is none of it: a train that still powers a little loses speed on climbs, and
    /// a rotating mass that is off makes something of each. Beside other slopes than the described ones it is theirs.
    fn follows_climb(self) -> f64 {
        match self {
            Self::OtherSlopes => 0.0,
            Self::SmallErrors => 1.0,
        }
    }
}

/// By how many standard errors what all places say is above zero.
fn standard_errors(places: impl Iterator<Item = f64> + Clone) -> f64 {
    let squares: f64 = places.clone().map(|x| x * x).sum();
    if squares > 0.0 { places.sum::<f64>() / squares.sqrt() } else { 0.0 }
}

/// By how many standard errors a version of the gradients explains the stretches better than another one (Vuong's test,
/// clustered by place).
pub fn better_by(stretches: &[Stretch], better: &MixtureFit, other: &MixtureFit) -> f64 {
    let mut places: BTreeMap<i64, f64> = BTreeMap::new();
    for (stretch, (a, b)) in stretches.iter().zip(better.log_likelihoods.iter().zip(&other.log_likelihoods)) {
        *places.entry(cell(stretch.fronts_m)).or_default() += a - b;
    }
    standard_errors(places.into_values().collect::<Vec<f64>>().iter().copied())
}

/// The part of the scatter of coasts that comes again at its place.
#[derive(Clone, Copy, Debug, Default)]
pub struct Locked {
    /// Its standard deviation, N/kg.
    pub sd_n_per_kg: f64,
    /// By how many standard errors over places it is above zero.
    pub z: f64,
    /// Standard deviation of all scatter, N/kg.
    pub all_sd_n_per_kg: f64,
    /// Coasted stretches.
    pub stretches: f64,
}

impl Locked {
    /// Of stretches that lose speed, where powering does not come in, and where coasts do. None from too few places.
    pub fn of(stretches: &[Stretch], fit: &MixtureFit, climbs_n_per_kg: &[f64], asked: AtPlaces) -> Option<Self> {
        let efforts = fit.residuals(stretches, climbs_n_per_kg);
        let losing = |((stretch, share), effort): ((&Stretch, &f64), &f64)| {
            let may_count = asked.loses(effort - stretch.gain_n_per_kg, fit.sd_n_per_kg);
            if stretch.gain_n_per_kg < 0.0 && may_count { *share } else { 0.0 }
        };
        let shares: Vec<f64> = stretches.iter().zip(&fit.shares).zip(&efforts).map(losing).collect();
        let climbs: Vec<f64> = climbs_n_per_kg.iter().map(|climb| asked.follows_climb() * climb).collect();
        let residuals = without_resistance((stretches, &climbs), &shares, &efforts);
        let weighed = stretches.iter().zip(&shares).zip(&residuals);
        let of_run = |((stretch, share), residual): ((&Stretch, &f64), &f64)| Leaves {
            cell: cell(stretch.fronts_m),
            run: stretch.run,
            share: *share,
            residual: stretch.direction.sign() * residual,
        };
        let Recurring { sd_n_per_kg, z } = recurring(weighed.clone().map(of_run))?;
        let squares: f64 = weighed.map(|((_, share), residual)| share * residual * residual).sum();
        let weight = shares.iter().sum::<f64>();
        Some(Self { sd_n_per_kg, z, all_sd_n_per_kg: (squares / weight).sqrt(), stretches: weight })
    }
}

/// What a run leaves unexplained at a place, along the line as the chainage grows, N/kg, and how surely it counts, 0 to
/// 1.
#[derive(Clone, Copy, Debug)]
pub struct Leaves {
    pub cell: i64,
    pub run: usize,
    pub share: f64,
    pub residual: f64,
}

/// What different runs leave unexplained at the same places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recurring {
    /// Its standard deviation, N/kg.
    pub sd_n_per_kg: f64,
    /// By how many standard errors over places it is above zero.
    pub z: f64,
}

/// The place in whose cell the middle between two fronts lies.
pub fn cell(fronts_m: [f64; 2]) -> i64 {
    (0.5 * (fronts_m[0] + fronts_m[1]) / PLACE_M).floor() as i64
}

/// Mean product over the pairs of different runs at one place; none from too few places.
pub fn recurring(residuals: impl Iterator<Item = Leaves>) -> Option<Recurring> {
    let mut cells: BTreeMap<i64, BTreeMap<usize, [f64; 2]>> = BTreeMap::new();
    for Leaves { cell, run, share, residual } in residuals {
        let [sum, of_run] = cells.entry(cell).or_default().entry(run).or_default();
        *sum += share * residual;
        *of_run += share;
    }
    let places: Vec<[f64; 2]> = cells.values().filter_map(product).collect();
    let pairs: f64 = places.iter().map(|[_, weight]| weight).sum();
    let products = places.iter().map(|[product, _]| *product);
    (places.len() >= FEWEST).then(|| Recurring {
        sd_n_per_kg: (products.clone().sum::<f64>() / pairs).max(0.0).sqrt(),
        z: standard_errors(products),
    })
}

/// Mean product of residuals of different runs at one place, times its weight, and that weight: as many as there are
/// stretches. None from less than a pair.
fn product(runs: &BTreeMap<usize, [f64; 2]>) -> Option<[f64; 2]> {
    let sum = |index: usize| runs.values().map(|of_run| of_run[index]).sum::<f64>();
    let own = |index: usize| runs.values().map(|of_run| of_run[index].powi(2)).sum::<f64>();
    let (product, pairs) = (sum(0).powi(2) - own(0), sum(1).powi(2) - own(1));
    (pairs >= 1.0).then(|| [product * sum(1) / pairs, sum(1)])
}

/// What of the residuals follows no resistance, however far the described one is off, and none of these climbs, N/kg:
/// runs that coast at the same places at the same speeds share that, too.
fn without_resistance((stretches, climbs): (&[Stretch], &[f64]), shares: &[f64], residuals: &[f64]) -> Vec<f64> {
    let row = |(stretch, climb): (&Stretch, &f64)| {
        let r = 100.0 * stretch.resistance_n_per_kg;
        Vector4::new(1.0, r, r * r, 100.0 * climb)
    };
    // A ridge, so that one speed alone, or a level line, is no refusal.
    let (mut information, mut score) = (1e-6 * Matrix4::<f64>::identity(), Vector4::zeros());
    let rows: Vec<Vector4<f64>> = stretches.iter().zip(climbs).map(row).collect();
    for ((x, share), residual) in rows.iter().zip(shares).zip(residuals) {
        information += *share * x * x.transpose();
        score += *share * *residual * x;
    }
    let fit = information.cholesky().map_or_else(Vector4::zeros, |factor| factor.solve(&score));
    rows.iter().zip(residuals).map(|(x, residual)| residual - fit.dot(x)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::mixture::MOST_SD_N_PER_KG;
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rundown::model::direction::Direction;

    /// Coasts of 20 runs, there and back, over 20 places with slopes of these forces; each run has a wind of its own.
    fn coasts(slope_n_per_kg: f64) -> Vec<Stretch> {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let slopes: Vec<f64> = (0..20).map(|_| slope_n_per_kg * random.random_range(-1.0..1.0)).collect();
        let mut stretches = Vec::new();
        for run in 0..20 {
            let direction = if run % 2 == 0 { Direction::Up } else { Direction::Down };
            let wind_n_per_kg = random.random_range(-0.005..0.005);
            for (place, slope) in slopes.iter().enumerate() {
                let noise_n_per_kg = random.random_range(-0.01..0.01);
                let from_m = 500.0 * place as f64;
                stretches.push(Stretch {
                    gain_n_per_kg: noise_n_per_kg - 0.03 - wind_n_per_kg - direction.sign() * slope,
                    resistance_n_per_kg: 0.03,
                    mean_powers: [25.0, 625.0],
                    fronts_m: [from_m, from_m + 490.0],
                    way_m: 490.0,
                    rounded_n_per_kg: 0.0,
                    direction,
                    run,
                });
            }
        }
        stretches
    }

    fn locked(slope_n_per_kg: f64) -> Locked {
        let (stretches, level) = (coasts(slope_n_per_kg), [0.0; 400]);
        let fit = MixtureFit::of(&stretches, &level, MOST_SD_N_PER_KG).unwrap();
        Locked::of(&stretches, &fit, &level, AtPlaces::SmallErrors).unwrap()
    }

    #[test]
    fn slopes_that_nobody_described_come_again_at_their_places_and_winds_do_not() {
        let hilly = locked(0.015);
        assert!(hilly.z > 3.5 && (0.006..0.011).contains(&hilly.sd_n_per_kg), "{hilly:?}");
        let level = locked(0.0);
        assert!(level.z < 2.5 && level.sd_n_per_kg < 0.002, "{level:?}");
    }

    /// What coasts of 40 runs on slopes as described, N/kg, in turns, have in common at their places; up a slope every
    /// fifth run powers a little.
    fn on_right_slopes(slopes: &[f64], power_n_per_kg: f64) -> [Locked; 2] {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let (mut stretches, mut climbs) = (Vec::new(), Vec::new());
        for number in 0..1680 {
            let (run, place) = (number / 42, number % 42);
            let climb = slopes[place % slopes.len()];
            let noise_n_per_kg: f64 = (0..12).map(|_| random.random_range(-0.007..0.007)).sum::<f64>() / 2.0;
            let power_n_per_kg = if climb > 0.0 && run % 5 == 0 { power_n_per_kg } else { 0.0 };
            climbs.push(climb);
            stretches.push(Stretch {
                gain_n_per_kg: noise_n_per_kg + power_n_per_kg - 0.03 - climb,
                resistance_n_per_kg: 0.03,
                mean_powers: [25.0, 625.0],
                fronts_m: [500.0 * place as f64, 500.0 * place as f64 + 490.0],
                way_m: 490.0,
                rounded_n_per_kg: 0.0,
                direction: Direction::Up,
                run,
            });
        }
        let fit = MixtureFit::of(&stretches, &climbs, MOST_SD_N_PER_KG).unwrap();
        [AtPlaces::SmallErrors, AtPlaces::OtherSlopes]
            .map(|asked| Locked::of(&stretches, &fit, &climbs, asked).unwrap())
    }

    #[test]
    fn coasts_that_hardly_lose_speed_are_no_errors_of_the_slopes() {
        let [small, all] = on_right_slopes(&[0.019, -0.028, 0.009, 0.0, 0.028, -0.019, -0.009], 0.0);
        assert!(small.z < 2.0 && all.z > 2.5, "{small:?} {all:?}");
    }

    #[test]
    fn a_little_power_on_climbs_is_no_error_of_the_slopes() {
        let [small, all] = on_right_slopes(&[0.0, 0.0, 0.02], 0.02);
        assert!(small.z < 2.0 && all.z > 2.5, "{small:?} {all:?}");
    }

    #[test]
    fn one_place_alone_makes_no_version_better() {
        let stretches = coasts(0.0);
        let fit = |gain: &dyn Fn(&Stretch) -> f64| {
            let mut fit = MixtureFit::of(&stretches, &[0.0; 400], MOST_SD_N_PER_KG).unwrap();
            fit.log_likelihoods = stretches.iter().map(gain).collect();
            fit
        };
        let other = fit(&|_| 0.0);
        let everywhere = better_by(&stretches, &fit(&|_| 0.2), &other);
        let at_one =
            better_by(&stretches, &fit(&|stretch| if cell(stretch.fronts_m) == 3 { 4.0 } else { 0.0 }), &other);
        assert!(everywhere > 3.0 && at_one < 1.1, "{everywhere} {at_one}");
    }
}
