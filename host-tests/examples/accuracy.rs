//! Tries settings on fleets: `cargo run -p host-tests --example accuracy FLEET VEHICLES RUNS SEED [NAME=VALUE]..`.
use host_tests::prelude::*;
use sim_harness::accuracy_bench::{fleets, judge};
fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize| arguments[i].parse::<usize>().unwrap();
    let (vehicles, runs, seed) = (number(1), number(2), number(3) as u64);
    for fleet in fleets::all() {
        if arguments[0] != "all" && !arguments[0].split(',').any(|name| name == fleet.name) {
            continue;
        }
        let mut config = fleet.config();
        for setting in &arguments[4..] {
            let (name, value) = setting.split_once('=').unwrap();
            let value: f64 = value.parse().unwrap();
            let learning = &mut config.learning;
            match name {
                "min_speed" => learning.min_speed_kmh = value,
                "begin" => learning.begin_probability = value,
                "end" => learning.end_probability = value,
                "cut" => learning.end_cut_s = value,
                "min" => learning.min_segment_s = value,
                "interval" => config.recogniser.interval_s = value,
                "staircase" => learning.staircase_s = value,
                "noise" => learning.acceleration_noise_mps2 = value,
                "share" => learning.effort_change_share = value,
                _ => panic!("{name}"),
            }
        }
        match judge(&fleet, config, vehicles, runs, seed, || ()) {
            Ok(table) => table.print(&format!("{}: {}", fleet.name, fleet.what)),
            Err(e) => println!("{}: {e}", fleet.name),
        }
    }
}
