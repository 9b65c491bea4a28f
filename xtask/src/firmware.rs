//! `cargo xtask firmware`: builds the firmware of a board, checked and named after it.

use crate::shell::{root, run};
use crate::toolchain::{TARGET, Toolchain};
use emulator::Board;
use std::path::PathBuf;
use std::process::Command;

/// Its own folder, so that the host's build and this one do not wait for each other.
const FOLDER: &str = "target/firmware";

/// Builds it and returns at once if nothing has changed.
pub fn firmware(board: Board) -> Result<(), String> {
    run(&mut command(board, "build")?)?;
    let built = root().join(format!("{FOLDER}/{TARGET}/firmware/firmware"));
    let image = board.image_path();
    // A copy, not a move: cargo would build again. Copying also says when it was last found to be up to date.
    std::fs::copy(&built, &image).map_err(|error| format!("{} -> {}: {error}", built.display(), image.display()))?;
    println!("{}", image.display());
    Ok(())
}

/// Builds the image that runs steps of the filter and nothing else, for [`Board::Mps2`].
pub fn filter_step() -> Result<PathBuf, String> {
    run(&mut of_the_filter("build")?)?;
    Ok(root().join(format!("{FOLDER}/{TARGET}/firmware/{FILTER_STEP}")))
}

/// clippy over what the host never compiles.
pub fn lint(board: Board) -> Result<(), String> {
    run(command(board, "clippy")?.args(["--", "-D", "warnings"]))
}

/// The same for the image of the filter.
pub fn lint_filter_step() -> Result<(), String> {
    run(of_the_filter("clippy")?.args(["--", "-D", "warnings"]))
}

const FILTER_STEP: &str = "filter-step";

fn of_the_filter(word: &str) -> Result<Command, String> {
    of_program(word, FILTER_STEP, Some(FILTER_STEP))
}

fn command(board: Board, word: &str) -> Result<Command, String> {
    of_program(word, "firmware", board.feature())
}

fn of_program(word: &str, program: &str, feature: Option<&str>) -> Result<Command, String> {
    let toolchain = Toolchain::find().ok_or_else(|| format!("no compiler for {TARGET}: run `cargo xtask setup`"))?;
    let mut cargo = toolchain.cargo(word);
    cargo.args(["--profile", "firmware", "-p", "rundown", "--bin", program]);
    cargo.args(["--target-dir", FOLDER]);
    if let Some(feature) = feature {
        cargo.args(["--features", feature]);
    }
    Ok(cargo)
}
