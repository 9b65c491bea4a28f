//! What is kept in RAM over a reset, as words with a checksum.
//!
//! In: RAM of unknown content. Out: what the firmware wrote there before the reset, or nothing: RAM after power-on
//! passes the CRC-32C once in 4 billion times.

use crate::onboard::crash_loop::{CrashLoop, MOST_RESETS, Operation};
use crate::onboard::watchdog::Stalled;
use rundown_wire::ResetCause::{PowerOn, Watchdog};
use rundown_wire::link::checksum::Crc32c;
use rundown_wire::{FILE_TAIL, Failure, ResetCause};

/// Size in RAM, words.
pub const WORDS: usize = 24;
/// Words of a failure.
const FAILURE_WORDS: usize = 2 + FILE_TAIL / 4;
/// Changes with the layout below, so that an older firmware's RAM is not read.
const MAGIC: u32 = 0x5244_4b02;

/// What is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kept {
    /// Resets since power-on.
    pub crash_loop: CrashLoop,
    /// Why the firmware falls. Written just before.
    pub failure: Failure,
    /// Why it fell last, since power-on.
    pub last: Failure,
}

/// What a boot found. Goes into the status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Boot {
    /// What the hardware says.
    pub cause: ResetCause,
    /// What the firmware wrote down before.
    pub failure: Failure,
    /// Crashes since power-on.
    pub resets: u32,
    /// What follows from them.
    pub operation: Operation,
}

impl Kept {
    /// Reads the words that survived a reset. `None` if they were not written by this layout, or not whole.
    pub fn from_words(words: &[u32; WORDS]) -> Option<Self> {
        let [magic, clock_s, at_0, at_1, at_2, resets, gave_up, failures @ .., checksum] = *words;
        if magic != MAGIC || checksum != check(words) {
            return None;
        }
        let (failure, last) = failures.split_at(FAILURE_WORDS);
        let crash_loop = CrashLoop { clock_s, at_s: [at_0, at_1, at_2], resets, gave_up: gave_up != 0 };
        Some(Self { crash_loop, failure: from_words(failure)?, last: from_words(last)? })
    }

    /// The words to keep.
    pub fn to_words(&self) -> [u32; WORDS] {
        let CrashLoop { clock_s, at_s: [at_0, at_1, at_2], resets, gave_up } = self.crash_loop;
        let mut words = [0; WORDS];
        let head = [MAGIC, clock_s, at_0, at_1, at_2, resets, u32::from(gave_up)];
        let body = head.into_iter().chain(to_words(&self.failure)).chain(to_words(&self.last));
        for (to, word) in words.iter_mut().zip(body) {
            *to = word;
        }
        let checksum = check(&words);
        if let Some(last) = words.last_mut() {
            *last = checksum;
        }
        words
    }

    /// A boot: what was found in RAM and in the reset register becomes the report, and what is to be kept from now on.
    ///
    /// RAM that was not kept means that the power was away, whatever the register says. What the firmware wrote down
    /// before it fell outranks a register that says power-on or watchdog: some parts (and the emulator) do not
    /// distinguish resets.
    pub fn boot(found: Option<Self>, register: ResetCause) -> (Self, Boot) {
        let mut kept = found.unwrap_or_default();
        let cause = match (found.map(|kept| kept.failure), register) {
            (None, _) => ResetCause::PowerOn,
            (Some(Failure::Panic { .. } | Failure::Fault { .. } | Failure::StackOverflow), PowerOn | Watchdog) => {
                ResetCause::Software
            }
            (Some(Failure::Stalled(_)), PowerOn) => Watchdog,
            (Some(_), register) => register,
        };
        if cause == ResetCause::PowerOn {
            kept = Self::default();
        }
        let crashed = cause.is_crash(&kept.failure);
        if crashed {
            kept.crash_loop.reset();
        }
        let boot = Boot {
            cause,
            failure: kept.failure,
            resets: kept.crash_loop.resets(),
            operation: kept.crash_loop.operation(),
        };
        // The next reset has its own reason.
        if crashed {
            kept.last = kept.failure;
        }
        kept.failure = Failure::None;
        (kept, boot)
    }
}

/// Over all words but the last.
fn check(words: &[u32; WORDS]) -> u32 {
    let mut crc = Crc32c::START;
    for word in words.iter().take(WORDS - 1) {
        crc.update(&word.to_le_bytes());
    }
    crc.value()
}

/// Kind, value, file.
fn to_words(failure: &Failure) -> [u32; FAILURE_WORDS] {
    let (kind, value, file) = match *failure {
        Failure::None => (0, 0, [0; FILE_TAIL]),
        Failure::Panic { line, file } => (1, line, file),
        Failure::Fault { at } => (2, at, [0; FILE_TAIL]),
        Failure::Stalled(who) => {
            let value = u32::from(who.tick) | u32::from(who.link) << 1;
            (3, value, [0; FILE_TAIL])
        }
        Failure::StackOverflow => (4, 0, [0; FILE_TAIL]),
    };
    let mut words = [0; FAILURE_WORDS];
    let [to_kind, to_value, to_file @ ..] = &mut words;
    (*to_kind, *to_value) = (kind, value);
    for (to, bytes) in to_file.iter_mut().zip(file.as_chunks().0) {
        *to = u32::from_le_bytes(*bytes);
    }
    words
}

