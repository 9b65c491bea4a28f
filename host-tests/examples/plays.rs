//! `cargo xtask budget`: plays that ask more of the board than the reference run, through the firmware in the emulator
//! and the task on the host.
//!
//! Out: a line for each with its name, the depth of the stack, and the longest call of the application.

use host_tests::plays::{day, measured, seven_effects};
use host_tests::target::firmware;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let settings = firmware()?;
    for play in [seven_effects(), measured(), day()] {
        let same = play.compare(&settings)?;
        println!(
            "{} ticks={} stack_bytes={} longest_us={}",
            play.name, same.ticks, same.health.stack_bytes, same.health.longest_us
        );
    }
    Ok(())
}
