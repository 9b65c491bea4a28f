//! `cargo xtask python`: builds the Python module, installs it into a virtual environment of its own, and runs its
//! tests. A second run finds the environment and does not fill it again.

use crate::shell::{ask, cargo, root, run, target};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The oldest Python that the module runs on: `abi3-py39` in its `Cargo.toml`.
const OLDEST: (u32, u32) = (3, 9);
const PACKAGE: &str = "sim-harness/python";
/// Names of the interpreter, the first that is new enough is taken.
const NAMES: [&str; 2] = ["python3", "python"];

/// Tests of the tools that read exported trains, with requirements of their own.
const TOOLS: &str = "sim-harness/python/tools";

/// Engines that replay a fleet with the module, with requirements of their own.
const FLEETS: &str = "sim-harness/python/fleets";

/// `cargo xtask tools`: SUMO and ALTRIOS read what `rundown export` writes. Apart from the module's tests, for what
/// they install.
pub fn tools() -> Result<(), String> {
    let environment = Environment::at(target().join("tools").join("venv"), TOOLS)?;
    let rundown = command()?;
    let arguments = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "--durations=3", TOOLS];
    run(environment.command("python").args(arguments).env(COMMAND, rundown))
}

/// The variable that names the command `rundown` that the tests run. Where it is not set, the command is built.
const COMMAND: &str = "RUNDOWN_COMMAND";

fn command() -> Result<PathBuf, String> {
    if let Some(path) = std::env::var_os(COMMAND) {
        // A relative path is one of the workspace, as the tests run elsewhere.
        let path = root().join(path);
        return if path.is_file() { Ok(path) } else { Err(format!("{COMMAND}: no file {}", path.display())) };
    }
    run(cargo().args(["build", "-p", "sim-harness", "--bin", "rundown"]))?;
    Ok(target().join("debug").join(format!("rundown{}", std::env::consts::EXE_SUFFIX)))
}

pub fn python() -> Result<(), String> {
    let rundown = command()?;
    let environment = with_module("python", PACKAGE)?;
    let tests = format!("{PACKAGE}/tests");
    let arguments = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "--durations=3", &tests];
    run(environment.command("python").args(arguments).env(COMMAND, rundown))
}

/// `cargo xtask fleets`: DuckDB, Ray Data and Spark replay a fleet, each to the same bits as the command. Apart from
/// the module's tests, for what they install and what they take.
pub fn fleets(runs: &str) -> Result<(), String> {
    if ask("java", &["-version"]).is_none() {
        return Err("Spark: expected Java 17 as java, found none.\n\
                    On Debian and Ubuntu: `apt-get install openjdk-17-jre-headless`"
            .to_owned());
    }
    let rundown = command()?;
    let environment = with_module("fleets", FLEETS)?;
    let work = target().join("fleets").join("work");
    let mut fleets = environment.command("python");
    fleets.arg(format!("{FLEETS}/fleets.py")).args(["--runs", runs, "--work"]).arg(work);
    run(fleets.env(COMMAND, rundown))
}

/// A virtual environment in the target's `folder` with the module, built from the sources.
fn with_module(folder: &str, package: &str) -> Result<Environment, String> {
    let folder = target().join(folder);
    let environment = Environment::at(folder.join("venv"), package)?;
    let wheels = folder.join("wheels");
    // Left behind, an older wheel would be tested.
    match std::fs::remove_dir_all(&wheels) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(format!("{}: cannot be removed: {error}", wheels.display()));
        }
        _ => {}
    }
    // The profile of the other tests: what they have built is not built again, and bits do not depend on it.
    run(environment.command("maturin").args(["build", "--locked", "--profile", "dev", "--out"]).arg(&wheels))?;
    let wheel = only_wheel(&wheels)?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--force-reinstall"];
    run(environment.command("python").args(install).arg(wheel))?;
    Ok(environment)
}

