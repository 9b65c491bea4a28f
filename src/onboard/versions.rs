//! What the board runs: its firmware's version, the commit that it was built from, and the messages that it speaks.

use crate::uplink;
use rundown_wire::{VERSION, Versions};

/// Of this build. `build.rs` asks git for the commit, for a board only: a host's program would be built again after
/// each commit.
pub const VERSIONS: Versions = versions(option_env!("RUNDOWN_COMMIT"));

/// In: the first eight digits of the commit, with a `+` behind them where the sources differ from it. Anything else is
/// no commit.
const fn versions(commit: Option<&str>) -> Versions {
    let (commit, changed) = match commit {
        Some(text) => match text.as_bytes() {
            [_, _, _, _, _, _, _, _] => (number(text), false),
            [_, _, _, _, _, _, _, _, b'+'] => (number(text.split_at(8).0), true),
            _ => (None, false),
        },
        None => (None, false),
    };
    let firmware = [
        part(env!("CARGO_PKG_VERSION_MAJOR")),
        part(env!("CARGO_PKG_VERSION_MINOR")),
        part(env!("CARGO_PKG_VERSION_PATCH")),
    ];
    Versions { firmware, commit, changed, downlink: VERSION, uplink: uplink::VERSION }
}

const fn number(digits: &str) -> Option<u32> {
    match u32::from_str_radix(digits, 16) {
        Ok(number) => Some(number),
        Err(_) => None,
    }
}

/// Evaluated while compiling: a version that does not fit does not build.
const fn part(digits: &str) -> u16 {
    match u16::from_str_radix(digits, 10) {
        Ok(number) => number,
        Err(_) => panic!("a part of the version is above 65535"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_commit_is_read_as_git_writes_it() {
        let of = |commit| {
            let versions = versions(commit);
            (versions.commit, versions.changed)
        };
        assert_eq!(of(Some("0a1b2c3d")), (Some(0x0A1B_2C3D), false));
        assert_eq!(of(Some("0a1b2c3d+")), (Some(0x0A1B_2C3D), true));
        for unknown in [None, Some("unknown"), Some(""), Some("0a1b2c3"), Some("0a1b2c3d-"), Some("wxyzwxyz")] {
            assert_eq!(of(unknown), (None, false), "{unknown:?}");
        }
    }

    #[test]
    fn the_version_is_the_packages() {
        let [major, minor, patch] = VERSIONS.firmware;
        assert_eq!(std::format!("{major}.{minor}.{patch}"), env!("CARGO_PKG_VERSION"));
        assert_eq!((VERSIONS.downlink, VERSIONS.uplink), (1, 1));
    }

    extern crate std;
}
