//! A track that is not as described: what is learned on it is doubted, and the trust in it falls where the description
//! was believed.

use host_tests::accuracy::{Errors, davis, replay, resistance};
use host_tests::prelude::*;
use rundown::estimator::config::Config;
use rundown::tick::foresight::Trust;
use rundown_truth::plan::plan;
use rundown_truth::scenario::{Run, Scenario, simulate_planned};
use rundown_wire::Learned;
use sim_harness::accuracy_bench::fleets::{self, Fleet};

const RUNS: usize = 12;
const VEHICLES: u64 = 4;

/// Runs of vehicles whose resistance is as described, on the line of the case study.
fn fleet() -> Vec<Vec<Run>> {
    fleet_of(&Scenario::default())
}

fn fleet_of(scenario: &Scenario) -> Vec<Vec<Run>> {
    let of_vehicle =
        |seed| plan(scenario, RUNS, seed).iter().map(|plan| simulate_planned(scenario, plan).unwrap()).collect();
    (71..71 + VEHICLES).map(of_vehicle).collect()
}

fn calm() -> Fleet {
    fleets::all().into_iter().find(|fleet| fleet.name == "calm").unwrap()
}

/// Gradients are described with this factor and believed with this doubt.
fn estimator_on(calm: &Fleet, factor: f64, doubt_permille: f64) -> Estimator {
    let mut config = Config::default();
    config.track_doubt.gradient_sd_permille = doubt_permille;
    let line = &calm.scenario.line;
    let gradients = line.gradients_permille().iter();
    let gradients = gradients.map(|&(from_m, permille)| Gradient { from_m, permille: factor * permille });
    let track = Track::try_new(line.length_m(), gradients).unwrap();
    Estimator::try_new(config, calm.train().unwrap(), track).unwrap()
}

/// A vehicle after its runs.
fn taught(estimator: &Estimator, runs: &[Run]) -> Vehicle {
    let mut vehicle = estimator.new_vehicle();
    for run in runs {
        replay(estimator, &mut vehicle, run);
    }
    vehicle
}

/// Errors of r(v) and the trust in each vehicle.
fn learned_on(fleet: &[Vec<Run>], factor: f64, doubt_permille: f64) -> (Errors, Vec<Trust>) {
    let calm = calm();
    let estimator = estimator_on(&calm, factor, doubt_permille);
    let mut errors = Errors::default();
    let of_vehicle = |runs: &Vec<Run>| {
        let vehicle = taught(&estimator, runs);
        errors.add(calm.band_kmh, &vehicle.davis(), &davis(&runs[0].facts.davis));
        *vehicle.trust()
    };
    let trusts = fleet.iter().map(of_vehicle).collect();
    (errors, trusts)
}

#[test]
fn unknown_gradients_are_not_taken_for_resistance() {
    let fleet = fleet();
    let (believed_flat, _) = learned_on(&fleet, 0.0, 0.0);
    let (doubted, _) = learned_on(&fleet, 0.0, 5.0);
    // The control: a flat line that is believed in misleads.
    assert!(believed_flat.rmse_percent() > 8.0 && believed_flat.deviations() > 2.0, "{believed_flat:?}");
    // One line is one draw of the doubt, and all of its vehicles err alike.
    assert!(doubted.coverage() > 0.84 && doubted.deviations() < 1.6, "{doubted:?}");
}

#[test]
fn coasts_on_wrong_gradients_scatter_and_on_right_ones_do_not() {
    let fleet = fleet();
    let (right, trusts) = learned_on(&fleet, 1.0, 0.0);
    assert!(trusts.iter().all(|t| t.coasts > 5.0 && t.inflation() < 1.3 && t.worse_by() < 2.0), "{trusts:?}");
    assert!(right.coverage() > 0.9);
    let (_, trusts) = learned_on(&fleet, -1.0, 0.0);
    assert!(trusts.iter().all(|t| t.coasts > 5.0 && t.inflation() > 1.5), "{trusts:?}");
}

/// Half of the coasts keep so much of the brake on: what is learned is withheld, or its interval knows of it.
#[test]
fn a_brake_in_some_coasts_is_not_published_as_resistance() {
    let scenario = |coast_brake_n_per_kg| Scenario { coast_brake_n_per_kg, cycle_share: 0.7, ..Scenario::default() };
    let published = |coast_brake_n_per_kg: f64| {
        let estimator = estimator_on(&calm(), 1.0, 0.0);
        let of_vehicle = |runs: &Vec<Run>| {
            let vehicle = taught(&estimator, runs);
            let (r, sd) = resistance(&vehicle.davis(), 60.0);
            let deviations = (r - davis(&runs[0].facts.davis).resistance_n_per_kg(60.0 / 3.6)) / sd;
            (estimator.published(&vehicle).1, deviations)
        };
        fleet_of(&scenario(coast_brake_n_per_kg)).iter().map(of_vehicle).collect::<Vec<_>>()
    };
    let is_off = |vehicle: &(Learned, f64)| vehicle.1.abs() > 2.5;
    // The control: of coasts without it all vehicles are learned.
    let free = published(0.0);
    assert!(free.iter().all(|(learned, _)| *learned == Learned::Learned), "{free:?}");
    assert!(!free.iter().any(is_off), "{free:?}");
    let braked = [0.02, 0.04].map(published).concat();
    let (learned, withheld): (Vec<_>, Vec<_>) = braked.iter().copied().partition(|(said, _)| *said == Learned::Learned);
    assert!(!withheld.is_empty() && withheld.iter().any(is_off), "{braked:?}");
    assert!(!learned.iter().any(is_off), "{braked:?}");
}
