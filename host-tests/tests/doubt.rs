//! A track that is not as described: what is learned on it is doubted, and the trust in it falls where the description was believed.

use host_tests::accuracy::{Errors, davis, replay};
use host_tests::prelude::*;
use rundown::estimator::config::Config;
use rundown::tick::foresight::Trust;
use rundown_truth::plan::plan;
use rundown_truth::scenario::{Run, Scenario, simulate_planned};
use sim_harness::accuracy_bench::fleets;

const RUNS: usize = 12;

/// Runs of one vehicle, resistance as described, on the line of the case study.
fn runs() -> Vec<Run> {
    let scenario = Scenario::default();
    plan(&scenario, RUNS, 71).iter().map(|plan| simulate_planned(&scenario, plan).unwrap()).collect()
}

/// Errors of the vehicle's r(v) and the trust in it, where gradients are described with this factor and believed with this doubt.
fn learned_on(runs: &[Run], factor: f64, doubt_permille: f64) -> (Errors, Trust) {
    let fleet = fleets::all().into_iter().find(|fleet| fleet.name == "calm").unwrap();
    let mut config = Config::default();
    config.track_doubt.gradient_sd_permille = doubt_permille;
    let line = &fleet.scenario.line;
    let gradients = line.gradients_permille().iter();
    let gradients = gradients.map(|&(from_m, permille)| Gradient { from_m, permille: factor * permille });
    let track = Track::try_new(line.length_m(), gradients).unwrap();
    let estimator = Estimator::try_new(config, fleet.train().unwrap(), track).unwrap();
    let mut vehicle = estimator.new_vehicle();
    for run in runs {
        replay(&estimator, &mut vehicle, run);
    }
    let mut errors = Errors::default();
    errors.add(fleet.band_kmh, &vehicle.davis(), &davis(&runs[0].facts.davis));
    (errors, *vehicle.trust())
}

#[test]
fn unknown_gradients_are_not_taken_for_resistance() {
    let runs = runs();
    let (believed_flat, _) = learned_on(&runs, 0.0, 0.0);
    let (doubted, _) = learned_on(&runs, 0.0, 5.0);
    // The control: a flat line that is believed in misleads.
    assert!(believed_flat.rmse_percent() > 8.0 && believed_flat.deviations() > 1.5, "{believed_flat:?}");
    assert!(doubted.rmse_percent() < believed_flat.rmse_percent(), "{doubted:?}");
    assert!(doubted.deviations() < 1.0, "{doubted:?}");
}

#[test]
fn coasts_on_wrong_gradients_scatter_and_on_right_ones_do_not() {
    let runs = runs();
    let (right, trust) = learned_on(&runs, 1.0, 0.0);
    assert!(trust.coasts > 5.0 && trust.inflation() < 1.2 && trust.worse_by() < 2.0, "{trust:?}");
    assert!(right.coverage() > 0.9);
    let (_, trust) = learned_on(&runs, -1.0, 0.0);
    assert!(trust.coasts > 5.0 && trust.inflation() > 1.5, "{trust:?}");
}
