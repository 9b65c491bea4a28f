//! A track that is not as described: what is learned on it is doubted, and the trust in it falls where the description was believed.

use host_tests::accuracy::{Errors, davis, replay};
use host_tests::prelude::*;
use rundown::estimator::config::Config;
use rundown::tick::foresight::Trust;
use rundown_truth::plan::plan;
use rundown_truth::scenario::{Run, Scenario, simulate_planned};
use sim_harness::accuracy_bench::fleets;

const RUNS: usize = 12;
const VEHICLES: u64 = 4;

/// Runs of vehicles whose resistance is as described, on the line of the case study.
fn fleet() -> Vec<Vec<Run>> {
    let scenario = Scenario::default();
    let of_vehicle =
        |seed| plan(&scenario, RUNS, seed).iter().map(|plan| simulate_planned(&scenario, plan).unwrap()).collect();
    (71..71 + VEHICLES).map(of_vehicle).collect()
}

/// Errors of r(v) and the trust in each vehicle, where gradients are described with this factor and believed with this doubt.
fn learned_on(fleet: &[Vec<Run>], factor: f64, doubt_permille: f64) -> (Errors, Vec<Trust>) {
    let calm = fleets::all().into_iter().find(|fleet| fleet.name == "calm").unwrap();
    let mut config = Config::default();
    config.track_doubt.gradient_sd_permille = doubt_permille;
    let line = &calm.scenario.line;
    let gradients = line.gradients_permille().iter();
    let gradients = gradients.map(|&(from_m, permille)| Gradient { from_m, permille: factor * permille });
    let track = Track::try_new(line.length_m(), gradients).unwrap();
    let estimator = Estimator::try_new(config, calm.train().unwrap(), track).unwrap();
    let mut errors = Errors::default();
    let of_vehicle = |runs: &Vec<Run>| {
        let mut vehicle = estimator.new_vehicle();
        for run in runs {
            replay(&estimator, &mut vehicle, run);
        }
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
    assert!(doubted.coverage() > 0.9 && doubted.deviations() < 1.3, "{doubted:?}");
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
