//! What one step of the paper's filter costs, and the filter of a tick: instructions in the emulator, stack and code
//! from the image. And whether the board's doubles and copies are right.

use super::calls::Graph;
use crate::firmware;
use emulator::{Board, Emulator, Image, NS_PER_INSTRUCTION, Settings, Sleep};
use std::io::Read;

/// The function of `src/bin/filter_step/image.rs` that is measured.
const STEP: &str = "filter_step::image::filter_step";
/// Of the processor of the mps2-an386, whose timer counts.
const NS_PER_COUNT: u64 = 40;

/// A step.
pub struct FilterStep {
    pub instructions: u64,
    /// Of the filter of a tick of the learning modes: four sub-steps and an update.
    pub tick_instructions: u64,
    pub stack_bytes: u64,
    /// With the functions that it calls, those for f64 among them.
    pub code_bytes: u64,
    /// Sums, products and quotients of doubles that are not those of `rundown::onboard::doubles`.
    pub wrong_doubles: u64,
    /// Copies and fills of memory that are not those of single bytes.
    pub wrong_copies: u64,
}

/// Builds the image, reads it, and lets it run.
pub fn measure() -> Result<FilterStep, String> {
    let path = firmware::filter_step()?;
    let image = Image::read(&path).map_err(|error| error.to_string())?;
    let graph = Graph::read(&image);
    let missing = || format!("{} has no function {STEP}", path.display());
    let deepest = graph.deepest(STEP).ok_or_else(missing)?;
    let code_bytes = graph.code_below(STEP).ok_or_else(missing)?;
    let settings =
        Settings { board: Board::Mps2, image: path, sleep: Sleep::AsHost, flash: None, preloads: Vec::new() };
    let mut emulator = Emulator::start(&settings).map_err(|error| error.to_string())?;
    let mut said = || {
        let mut count = [0; 4];
        let read = emulator.line().read_exact(&mut count);
        read.map_err(|error| format!("the step of the filter does not end: {error}"))?;
        Ok::<_, String>(u64::from(u32::from_le_bytes(count)))
    };
    let mut taken = || match said()? {
        0 => Err("a step of the filter failed in the emulator".to_owned()),
        counts => Ok(counts * NS_PER_COUNT / u64::from(NS_PER_INSTRUCTION)),
    };
    let (instructions, tick_instructions) = (taken()?, taken()?);
    let (wrong_doubles, wrong_copies) = (said()?, said()?);
    Ok(FilterStep {
        instructions,
        tick_instructions,
        stack_bytes: deepest.bytes,
        code_bytes,
        wrong_doubles,
        wrong_copies,
    })
}
