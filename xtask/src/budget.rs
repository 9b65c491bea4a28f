//! `cargo xtask budget`: what the firmware costs, against what it may cost.

mod calls;
mod filter;
mod stack;
mod thumb;

use crate::shell::{cargo, root, run, target};
use crate::{firmware, setup};
use calls::Graph;
use emulator::{Board, Image, NS_PER_INSTRUCTION};
use std::process::{Command, Stdio};

/// A line of the budget. The limit is what was measured when it was set (in the comment) and a tenth more, so that a
/// change has room and nothing gets much worse unseen; never above a goal that is reached. Of the flash it is the next
/// step to its goal. docs/firmware.md has what is measured today.
struct Limit {
    what: &'static str,
    unit: &'static str,
    most: u64,
    goal: u64,
}

/// Code, constants and first values of variables: 125 788 with Debian's Rust 1.96.0-1~deb12u2.
const FLASH: Limit = Limit { what: "flash: code, constants, first values", unit: "B", most: 126_300, goal: 96 << 10 };
/// 81 472; the goal is SRAM1 of the reference board.
const RAM: Limit = Limit { what: "RAM: variables", unit: "B", most: 89_800, goal: 96 << 10 };
/// 8144; the goal is a quarter of SRAM2.
const STACK: Limit = Limit { what: "stack: most, from the code", unit: "B", most: 8 << 10, goal: 8 << 10 };
/// At most 7532.
const PAINTED: Limit = Limit { what: "stack: deepest in any run, painted", most: 8170, ..STACK };
/// One call of the application, without the time of the line, 317 500: at 80 MHz and one instruction a cycle 1.9 ms for
/// the goal.
const CALL: Limit =
    Limit { what: "longest call of the application", unit: "instructions", most: 349_000, goal: 150_000 };
/// The same with seven effects, 308 437, in three runs of the measured mode with eight, 356 312, and in a day of hops
/// between stops, 261 812.
const CALL_EFFECTS: Limit = Limit { what: "the same, seven effects and targets", most: 339_200, goal: 400_000, ..CALL };
const CALL_MEASURED: Limit = Limit { what: "the same in the measured mode", most: 391_900, goal: 400_000, ..CALL };
const CALL_DAY: Limit = Limit { what: "the same, a day with stops", most: 287_900, goal: 400_000, ..CALL };
/// A step of the paper's model, f64 in software: 11 sigma points, two readings. 19 155.
const FILTER_CALL: Limit = Limit { what: "filter step alone", unit: "instructions", most: 21_000, goal: 30_000 };
/// As the learning modes have it: six coefficients, four sub-steps, one update. 77 400.
const TICK_FILTER: Limit = Limit { what: "filter of a tick", unit: "instructions", most: 80_000, goal: 80_000 };
/// 984 and 7880.
const FILTER_STACK: Limit = Limit { what: "filter step alone: stack", unit: "B", most: 1 << 10, goal: 1 << 10 };
const FILTER_CODE: Limit = Limit { what: "filter step alone: code", unit: "B", most: 8800, goal: 10_000 };
/// Of 800 000 sums, differences, products and quotients, and as many comparisons and conversions
/// (`src/board/soft_doubles.rs`).
const DOUBLES: Limit = Limit { what: "doubles with a wrong bit", unit: "", most: 0, goal: 0 };
/// Of 2560 copies, moves and fills (`src/board/memory.rs`).
const COPIES: Limit = Limit { what: "copies with a wrong byte", ..DOUBLES };
const PANICS: Limit = Limit { what: "places that may panic", unit: "", most: 0, goal: 0 };
const ALLOCATORS: Limit = Limit { what: "allocator symbols", unit: "", most: 0, goal: 0 };

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
    let (run, line_bytes_per_tick) = measure()?;
    let [effects, measured, day] = plays()?;
    let graph = Graph::read(&image);
    let panics = graph.to_panics();
    let allocators = calls::allocators(&image);
    let bound = stack::bound(&graph)?;
    let step = filter::measure()?;
    let lines = [
        (FLASH, image.flash),
        (RAM, image.ram),
        (STACK, bound.bytes),
        (PAINTED, [&run, &effects, &measured, &day].map(|run| run.stack_bytes).into_iter().max().unwrap_or_default()),
        (CALL, run.instructions),
        (CALL_EFFECTS, effects.instructions),
        (CALL_MEASURED, measured.instructions),
        (CALL_DAY, day.instructions),
        (FILTER_CALL, step.instructions),
        (TICK_FILTER, step.tick_instructions),
        (FILTER_STACK, step.stack_bytes),
        (FILTER_CODE, step.code_bytes),
        (DOUBLES, step.wrong_doubles),
        (COPIES, step.wrong_copies),
        (PANICS, count(&panics)),
        (ALLOCATORS, count(&allocators)),
    ];
    println!("\n{} bytes on the line a tick", line_bytes_per_tick);
    println!("\n{:<38} {:>9} {:>9} {:>9}", "", "found", "most", "goal");
    let mut above = 0;
    for (limit, found) in &lines {
        let verdict = if *found > limit.most {
            above += 1;
            "  ABOVE"
        } else if *found > limit.goal {
            "  goal missed"
        } else {
            ""
        };
        println!("{:<38} {found:>9} {:>9} {:>9} {}{verdict}", limit.what, limit.most, limit.goal, limit.unit);
    }
    for caller in panics.iter().chain(&allocators) {
        println!("  {caller}");
    }
    let recursive = bound.parts.iter().flat_map(|(_, part)| &part.recursive);
    for function in recursive {
        above += 1;
        println!("  may call itself, so that its stack has no bound: {function}");
    }
    if above > 0 {
        return Err(format!("{above} above their limit"));
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
}

