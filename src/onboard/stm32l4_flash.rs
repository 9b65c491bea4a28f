//! How an STM32L4 erases and programs its own flash: the sequence of RM0351 3.3.5 to 3.3.7, free of registers so that
//! the host tests it.
//!
//! In: a controller's registers and pages ([`FlashController`]). Out: a [`NorFlash`] that the store writes to.
//!
//! One operation:
//!
//! 1. Wait until the one before is over. Every wait is bounded.
//! 2. Clear the error flags. They are sticky, some are set after a reset already (OPTVERR, PGSERR), and a flag that is
//!    set makes the controller refuse.
//! 3. Unlock, if it is locked: keys that come unasked raise a fault.
//! 4. Data cache off: by an erratum of the chip (ES0250) reading one bank while the other is written may corrupt it.
//! 5. Erase or program, wait, look at the flags.
//! 6. Lock; forget what the cache held, because it may be stale, and switch it on.
//! 7. Read back.
//!
//! A double word is programmed once between two erasures. Power that goes away meanwhile leaves bits that may read
//! either way; that is the caller's to survive (checksums, two places).

use super::clock::{FAST_HZ, MOST_POLLS, SLOW_HZ};
use core::ops::Range;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

/// Page, bytes.
pub const PAGE: u32 = 2048;
/// Polls of the status before an operation counts as stuck. An erasure takes up to 25 ms, 80 k polls of 25 cycles at 80
/// MHz.
pub const MOST_WAITS: u32 = 40 * MOST_POLLS;
/// The same without wait states, as of a processor that had to stay at its slow clock: 0.25 s there, too. The watchdog
/// bites after 2 s.
pub const MOST_WAITS_SLOW: u32 = MOST_WAITS / (FAST_HZ / SLOW_HZ);

/// Keys that unlock the control register, in this order.
pub const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

/// Bits of the access control register.
pub mod access {
    /// Wait states: none where the processor runs at its slow clock.
    pub const LATENCY: u32 = 0b111;
    /// Data cache on.
    pub const DATA_CACHE: u32 = 1 << 10;
    /// Forgets what the data cache holds; only while it is off.
    pub const DATA_CACHE_RESET: u32 = 1 << 12;
}

/// Bits of the status register; the flags are cleared by writing 1.
pub mod status {
    /// All flags that say that an operation was refused or failed.
    pub const ERRORS: u32 = 0xC3FA;
    /// An operation is under way.
    pub const BUSY: u32 = 1 << 16;
}

/// Bits of the control register.
pub mod control {
    /// Program double words.
    pub const PROGRAM: u32 = 1 << 0;
    /// Erase a page.
    pub const ERASE: u32 = 1 << 1;
    /// Lowest bit of the page's number within its bank.
    pub const PAGE_SHIFT: u32 = 3;
    /// The page is one of bank 2.
    pub const BANK_2: u32 = 1 << 11;
    /// Begin.
    pub const START: u32 = 1 << 16;
    /// Only keys change it.
    pub const LOCK: u32 = 1 << 31;
}

/// Bits of the ECC register.
mod ecc {
    /// Offset within both banks of the word that failed: the number of the bank is the bit above the offset within it.
    pub const OFFSET: u32 = 0xF_FFFF;
    /// It is in the system memory.
    pub const SYSTEM: u32 = 1 << 20;
    /// One bit of a word was wrong before, and was put right: the address is that of it, and stays.
    pub const CORRECTED: u32 = 1 << 30;
    /// Two bits of a word were wrong; cleared by writing 1.
    pub const DETECTED: u32 = 1 << 31;
}

/// Where the flash begins.
const FLASH: u32 = 0x0800_0000;

/// What follows from a word of which two bits are wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DoubleBitError {
    /// Power was lost while it was written; whoever reads it has a checksum.
    Torn,
    /// The program is damaged here, or nothing is known: what runs on may do anything.
    Damage(u32),
}

/// What FLASH_ECCR reports, in the non-maskable interrupt; `written` are the addresses of the pages that are written
/// and checked, `are_read`: the records are being read just now.
pub fn double_bit_error(register: u32, written: &[Range<u32>], are_read: bool) -> DoubleBitError {
    let at = FLASH + (register & ecc::OFFSET);
    let reported = register & (ecc::DETECTED | ecc::SYSTEM) == ecc::DETECTED;
    let is_written = match register & ecc::CORRECTED {
        0 => reported && written.iter().any(|pages| pages.contains(&at)),
        _ => register & ecc::DETECTED != 0 && are_read,
    };
    if is_written { DoubleBitError::Torn } else { DoubleBitError::Damage(at) }
}

