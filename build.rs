//! Hands the memory layout of the chosen board to the linker, as the `board.x` that `memory.x` includes. Does nothing for the host.

use std::path::Path;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/board");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return Ok(());
    }
    let chosen = |feature| env::var_os(feature).is_some();
    let layout = if chosen("CARGO_FEATURE_MPS2") {
        "src/board/mps2/board.x"
    } else if chosen("CARGO_FEATURE_EMULATOR") {
        "src/board/l475/emulated.x"
    } else {
        "src/board/l475/board.x"
    };
    let out = env::var("OUT_DIR").map_err(io::Error::other)?;
    fs::copy(layout, Path::new(&out).join("board.x"))?;
    fs::copy("memory.x", Path::new(&out).join("memory.x"))?;
    // Each board has its table of interrupts itself; the start-up code's layout includes names of a crate's.
    fs::write(Path::new(&out).join("device.x"), "")?;
    println!("cargo::rustc-link-search={out}");
    Ok(())
}
