//! `cargo xtask budget`: plays that ask more of the board than the reference run, through the firmware in the emulator
//! and the task on the host.
//!
//! Out: a line for each with its name, the depth of the stack, and the longest call of the application.

use host_tests::plays::{day, seven_effects};
use host_tests::prelude::*;
use host_tests::target::{compare, firmware};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let settings = firmware()?;
    let effects = [("seven_effects", Mode::Gated), ("measured", Mode::Measured)];
    for play in effects.map(|(name, mode)| seven_effects(name, mode)).into_iter().chain([day()]) {
        let same = compare(&settings, &play.description, Direction::Up, &play.log)?;
        println!(
            "{} ticks={} stack_bytes={} longest_us={}",
            play.name, same.ticks, same.health.stack_bytes, same.health.longest_us
        );
    }
    Ok(())
}
