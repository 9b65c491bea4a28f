//! Is it the same code? The firmware in the emulator and the task on the host, fed with the same logs, say the same
//! bytes.

use emulator::Settings;
use host_tests::accuracy::{description, measurements};
use host_tests::coasting::with_targets;
use host_tests::plays::{Play, day, measured, seven_effects};
use host_tests::prelude::*;
use host_tests::reference::{Logs, recording};
use host_tests::target::{Same, compare, firmware};
use rundown_truth::line::Line;
use rundown_truth::sensors::Bursts;
use sim_harness::session;

/// Compares a simulated run, and says what it was.
fn simulated(what: &str, mode: Mode, scenario: &Scenario, seed: u64) {
    let settings = firmware().unwrap();
    let description = description(Config::with_mode(mode), scenario);
    described(what, &settings, &description, scenario, seed);
}

fn described(what: &str, settings: &Settings, description: &Description, scenario: &Scenario, seed: u64) {
    let log = measurements(&simulate(scenario, seed));
    let same = compare(settings, description, Direction::Up, &[&log]);
    say(what, &same.unwrap_or_else(|error| panic!("{what}, seed {seed}: {error}")));
}

fn say(what: &str, same: &Same) {
    println!(
        "{what}: {} ticks, {} frames and {} bytes the same; stack {} B, longest call {} us",
        same.ticks, same.frames, same.line_bytes, same.health.stack_bytes, same.health.longest_us
    );
    assert!(same.frames > 3 * same.ticks, "{what}: {} frames", same.frames);
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_run_of_the_case_study() {
    simulated("gated", Mode::Gated, &Scenario::default(), 3);
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_run_towards_targets() {
    let settings = firmware().unwrap();
    let scenario = Scenario { line: Line::hilly(8), wind_sd_mps: 2.0, ..Scenario::default() };
    let description = with_targets(Config::default(), &scenario);
    described("targets", &settings, &description, &scenario, 8);
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn the_papers_mode() {
    simulated("paper", Mode::Paper, &Scenario::default(), 4);
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn the_measured_mode() {
    simulated("measured", Mode::Measured, &Scenario::default(), 5);
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_hilly_line_with_wind() {
    let scenario = Scenario { line: Line::hilly(8), wind_sd_mps: 2.0, ..Scenario::default() };
    simulated("hills and wind", Mode::Gated, &scenario, 6);
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_model_with_effects() {
    played(&seven_effects());
    played(&measured());
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_day_of_hops() {
    played(&day());
}

fn played(play: &Play) {
    let same = play.compare(&firmware().unwrap());
    say(play.name, &same.unwrap_or_else(|error| panic!("{}: {error}", play.name)));
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_run_with_dropouts() {
    let sensors = Sensors {
        dropout_probability: 0.2,
        bursts: Some(Bursts { probability: 0.03, samples: [3, 12] }),
        ..Sensors::default()
    };
    let scenario = Scenario { sensors, ..Scenario::default() };
    simulated("dropouts", Mode::Gated, &scenario, 7);
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_recorded_run() {
    let logs = Logs::find();
    let (train, track) = (logs.train().1, logs.track().0);
    let recording = recording(&logs.set.files[0].path);
    let log: Vec<_> = recording.rows.iter().map(Sample::measurement).collect();
    let description = session::description(&train, &track, Config::default());
    let same = compare(&firmware().unwrap(), &description, recording.direction, &[&log]).unwrap();
    say(&recording.name, &same);
}
