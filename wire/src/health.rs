//! How the hardware is: why it started, what went wrong on the line, how deep the stack was.

use crate::link::Counters;
use crate::words::words;
use serde::{Deserialize, Serialize};

words! {
    /// Why the board started.
    #[derive(Default)]
    #[non_exhaustive]
    ResetCause {
        /// Power came, or fell below what the processor needs.
        #[default]
        PowerOn "power_on",
        /// The reset pin, a button or a probe.
        Pin "pin",
        /// The firmware asked for it: a panic or a fault; or a probe did.
        Software "software",
        /// The watchdog was not fed.
        Watchdog "watchdog",
        /// Something else (option bytes, firewall, low-power entry).
        Other "other",
    }
}

impl ResetCause {
    /// Whether it counts towards the crash loop, with what the firmware wrote down before. A person who presses the
    /// button is no crash, nor is a probe that asks the processor for a reset, as the firmware does when it fails.
    pub const fn is_crash(self, failure: &Failure) -> bool {
        match self {
            Self::Watchdog => true,
            Self::Software => !matches!(failure, Failure::None),
            Self::PowerOn | Self::Pin | Self::Other => false,
        }
    }
}

/// Bytes kept of a file's name: its end, which distinguishes files.
pub const FILE_TAIL: usize = 24;

/// What the firmware wrote down before the reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// Nothing: power-on, button, or the end came without warning.
    #[default]
    None,
    /// A panic in this line of the file whose name ends so.
    Panic {
        /// Line.
        line: u32,
        /// End of the path, filled with zeros.
        file: [u8; FILE_TAIL],
    },
    /// A processor fault at this address of code.
    Fault {
        /// Program counter.
        at: u32,
    },
    /// The stack was used up.
    StackOverflow,
    /// A task did not advance and the watchdog was not fed.
    Stalled(Stalled),
}

impl Failure {
    /// A panic at this place.
    ///
    /// ```
    /// use rundown_wire::Failure;
    ///
    /// let panic = Failure::panic("/far/away/rundown/src/estimator.rs", 12);
    /// assert_eq!(panic.file(), "rundown/src/estimator.rs");
    /// ```
    pub fn panic(path: &str, line: u32) -> Self {
        let bytes = path.as_bytes();
        let mut from = bytes.len().saturating_sub(FILE_TAIL);
        // Not in the middle of a character.
        while !path.is_char_boundary(from) {
            from += 1;
        }
        let mut file = [0; FILE_TAIL];
        for (to, byte) in file.iter_mut().zip(bytes.iter().skip(from)) {
            *to = *byte;
        }
        Self::Panic { line, file }
    }

    /// End of the file's name of a panic, else nothing.
    pub fn file(&self) -> &str {
        let Self::Panic { file, .. } = self else {
            return "";
        };
        core::str::from_utf8(file).unwrap_or("").trim_end_matches('\0')
    }
}

/// Which task has not advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Stalled {
    /// The tick task.
    pub tick: bool,
    /// The link task.
    pub link: bool,
}

/// What went wrong on the serial line, and on CAN where the firmware has it, counted since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LineCounts {
    /// A byte came before the last one was read; on CAN a frame.
    pub overrun: u32,
    /// A byte without its stop bit.
    pub framing: u32,
    /// The samples of a bit disagreed.
    pub noise: u32,
    /// Parity, or what the port cannot name; a crystal that does not start to trim the clock; on CAN a bus-off, and a
    /// controller that does not start.
    pub other: u32,
    /// Bytes, on CAN frames, that had come and were dropped: the ring was full, or a DMA transfer failed or was overrun
    /// (at least so many).
    pub ring_full: u32,
}

/// How the hardware is. The only frame that differs between a board and a host that replays its log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Health {
    /// Since the start, s.
    pub uptime_s: u32,
    /// Why it started.
    pub reset_cause: ResetCause,
    /// What the firmware wrote down before.
    pub failure: Failure,
    /// Crashes since power-on.
    pub resets: u32,
    /// The processor runs on its slow clock, because the fast one did not come.
    pub slow_clock: bool,
    /// Most of the stack that was ever used, bytes.
    pub stack_bytes: u32,
    /// Longest time that a tick or a message took, microseconds.
    pub longest_us: u32,
    /// Double-bit errors that the flash reported.
    pub flash_errors: u32,
    /// The serial line, and CAN.
    pub line: LineCounts,
    /// The link; of both lines together.
    pub messages: Counters,
    /// Frames that the line did not take; of both lines together.
    pub not_sent: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_name_is_kept_whole() {
        assert_eq!(Failure::panic("src/ukf.rs", 1).file(), "src/ukf.rs");
    }

    #[test]
    fn a_long_name_is_cut_at_a_character() {
        // 13 characters of two bytes: the cut at 24 bytes falls on a boundary, at 25 it would not.
        let panic = Failure::panic("äääääääääääääb", 1);
        assert_eq!(panic.file(), "äääääääääääb");
    }

    #[test]
    fn only_crashes_count() {
        assert!(ResetCause::Watchdog.is_crash(&Failure::None));
        assert!(ResetCause::Software.is_crash(&Failure::StackOverflow));
        assert!(!ResetCause::Software.is_crash(&Failure::None));
        assert!(!ResetCause::Pin.is_crash(&Failure::StackOverflow));
        assert!(!ResetCause::PowerOn.is_crash(&Failure::None));
    }
}
