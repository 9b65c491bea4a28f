//! Is the coast-ahead prediction right as often as it says, does it stand still, and does the board say it?
//!
//! Truth is what the simulated train does when it coasts from there: the simulator's own integrator, with the wind and
//! the load of that run.

use host_tests::board::{case_study, running};
use host_tests::coasting::{Calibration, Judged, judge, published};
use host_tests::prelude::*;
use host_tests::said;
use rayon::prelude::*;
use rundown::coast_ahead::CoastConfig;
use rundown::model::track::MAX_TARGETS;
use rundown::uplink::{Setting, TargetPart};
use rundown_truth::driver::Regime;
use rundown_wire::{Body, CoastAhead, CoastOutcome, Refusal};

/// Share of the described resistance of r0, r1, r2 of eight vehicles.
const SCALES: [[f64; 3]; 8] = [
    [0.75, 0.82, 0.71],
    [0.86, 0.80, 0.92],
    [0.97, 1.04, 0.94],
    [1.05, 0.99, 1.10],
    [1.14, 1.21, 1.09],
    [1.27, 1.18, 1.24],
    [0.92, 0.92, 0.92],
    [1.08, 0.93, 1.02],
];
const RUNS: usize = 12;

fn fleet(name: &str, scenario: &Scenario) -> Vec<Judged> {
    let of_vehicle = |(i, scale)| judge(Config::default(), scenario, scale, RUNS, 40 + i, 60.0);
    let vehicles = SCALES.into_par_iter().enumerate();
    let judged: Vec<Judged> = vehicles.flat_map_iter(|(i, scale)| of_vehicle((i as u64, scale))).collect();
    println!("{name}\n  all      {}", Calibration::of(&judged).row());
    for (name, regime) in [("coasting", Regime::Coast), ("cruising", Regime::Cruise)] {
        let row = judged.iter().filter(|one| one.regime == regime);
        println!("  {name} {}", Calibration::of(row).row());
    }
    judged
}

#[test]
fn the_90_percent_interval_holds_the_truth_in_85_to_95_percent() {
    for wind_sd_mps in [1.0, 2.0] {
        let scenario = Scenario { wind_sd_mps, load_sd: 0.03, ..Scenario::default() };
        let judged = fleet(&format!("wind {wind_sd_mps} m/s, load 3 %"), &scenario);
        let found = Calibration::of(&judged);
        assert!(found.count > 4000.0, "{}", found.count);
        for coverage in found.coverage() {
            assert!((0.85..=0.95).contains(&coverage), "{}", found.row());
        }
        let coasting = Calibration::of(judged.iter().filter(|one| one.regime == Regime::Coast));
        for coverage in coasting.coverage() {
            assert!((0.85..=0.96).contains(&coverage), "{}", coasting.row());
        }
        // It was said to arrive and stood before, or the other way round.
        assert!(found.wrong[0] + found.wrong[1] < 0.01 * found.count, "{}", found.row());
    }
}

/// Without wind and with clean sensors the interval is too wide, as that of the resistance is.
#[test]
fn in_calm_the_interval_is_wide_and_the_prediction_sharp() {
    let judged = fleet("calm", &Scenario::default());
    let late: Vec<&Judged> = judged.iter().filter(|one| one.run >= 5).collect();
    let found = Calibration::of(late.iter().copied());
    for coverage in found.coverage() {
        assert!(coverage >= 0.85, "{}", found.row());
    }
    let coasting = late.iter().filter(|one| one.regime == Regime::Coast);
    let coasting = Calibration::of(coasting.copied());
    let [speed_kmh, time_s] = coasting.square.map(|sum| (sum / coasting.count).sqrt());
    assert!(speed_kmh < 0.6 && time_s < 4.0, "{}", coasting.row());
}

#[test]
fn advice_stands_still_while_the_train_coasts() {
    let scenario = Scenario::default();
    let config = Config::default();
    let judged = judge(config, &scenario, [0.95, 1.02, 0.97], RUNS, 90, 60.0);
    let [all, coasting] = published(&config, &judged);
    println!("published: {all:?} of all ticks, {coasting:?} while coasting");
    // Under power each place has another prediction.
    assert!(3 * coasting[0] < coasting[1], "{coasting:?}");
    let restless =
        Config { coast: CoastConfig { coasting_point_m: 0.0, arrival_s: 0.0, ..CoastConfig::default() }, ..config };
    let [_, every] = published(&restless, &judged);
    // A train that stands or may stand has nothing that could move.
    assert!(20 * every[0] > 19 * every[1], "{every:?}");
}