/// The four registers that the sequence touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashRegister {
    /// FLASH_ACR.
    Access,
    /// FLASH_KEYR.
    Key,
    /// FLASH_SR.
    Status,
    /// FLASH_CR.
    Control,
}

/// A flash controller with the pages for records, which lie in bank 2. Offsets are those of the first page.
pub trait FlashController {
    /// Bytes for records, a multiple of [`PAGE`].
    const CAPACITY: usize;
    /// Reads a register.
    fn register(&mut self, register: FlashRegister) -> u32;
    /// Writes a register as a whole.
    fn set_register(&mut self, register: FlashRegister, bits: u32);
    /// Writes a double word, its low half first, with nothing between.
    fn program(&mut self, offset: u32, double_word: [u32; 2]);
    /// Reads a byte, past no optimisation of the compiler.
    fn byte(&mut self, offset: u32) -> u8;
    /// Number of the first page within bank 2.
    fn first_page(&self) -> u32;
    /// Double-bit errors that reading has met since boot.
    fn double_bit_errors(&self) -> u32;
}

/// Why the flash did not do it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Not aligned, or beyond the pages.
    Range(NorFlashErrorKind),
    /// The controller did not finish in time. The emulator has none.
    NoAnswer,
    /// The keys did not open the control register.
    Locked,
    /// The controller reported these error bits.
    Refused(u32),
    /// The bytes there are not those that were written, or not erased.
    ReadBack,
    /// A double-bit error while reading: a word that was torn.
    Torn,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Range(kind) => *kind,
            Self::NoAnswer | Self::Locked | Self::Refused(_) | Self::ReadBack | Self::Torn => NorFlashErrorKind::Other,
        }
    }
}

/// The pages for records behind a controller.
#[derive(Clone, Debug)]
pub struct Stm32l4Flash<C> {
    controller: C,
}

impl<C: FlashController> Stm32l4Flash<C> {
    /// Touches no register yet.
    pub fn new(controller: C) -> Self {
        Self { controller }
    }

    /// The controller.
    pub fn controller(&mut self) -> &mut C {
        &mut self.controller
    }

    /// Steps 1 to 6 around `work`.
    fn operation(&mut self, work: impl FnOnce(&mut Self) -> Result<(), FlashError>) -> Result<(), FlashError> {
        self.wait()?;
        self.controller.set_register(FlashRegister::Status, status::ERRORS);
        self.unlock()?;
        let access = self.controller.register(FlashRegister::Access);
        let cache_off = access & !(access::DATA_CACHE | access::DATA_CACHE_RESET);
        self.controller.set_register(FlashRegister::Access, cache_off);
        let done = work(self);
        // While it is busy the control register takes no write: the bus would stand still. The cache stays off until an
        // operation ends.
        if done != Err(FlashError::NoAnswer) {
            self.controller.set_register(FlashRegister::Control, control::LOCK);
            self.controller.set_register(FlashRegister::Access, cache_off | access::DATA_CACHE_RESET);
            self.controller.set_register(FlashRegister::Access, cache_off);
            self.controller.set_register(FlashRegister::Access, cache_off | access::DATA_CACHE);
        }
        done
    }

    fn unlock(&mut self) -> Result<(), FlashError> {
        if self.is_locked() {
            KEYS.into_iter().for_each(|key| self.controller.set_register(FlashRegister::Key, key));
        }
        if self.is_locked() { Err(FlashError::Locked) } else { Ok(()) }
    }

    fn is_locked(&mut self) -> bool {
        self.controller.register(FlashRegister::Control) & control::LOCK != 0
    }

    /// The status once nothing is under way.
    fn wait(&mut self) -> Result<u32, FlashError> {
        let slow = self.controller.register(FlashRegister::Access) & access::LATENCY == 0;
        (0..if slow { MOST_WAITS_SLOW } else { MOST_WAITS })
            .map(|_| self.controller.register(FlashRegister::Status))
            .find(|status| status & status::BUSY == 0)
            .ok_or(FlashError::NoAnswer)
    }

