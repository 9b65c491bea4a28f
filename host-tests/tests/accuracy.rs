//! How near does it come to the truth? Fleets of simulated vehicles on both sides of the manufacturer's values.
//!
//! The limits are the goals of the project where they are met, rounded up for another set of seeds, and elsewhere what
//! was reached; the full table is printed by `rundown accuracy-bench`.

use host_tests::accuracy::{BAND_KMH, FleetFigures, JudgedVehicle, NOMINAL, judge, replay};
use host_tests::prelude::*;
use rundown::tick::sensor::Rounding;
use rundown_truth::sensors::SpeedReading;
use sim_harness::accuracy_bench::fleets;

/// Scales of (r0, r1, r2): common from 0.75 to 1.25, each coefficient a little apart.
fn vehicles(count: usize) -> Vec<[f64; 3]> {
    (0..count)
        .map(|i| {
            let common = 0.75 + 0.5 * (i as f64 + 0.5) / count as f64;
            let apart = |k: usize| 1.0 + 0.06 * ((i + k) % 3) as f64 - 0.06;
            [common * apart(0), common * apart(1), common * apart(2)]
        })
        .collect()
}

fn judged(title: &str, config: Config, scenario: &Scenario, count: usize, runs: usize) -> FleetFigures {
    let table = judge(config, scenario, &vehicles(count), runs, 4000);
    table.print(title);
    table
}

#[test]
fn gated_learning_follows_the_truth() {
    let table = judged("gated, clean", Config::default(), &Scenario::default(), 10, 10);
    for slope in table.slopes() {
        assert!((0.82..1.06).contains(&slope), "slope {slope}");
    }
    assert!(table.vehicle[0].rmse_percent() < 3.9);
    assert!(table.vehicle[1].rmse_percent() < 1.6);
    for errors in [&table.vehicle[0], &table.vehicle[1]] {
        assert!(errors.coverage() > 0.85);
    }
    let [(causal, _), (confirmed, f1)] = table.regime_scores();
    assert!(causal > 0.88 && confirmed > 0.90 && f1 > 0.91);
    let [brake_s, coast_s, cruise_kmh, power_percent] = table.feature_p90();
    // 10 s over 804 runs of another seed, 11 and 12 s over 400 each.
    assert!(brake_s < 5.0 && coast_s < 17.0, "{brake_s} {coast_s}");
    assert!(cruise_kmh < 0.7 && power_percent < 1.6, "{cruise_kmh} {power_percent}");
}

/// The paper's loop computes the effort from the speed that it explains: what it estimates says nothing about the
/// train.
#[test]
fn the_papers_loop_does_not_follow_the_truth() {
    let config = Config::with_mode(Mode::Paper);
    let table = judged("paper", config, &Scenario::default(), 12, 1);
    for slope in table.slopes() {
        assert!(slope.abs() < 0.05, "slope {slope}");
    }
}

#[test]
fn wind_between_runs_does_not_poison_the_vehicle() {
    let windy = Scenario { wind_sd_mps: 2.0, ..Scenario::default() };
    let table = judged("gated, wind 2 m/s", Config::default(), &windy, 4, 40);
    assert!(table.vehicle[2].rmse_percent() < 3.5);
    assert!(table.running[2].rmse_percent() < 2.5);
    assert!(table.vehicle[2].coverage() > 0.75);
}

/// 10 % was the prior's own error with the effort column taken for what it is not; the bound is 0.8 / 0.5 %.
#[test]
fn an_effort_column_teaches_however_it_was_made_and_whatever_its_gain() {
    let config = Config::with_mode(Mode::Measured);
    let wrong_gain = Sensors { effort_gain: 1.02, effort_noise_share: 0.02, ..Sensors::default() };
    let momentary = Sensors { effort_momentary: true, ..wrong_gain.clone() };
    let fast = Sensors { sampling_s: 1.0, ..wrong_gain.clone() };
    for (title, sensors, after_10) in
        [("mean", wrong_gain, 1.2), ("momentary", momentary, 1.6), ("mean, 1 s", fast, 1.2)]
    {
        let table = judged(title, config, &Scenario { sensors, ..Scenario::default() }, 6, 10);
        assert!(table.vehicle[0].rmse_percent() < 4.2, "{title}");
        assert!(table.vehicle[1].rmse_percent() < after_10, "{title}");
        assert!(table.vehicle[1].coverage() > 0.85, "{title}");
    }
}

