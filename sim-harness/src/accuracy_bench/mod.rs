//! How near does the estimator come to the truth? Fleets of simulated vehicles of several kinds.
//!
//! ```text
//! fleet, seed -> vehicles off their description -> runs -> the board's estimator -> errors of r(v), intervals, regimes, features
//!                                                  -> bound -> the errors that are possible
//! ```

pub mod fleets;
pub mod score;
pub mod table;

use crate::bound::{Bound, Known, Worth};
use fleets::Fleet;
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use rayon::prelude::*;
use rundown::estimator::Estimator;
use rundown::estimator::config::Config;
use rundown::model::resistance::Davis;
use rundown::model::track::{Gradient, Track};
use rundown_truth::plan::plan;
use rundown_truth::scenario::{Scenario, simulate_planned};
use score::{FleetFigures, JudgedVehicle};

/// By how much the coefficients of vehicles differ at most from the described ones: in common, and each beyond that.
const COMMON: f64 = 0.25;
const OWN: f64 = 0.08;

/// True over described r0, r1, r2 of so many vehicles: up to 35 % off in common, with a part of its own for each
/// coefficient. The same every time.
pub fn scales(vehicles: usize) -> Vec<[f64; 3]> {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let scales = |_| {
        let common = rng.random_range(1.0 - COMMON..1.0 + COMMON);
        [0; 3].map(|_| common * rng.random_range(1.0 - OWN..1.0 + OWN))
    };
    (0..vehicles).map(scales).collect()
}

/// The covariance of true r0, r1, r2 that [`scales`] has, of described ones.
fn scatter(described: &Davis) -> Matrix3<f64> {
    let r = Vector3::new(described.r0, described.r1, described.r2);
    // Of evenly spread draws.
    let [common, own] = [COMMON, OWN].map(|most| most * most / 3.0);
    (r * r.transpose()).map_with_location(|row, column, product| {
        product * if row == column { (1.0 + common) * (1.0 + own) - 1.0 } else { common }
    })
}

/// Simulates the vehicles of a fleet and judges what the estimator makes of them. `done` is called after each.
///
/// # Errors
/// A run that could not be simulated, or a description that the estimator refuses; in words.
pub fn judge(
    fleet: &Fleet,
    config: Config,
    vehicles: usize,
    runs: usize,
    seed: u64,
    done: impl Fn() + Sync,
) -> Result<FleetFigures, String> {
    let of_vehicle = |(index, scale): (usize, &[f64; 3])| {
        let table = judge_vehicle(fleet, config, *scale, runs, seed.wrapping_add(1000 * index as u64));
        done();
        table
    };
    let tables = scales(vehicles).par_iter().enumerate().map(of_vehicle).collect::<Result<Vec<_>, _>>()?;
    let mut all = FleetFigures::default();
    tables.into_iter().for_each(|table| all.merge(table));
    Ok(all)
}

fn judge_vehicle(
    fleet: &Fleet,
    config: Config,
    scale: [f64; 3],
    runs: usize,
    seed: u64,
) -> Result<FleetFigures, String> {
    let mut scenario = Scenario { davis_scale: scale, ..fleet.scenario.clone() };
    let unit: f64 = Normal::new(0.0, 1.0).map_err(|e| e.to_string())?.sample(&mut ChaCha8Rng::seed_from_u64(seed));
    scenario.sensors.effort_gain *= 1.0 + fleet.effort_gain_sd * unit;
    let driven = plan(&scenario, runs, seed);
    let driven = driven.iter().map(|plan| simulate_planned(&scenario, plan)).collect::<Result<Vec<_>, _>>();
    let driven = driven.map_err(|e| e.to_string())?;
    let described = fleet.train().ok_or("the train's description is refused")?;
    let gradients = scenario.line.gradients_permille().iter();
    let gradients = gradients.map(|&(from_m, permille)| Gradient { from_m, permille });
    let track = Track::try_new(scenario.line.length_m(), gradients).map_err(|e| e.to_string())?;
    let estimator = Estimator::try_new(config, described, track).map_err(|e| e.to_string())?;
    let nominal = described.davis();
    let truth = Davis { r0: nominal.r0 * scale[0], r1: nominal.r1 * scale[1], r2: nominal.r2 * scale[2] };
    let mut table = FleetFigures::default();
    let judged = JudgedVehicle { estimator: &estimator, truth, band_kmh: fleet.band_kmh };
    table.judge_vehicle(&judged, &driven);
    let worth = Worth::of(&scenario.sensors);
    let bounds = [estimator.new_vehicle().davis().covariance, scatter(&nominal)]
        .map(|prior| Bound::new(Known::of(fleet.mode), worth, prior, fleet.effort_gain_sd, scenario.wind_sd_mps));
    table.judge_bounds(&judged, bounds, &driven);
    Ok(table)
}
