//! Which compiler builds the firmware.
//!
//! 1. The active one, if it has the target (`rustup target add`).
//! 2. Debian's `rustc-web`, which builds `core` from its source package and borrows the linker of a rustup toolchain.

use crate::shell::ask;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The target of both boards: Cortex-M4 with single-precision registers.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// A compiler that can build the firmware.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Toolchain {
    /// The active one.
    Active,
    /// Debian's, with this folder that holds `rust-lld`.
    Debian { linker: PathBuf },
}

impl Toolchain {
    /// The first that works. `RUNDOWN_TOOLCHAIN=debian` passes the active one over.
    pub fn find() -> Option<Self> {
        let wanted = std::env::var("RUNDOWN_TOOLCHAIN").unwrap_or_default();
        let active = (wanted != "debian").then(active).flatten();
        active.or_else(debian)
    }

    /// One line about it.
    pub fn shown(&self) -> String {
        match self {
            Self::Active => format!("active Rust with {TARGET}"),
            Self::Debian { .. } => "Debian's Rust (rustc-web), core built from rust-web-src".to_owned(),
        }
    }

    /// `cargo WORD --target ...`, the environment included.
    pub fn cargo(&self, word: &str) -> Command {
        match self {
            Self::Active => {
                let mut cargo = crate::shell::cargo();
                cargo.args([word, "--target", TARGET]);
                cargo
            }
            Self::Debian { linker } => {
                // `cargo clippy` would take rustup's, which lints with another compiler than `core` is built with.
                let mut cargo = Command::new(if word == "clippy" { DEBIAN_CLIPPY } else { DEBIAN_CARGO });
                cargo
                    .args([word, "-Z", "build-std=core", "--target", TARGET])
                    .env("RUSTC", DEBIAN_RUSTC)
                    // Building `core` is an unstable option of cargo.
                    .env("RUSTC_BOOTSTRAP", "1")
                    .env("PATH", with_path(linker))
                    .env("CARGO", DEBIAN_CARGO)
                    .env_remove("RUSTUP_TOOLCHAIN");
                cargo
            }
        }
    }
}

const DEBIAN_CARGO: &str = "/usr/bin/cargo";
const DEBIAN_CLIPPY: &str = "/usr/bin/cargo-clippy";
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";

fn active() -> Option<Toolchain> {
    let folder = ask("rustc", &["--print", "target-libdir", "--target", TARGET])?;
    Path::new(&folder).is_dir().then_some(Toolchain::Active)
}

fn debian() -> Option<Toolchain> {
    if ![DEBIAN_CARGO, DEBIAN_CLIPPY].iter().all(|program| Path::new(program).exists()) {
        return None;
    }
    let sysroot = ask(DEBIAN_RUSTC, &["--print", "sysroot"])?;
    let version = ask(DEBIAN_RUSTC, &["--version"])?;
    let source = Path::new(&sysroot).join("lib/rustlib/src/rust/library/core");
    // Debian 12's own 1.63 does not know the edition.
    let found = source.is_dir() && minor(&version).is_some_and(|minor| minor >= 95);
    found.then(linker).flatten().map(|linker| Toolchain::Debian { linker })
}

/// The second number of `rustc 1.96.0 (...)`.
fn minor(version: &str) -> Option<u32> {
    version.split('.').nth(1)?.parse().ok()
}

/// The folder of `rust-lld`: Debian leaves it out, each rustup toolchain has it.
fn linker() -> Option<PathBuf> {
    let sysroot = PathBuf::from(ask("rustc", &["--print", "sysroot"])?);
    let host = ask("rustc", &["--print", "host-tuple"])?;
    let folder = sysroot.join("lib/rustlib").join(host).join("bin");
    folder.join("rust-lld").exists().then_some(folder)
}

fn with_path(first: &Path) -> OsString {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut all = vec![first.to_owned()];
    all.extend(std::env::split_paths(&path));
    // A folder with the separator in its name cannot be on any path.
    std::env::join_paths(all).unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minor_version_is_read() {
        assert_eq!(minor("rustc 1.96.0 (abc 2026-01-01)"), Some(96));
        assert_eq!(minor("something else"), None);
    }

    #[test]
    fn debians_cargo_is_asked_to_build_core() {
        let debian = Toolchain::Debian { linker: PathBuf::from("/lld") };
        let line = crate::shell::shown(&debian.cargo("build"));
        assert_eq!(line, format!("cargo build -Z build-std=core --target {TARGET}"));
    }
}