/// 5 % low at 140 km/h and right at standstill. Rows that were doubted by white noise alone taught an r(v) that was 15
/// % too large at 20 km/h and 7 % (rms) off in all, seven standard deviations; now it is 2.8 %, and still two of them,
/// because all runs are off alike.
#[test]
fn a_gain_that_changes_with_the_speed_makes_no_other_resistance() {
    let sensors = Sensors { sampling_s: 1.0, effort_noise_share: 0.02, ..Sensors::default() };
    let scenario = Scenario { sensors, ..Scenario::default() };
    let estimator = host_tests::accuracy::estimator(Config::with_mode(Mode::Measured), &scenario);
    let mut table = FleetFigures::default();
    for (index, scale) in vehicles(4).into_iter().enumerate() {
        let mut runs = rundown_truth::scenario::fleet(&scenario, scale, 10, 6000 + 100 * index as u64);
        for sample in runs.iter_mut().flat_map(|run| &mut run.samples) {
            sample.effort_n_per_kg *= 1.0 - 0.05 * sample.speed_kmh.unwrap_or_default() / 140.0;
        }
        let truth = Davis { r0: NOMINAL.r0 * scale[0], r1: NOMINAL.r1 * scale[1], r2: NOMINAL.r2 * scale[2] };
        table.judge_vehicle(&JudgedVehicle { estimator: &estimator, truth, band_kmh: BAND_KMH }, &runs);
    }
    table.print("gain 5 % low at 140 km/h");
    assert!(table.vehicle[1].rmse_percent() < 3.5 && table.vehicle[1].deviations() < 3.0);
}

/// A late column was learned from with a bias of 2 to 3 %, and the intervals held a third to a half of the truths after
/// 67 runs (74 % after 10).
#[test]
fn the_interval_of_a_late_column_holds() {
    let fleet = fleets::all().into_iter().find(|fleet| fleet.name == "late").unwrap();
    let mut all = FleetFigures::default();
    for seed in [31, 32, 33] {
        all.merge(sim_harness::accuracy_bench::judge(&fleet, fleet.config(), 4, 24, seed, || ()).unwrap());
    }
    all.print("mean efforts one second late, and not declared");
    for (errors, most_percent) in all.vehicle.iter().zip([2.6, 1.2, 0.9]) {
        assert!(errors.rmse_percent() < most_percent);
        assert!(errors.coverage() > 0.92 && errors.deviations() < 1.2);
    }
}

/// What a run learned of the column the next one begins with; a recorder that was swapped is believed after some runs.
#[test]
fn gain_and_age_of_an_effort_column_are_carried_and_a_swapped_recorder_is_believed() {
    let scenario = |effort_gain, effort_momentary| {
        let sensors = Sensors { effort_gain, effort_momentary, effort_noise_share: 0.02, ..Sensors::default() };
        Scenario { sensors, ..Scenario::default() }
    };
    let [old, new] = [scenario(1.05, false), scenario(0.97, true)];
    let estimator = host_tests::accuracy::estimator(Config::with_mode(Mode::Measured), &old);
    let mut vehicle = estimator.new_vehicle();
    let known =
        |vehicle: &Vehicle| vehicle.column().next_run().map(|(mean, variance)| (f64::from(mean), f64::from(variance)));
    assert_eq!(known(&vehicle), [(1.0, 0.0), (0.0, 0.0)], "nothing is known of a new one");
    let mut after = |scenario: &Scenario, seeds: std::ops::Range<u64>| {
        for seed in seeds {
            replay(&estimator, &mut vehicle, &simulate(scenario, seed));
        }
        known(&vehicle)
    };
    let [(gain, gain_variance), (share, share_variance)] = after(&old, 710..714);
    assert!((gain - 1.0 / 1.05).abs() < 0.012 && gain_variance.sqrt() < 0.012, "{gain} {gain_variance}");
    assert!(share.abs() < 0.1 && share_variance.sqrt() < 0.07, "{share} {share_variance}");
    let [(gain, _), (share, _)] = after(&new, 720..732);
    assert!((gain - 1.0 / 0.97).abs() < 0.03, "{gain}");
    assert!((share - 0.5).abs() < 0.15, "{share}");
}

