//! `fuzz`: every fuzz target for a while.
//!
//! Any toolchain that builds the workspace will do: the coverage counters that libFuzzer follows are a pass of the
//! stable compiler. `cargo fuzz` on nightly Rust works in `host-tests/fuzz/` as well and adds the address sanitizer, of
//! which the code without `unsafe` has little need.

use crate::shell::{ask, cargo, root, run, shown};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};

/// The programs of `host-tests/fuzz/Cargo.toml`.
const TARGETS: [&str; 4] = ["serial_decoder", "isotp_receiver", "uplink", "whole_task"];

/// As many as a small machine has processors.
const AT_ONCE: usize = 2;

/// So many lines tell what broke a target.
const FINDING_LINES: usize = 40;

/// Coverage counters for libFuzzer, and the checks of a debug build (overflow, assertions) in optimised code.
const FLAGS: [&str; 8] = [
    "--cfg fuzzing",
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "-Cdebug-assertions",
    "-Ccodegen-units=1",
];

/// Each target for so many seconds; what breaks one is left in `host-tests/fuzz/artifacts`.
/// With a seed the same inputs come each time, as far as the time allows.
pub fn fuzz(seconds: &str, seed: Option<&str>) -> Result<(), String> {
    let seconds: u32 = seconds.parse().map_err(|_| format!("expected a number of seconds, found `{seconds}`"))?;
    let number = |text: &str| text.parse().map_err(|_| format!("expected a seed, found `{text}`"));
    let seed: Option<u32> = seed.map(number).transpose()?;
    // Zero would be for ever.
    if seconds == 0 {
        return Err("expected at least one second, found 0".into());
    }
    let host = ask("rustc", &["--print", "host-tuple"])
        .ok_or("`rustc --print host-tuple` says nothing: is Rust installed?")?;
    build(&host)?;
    let programs = root().join("host-tests/fuzz/target").join(&host).join("release");
    for targets in TARGETS.chunks(AT_ONCE) {
        run_together(&programs, targets, seconds, seed)?;
    }
    Ok(())
}

/// All targets at once: they differ in little but their last file.
fn build(host: &str) -> Result<(), String> {
    let mut build = cargo();
    build.args(["build", "--release", "--bins", "--locked"]);
    build.args(["--manifest-path", "host-tests/fuzz/Cargo.toml"]);
    // For a named target the flags do not reach build scripts and macros.
    build.args(["--target", host, "--target-dir", "host-tests/fuzz/target"]);
    build.env("RUSTFLAGS", FLAGS.join(" "));
    run(&mut build).map_err(|error| {
        format!("{error}\nfuzzing needs a C++ compiler for libFuzzer (Debian: apt-get install g++) and an up-to-date host-tests/fuzz/Cargo.lock (cargo metadata --manifest-path host-tests/fuzz/Cargo.toml)")
    })
}

/// Waits for all of them, also where one has failed: the others' findings count too.
fn run_together(programs: &Path, targets: &[&str], seconds: u32, seed: Option<u32>) -> Result<(), String> {
    let mut running = Vec::new();
    for target in targets {
        running.push((target, start(programs, target, seconds, seed)?));
    }
    let mut failed = Vec::new();
    for (target, mut child) in running {
        let ended = child.wait();
        let said = std::fs::read(log_of(target)).unwrap_or_default();
        let said = String::from_utf8_lossy(&said);
        let counts = said.lines().filter_map(|line| line.strip_prefix("stat::"));
        println!("{target}: {}", counts.map(|count| count.replace(' ', "")).collect::<Vec<_>>().join(", "));
        if !ended.is_ok_and(|status| status.success()) {
            println!("{}", finding(&said));
            failed
                .push(format!("{target} failed; the input that breaks it lies in host-tests/fuzz/artifacts/{target}"));
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n")) }
}

/// What a target says goes here: thousands of lines, in which a finding would be lost.
fn log_of(target: &str) -> PathBuf {
    root().join("host-tests/fuzz/artifacts").join(format!("{target}.log"))
}

/// From the panic on, without the news of new inputs; the last lines where nothing panicked.
fn finding(said: &str) -> String {
    let lines: Vec<&str> = said.lines().filter(|line| !line.starts_with('#')).collect();
    let last = lines.len().saturating_sub(FINDING_LINES);
    let first = lines.iter().position(|line| line.contains("panicked at")).unwrap_or(last);
    lines[first..].iter().take(FINDING_LINES).copied().collect::<Vec<_>>().join("\n")
}

fn start(programs: &Path, target: &str, seconds: u32, seed: Option<u32>) -> Result<Child, String> {
    // What earlier runs found would lead a sequence of inputs elsewhere.
    let corpus = match seed {
        Some(seed) => format!("host-tests/fuzz/target/corpus-{seed}/{target}"),
        None => format!("host-tests/fuzz/corpus/{target}"),
    };
    if seed.is_some() && root().join(&corpus).exists() {
        std::fs::remove_dir_all(root().join(&corpus)).map_err(|error| format!("{corpus}: {error}"))?;
    }
    for folder in [&corpus, &format!("host-tests/fuzz/artifacts/{target}")] {
        std::fs::create_dir_all(root().join(folder)).map_err(|error| format!("{folder}: {error}"))?;
    }
    let log = log_of(target);
    let log = File::create(&log).map_err(|error| format!("{}: {error}", log.display()))?;
    let mut command = Command::new(programs.join(target));
    // All lengths from the start: by default a short run of a slow target stays with inputs of a few bytes.
    command.args(["-max_len=4096", "-len_control=0", "-print_final_stats=1"]);
    command.arg(format!("-max_total_time={seconds}"));
    command.args(seed.map(|seed| format!("-seed={seed}")));
    command.arg(format!("-artifact_prefix=host-tests/fuzz/artifacts/{target}/"));
    command.arg(corpus);
    println!("$ {} 2> host-tests/fuzz/artifacts/{target}.log", shown(&command));
    let started = command.current_dir(root()).stderr(log).spawn();
    started.map_err(|error| format!("{target} could not be started: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_is_run() {
        let mut files: Vec<String> = std::fs::read_dir(root().join("host-tests/fuzz/fuzz_targets"))
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
    fn a_finding_is_reported_without_the_news_around_it() {
        assert_eq!(
            finding("INFO: seed\n#2 NEW\nthread panicked at src\n#3 NEW\nnot a number\n"),
            "thread panicked at src\nnot a number"
        );
        assert_eq!(finding("#2 NEW\nout of memory"), "out of memory");
    }

    #[test]
    fn a_time_that_is_none_is_named() {
        assert_eq!(fuzz("soon", None), Err("expected a number of seconds, found `soon`".into()));
        assert!(fuzz("0", None).is_err());
    }
}