fn from_words(words: &[u32]) -> Option<Failure> {
    let [kind, value, file @ ..] = words else {
        return None;
    };
    match kind {
        0 => Some(Failure::None),
        1 => {
            let mut tail = [0; FILE_TAIL];
            for (to, word) in tail.as_chunks_mut().0.iter_mut().zip(file) {
                *to = word.to_le_bytes();
            }
            Some(Failure::Panic { line: *value, file: tail })
        }
        2 => Some(Failure::Fault { at: *value }),
        3 => Some(Failure::Stalled(Stalled { tick: value & 1 != 0, link: value & 2 != 0 })),
        4 => Some(Failure::StackOverflow),
        _ => None,
    }
}

const _: () = assert!(WORDS == 7 + 2 * FAILURE_WORDS + 1, "head, failures, checksum");
const _: () = assert!(MOST_RESETS == 3, "the layout has three times");

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Kept {
        let mut crash_loop = CrashLoop::default();
        crash_loop.second();
        crash_loop.reset();
        Kept { crash_loop, failure: Failure::panic("src/ukf.rs", 77), last: Failure::StackOverflow }
    }

    #[test]
    fn every_failure_comes_back() {
        let stalled = Stalled { tick: false, link: true };
        for failure in [
            Failure::None,
            Failure::panic("a", 1),
            Failure::panic("0123456789012345678901234567", u32::MAX),
            Failure::Fault { at: 0x0800_1234 },
            Failure::Stalled(stalled),
            Failure::StackOverflow,
        ] {
            let kept = Kept { failure, ..example() };
            assert_eq!(Kept::from_words(&kept.to_words()), Some(kept));
        }
    }

    #[test]
    fn a_flipped_bit_anywhere_is_seen() {
        let words = example().to_words();
        for word in 0..WORDS {
            for bit in 0..32 {
                let mut broken = words;
                broken[word] ^= 1 << bit;
                assert_eq!(Kept::from_words(&broken), None, "word {word} bit {bit}");
            }
        }
    }

    #[test]
    fn empty_ram_is_nothing() {
        assert_eq!(Kept::from_words(&[0; WORDS]), None);
        assert_eq!(Kept::from_words(&[u32::MAX; WORDS]), None);
    }

    #[test]
    fn a_crash_is_reported_once_and_counted() {
        let (kept, boot) = Kept::boot(Some(example()), ResetCause::Software);
        assert_eq!(boot.resets, 2);
        assert_eq!(boot.failure, Failure::panic("src/ukf.rs", 77));
        assert_eq!(kept.failure, Failure::None);
        assert_eq!(kept.last, Failure::panic("src/ukf.rs", 77));
        let (_, boot) = Kept::boot(Some(kept), ResetCause::Watchdog);
        assert_eq!(boot.operation, Operation::HeartbeatOnly);
    }

    #[test]
    fn a_power_cut_forgets_all() {
        let (_, boot) = Kept::boot(None, ResetCause::Watchdog);
        assert_eq!(boot, Boot::default());
        let quiet = Kept { failure: Failure::None, ..example() };
        let (_, boot) = Kept::boot(Some(quiet), ResetCause::PowerOn);
        assert_eq!(boot, Boot::default());
    }

    #[test]
    fn what_was_written_down_outranks_a_register_that_cannot_tell() {
        let (_, boot) = Kept::boot(Some(example()), ResetCause::PowerOn);
        assert_eq!((boot.cause, boot.resets), (ResetCause::Software, 2));
    }

    #[test]
    fn a_reset_by_a_probe_is_no_crash() {
        let quiet = Kept { failure: Failure::None, ..example() };
        let mut found = Some(quiet);
        for _ in 0..2 * MOST_RESETS {
            let (kept, boot) = Kept::boot(found, ResetCause::Software);
            assert_eq!((boot.cause, boot.resets, boot.operation), (ResetCause::Software, 1, Operation::Normal));
            assert_eq!(kept, quiet);
            found = Some(kept);
        }
        // The watchdog bites for a reason, whether it could be written down or not.
        let (_, boot) = Kept::boot(found, ResetCause::Watchdog);
        assert_eq!(boot.resets, 2);
    }

    #[test]
    fn the_button_is_no_crash() {
        let (kept, boot) = Kept::boot(Some(example()), ResetCause::Pin);
        assert_eq!((boot.cause, boot.resets), (ResetCause::Pin, 1));
        assert_eq!(kept.crash_loop, example().crash_loop);
    }
}
