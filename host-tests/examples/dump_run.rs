//! Prints one simulated run as CSV: `cargo run -p host-tests --example dump_run -- [seed] [case|hilly|hops|red]`.
//!
//! The first four columns that a run log knows keep their names; the truth stands beside them.

use rundown_truth::habits::DriverKind;
use rundown_truth::line::Line;
use rundown_truth::scenario::{Scenario, UnscheduledStop, simulate};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seed = arguments.next().map_or(1, |s| s.parse().expect("the seed is a number"));
    let scenario = match arguments.next().as_deref().unwrap_or("case") {
        "case" => Scenario::default(),
        "hilly" => Scenario { line: Line::hilly(seed), ..Scenario::default() },
        "hops" => Scenario { driver: DriverKind::ShortHop, final_dwell: true, ..Scenario::default() },
        "red" => Scenario {
            unscheduled_stop: Some(UnscheduledStop { at_m: 14_000.0, dwell_s: 45.0, share: 1.0 }),
            ..Scenario::default()
        },
        other => panic!("expected case, hilly, hops or red, found {other}"),
    };
    let run = simulate(&scenario, seed);
    println!("# {:?}", run.facts);
    println!("time_s,location_m,speed_kmh,regime,effort_n_per_kg,true_location_m,true_speed_kmh");
    for (sample, truth) in run.samples.iter().zip(&run.truth) {
        let field = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.3}"));
        println!(
            "{:.1},{},{},{:?},{:.4},{:.3},{:.3}",
            sample.time_s,
            field(sample.location_m),
            field(sample.speed_kmh),
            truth.regime,
            sample.effort_n_per_kg,
            truth.location_m,
            3.6 * truth.speed_mps,
        );
    }
}
