//! `cargo xtask budget`: what the firmware costs, against what it may cost.

mod calls;
mod drive;

use crate::{firmware, setup};
use emulator::{Board, Emulator, Image, NS_PER_INSTRUCTION, Settings};
use rundown::onboard::clock::FAST_HZ;
use rundown::onboard::stack::high_water_bytes;

/// Flash for code, constants and first values, bytes.
const MOST_FLASH: u64 = 96 << 10;
/// RAM for variables, bytes: SRAM1 of the reference board.
const MOST_RAM: u64 = 96 << 10;
/// Deepest stack, bytes: a quarter of SRAM2.
const MOST_STACK: u64 = 8 << 10;
/// One call of the application: 2.4 ms at 80 MHz and one instruction a cycle.
const MOST_INSTRUCTIONS: u64 = 150_000;

struct Line {
    what: &'static str,
    unit: &'static str,
    found: u64,
    most: u64,
}

/// Measures, prints, and fails above a limit.
pub fn budget() -> Result<(), String> {
    setup::setup()?;
    firmware::firmware(Board::L475)?;
    let image = Image::read(&Board::L475.image_path()).map_err(|error| error.to_string())?;
    let (stack, instructions) = measure(&image)?;
    let panics = calls::to_panics(&image);
    let allocators = calls::allocators(&image);
    let lines = [
        Line {
            what: "flash: code, constants, first values",
            unit: "B",
            found: image.flash,
            most: MOST_FLASH,
        },
        Line {
            what: "RAM: variables",
            unit: "B",
            found: image.ram,
            most: MOST_RAM,
        },
        Line {
            what: "stack: deepest in a run, painted",
            unit: "B",
            found: stack,
            most: MOST_STACK,
        },
        Line {
            what: "longest call of the application",
            unit: "instructions",
            found: instructions,
            most: MOST_INSTRUCTIONS,
        },
        Line {
            what: "places that may panic",
            unit: "",
            found: count(&panics),
            most: 0,
        },
        Line {
            what: "allocator symbols",
            unit: "",
            found: count(&allocators),
            most: 0,
        },
    ];
    println!("\n{:<38} {:>9} {:>9}", "", "found", "most");
    let mut above = 0;
    for line in &lines {
        let verdict = if line.found > line.most {
            above += 1;
            "  ABOVE"
        } else {
            ""
        };
        println!(
            "{:<38} {:>9} {:>9} {}{verdict}",
            line.what, line.found, line.most, line.unit
        );
    }
    for caller in panics.iter().chain(&allocators) {
        println!("  {caller}");
    }
    if above > 0 {
        return Err(format!("{above} of {} above their limit", lines.len()));
    }
    Ok(())
}

fn count(names: &[String]) -> u64 {
    names.len() as u64
}

/// Drives a run and reads the board's memory: deepest stack in bytes, longest call in instructions.
fn measure(image: &Image) -> Result<(u64, u64), String> {
    let settings = Settings::new(Board::L475).map_err(|error| error.to_string())?;
    let mut emulator = Emulator::start(&settings).map_err(|error| error.to_string())?;
    drive::drive(emulator.line()).map_err(|error| format!("the run in the emulator: {error}"))?;
    let address = |symbol| image.address(symbol).map_err(|error| error.to_string());
    let (low, high) = (address("_stack_end")?, address("_stack_start")?);
    let stack = emulator
        .memory(low, high - low)
        .map_err(|error| error.to_string())?;
    let words = stack.chunks_exact(4).map(|word| {
        word.iter()
            .rev()
            .fold(0, |sum, byte| sum << 8 | u32::from(*byte))
    });
    let counts = emulator
        .word(address("LONGEST_COUNTS")?)
        .map_err(|error| error.to_string())?;
    // The timer counts at the processor's nominal clock, the emulator gives each instruction a fixed time.
    let instructions =
        u64::from(counts) * 1_000_000_000 / u64::from(FAST_HZ) / u64::from(NS_PER_INSTRUCTION);
    Ok((high_water_bytes(words) as u64, instructions))
}
