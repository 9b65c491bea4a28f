//! Hands the memory layout of the chosen board to the linker, as the `board.x` that `memory.x` includes, and the commit
//! to the firmware. Does nothing for the host.

use std::path::Path;
use std::process::Command;
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
    println!("cargo::rustc-env=RUNDOWN_COMMIT={}", commit().as_deref().unwrap_or("unknown"));
    Ok(())
}

/// What the firmware is made of.
const SOURCES: [&str; 8] =
    [".cargo/config.toml", "build.rs", "Cargo.lock", "Cargo.toml", "memory.x", "src", "wire/Cargo.toml", "wire/src"];

/// First eight digits of the commit, with a `+` where sources differ from it; none outside of git. The same commit
/// gives the same, at any time and place.
fn commit() -> Option<String> {
    // Another commit, a branch that moves, a changed source: asked again.
    let branch = git(&["symbolic-ref", "-q", "HEAD"]);
    for name in ["HEAD", "index", "packed-refs"].into_iter().chain(branch.as_deref()) {
        if let Some(path) = git(&["rev-parse", "--git-path", name]).filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    SOURCES
        .into_iter()
        .filter(|path| Path::new(path).exists())
        .for_each(|path| println!("cargo::rerun-if-changed={path}"));
    // A folder within somebody else's repository is outside of git.
    git(&["ls-files", "--error-unmatch", "build.rs"])?;
    let commit = git(&["rev-parse", "--short=8", "HEAD"])?;
    let digits = commit.get(..8)?;
    let arguments = [&["--no-optional-locks", "status", "--porcelain", "--"], &SOURCES[..]].concat();
    let changed = git(&arguments).is_none_or(|lines| !lines.is_empty());
    Some(format!("{digits}{}", if changed { "+" } else { "" }))
}

/// What git prints, if it succeeds.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
