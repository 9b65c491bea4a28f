//! `rundown doctor`: what this machine has, and lacks, for a board, its emulator, the browser's tests and Python.

use super::{Failure, screen};
use crate::replaying::Request;
use rundown_files::train_file::TrainFile;
use std::path::Path;
use std::process::{Command, ExitCode};

const TARGET: &str = "thumbv7em-none-eabihf";
/// Older ones emulate the timer of the STM32L475 too little.
const QEMU: (u32, u32) = (10, 0);
/// The oldest Python that the module runs on.
const PYTHON: (u32, u32) = (3, 9);

/// Where Linux lists what is plugged in.
const USB: &str = "/sys/bus/usb/devices";
/// STMicroelectronics.
const ST: &str = "0483";
/// ST-LINK/V2, V2-1 and V3; the board for which the firmware is built has a V2-1.
const ST_LINKS: [&str; 11] = ["3748", "374a", "374b", "374d", "374e", "374f", "3752", "3753", "3754", "3755", "3757"];

/// What is looked for.
struct Check {
    name: &'static str,
    /// What it is needed for.
    purpose: &'static str,
    /// The command that mends it.
    mend: &'static str,
    /// What was found, or what is wrong.
    found: Result<String, String>,
}

pub(super) fn run() -> Result<ExitCode, Failure> {
    for check in checks() {
        let Check { name, purpose, mend, found } = check;
        screen::print(&match found {
            Ok(found) => format!("ok       {name:15} {found}\n"),
            Err(wrong) => format!("missing  {name:15} {wrong}; {purpose} needs it\n         {:15} mend: {mend}\n", ""),
        });
    }
    let replayed = replay_one();
    let said = match &replayed {
        Ok(()) => "ok       replay          a run was read, replayed and written\n".to_owned(),
        Err(failure) => format!("broken   replay          {}\n", failure.message),
    };
    screen::print(&said);
    replayed.map(|()| ExitCode::SUCCESS)
}

fn checks() -> Vec<Check> {
    let check = |name, purpose, mend, found| Check { name, purpose, mend, found };
    vec![
        check("thumb target", "the firmware", "cargo xtask setup", thumb_target()),
        check("probe-rs", "flashing a board", "cargo install --locked probe-rs-tools", ask("probe-rs", &["--version"])),
        check("ST-LINK", "flashing a board", "connect the board's USB socket ST-LINK", st_link(Path::new(USB))),
        check(
            "QEMU",
            "the emulated board",
            "cargo xtask setup",
            ask("qemu-system-arm", &["--version"]).and_then(|text| at_least(&text, QEMU)),
        ),
        check(
            "Chromium",
            "the browser test (`cargo xtask browser`)",
            "apt-get install chromium chromium-driver",
            ask("chromium", &["--version"]).and_then(|found| ask("chromedriver", &["--version"]).map(|_| found)),
        ),
        check("Python", "the wheel (`pip install .`)", "apt-get install python3 python3-venv", python()),
    ]
}

/// The probes that are plugged in, by the numbers of their makers and products.
fn st_link(devices: &Path) -> Result<String, String> {
    let entries = std::fs::read_dir(devices)
        .map_err(|error| format!("expected the list of USB devices in {}, found: {error}", devices.display()))?;
    let named = |entry: &Path, file: &str| {
        let text = std::fs::read_to_string(entry.join(file)).unwrap_or_default();
        text.trim().to_owned()
    };
    let of = |entry: std::fs::DirEntry| {
        let entry = entry.path();
        let is_probe = named(&entry, "idVendor") == ST && ST_LINKS.contains(&named(&entry, "idProduct").as_str());
        is_probe.then(|| format!("{} {}", named(&entry, "product"), named(&entry, "serial")).trim().to_owned())
    };
    let mut found: Vec<String> = entries.flatten().filter_map(of).collect();
    found.sort();
    match found.is_empty() {
        false => Ok(format!("plugged in: {}", found.join(", "))),
        true => Err("expected an ST-LINK at USB, found none".to_owned()),
    }
}

/// The compiled core library, of the toolchain that is active or of Debian's package.
fn thumb_target() -> Result<String, String> {
    let folder = ask("rustc", &["--print", "target-libdir", "--target", TARGET])?;
    if Path::new(&folder).is_dir() {
        return Ok(format!("{TARGET} of the active toolchain"));
    }
    let source =
        ask("/usr/bin/rustc", &["--print", "sysroot"]).map(|root| format!("{root}/lib/rustlib/src/rust/library/core"));
    match source {
        Ok(source) if Path::new(&source).is_dir() => Ok(format!("{TARGET} is built from Debian's sources of Rust")),
        _ => Err(format!("expected Rust for {TARGET}, found none")),
    }
}