/// A virtual environment with what the tests need.
struct Environment(PathBuf);

impl Environment {
    /// Makes it, unless it is there and has what is asked for.
    fn at(folder: PathBuf, package: &str) -> Result<Self, String> {
        let wanted = root().join(package).join("requirements.txt");
        let text = std::fs::read_to_string(&wanted).map_err(|error| format!("{}: {error}", wanted.display()))?;
        let environment = Self(folder);
        // Written last: what was interrupted is made again.
        let mark = environment.0.join("requirements.txt");
        if std::fs::read_to_string(&mark).is_ok_and(|found| found == text) && environment.version().is_some() {
            println!("environment  {} is there", environment.0.display());
            return Ok(environment);
        }
        let interpreter = interpreter()?;
        println!("environment  {} is made; its packages are 250 MB and more", environment.0.display());
        run(Command::new(interpreter).args(["-m", "venv", "--clear"]).arg(&environment.0))?;
        let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"];
        run(environment.command("python").args(install).arg(&wanted))?;
        std::fs::write(&mark, text).map_err(|error| format!("{}: {error}", mark.display()))?;
        Ok(environment)
    }

    fn program(&self, name: &str) -> PathBuf {
        let scripts = if cfg!(windows) { "Scripts" } else { "bin" };
        self.0.join(scripts).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    }

    fn command(&self, name: &str) -> Command {
        let mut command = Command::new(self.program(name));
        command.env("VIRTUAL_ENV", &self.0);
        command
    }

    fn version(&self) -> Option<String> {
        ask(self.program("python").to_str()?, &["--version"])
    }
}

/// A Python that is new enough.
fn interpreter() -> Result<&'static str, String> {
    let found: Vec<(&str, String)> =
        NAMES.into_iter().filter_map(|name| Some((name, ask(name, &["--version"])?))).collect();
    if let Some((name, version)) = found.iter().find(|(_, version)| is_new_enough(version)) {
        println!("interpreter  {version}");
        return Ok(name);
    }
    let (major, minor) = OLDEST;
    let versions: Vec<&str> = found.iter().map(|(_, version)| version.as_str()).collect();
    let found = if versions.is_empty() { "none".to_owned() } else { versions.join(", ") };
    Err(format!(
        "the Python module: expected Python {major}.{minor} or newer as python3 or python, found {found}.\n\
         On Debian and Ubuntu: `apt-get install python3 python3-venv`"
    ))
}

/// `Python 3.11.7`
fn is_new_enough(version: &str) -> bool {
    let mut numbers = version.trim_start_matches("Python ").split('.').map(str::parse::<u32>);
    matches!((numbers.next(), numbers.next()), (Some(Ok(major)), Some(Ok(minor))) if (major, minor) >= OLDEST)
}

fn only_wheel(folder: &Path) -> Result<PathBuf, String> {
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let paths = entries.filter_map(|entry| entry.ok().map(|entry| entry.path()));
    let mut wheels: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|e| e == "whl")).collect();
    match (wheels.pop(), wheels.is_empty()) {
        (Some(wheel), true) => Ok(wheel),
        _ => Err(format!("{}: expected one wheel", folder.display())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_compared_as_numbers() {
        for (version, enough) in [
            ("Python 3.9.0", true),
            ("Python 3.11.7", true),
            ("Python 3.8.19", false),
            ("Python 2.7.18", false),
            ("", false),
        ] {
            assert_eq!(is_new_enough(version), enough, "{version}");
        }
    }

    #[test]
    fn the_oldest_python_is_that_of_the_package() {
        let text = |path: &str| std::fs::read_to_string(root().join(path)).unwrap();
        let (major, minor) = OLDEST;
        assert!(text("pyproject.toml").contains(&format!("requires-python = \">={major}.{minor}\"")));
        assert!(text(&format!("{PACKAGE}/Cargo.toml")).contains(&format!("abi3-py{major}{minor}")));
    }
}
