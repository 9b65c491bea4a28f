//! Prints estimates against truth for fleets of simulated vehicles: `cargo run --release -p host-tests --example accuracy [vehicles] [runs] [mode]`.

use host_tests::accuracy::{judge, scales};
use host_tests::prelude::*;

fn main() {
    let argument = |i: usize| std::env::args().nth(i);
    let vehicles = argument(1).and_then(|a| a.parse().ok()).unwrap_or(12);
    let runs = argument(2).and_then(|a| a.parse().ok()).unwrap_or(67);
    let mode = match argument(3).as_deref() {
        Some("paper") => Mode::Paper,
        Some("measured") => Mode::Measured,
        _ => Mode::Gated,
    };
    let which = argument(4);
    let scales = scales(vehicles);
    let config = Config::with_mode(mode);
    let one_second = Sensors { sampling_s: 1.0, ..Sensors::default() };
    for (name, scenario) in [
        ("clean", Scenario::default()),
        ("wind", Scenario { wind_sd_mps: 2.0, ..Scenario::default() }),
        ("hilly", Scenario { line: rundown_truth::line::Line::hilly(3), ..Scenario::default() }),
        ("fast", Scenario { sensors: one_second, ..Scenario::default() }),
    ] {
        if which.as_deref().is_none_or(|which| which == name) {
            judge(config, &scenario, &scales, runs, 77).print(name);
        }
    }
}
