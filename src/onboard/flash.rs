//! Memory that plays the pages for records where there is no flash: in the emulator, on the host, in a demonstration.
//!
//! As the reference board's: pages of 2 KiB, words of 8 bytes that are programmed once between two erasures, erased
//! bytes are `0xFF`.

use core::sync::atomic::{Ordering, compiler_fence};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

/// Bytes of a page.
pub const PAGE: usize = 2048;
/// Bytes of a word.
pub const WORD: usize = 8;
/// Bytes of the pages for records; `memory.x` has the same.
pub const RECORDS: usize = 8 * PAGE;

/// Where the bytes are.
pub trait Memory: AsRef<[u8]> + AsMut<[u8]> {
    /// Called after each change: makes it last. False when it does not.
    fn keep(&mut self) -> bool {
        true
    }
}

impl Memory for [u8; RECORDS] {}
impl Memory for &mut [u8; RECORDS] {}

/// Memory as a flash. Whole pages.
#[derive(Clone, Debug)]
pub struct MemoryFlash<M>(M);

/// Why the flash did not do it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryFlashError {
    /// Not aligned, or beyond the pages.
    Range(NorFlashErrorKind),
    /// A word that is not erased.
    NotErased,
    /// [`Memory::keep`] failed.
    NotKept,
}

impl NorFlashError for MemoryFlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Range(kind) => *kind,
            Self::NotErased | Self::NotKept => NorFlashErrorKind::Other,
        }
    }
}

impl MemoryFlash<[u8; RECORDS]> {
    /// A new flash, erased.
    pub const ERASED: Self = Self([0xFF; RECORDS]);
}

impl<M: Memory> MemoryFlash<M> {
    /// Memory that was just switched on holds zeros: a flash is erased when it is new.
    pub fn new(mut memory: M) -> Self {
        let bytes = memory.as_mut();
        if bytes.iter().all(|byte| *byte == 0) {
            bytes.fill(0xFF);
        }
        Self(memory)
    }

    fn change(
        &mut self,
        offset: u32,
        length: usize,
        change: impl FnOnce(&mut [u8]) -> Result<(), MemoryFlashError>,
    ) -> Result<(), MemoryFlashError> {
        let from = offset as usize;
        let bytes = self.0.as_mut().get_mut(from..from + length);
        change(bytes.ok_or(MemoryFlashError::Range(NorFlashErrorKind::OutOfBounds))?)?;
        self.0.keep().then_some(()).ok_or(MemoryFlashError::NotKept)
    }
}

impl<M: Memory> ErrorType for MemoryFlash<M> {
    type Error = MemoryFlashError;
}

impl<M: Memory> ReadNorFlash for MemoryFlash<M> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), MemoryFlashError> {
        check_read(self, offset, bytes.len()).map_err(MemoryFlashError::Range)?;
        let from = offset as usize;
        let found = self.0.as_ref().get(from..from + bytes.len());
        bytes.copy_from_slice(found.ok_or(MemoryFlashError::Range(NorFlashErrorKind::OutOfBounds))?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.as_ref().len()
    }
}

impl<M: Memory> NorFlash for MemoryFlash<M> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), MemoryFlashError> {
        check_erase(self, from, to).map_err(MemoryFlashError::Range)?;
        self.change(from, (to - from) as usize, |page| {
            page.fill(0xFF);
            Ok(())
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), MemoryFlashError> {
        check_write(self, offset, bytes.len()).map_err(MemoryFlashError::Range)?;
        self.change(offset, bytes.len(), |place| {
            for (place, word) in place.chunks_exact_mut(WORD).zip(bytes.chunks_exact(WORD)) {
                if place.iter().any(|byte| *byte != 0xFF) {
                    return Err(MemoryFlashError::NotErased);
                }
                place.copy_from_slice(word);
                // The order of the words is the device's, whatever a supply that goes away leaves of them.
                compiler_fence(Ordering::SeqCst);
            }
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_programmed_once_between_two_erasures() {
        let mut memory = [0; RECORDS];
        let mut flash = MemoryFlash::new(&mut memory);
        assert_eq!(flash.write(PAGE as u32, &[1; 2 * WORD]), Ok(()));
        assert_eq!(flash.write((PAGE + WORD) as u32, &[1; WORD]), Err(MemoryFlashError::NotErased));
        assert_eq!(flash.erase(0, PAGE as u32), Ok(()));
        let mut found = [0; 3];
        flash.read(PAGE as u32 + 15, &mut found).unwrap();
        assert_eq!(found, [1, 0xFF, 0xFF]);
        assert_eq!(flash.erase(PAGE as u32, 2 * PAGE as u32), Ok(()));
        assert_eq!(flash.write(PAGE as u32, &[2; WORD]), Ok(()));
    }

    #[test]
    fn what_lies_outside_or_across_words_is_refused() {
        let mut flash = MemoryFlash::ERASED;
        assert_eq!(flash.capacity(), RECORDS);
        for refused in [
            flash.write(4, &[0; WORD]),
            flash.write(RECORDS as u32, &[0; WORD]),
            flash.erase(0, 8),
            flash.read(RECORDS as u32, &mut [0]),
        ] {
            assert!(matches!(refused, Err(MemoryFlashError::Range(_))), "{refused:?}");
        }
    }
}
