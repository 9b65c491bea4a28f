//! RAM that behaves like the reference board's flash: pages of 2 KiB, double words, programmed once between two erasures. For the emulator, which has no flash controller:
//! on the mps2-an386 a file holds it over the loss of power, on the B-L475E-IOT01A it is lost.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

const PAGE: u32 = 2048;
/// Pages for records; `memory.x` has the same.
const PAGES: u32 = 8;

unsafe extern "C" {
    /// First byte of the records; the linker's symbol.
    static mut _records: u8;
}

/// Why the flash did not do it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Not aligned, or beyond the pages.
    Range(NorFlashErrorKind),
    /// A word that is not erased.
    Refused,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Range(kind) => *kind,
            Self::Refused => NorFlashErrorKind::Other,
        }
    }
}

/// The pages for records.
pub struct Flash;

impl Flash {
    /// RAM that was just switched on holds zeros: a flash is erased when it is new.
    pub fn start() -> Self {
        let size = PAGE * PAGES;
        if (0..size).all(|offset| Self::byte(offset) == 0) {
            (0..size).for_each(|offset| Self::put(offset, 0xFF));
        }
        Self
    }

    fn at(offset: u32) -> *mut u8 {
        // SAFETY: the callers have checked the range.
        unsafe { (&raw mut _records).add(offset as usize) }
    }

    fn byte(offset: u32) -> u8 {
        // SAFETY: as above; volatile, because it stands for a device.
        unsafe { Self::at(offset).read_volatile() }
    }

    fn put(offset: u32, byte: u8) {
        // SAFETY: as above.
        unsafe { Self::at(offset).write_volatile(byte) }
    }
}

impl ErrorType for Flash {
    type Error = FlashError;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        check_read(self, offset, bytes.len()).map_err(FlashError::Range)?;
        for (offset, byte) in (offset..).zip(bytes) {
            *byte = Self::byte(offset);
        }
        Ok(())
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
        for offset in from..to {
            Self::put(offset, 0xFF);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check_write(self, offset, bytes.len()).map_err(FlashError::Range)?;
        for (place, word) in (offset..).step_by(8).zip(bytes.chunks_exact(8)) {
            if (place..place + 8).any(|offset| Self::byte(offset) != 0xFF) {
                return Err(FlashError::Refused);
            }
            for (offset, byte) in (place..).zip(word) {
                Self::put(offset, *byte);
            }
        }
        Ok(())
    }
}
