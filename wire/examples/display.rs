//! A display in thirty lines: a serial line's bytes on standard input, a line of text for each tick.
//!
//! `cargo run -p rundown-wire --example display < frames.bin`

use rundown_wire::{Body, Learned, Reader};
use std::io::Read;

fn main() -> std::io::Result<()> {
    let mut reader = Reader::new();
    let mut resistance = "not learned yet".to_owned();
    for byte in std::io::stdin().lock().bytes() {
        let Some(received) = reader.byte(byte?) else {
            continue;
        };
        match received.frame.body {
            Body::Parameters(parameters) if parameters.learned == Learned::Learned => {
                let r = parameters.at(100.0 / 3.6);
                resistance = format!("r(100 km/h) = {:.4} ± {:.4} N/kg", r.value, r.sd);
            }
            Body::Estimate(estimate) => {
                let km = estimate.location_m.value / 1000.0;
                let kmh = estimate.speed_mps.value * 3.6;
                let (regime, validity) = (estimate.regime, estimate.validity.as_str());
                println!("{km:7.3} km {kmh:5.1} km/h {regime:10} {validity:7} {resistance}");
            }
            _ => {}
        }
    }
    let tally = reader.tally();
    eprintln!("{} frames, {} lost, {} damaged", tally.frames, tally.lost, tally.damaged);
    Ok(())
}