#[test]
fn the_board_says_it_third_and_again_each_minute() {
    let (mut board, _, log) = running(case_study());
    let (mut said, mut frames_of_it, mut arrivals) = (None, 0, 0);
    for (tick, measurement) in (1..).zip(&log) {
        let frames = board.measure(measurement);
        let place = frames.iter().position(|f| matches!(f.body, Body::CoastAhead(_)));
        let Some(place) = place else {
            assert!(tick % 6 != 1, "tick {tick}: said again");
            continue;
        };
        assert_eq!(place, 2, "behind parameters and effort");
        assert!(tick % 6 != 0 && tick % 12 != 3, "tick {tick}: in a long one");
        let now = said!(frames, CoastAhead);
        assert!(now != said || tick % 6 == 1, "tick {tick}: {now:?}");
        said = now;
        frames_of_it += 1;
        if let Some(CoastAhead { outcome: CoastOutcome::Arrives(arrival), target, .. }) = now {
            arrivals += 1;
            assert!(arrival.speed_mps.value > 0.0 && arrival.speed_mps.sd > 0.0);
            assert!(arrival.time_s > measurement.time_s - 600.0 && arrival.time_sd_s > 0.0);
            assert!(target.is_some());
        }
    }
    assert!(arrivals > 20 && frames_of_it < log.len(), "{arrivals} of {frames_of_it}");
    let last = said.unwrap();
    assert_eq!(last.outcome, CoastOutcome::Unknown, "the train stands");
}

#[test]
fn a_run_that_goes_on_from_a_snapshot_says_the_same() {
    let (mut board, description, log) = running(case_study());
    let half = log.len() / 2;
    for measurement in &log[..half] {
        board.measure(measurement);
    }
    let parts = board.snapshot();
    let rest: Vec<_> = log[half..].iter().map(|measurement| said!(board.measure(measurement), CoastAhead)).collect();
    let mut other = board.restart();
    other.describe(&description);
    other.ask(Request::Command(Command::Pace(Pace::Lockstep))).unwrap();
    for part in parts {
        other.ask(Request::Snapshot(part)).unwrap();
    }
    let again: Vec<_> = log[half..].iter().map(|measurement| said!(other.measure(measurement), CoastAhead)).collect();
    assert!(rest.iter().flatten().count() > 5);
    assert_eq!(again, rest);
}

#[test]
fn targets_are_taken_whole_and_in_order() {
    let (mut board, description, _) = running(case_study());
    let stop = |at_m| Target { at_m, limit_mps: None };
    let part = |track_id, first, targets: &[Target]| {
        Request::Targets(TargetPart { track_id, first, targets: targets.iter().copied().collect() })
    };
    let id = description.track_id();
    assert_eq!(board.ask(part(id, 0, &[])), Err(Refusal::Running));
    board.ask(Request::Command(Command::End)).unwrap();
    assert_eq!(board.ask(part(id + 1, 0, &[])), Err(Refusal::OtherTrack));
    assert_eq!(board.ask(part(id, 0, &[stop(1e3)])), Ok(()));
    assert_eq!(board.ask(part(id, 2, &[stop(2e3)])), Err(Refusal::OutOfOrder));
    assert_eq!(board.ask(part(id, 1, &[stop(2e3)])), Ok(()));
    assert_eq!(board.ask(part(id, 2, &[stop(1e3)])), Err(Refusal::OutOfRange));
    // A partial description is rejected.
    assert_eq!(board.ask(part(id, 2, &[stop(3e3)])), Err(Refusal::OutOfOrder));
    let many: Vec<Target> = (0..MAX_TARGETS + 1).map(|i| stop(i as f64)).collect();
    let mut results = Vec::new();
    for (index, chunk) in many.chunks(24).enumerate() {
        results.push(board.ask(part(id, (24 * index) as u16, chunk)));
    }
    assert_eq!(results.pop(), Some(Err(Refusal::OutOfRange)));
    assert!(results.iter().all(Result::is_ok));
    let wild = CoastConfig { horizon_m: f64::NAN, ..CoastConfig::default() };
    assert_eq!(board.ask(Request::Setting(Setting::Coast(wild))), Err(Refusal::OutOfRange));
}
