//! `cargo xtask setup`: everything that the firmware's build and its emulator need. Says what it finds and what it
//! does; a second run finds all and does nothing.

use crate::shell::{ask, root, run};
use crate::toolchain::{TARGET, Toolchain};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// rustup answers within seconds, or its server cannot be reached.
const RUSTUP_TIME: Duration = Duration::from_secs(120);
const DEBIAN_RUST: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "rust-web-clippy"];
const BACKPORTS: &str = "/etc/apt/sources.list.d/rundown-backports.sources";

pub fn setup() -> Result<(), String> {
    let toolchain = toolchain()?;
    println!("compiler  {}", toolchain.shown());
    let qemu = qemu()?;
    println!("emulator  qemu-system-arm {qemu}");
    Ok(())
}

fn toolchain() -> Result<Toolchain, String> {
    if let Some(found) = Toolchain::find() {
        return Ok(found);
    }
    if ask("rustup", &["--version"]).is_some()
        && add_target()
        && let Some(found) = Toolchain::find()
    {
        return Ok(found);
    }
    if has_apt() {
        println!("rustup cannot bring {TARGET} here; taking Debian's Rust for the firmware");
        apt(&["update"])?;
        let mut words = vec!["install", "-y", "--no-install-recommends"];
        words.extend(DEBIAN_RUST);
        apt(&words)?;
    }
    Toolchain::find().ok_or_else(|| {
        format!(
            "no compiler for {TARGET}. Either `rustup target add {TARGET}` (needs access to static.rust-lang.org),\n\
             or on Debian 12: `apt-get install --no-install-recommends {}` next to a rustup toolchain, whose rust-lld it uses",
            DEBIAN_RUST.join(" ")
        )
    })
}

/// Whether rustup brought the target. Its failure is no error: Debian's packages do as well.
fn add_target() -> bool {
    let mut command = Command::new("rustup");
    command.args(["target", "add", TARGET]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    println!("$ rustup target add {TARGET}");
    let Ok(mut child) = command.spawn() else {
        return false;
    };
    let begin = Instant::now();
    while begin.elapsed() < RUSTUP_TIME {
        match child.try_wait() {
            Ok(None) => std::thread::sleep(Duration::from_millis(100)),
            Ok(Some(status)) => return status.success(),
            Err(_) => return false,
        }
    }
    let _ = child.kill();
    let _ = child.wait();
    false
}

fn qemu() -> Result<String, String> {
    let missing = match emulator::version() {
        Ok(version) => return Ok(version),
        Err(missing) => missing,
    };
    println!("{missing}");
    if has_apt() {
        // Debian 12 has 7.2, its backports have 10.
        let old =
            ask("sh", &["-c", ". /etc/os-release; echo $VERSION_CODENAME"]).is_some_and(|name| name == "bookworm");
        if old {
            add_backports()?;
        }
        apt(&["update"])?;
        let mut words = vec!["install", "-y", "--no-install-recommends"];
        if old {
            words.extend(["-t", "bookworm-backports"]);
        }
        words.push("qemu-system-arm");
        apt(&words)?;
    }
    emulator::version().map_err(|error| {
        format!(
            "{error}\nor by hand: QEMU 10 or newer with qemu-system-arm on the path (https://www.qemu.org/download)"
        )
    })
}

fn add_backports() -> Result<(), String> {
    let known = ask("apt-cache", &["policy"]).is_some_and(|text| text.contains("bookworm-backports"));
    if known {
        return Ok(());
    }
    println!("adding the suite bookworm-backports: {BACKPORTS}");
    let text = "Types: deb\nURIs: http://deb.debian.org/debian\nSuites: bookworm-backports\nComponents: main\n\
                Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg\n";
    let mut child = as_root("tee")
        .arg(BACKPORTS)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .map_err(|error| format!("`tee {BACKPORTS}` could not be started: {error}"))?;
    if let Some(mut stdin) = child.stdin.take() {
        stdin.write_all(text.as_bytes()).map_err(|error| format!("{BACKPORTS}: {error}"))?;
    }
    match child.wait() {
        Ok(status) if status.success() => Ok(()),
        _ => Err(format!("{BACKPORTS} could not be written")),
    }
}

fn has_apt() -> bool {
    Path::new("/etc/debian_version").exists() && Path::new("/usr/bin/apt-get").exists()
}

/// Another apt (a machine that has just started updates itself) holds the lock for minutes at most.
const APT_WAITS: &str = "DPkg::Lock::Timeout=120";

fn apt(words: &[&str]) -> Result<(), String> {
    let mut command = as_root("apt-get");
    command.args(["-o", APT_WAITS]).args(words).env("DEBIAN_FRONTEND", "noninteractive");
    run(&mut command).map_err(|error| {
        format!(
            "{error}\napt could not do it: where it says that a lock is held, another apt or dpkg is at work; wait for it \
             (`sudo fuser -v /var/lib/dpkg/lock-frontend /var/lib/apt/lists/lock` names it) and repeat `cargo xtask setup`. \
             Where apt may not be used at all, install by hand what `$ apt-get` above names"
        )
    })
}

/// The program as root: by sudo, which is shown and asks, unless this is root.
fn as_root(program: &str) -> Command {
    if ask("id", &["-u"]).as_deref() == Some("0") {
        return Command::new(program);
    }
    println!("(needs root: by sudo)");
    let mut sudo = Command::new("sudo");
    sudo.arg(program);
    sudo
}

/// The browser that the page is looked at with, and its driver, of the same version.
pub fn browser() -> Result<(), String> {
    let versions = || Some((ask("chromium", &["--version"])?, ask("chromedriver", &["--version"])?));
    if versions().is_none() && has_apt() {
        println!("the page is tested in Chromium, which is missing; taking Debian's");
        apt(&["update"])?;
        apt(&["install", "-y", "--no-install-recommends", "chromium", "chromium-driver"])?;
    }
    let (browser, driver) = versions().ok_or(
        "no browser: the page is tested in Chromium. On Debian: `apt-get install --no-install-recommends chromium chromium-driver`;\n\
         elsewhere put `chromium` and a `chromedriver` of its version on the path",
    )?;
    println!("browser   {browser}\n          {driver}");
    Ok(())
}

/// The independent peers of the CAN link, in a Python environment of their own. At once when they are there.
pub fn peers() -> Result<(), String> {
    let folder = root().join("target/peers");
    if folder.join("bin/python").exists() && folder.join("complete").exists() {
        return Ok(());
    }
    run(Command::new("python3").args(["-m", "venv", "target/peers"]))?;
    run(Command::new(folder.join("bin/pip")).args([
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "-r",
        "host-tests/peers/requirements.txt",
    ]))?;
    std::fs::write(folder.join("complete"), "").map_err(|error| error.to_string())
}
