//! The pages for records, programmed by double words, every word read back.
//!
//! A word is programmed once between two erasures. Power that goes away while a word is programmed or a page erased leaves bits that may read either way;
//! that is the caller's to survive (checksums, two places). Every wait is bounded.

use super::L475;
use super::device::FLASH;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use rundown::onboard::board::Board;
use rundown::onboard::clock::MOST_POLLS;

/// Page, bytes.
const PAGE: u32 = 2048;
/// Pages for records; `memory.x` has the same.
const PAGES: u32 = 8;
/// Where bank 2 begins.
const BANK_2: u32 = 0x0808_0000;
/// Unlock the control register, in this order.
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
/// All error flags of the status register (write 1 to clear), and the end of an operation.
const ERRORS: u32 = 0xC3FA;
const BUSY: u32 = 1 << 16;
/// An erasure takes up to 25 ms, 80 k polls of 25 cycles at 80 MHz.
const MOST_WAITS: u32 = 40 * MOST_POLLS;

unsafe extern "C" {
    /// First byte of the records; the linker's symbol, its address is the value.
    static _records: u8;
}

/// Why the flash did not do it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Not aligned, or beyond the pages.
    Range(NorFlashErrorKind),
    /// The controller did not finish in time, or could not be unlocked. The emulator has none.
    NoAnswer,
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
            _ => NorFlashErrorKind::Other,
        }
    }
}

/// The pages for records.
pub struct Flash {
    registers: FLASH,
}

impl Flash {
    pub fn new(registers: FLASH) -> Self {
        Self { registers }
    }

    fn unlocked(&mut self, work: impl FnOnce(&mut Self) -> Result<(), FlashError>) -> Result<(), FlashError> {
        self.wait()?;
        // SAFETY: flags and keys, no memory.
        self.registers.sr().write(|w| unsafe { w.bits(ERRORS) });
        for key in KEYS {
            // SAFETY: as above.
            self.registers.keyr().write(|w| unsafe { w.bits(key) });
        }
        let done = work(self);
        self.registers.cr().write(|w| w.lock().set_bit());
        done
    }

    fn wait(&self) -> Result<(), FlashError> {
        for _ in 0..MOST_WAITS {
            let status = self.registers.sr().read().bits();
            if status & BUSY == 0 {
                // Bit 0 is the end of an operation, not an error.
                let errors = status & ERRORS & !1;
                return if errors == 0 { Ok(()) } else { Err(FlashError::Refused(errors)) };
            }
        }
        Err(FlashError::NoAnswer)
    }

    fn base() -> *mut u8 {
        (&raw const _records).cast_mut()
    }

    fn byte(offset: u32) -> u8 {
        // SAFETY: the callers have checked the range; volatile, because the controller changes it.
        unsafe { Self::base().add(offset as usize).read_volatile() }
    }
}

impl ErrorType for Flash {
    type Error = FlashError;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        check_read(self, offset, bytes.len()).map_err(FlashError::Range)?;
        let before = L475::flash_errors();
        for (offset, byte) in (offset..).zip(bytes) {
            *byte = Self::byte(offset);
        }
        if L475::flash_errors() == before { Ok(()) } else { Err(FlashError::Torn) }
    }

    fn capacity(&self) -> usize {
        (PAGE * PAGES) as usize
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        check_erase(self, from, to).map_err(FlashError::Range)?;
        let first = (Self::base() as u32 - BANK_2) / PAGE;
        self.unlocked(|flash| {
            for page in from / PAGE..to / PAGE {
                let number = (first + page) as u8;
                flash.registers.cr().write(|w| {
                    // SAFETY: a page of the records, by the check above and `memory.x`.
                    unsafe { w.pnb().bits(number) };
                    w.bker().set_bit();
                    w.per().set_bit()
                });
                flash.registers.cr().modify(|_, w| w.start().set_bit());
                flash.wait()?;
            }
            Ok(())
        })?;
        if (from..to).all(|offset| Self::byte(offset) == 0xFF) { Ok(()) } else { Err(FlashError::ReadBack) }
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check_write(self, offset, bytes.len()).map_err(FlashError::Range)?;
        self.unlocked(|flash| {
            flash.registers.cr().write(|w| w.pg().set_bit());
            for (place, word) in (offset as usize..).step_by(8).zip(bytes.chunks_exact(8)) {
                let [a, b, c, d, e, f, g, h] = *word else {
                    continue;
                };
                // SAFETY: within the records and aligned by the check above. Two writes of 32 bits, the low one first, nothing between them.
                unsafe {
                    let to = Self::base().add(place).cast::<u32>();
                    to.write_volatile(u32::from_le_bytes([a, b, c, d]));
                    to.add(1).write_volatile(u32::from_le_bytes([e, f, g, h]));
                }
                flash.wait()?;
            }
            Ok(())
        })?;
        if (offset..).zip(bytes).all(|(offset, byte)| Self::byte(offset) == *byte) {
            Ok(())
        } else {
            Err(FlashError::ReadBack)
        }
    }
}
