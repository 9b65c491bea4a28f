//! Set-up and checks of the workspace: `cargo xtask help`.
//!
//! Each task is a list of commands. A command is printed before it runs, so that it can be repeated by hand; the first
//! one that fails ends the task.
#![forbid(unsafe_code)]

mod budget;
mod firmware;
mod fuzz;
mod mutants;
mod python;
mod run_firmware;
mod setup;
mod shell;
mod toolchain;

use emulator::Board;
use shell::{cargo, run, run_aside};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const HELP: &str = "\
Usage: cargo xtask TASK

Tasks:
  setup                         finds or installs what the firmware needs: Rust for thumbv7em-none-eabihf, QEMU >= 10
  firmware [--board NAME]       builds the firmware: l475, l475-can, l475-emulated, mps2 (default: all)
  firmware-lint                 clippy over the firmware of all boards
  run [--key KEY.bin]           starts the B-L475E-IOT01A in the emulator; its serial line is a TCP port of this machine
  emulate RUN.csv [T.toml K.toml] [FRAMES.bin]
                                plays a log to the firmware in the emulator and to the host, in lockstep: the same bytes, or the first tick that
                                differs (default: train and track of data/reference)
  budget                        flash, RAM, stack and instructions of the firmware against their limits
  stack                         the most stack that the firmware can take, path by path, and the largest frames
  test [--pages]                the whole test run: set-up, firmware, unit, integration and documentation tests of every package; with
                                --pages what `browser` does, too, without building it all again
  browser                       the pages of `rundown` in Chromium, which is installed if it is missing; pictures in target/browser
  python                        the Python module: builds the wheel, installs it into a virtual environment in target/python, runs its tests;
                                needs Python >= 3.9
  tools                         SUMO and ALTRIOS read what `rundown export` writes; installs them into a virtual environment in
                                target/tools (about 1.5 GB); needs Python >= 3.11
  fleets [--runs N]             DuckDB, Ray Data and Spark replay a simulated fleet (default: 2010 runs), each to the same bits as the command;
                                installs them into a virtual environment in target/fleets (about 1.5 GB); needs Python >= 3.11 and Java 17
  fuzz [--seconds N] [--seed N] every fuzz target for so long (default: 60), two at a time; other inputs each time
                                without a seed; needs a C++ compiler
  mutants MODULE [K/N]          changes the code of a module line by line, and says which changes its tests do not notice: plausibility,
                                store, auth, task, link; all of them take 10 to 60 minutes a module, K/N each N-th from the K-th (0/4);
                                needs cargo-mutants
  ci                            everything a change must pass: format, clippy, documentation, licences, test, demo (.ci/run)

Exit codes: 0 passed, 1 a command failed, 2 no such task";

