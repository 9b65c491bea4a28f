//! Sets of runs of one recorder: on lines of their own stops, and of services that all call at the same stations.

use crate::accuracy_bench::fleets;
use crate::study::case::Case;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown_files::recording::Recording;
use rundown_truth::scenario::{DriveError, Scenario, simulate_planned};
use rundown_truth::{habits::DriverKind, line::Line, plan::plan, sensors::Sensors};

/// Runs of a set ...
pub(super) const RUNS: usize = 4;
/// ... and where runs are compared with one another.
pub(super) const MANY_RUNS: usize = 8;
/// Lines where all runs stop at the same stations, by the names of the accuracy bench.
pub(super) const SERVICES: [&str; 4] = ["wind", "suburban", "metro", "tram"];

/// The one of them whose drivers coast for minutes.
pub(super) const COASTING: &str = "wind";
/// The one whose line has the most stops on the longest way.
pub(super) const SUBURBAN: &str = "suburban";

/// Runs of a recorder. `lags_s`: by how much the speed of each run is late.
pub(super) fn simulated(sensors: &Sensors, seed: u64, lags_s: &[f64]) -> Result<Vec<Recording>, DriveError> {
    let scenario = Scenario {
        line: if seed.is_multiple_of(2) { Line::hilly(seed) } else { Line::flat_corridor() },
        driver: if seed.is_multiple_of(3) { DriverKind::CaseStudy } else { DriverKind::ShortHop },
        wind_sd_mps: 2.0,
        load_sd: 0.02,
        final_dwell: true,
        sensors: sensors.clone(),
        ..Scenario::default()
    };
    recorded(&scenario, RUNS, seed, lags_s)
}

/// Runs of one of these services, by the seed, at stations whose distances differ.
pub(super) fn on_stations(services: &[&str], sensors: &Sensors, seed: u64) -> Result<Vec<Recording>, DriveError> {
    let scenario = service(services[seed as usize % services.len()], sensors, seed);
    recorded(&scenario, MANY_RUNS, seed, &[])
}

/// So many runs. `lags_s`: by how much the speed of each is late, where it is not as the sensors have it.
fn recorded(scenario: &Scenario, runs: usize, seed: u64, lags_s: &[f64]) -> Result<Vec<Recording>, DriveError> {
    let run = |(i, plan)| {
        let mut scenario = scenario.clone();
        if let Some(lag_s) = lags_s.get(i) {
            scenario.sensors.speed_lag_s = [*lag_s; 2];
        }
        Ok(Case::simulated(format!("run{i}"), String::new(), simulate_planned(&scenario, plan)?).recording)
    };
    plan(scenario, runs, seed).iter().enumerate().map(run).collect()
}

/// A service of the accuracy bench in a little wind, its stations moved.
pub(super) fn service(name: &str, sensors: &Sensors, seed: u64) -> Scenario {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x57A7);
    let service = fleets::all().into_iter().find(|fleet| fleet.name == name);
    let Scenario { mut line, train, driver, .. } = service.map(|fleet| fleet.scenario).unwrap_or_default();
    let hop_m = line.length_m() / (line.calls_m().len() + 1) as f64;
    let mut near = |at_m: &f64| at_m + random.random_range(-0.3..0.3) * hop_m;
    let calls_m = line.calls_m().iter().map(&mut near).collect();
    line.set_calls(calls_m);
    let calm = Scenario { wind_sd_mps: 2.0, load_sd: 0.02, final_dwell: true, ..Scenario::default() };
    Scenario { line, train, driver, sensors: sensors.clone(), ..calm }
}
