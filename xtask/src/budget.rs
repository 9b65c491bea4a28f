//! `cargo xtask budget`: what the firmware costs, against what it may cost.

mod calls;
mod stack;
mod thumb;

use crate::shell::root;
use crate::{firmware, setup};
use calls::Graph;
use emulator::{Board, Image, NS_PER_INSTRUCTION};
use std::process::Stdio;

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

/// Where the stack of the firmware goes.
pub fn stack() -> Result<(), String> {
    firmware::firmware(Board::L475)?;
    let image = Image::read(&Board::L475.image_path()).map_err(|error| error.to_string())?;
    let graph = Graph::read(&image);
    stack::print(&graph, &stack::bound(&graph)?);
    Ok(())
}

/// Measures, prints, and fails above a limit.
pub fn budget() -> Result<(), String> {
    setup::setup()?;
    firmware::firmware(Board::L475)?;
    let image = Image::read(&Board::L475.image_path()).map_err(|error| error.to_string())?;
    firmware::firmware(Board::L475Emulated)?;
    let run = measure()?;
    let graph = Graph::read(&image);
    let panics = graph.to_panics();
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
            found: run.stack_bytes,
            most: MOST_STACK,
        },
        Line {
            what: "longest call of the application",
            unit: "instructions",
            found: run.instructions,
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
    println!("\n{} bytes on the line a tick", run.line_bytes_per_tick);
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

/// What a run in the emulator costs.
struct Run {
    stack_bytes: u64,
    instructions: u64,
    line_bytes_per_tick: u64,
}

/// Plays the reference run to the firmware and to the host; what the firmware says of itself is in the last line.
fn measure() -> Result<Run, String> {
    let mut emulate = crate::emulate_command("data/reference/run01.csv", crate::REFERENCE, None);
    let output = emulate
        .current_dir(root())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| error.to_string())?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    if !output.status.success() {
        return Err(format!("the run in the emulator failed: {said}"));
    }
    let value = |name: &str| {
        let word = said
            .split_whitespace()
            .find_map(|word| word.strip_prefix(name));
        word.and_then(|word| word.parse::<u64>().ok())
            .ok_or_else(|| format!("expected {name} in: {said}"))
    };
    Ok(Run {
        stack_bytes: value("stack_bytes=")?,
        // The emulator gives each instruction a fixed time.
        instructions: value("longest_us=")? * 1000 / u64::from(NS_PER_INSTRUCTION),
        line_bytes_per_tick: value("line_bytes_per_tick=")?,
    })
}
