//! The boards and where their firmware lies.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// A board that the firmware is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Board {
    /// ST B-L475E-IOT01A, the reference board. In the emulator it refuses everything that is secured: it cannot write
    /// its flash, so it has no boot epoch.
    L475,
    /// The same with RAM in the place of the flash pages for records, for the emulator.
    L475Emulated,
    /// The same with CAN beside the serial line. The emulator has no CAN controller: there only the serial line speaks,
    /// and secured messages are refused.
    L475Can,
    /// Arm MPS2 AN386: test-only, its watchdog bites and its flash survives the loss of power.
    Mps2,
}

/// Why there is no firmware to start.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each has its message")]
pub enum NoImage {
    #[error("no firmware at {0}: build it with `cargo xtask firmware`")]
    Missing(PathBuf),
    #[error("the firmware at {image} is older than {source_file}: build it with `cargo xtask firmware`")]
    Stale { image: PathBuf, source_file: PathBuf },
}

impl Board {
    /// All.
    pub const ALL: [Self; 4] = [Self::L475, Self::L475Emulated, Self::L475Can, Self::Mps2];

    /// Its name on the command line, the feature of the firmware that makes it, QEMU's name for it.
    const fn names(self) -> (&'static str, Option<&'static str>, &'static str) {
        match self {
            Self::L475 => ("l475", None, "b-l475e-iot01a"),
            Self::L475Emulated => ("l475-emulated", Some("emulator"), "b-l475e-iot01a"),
            Self::L475Can => ("l475-can", Some("can"), "b-l475e-iot01a"),
            Self::Mps2 => ("mps2", Some("mps2"), "mps2-an386"),
        }
    }

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        self.names().0
    }

    /// The board of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|board| board.name() == name)
    }

    /// The feature of the firmware that makes it.
    pub fn feature(self) -> Option<&'static str> {
        self.names().1
    }

    pub(crate) fn machine(self) -> &'static str {
        self.names().2
    }

    /// Where `cargo xtask firmware` puts its firmware.
    pub fn image_path(self) -> PathBuf {
        root().join(format!("target/firmware/rundown-{}.elf", self.name()))
    }

    /// Its firmware, if it is there and no source of it is newer.
    pub fn image(self) -> Result<PathBuf, NoImage> {
        let image = self.image_path();
        let Some(built) = modified(&image) else {
            return Err(NoImage::Missing(image));
        };
        match newest_source().filter(|(changed, _)| *changed > built) {
            Some((_, source_file)) => Err(NoImage::Stale { image, source_file }),
            None => Ok(image),
        }
    }
}

/// Root of the workspace.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_owned()
}

fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().ok()?.modified().ok()
}

fn newest_source() -> Option<(SystemTime, PathBuf)> {
    let mut folders = vec![root().join("src")];
    let mut files: Vec<PathBuf> =
        ["Cargo.toml", "Cargo.lock", "build.rs", "memory.x"].map(|name| root().join(name)).into();
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir().into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.into_iter().filter_map(|file| Some((modified(&file)?, file))).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_again() {
        for board in Board::ALL {
            assert_eq!(Board::named(board.name()), Some(board));
        }
        assert_eq!(Board::named("f405"), None);
    }

    #[test]
    fn the_firmwares_sources_are_seen() {
        let (_, newest) = newest_source().unwrap();
        assert!(newest.exists());
    }
}
