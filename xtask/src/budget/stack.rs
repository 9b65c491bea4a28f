//! The most stack that the firmware can take: the deepest path of the start, or of the tasks one within another.
//!
//! RTIC's tasks of one priority never interrupt each other, so of each priority the deepest counts once, and with it
//! the frame that the processor saves for an interrupt.

use super::calls::{Deepest, Graph};

/// Registers that the processor saves for an interrupt, with those for floating point and the alignment.
const EXCEPTION_FRAME: u64 = 4 * 26 + 4;

/// Handlers by priority, see `src/bin/firmware/tasks.rs`.
const TASKS: [&[&str]; 3] = [&["TSC", "COMP"], &["SysTick"], &["USART1"]];

/// The deepest stack of the firmware.
pub struct Bound {
    /// Bytes.
    pub bytes: u64,
    /// Its parts, each with its path.
    pub parts: Vec<(String, Deepest)>,
}

/// Sums it up.
pub fn bound(graph: &Graph) -> Result<Bound, String> {
    let deepest = |name: &str| {
        graph
            .deepest(name)
            .map(|found| (name.to_owned(), found))
            .ok_or_else(|| format!("the image has no function {name}"))
    };
    let start = deepest("Reset")?;
    // What is left of the start when the tasks run: the frames of the functions that sleep for ever.
    let asleep: u64 = graph
        .functions()
        .filter(|function| ["Reset", "main"].contains(&function.name.as_str()))
        .map(|function| function.frame)
        .sum();
    let mut tasks = Vec::new();
    for names in TASKS {
        let of_priority = names.iter().map(|name| deepest(name));
        let of_priority: Vec<_> = of_priority.collect::<Result<_, _>>()?;
        tasks.extend(of_priority.into_iter().max_by_key(|(_, found)| found.bytes));
    }
    let running = asleep + tasks.iter().map(|(_, found)| found.bytes + EXCEPTION_FRAME).sum::<u64>();
    let bytes = running.max(start.1.bytes);
    tasks.push(start);
    Ok(Bound { bytes, parts: tasks })
}

/// Where the stack goes: `cargo xtask stack`.
pub fn print(graph: &Graph, bound: &Bound) {
    println!("at most {} bytes of stack", bound.bytes);
    for (name, found) in &bound.parts {
        println!("\n{name}: {} bytes", found.bytes);
        for (function, frame) in &found.path {
            println!("{frame:>7}  {function}");
        }
        for function in &found.recursive {
            println!("  may call itself: {function}");
        }
        for function in &found.unknown {
            println!("  calls through a register: {function}");
        }
    }
    let mut largest: Vec<_> = graph.functions().collect();
    largest.sort_by_key(|function| std::cmp::Reverse(function.frame));
    println!("\nlargest frames");
    for function in largest.iter().take(25) {
        println!("{:>7}  {}", function.frame, function.name);
    }
}