/// The lines of the help that are about one task.
fn help_of(task: &str) -> Option<String> {
    let is_entry = |line: &str| line.strip_prefix("  ").is_some_and(|rest| !rest.starts_with(' '));
    let mut lines = HELP.lines().skip_while(|line| !is_entry(line) || line.split_whitespace().next() != Some(task));
    let first = lines.next()?;
    let more = lines.take_while(|line| line.starts_with("   "));
    Some(std::iter::once(first).chain(more).collect::<Vec<_>>().join("\n"))
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    // Before anything is built.
    if let [task, rest @ ..] = arguments.as_slice()
        && rest.iter().any(|word| ["--help", "-h"].contains(word))
        && let Some(help) = help_of(task)
    {
        println!("{help}");
        return ExitCode::SUCCESS;
    }
    let done = match arguments.as_slice() {
        ["setup"] => setup::setup(),
        ["firmware"] => all(firmware::firmware),
        ["firmware", "--board", name] => with_board(name, firmware::firmware),
        ["firmware-lint"] => all(firmware::lint).and_then(|()| firmware::lint_filter_step()),
        ["run"] => run_firmware::run_firmware(Board::L475Emulated, None),
        ["run", "--key", key] => run_firmware::run_firmware(Board::L475Emulated, Some(*key)),
        ["emulate", arguments @ ..] => emulate(arguments),
        ["budget"] => budget::budget(),
        ["stack"] => budget::stack(),
        ["test"] => test(&[]),
        ["test", "--pages"] => setup::browser().and_then(|()| test(&["--features", "browser-tests/browser"])),
        ["browser"] => browser(),
        ["python"] => python::python(),
        ["tools"] => python::tools(),
        ["fleets"] => python::fleets("2010"),
        ["fleets", "--runs", runs] => python::fleets(runs),
        ["fuzz"] => fuzz::fuzz("60", None),
        ["fuzz", "--seconds", seconds] => fuzz::fuzz(seconds, None),
        ["fuzz", "--seconds", seconds, "--seed", seed] => fuzz::fuzz(seconds, Some(seed)),
        ["mutants", module] => mutants::mutants(module, "0/1"),
        ["mutants", module, share] => mutants::mutants(module, share),
        ["ci"] => run(Command::new("bash").arg(".ci/run")),
        [] | ["help" | "--help" | "-h"] => {
            println!("{HELP}");
            return ExitCode::SUCCESS;
        }
        other => {
            eprintln!("error: no task `{}`\n\n{HELP}", other.join(" "));
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn emulate(arguments: &[&str]) -> Result<(), String> {
    let (run_log, rest) = arguments.split_first().ok_or("expected RUN.csv [T.toml K.toml] [FRAMES.bin]")?;
    let (described, frames) = match rest {
        [] => (REFERENCE, None),
        [frames] => (REFERENCE, Some(*frames)),
        [train, track] => ([*train, *track], None),
        [train, track, frames] => ([*train, *track], Some(*frames)),
        _ => return Err("expected RUN.csv [T.toml K.toml] [FRAMES.bin]".to_owned()),
    };
    // The emulator takes minutes to be built: what it cannot read is said before.
    for path in [*run_log].into_iter().chain(described) {
        if !shell::root().join(path).is_file() {
            return Err(format!("{path}: expected a file, found none"));
        }
    }
    setup::setup()?;
    firmware::firmware(Board::L475Emulated)?;
    run(&mut emulate_command(run_log, described, frames))
}

/// Train and track that a log is taken to be of when none are named.
const REFERENCE: [&str; 2] = ["data/reference/train.toml", "data/reference/track.toml"];

fn emulate_command(run_log: &str, described: [&str; 2], frames: Option<&str>) -> Command {
    let mut command = cargo();
    command
        .args(["run", "--release", "-p", "host-tests"])
        .args(["--example", "emulate", "--", run_log])
        .args(described)
        .args(frames);
    command
}

fn all(task: fn(Board) -> Result<(), String>) -> Result<(), String> {
    Board::ALL.into_iter().try_for_each(task)
}

fn with_board(name: &str, task: fn(Board) -> Result<(), String>) -> Result<(), String> {
    match Board::named(name) {
        Some(board) => task(board),
        None => Err(format!("no board `{name}`: there are l475, l475-can, l475-emulated and mps2")),
    }
}

/// Tests of what plain `cargo test` does not bring. They are ignored there, by attributes that say what they need, and
/// must pass here.
const WITH_EMULATOR: [&str; 5] = ["falls", "own_logs", "soak", "on_target", "on_target_power"];
const WITH_PEERS: &str = "peers";

/// Data of others, which are no part of the project: the variable that names their folder, where they are looked for
/// without it, what must be in it, the test that reads them. A train that somebody described for their logs is looked
/// for in a folder that is named only.
const DATA: [[&str; 4]; 3] = [
    ["RUNDOWN_LOGS", "../shared/data/recorded-gpx", "index.csv", "logs"],
    ["RUNDOWN_LOGS", "", "train.toml", "study"],
    ["RUNDOWN_TRACKS", "../shared/data/tracks", "", "truth"],
];

/// Documentation tests are part of `cargo test` as long as no targets are named. Both runs have the same features, or
/// the second one would build all again.
fn test(features: &[&str]) -> Result<(), String> {
    setup::setup()?;
    all(firmware::firmware)?;
    let tests = || {
        let mut tests = cargo();
        tests.args(["test", "--workspace", "--no-fail-fast"]).args(features);
        tests
    };
    let mut more = tests();
    more.args(WITH_EMULATOR.iter().flat_map(|test| ["--test", test]));
    match setup::peers() {
        Ok(()) => drop(more.args(["--test", WITH_PEERS])),
        Err(reason) => {
            println!("left out: the CAN link against python-can and can-isotp, which are not there ({reason})")
        }
    }
    if Path::new("/sys/class/net/vcan0").exists() {
        more.arg("--lib");
    } else {
        println!("left out: AF_CAN, which takes an interface vcan0");
    }
    for [variable, usual, must_be_there, test] in DATA {
        let folder = std::env::var_os(variable).map_or_else(|| shell::root().join(usual), PathBuf::from);
        if folder.join(must_be_there).exists() {
            more.args(["--test", test]).env(variable, folder);
        } else {
            println!("left out: what needs data of others; {variable} names their folder");
        }
    }
    more.args(["--", "--ignored"]);
    run(tests().arg("--no-run"))?;
    // Beside each other: either leaves a processor idle for minutes, in tests of a single thread.
    std::thread::scope(|scope| {
        let more = scope.spawn(|| run_aside(&mut more));
        run(&mut tests()).and(more.join().unwrap_or_else(|_| Err("the other tests were not run".to_owned())))
    })
}

/// The page's tests are built on demand only: the driver's client is many crates.
fn browser() -> Result<(), String> {
    setup::browser()?;
    run(cargo().args(["build", "-p", "sim-harness", "--bin", "rundown"]))?;
    run(cargo().args(["test", "-p", "browser-tests", "--features", "browser"]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_task_has_help_of_its_own() {
        let tasks = HELP.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
        let tasks: Vec<&str> = tasks.map(|line| line.split_whitespace().next().unwrap()).collect();
        assert_eq!(tasks.len(), 15, "{tasks:?}");
        for task in tasks {
            assert!(help_of(task).unwrap().trim_start().starts_with(task));
        }
        assert_eq!(help_of("emulate").unwrap().lines().count(), 3);
        assert_eq!(help_of("no-such-task"), None);
    }

    /// Else an ignored test would run nowhere.
    #[test]
    fn every_ignored_test_is_run() {
        let mut ignored = Vec::new();
        for folder in ["host-tests/tests", "host-tests/board/tests", "sim-harness/tests", "xtask/emulator/tests"] {
            for path in shell::root().join(folder).read_dir().unwrap().map(|entry| entry.unwrap().path()) {
                if path.is_file() && std::fs::read_to_string(&path).unwrap().contains("#[ignore") {
                    ignored.push(path.file_stem().unwrap().to_string_lossy().into_owned());
                }
            }
        }
        let mut run: Vec<&str> =
            WITH_EMULATOR.into_iter().chain([WITH_PEERS]).chain(DATA.map(|data| data[3])).collect();
        run.sort_unstable();
        ignored.sort_unstable();
        assert_eq!(ignored, run);
    }
}
