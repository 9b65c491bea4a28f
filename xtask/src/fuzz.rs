//! `fuzz`: every fuzz target for a while, by cargo-fuzz on nightly Rust.

use crate::shell::{ask, run};
use std::process::Command;

/// The programs of `fuzz/Cargo.toml`.
const TARGETS: [&str; 4] = ["serial_decoder", "isotp_receiver", "uplink", "whole_task"];

/// Each target for so many seconds; what breaks one is left in `fuzz/artifacts`.
pub fn fuzz(seconds: &str) -> Result<(), String> {
    let seconds: u32 = seconds
        .parse()
        .map_err(|_| format!("expected a number of seconds, found `{seconds}`"))?;
    // Zero would be for ever.
    if seconds == 0 {
        return Err("expected at least one second, found 0".into());
    }
    if ask("rustup", &["run", "nightly", "rustc", "--version"]).is_none() {
        return Err(
            "fuzzing needs nightly Rust: rustup toolchain install nightly --profile minimal".into(),
        );
    }
    if ask("cargo-fuzz", &["--version"]).is_none() {
        return Err(
            "fuzzing needs cargo-fuzz, which is not installed: cargo install cargo-fuzz --locked"
                .into(),
        );
    }
    for target in TARGETS {
        // Through rustup, since the cargo that runs this task is of another toolchain.
        let mut command = Command::new("rustup");
        command.args(["run", "nightly", "cargo", "fuzz", "run", target, "--"]);
        // All lengths from the start: by default a short run of a slow target stays with inputs of a few bytes.
        let limit = format!("-max_total_time={seconds}");
        run(command.args([&limit, "-max_len=4096", "-len_control=0"]))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell::root;

    #[test]
    fn every_target_is_run() {
        let mut files: Vec<String> = std::fs::read_dir(root().join("fuzz/fuzz_targets"))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
            .collect();
        files.sort();
        let mut targets = TARGETS;
        targets.sort();
        assert_eq!(files, targets);
    }

    #[test]
    fn a_time_that_is_none_is_named() {
        assert_eq!(
            fuzz("soon"),
            Err("expected a number of seconds, found `soon`".into())
        );
        assert!(fuzz("0").is_err());
    }
}
