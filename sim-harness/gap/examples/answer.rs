//! The whole workflow in a few lines: a folder as `rundown simulate` writes it in, an output folder out.
//!
//! ```text
//! cargo run -p rundown-gap --example answer -- set gap
//! ```

use rundown_gap::config::GapConfig;
use rundown_gap::input::Input;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let (set, out) = arguments.next().zip(arguments.next()).ok_or("expected a set and an output folder")?;
    let answer = rundown_gap::run(Input::of_set(&set)?, GapConfig::default(), None, |step| eprintln!("{step}"))?;
    println!("{}", answer.found.verdict.name());
    for one in &answer.found.named {
        println!("{} {:?}, confidence {:.2}", one.effect.name(), one.intervals, one.confidence);
    }
    Ok(answer.write(&out, true)?)
}
