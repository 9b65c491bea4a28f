//! Prints coverage and sharpness of the coast-ahead prediction:
//! `cargo run --release -p host-tests --example coasting [vehicles] [runs] [scenario] [wind_change_mps]`.
//!
//! Truth is what the simulated train does when it coasts from there. A row: predictions, share of truths inside the 90
//! % interval, its half width, rms error, bias, rms of error over standard deviation; of the speed at the target, then
//! of the time.

use host_tests::coasting::{Calibration, Judged, judge, published};
use host_tests::prelude::*;
use rayon::prelude::*;
use rundown_truth::driver::Regime;
use rundown_truth::line::Line;
use sim_harness::accuracy_bench::scales;

/// Slowest speed at which a prediction is judged, km/h.
const LEAST_KMH: f64 = 60.0;

fn main() {
    let argument = |i: usize| std::env::args().nth(i);
    let number = |i: usize| {
        argument(i)
            .map(|text| text.parse::<f64>().unwrap_or_else(|_| panic!("argument {i}: expected a number, found {text}")))
    };
    let vehicles = number(1).unwrap_or(24.0) as usize;
    let runs = number(2).unwrap_or(10.0) as usize;
    let which = argument(3);
    let scales = scales(vehicles);
    let wind = |wind_sd_mps| Scenario { wind_sd_mps, ..Scenario::default() };
    let loaded = Scenario { load_sd: 0.03, ..wind(2.0) };
    let hilly = Scenario { line: Line::hilly(3), ..wind(2.0) };
    for (name, scenario) in [
        ("calm", wind(0.0)),
        ("wind 1 m/s", wind(1.0)),
        ("wind 2 m/s", wind(2.0)),
        ("wind 2 m/s, load 3 %", loaded),
        ("wind 2 m/s, hills", hilly),
    ] {
        if which.as_deref().is_some_and(|which| which != name) {
            continue;
        }
        let mut config = Config::default();
        if let Some(wind_mps) = number(4) {
            config.coast.wind_change_mps = wind_mps;
        }
        let fleets: Vec<Vec<Judged>> = scales
            .par_iter()
            .enumerate()
            .map(|(i, scale)| judge(config, &scenario, *scale, runs, 300 + i as u64, LEAST_KMH))
            .collect();
        println!("{name}: {vehicles} vehicles, {runs} runs");
        let all = || fleets.iter().flatten();
        let row = |what: &str, keep: &dyn Fn(&&Judged) -> bool| {
            println!("  {what:14} {}", Calibration::of(all().filter(keep)).row());
        };
        row("all", &|_| true);
        row("run 1", &|j| j.run == 0);
        row("runs 2 to 5", &|j| (1..5).contains(&j.run));
        row("runs 6 on", &|j| j.run >= 5);
        row("coasting", &|j| j.regime == Regime::Coast);
        row("cruising", &|j| j.regime == Regime::Cruise);
        row("in traction", &|j| j.regime == Regime::Traction);
        for (from_m, to_m) in [(0.0, 2e3), (2e3, 6e3), (6e3, 12e3), (12e3, 25e3)] {
            let ahead_m = |j: &&Judged| j.said.target.map_or(f64::NAN, |t| t.at_m - j.said.from.location_m);
            row(&format!("{from_m} to {to_m} m"), &|j| (from_m..to_m).contains(&ahead_m(j)));
        }
        let counts = fleets.iter().map(|judged| published(&config, judged));
        let [all, coasting] = counts.fold([[0; 2]; 2], |mut sum, counts| {
            for (sum, count) in sum.iter_mut().flatten().zip(counts.iter().flatten()) {
                *sum += count;
            }
            sum
        });
        println!("  published: {all:?} of all ticks, {coasting:?} while coasting");
    }
}
