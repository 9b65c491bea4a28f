//! Set-up and checks of the workspace: `cargo xtask test`, `cargo xtask ci`.
//!
//! Each task is a list of commands. A command is printed before it runs, so that it can be repeated by hand; the first one that fails ends the task.
#![forbid(unsafe_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const HELP: &str = "\
Usage: cargo xtask TASK

Tasks:
  test  the whole test run: unit, integration and documentation tests of every package
  ci    everything a change must pass: format, clippy, documentation, licences, test, demo (.ci/run)

Exit codes: 0 passed, 1 a command failed, 2 no such task";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match arguments.as_slice() {
        ["test"] => test(),
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

/// Documentation tests are part of `cargo test` as long as it is not told which targets to take.
fn test() -> Result<(), String> {
    run(cargo().args(["test", "--workspace"]))
}

/// The cargo that runs this task.
fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Prints a command and runs it in the root of the workspace.
fn run(command: &mut Command) -> Result<(), String> {
    let line = shown(command);
    println!("$ {line}");
    match command.current_dir(root()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("`{line}` ended with {status}")),
        Err(error) => Err(format!("`{line}` could not be started: {error}")),
    }
}

/// The command as a person would type it.
fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program())
        .file_name()
        .unwrap_or(command.get_program());
    let words = std::iter::once(program).chain(command.get_args());
    words
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_shown_as_typed() {
        let mut command = Command::new("/usr/bin/cargo");
        assert_eq!(
            shown(command.args(["test", "--workspace"])),
            "cargo test --workspace"
        );
    }

    #[test]
    fn a_command_that_cannot_be_started_is_named() {
        let error = run(&mut Command::new("no-such-command")).unwrap_err();
        assert!(
            error.starts_with("`no-such-command` could not be started: "),
            "{error}"
        );
    }
}