/// Plays the reference run to the firmware and to the host; what the firmware says of itself is in the last line.
fn measure() -> Result<(Run, u64), String> {
    let said = played(example("emulate")?.arg("data/reference/run01.csv").args(crate::REFERENCE))?;
    Ok((Run::said(&said)?, value(&said, "line_bytes_per_tick=")?))
}

/// Plays what asks more of the board, in the order of the lines.
fn plays() -> Result<[Run; 3], String> {
    let said = played(&mut example("plays")?)?;
    let run = |name: &str| {
        let line = said.lines().find(|line| line.starts_with(name));
        Run::said(line.ok_or_else(|| format!("expected {name} in: {said}"))?)
    };
    Ok([run("seven_effects")?, run("measured")?, run("day")?])
}

/// An example of `host-tests`, built as `cargo xtask test --pages` has built it: in a run of CI nothing is left to do.
fn example(name: &str) -> Result<Command, String> {
    let built = ["build", "--quiet", "--workspace", "--features", "browser-tests/browser", "--example", name];
    run(cargo().args(built))?;
    Ok(Command::new(target().join("debug/examples").join(name)))
}

/// What a program with the emulator says.
fn played(program: &mut Command) -> Result<String, String> {
    let output = program.current_dir(root()).stderr(Stdio::inherit()).output().map_err(|error| error.to_string())?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() { Ok(said) } else { Err(format!("the run in the emulator failed: {said}")) }
}

fn value(said: &str, name: &str) -> Result<u64, String> {
    let word = said.split_whitespace().find_map(|word| word.strip_prefix(name));
    word.and_then(|word| word.parse::<u64>().ok()).ok_or_else(|| format!("expected {name} in: {said}"))
}

impl Run {
    fn said(said: &str) -> Result<Self, String> {
        Ok(Self {
            stack_bytes: value(said, "stack_bytes=")?,
            // The emulator gives each instruction a fixed time.
            instructions: value(said, "longest_us=")? * 1000 / u64::from(NS_PER_INSTRUCTION),
        })
    }
}
