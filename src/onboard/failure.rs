//! Why the processor began: what the reset register says, and what the firmware wrote down before it fell.

use crate::onboard::watchdog::Stalled;

/// What the hardware says about the last reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResetCause {
    /// Power came, or fell below what the processor needs.
    #[default]
    PowerOn,
    /// The reset pin, a button or a probe.
    Pin,
    /// The firmware asked for it: a panic or a fault.
    Software,
    /// The watchdog was not fed.
    Watchdog,
    /// Something else (option bytes, firewall, low-power entry).
    Other,
}

impl ResetCause {
    /// Whether it counts towards the crash loop. A person who presses the button is no crash.
    pub fn is_crash(self) -> bool {
        matches!(self, Self::Software | Self::Watchdog)
    }
}

/// Bytes kept of a file's name: its end, which tells files apart.
pub const FILE_TAIL: usize = 24;

/// What the firmware wrote down before the reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    /// use rundown::onboard::failure::Failure;
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
        core::str::from_utf8(file)
            .unwrap_or("")
            .trim_end_matches('\0')
    }
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
        assert!(ResetCause::Watchdog.is_crash());
        assert!(ResetCause::Software.is_crash());
        assert!(!ResetCause::Pin.is_crash());
        assert!(!ResetCause::PowerOn.is_crash());
    }
}