    /// Waits for what was just begun.
    fn outcome(&mut self) -> Result<(), FlashError> {
        match self.wait()? & status::ERRORS {
            0 => Ok(()),
            errors => Err(FlashError::Refused(errors)),
        }
    }

    fn erase_page(&mut self, number: u32) -> Result<(), FlashError> {
        let page = control::ERASE | control::BANK_2 | number << control::PAGE_SHIFT;
        self.controller.set_register(FlashRegister::Control, page);
        self.controller.set_register(FlashRegister::Control, page | control::START);
        self.outcome()
    }

    /// A word of which two bits are uncertain is not written, though it may read right.
    fn reads(&mut self, from: u32, mut bytes: impl Iterator<Item = u8>) -> Result<(), FlashError> {
        let (mut places, before) = (from.., self.controller.double_bit_errors());
        let same = bytes.all(|byte| places.next().is_some_and(|offset| self.controller.byte(offset) == byte));
        if same && self.controller.double_bit_errors() == before { Ok(()) } else { Err(FlashError::ReadBack) }
    }
}

impl<C> ErrorType for Stm32l4Flash<C> {
    type Error = FlashError;
}

impl<C: FlashController> ReadNorFlash for Stm32l4Flash<C> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        check_read(self, offset, bytes.len()).map_err(FlashError::Range)?;
        let before = self.controller.double_bit_errors();
        for (offset, byte) in (offset..).zip(bytes) {
            *byte = self.controller.byte(offset);
        }
        if self.controller.double_bit_errors() == before { Ok(()) } else { Err(FlashError::Torn) }
    }

    fn capacity(&self) -> usize {
        C::CAPACITY
    }
}

impl<C: FlashController> NorFlash for Stm32l4Flash<C> {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        check_erase(self, from, to).map_err(FlashError::Range)?;
        let first = self.controller.first_page();
        self.operation(|flash| (from / PAGE..to / PAGE).try_for_each(|page| flash.erase_page(first + page)))?;
        self.reads(from, (from..to).map(|_| 0xFF))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check_write(self, offset, bytes.len()).map_err(FlashError::Range)?;
        self.operation(|flash| {
            flash.controller.set_register(FlashRegister::Control, control::PROGRAM);
            for (offset, double_word) in (offset..).step_by(8).zip(bytes.as_chunks::<8>().0) {
                let bits = u64::from_le_bytes(*double_word);
                flash.controller.program(offset, [bits as u32, (bits >> 32) as u32]);
                flash.outcome()?;
            }
            Ok(())
        })?;
        self.reads(offset, bytes.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_word_of_the_records_or_the_key_may_be_torn() {
        let written = [0x080F_0000..0x080F_4000, 0x080F_F800..0x0810_0000];
        let (detected, bank_2, system) = (1 << 31, 1 << 19, 1 << 20);
        let asked = |register| double_bit_error(register, &written, false);
        for offset in [0x7_0000, 0x7_3FF8, 0x7_F800, 0x7_FFF8] {
            assert_eq!(asked(detected | bank_2 | offset), DoubleBitError::Torn, "{offset:#x}");
            // The same place in the bank of the program, in the system memory, and where nothing is reported.
            assert_eq!(asked(detected | offset), DoubleBitError::Damage(FLASH + offset));
            assert!(matches!(asked(detected | system | bank_2 | offset), DoubleBitError::Damage(_)));
            assert!(matches!(asked(bank_2 | offset), DoubleBitError::Damage(_)));
        }
        for offset in [0, 0x6_FFF8, 0x7_4000, 0x7_F7F8] {
            assert_eq!(asked(detected | bank_2 | offset), DoubleBitError::Damage(0x0808_0000 + offset));
        }
    }

    #[test]
    fn beside_a_bit_that_was_put_right_the_address_is_not_believed() {
        let records = 0x080F_0000..0x080F_4000;
        let both = 1 << 31 | 1 << 30;
        for at in [0x1230, 0xF_0000] {
            for are_read in [true, false] {
                let found = double_bit_error(both | at, core::slice::from_ref(&records), are_read);
                assert_eq!(found == DoubleBitError::Torn, are_read, "{at:#x}");
            }
        }
        let corrected = double_bit_error(1 << 30 | 0xF_0000, &[records], true);
        assert!(matches!(corrected, DoubleBitError::Damage(_)), "no word of which two bits are wrong");
    }
}