fn python() -> Result<String, String> {
    let version = ask("python3", &["--version"]).and_then(|text| at_least(&text, PYTHON))?;
    ask("python3", &["-m", "venv", "--help"]).map_err(|_| "expected the module venv, found none".to_owned())?;
    Ok(version)
}

/// The first line that a program says.
fn ask(program: &str, arguments: &[&str]) -> Result<String, String> {
    let missing = || format!("expected `{program}` on the path, found none");
    let output = Command::new(program).args(arguments).output().map_err(|_| missing())?;
    if !output.status.success() {
        return Err(format!("expected `{program} {}` to succeed, found {}", arguments.join(" "), output.status));
    }
    Ok(String::from_utf8_lossy(&output.stdout).lines().next().unwrap_or_default().trim().to_owned())
}

/// The text, where the first version in it is new enough.
fn at_least(text: &str, least: (u32, u32)) -> Result<String, String> {
    let numbers = text.split(|c: char| !(c.is_ascii_digit() || c == '.')).find_map(|word| {
        let mut parts = word.split('.').map(str::parse::<u32>);
        Some((parts.next()?.ok()?, parts.next()?.ok()?))
    });
    match numbers {
        Some(found) if found >= least => Ok(text.to_owned()),
        _ => Err(format!("expected version {}.{} or newer, found `{text}`", least.0, least.1)),
    }
}

/// The main job on a small scale: a run of a minute, from files to files.
fn replay_one() -> Result<(), Failure> {
    let folder = tempfile::tempdir().map_err(Failure::not_written)?;
    let path = |name: &str| folder.path().join(name);
    let train = TrainFile::of("doctor", &rundown::model::train::TrainDescription::CASE_STUDY);
    let rows: String = (0..7).map(|i| format!("{},{},90\n", 10 * i, 250 * i)).collect();
    let files = [
        ("train.toml", toml::to_string(&train).map_err(Failure::not_written)?),
        ("track.toml", "name = \"doctor\"\nlength_m = 5000\ngradient_sd_permille = 0\n".to_owned()),
        ("run.csv", format!("time_s,location_m,speed_kmh\n{rows}")),
    ];
    files.iter().try_for_each(|(name, text)| crate::output::files::text(&path(name), text))?;
    let request = Request::new(vec![path("run.csv")], path("train.toml"), path("track.toml"));
    let replayed = request.open()?.replay(|| ())?;
    if let Some(message) = replayed.nothing() {
        let why: Vec<&str> = replayed.failed.iter().map(|failed| failed.error.as_str()).collect();
        return Err(Failure::no_runs(format!("{message}: {}", why.join("; "))));
    }
    replayed.write(&path("out"))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_old_version_is_missing() {
        assert!(at_least("QEMU emulator version 10.0.2 (Debian 1:10.0)", QEMU).is_ok());
        let old = at_least("QEMU emulator version 7.2.19", QEMU).unwrap_err();
        assert_eq!(old, "expected version 10.0 or newer, found `QEMU emulator version 7.2.19`");
        assert!(at_least("Python 3.11.2", PYTHON).is_ok() && at_least("Python 3.8.10", PYTHON).is_err());
        assert!(at_least("no number", PYTHON).is_err());
    }

    #[test]
    fn a_program_that_is_not_there_is_named() {
        let missing = ask("no-such-program-of-rundown", &[]).unwrap_err();
        assert_eq!(missing, "expected `no-such-program-of-rundown` on the path, found none");
    }

    #[test]
    fn a_probe_is_known_by_its_numbers() {
        let devices = tempfile::tempdir().unwrap();
        let plug = |name: &str, files: &[(&str, &str)]| {
            let folder = devices.path().join(name);
            std::fs::create_dir(&folder).unwrap();
            files.iter().for_each(|(file, text)| std::fs::write(folder.join(file), format!("{text}\n")).unwrap());
        };
        plug("1-0:1.0", &[]);
        plug("1-1", &[("idVendor", "0483"), ("idProduct", "5740"), ("product", "Virtual COM Port")]);
        assert_eq!(st_link(devices.path()).unwrap_err(), "expected an ST-LINK at USB, found none");
        plug("1-2", &[("idVendor", "0483"), ("idProduct", "374b"), ("product", "STM32 STLink"), ("serial", "066A")]);
        assert_eq!(st_link(devices.path()).unwrap(), "plugged in: STM32 STLink 066A");
        assert!(st_link(&devices.path().join("none")).unwrap_err().starts_with("expected the list of USB devices in "));
    }

    #[test]
    fn the_main_job_works() {
        assert!(replay_one().is_ok());
    }
}
