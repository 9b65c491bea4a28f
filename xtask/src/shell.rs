//! Commands: printed before they run, so that they can be repeated by hand.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Root of the workspace.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

/// The cargo that runs this task.
pub fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Prints a command and runs it in the root of the workspace.
pub fn run(command: &mut Command) -> Result<(), String> {
    let line = shown(command);
    println!("$ {line}");
    match command.current_dir(root()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("`{line}` ended with {status}")),
        Err(error) => Err(format!("`{line}` could not be started: {error}")),
    }
}

/// Runs a command while another one runs: what it prints goes to a file, and is printed whole at its end.
pub fn run_aside(command: &mut Command) -> Result<(), String> {
    let line = shown(command);
    let path = target().join("ignored-tests.log");
    println!("$ {line} > {}", path.display());
    let failed = |error: std::io::Error| format!("`{line}` could not be started: {error}");
    let log = std::fs::File::create(&path).map_err(failed)?;
    let command = command.current_dir(root()).stdout(log.try_clone().map_err(failed)?).stderr(log);
    let status = command.status().map_err(failed)?;
    let printed = std::fs::read(&path).map_err(failed)?;
    println!("\n$ {line}\n{}", String::from_utf8_lossy(&printed));
    if status.success() { Ok(()) } else { Err(format!("`{line}` ended with {status}")) }
}

/// What a command prints, if it succeeds. Says nothing itself.
pub fn ask(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    output.status.success().then_some(text)
}

/// The command as a person would type it.
pub fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

/// The folder of what is built.
pub fn target() -> PathBuf {
    // A relative folder is one of the workspace: commands run there.
    root().join(std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| "target".into(), PathBuf::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_shown_as_typed() {
        let mut command = Command::new("/usr/bin/cargo");
        assert_eq!(shown(command.args(["test", "--workspace"])), "cargo test --workspace");
    }

    #[test]
    fn a_command_that_cannot_be_started_is_named() {
        let error = run(&mut Command::new("no-such-command")).unwrap_err();
        assert!(error.starts_with("`no-such-command` could not be started: "), "{error}");
    }

    #[test]
    fn a_failing_question_has_no_answer() {
        assert_eq!(ask("cargo", &["no-such-subcommand"]), None);
        assert_eq!(ask("no-such-command", &[]), None);
    }
}