/// `s` is a share of the tick: what rows of 10 s say of it, believed of rows of 1 s, hid most of the second for as long
/// as the vehicle ran.
#[test]
fn a_column_of_another_tick_keeps_its_gain_and_its_age_is_learned_again() {
    let every = |sampling_s| {
        let late = Sensors { effort_lag_s: 1.0, effort_gain: 1.05, effort_noise_share: 0.02, ..Sensors::default() };
        Scenario { sensors: Sensors { sampling_s, ..late }, ..Scenario::default() }
    };
    let estimator = host_tests::accuracy::estimator(Config::with_mode(Mode::Measured), &every(10.0));
    let mut vehicle = estimator.new_vehicle();
    for (sampling_s, runs, expected) in [(10.0, 810..816, -0.1), (1.0, 820..824, -1.0), (10.0, 830..834, -0.1)] {
        for seed in runs {
            replay(&estimator, &mut vehicle, &simulate(&every(sampling_s), seed));
        }
        let [(gain, _), (share, variance)] = vehicle.column().next_run();
        let off = (share - expected) / variance.sqrt();
        println!("{sampling_s} s: gain {gain}, s {share}, off by {off} standard deviations");
        assert!((gain - 1.0 / 1.05).abs() < 0.015, "{gain}");
        assert!(off.abs() < 3.0, "{sampling_s} s: {share}, off by {off} standard deviations");
    }
}

/// Nothing was learned on hops before: the errors after 20 runs were the 16 % of the descriptions. What is learned must
/// hold: gentle brakes that were taken for coasts gave a suburban train a fifth too much.
#[test]
fn short_coasts_teach_metros_trams_and_suburban_trains() {
    // With an effort column the first hop of each run, which is not known to be one, teaches by it; by all hops 9 %
    // after ten runs, 31 % inside.
    let fleets_and_limits =
        [("metro", 9.0, 0.95), ("tram", 6.0, 0.95), ("suburban-1s", 13.0, 0.95), ("suburban-effort", 5.0, 0.8)];
    for (name, most_percent, least_inside) in fleets_and_limits {
        let fleet = fleets::all().into_iter().find(|fleet| fleet.name == name).unwrap();
        let table = sim_harness::accuracy_bench::judge(&fleet, fleet.config(), 6, 20, 4000, || ()).unwrap();
        table.print(name);
        assert!(table.vehicle[2].rmse_percent() < most_percent, "{name}");
        assert!(table.vehicle[2].coverage() > least_inside, "{name}");
    }
}

/// Read as whole km/h, speeds in tenths ended with 3.4, 1.2 and 15 % and half-widths of 13 to 28 %; what held speeds
/// taught beside the coasts was not noticed.
#[test]
fn speeds_in_tenths_teach_short_hops_in_narrow_intervals() {
    for (name, most_percent) in [("metro-tenths", 2.5), ("tram-tenths", 1.5), ("suburban-tenths", 3.5)] {
        let fleet = fleets::all().into_iter().find(|fleet| fleet.name == name).unwrap();
        let table = sim_harness::accuracy_bench::judge(&fleet, fleet.config(), 6, 20, 4000, || ()).unwrap();
        table.print(name);
        let errors = &table.vehicle[2];
        assert!(errors.rmse_percent() < most_percent, "{name}");
        assert!(errors.coverage() > 0.92, "{name}");
    }
}

/// A recorder that cuts off whole km/h reads half of one too little; said in the configuration it costs nothing.
#[test]
fn truncated_speed_costs_nothing_when_configured() {
    let truncated =
        Scenario { sensors: Sensors { speed: SpeedReading::Truncated, ..Sensors::default() }, ..Scenario::default() };
    let mut config = Config::default();
    config.sensor.rounding = Rounding::Truncated;
    let table = judged("gated, truncated", config, &truncated, 6, 10);
    assert!(table.vehicle[1].rmse_percent() < 1.9);
    assert!(table.feature_p90()[2] < 0.7);
}

/// Not declared, the estimator ended with 2.0 % after 20 runs, and half of the truths inside the interval.
#[test]
fn speeds_that_are_cut_off_are_found_and_put_right() {
    let fleet = fleets::all().into_iter().find(|fleet| fleet.name == "truncated").unwrap();
    let table = sim_harness::accuracy_bench::judge(&fleet, fleet.config(), 6, 20, 4000, || ()).unwrap();
    table.print("truncated, not declared");
    assert!(table.vehicle[2].rmse_percent() < 1.0);
    assert!(table.vehicle[1].coverage() > 0.92 && table.vehicle[2].coverage() > 0.92);
    assert!(table.feature_p90()[2] < 0.9, "cruise speed");
}

/// Fast logs show each rounding step many times over; r must not be believed more than it is known. It is not known
/// better than from 10 s samples either: over these five runs the error stays near that of the first, with a bias of 1
/// %.
#[test]
fn one_second_logs_are_not_overconfident() {
    let fast = Scenario { sensors: Sensors { sampling_s: 1.0, ..Sensors::default() }, ..Scenario::default() };
    let table = judged("gated, 1 s", Config::default(), &fast, 6, 5);
    assert!(table.vehicle[2].rmse_percent() < 3.5);
    assert!(table.vehicle[2].coverage() > 0.85);
}
