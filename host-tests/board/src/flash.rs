//! NOR flash as in an STM32L4, on the host: pages of 2 KiB, words of 8 bytes that are programmed once, and a supply
//! that can be cut at any operation.
//!
//! One word programmed, or one page erased, is one operation. The mock knows of each word whether it was wholly erased;
//! programming any other word is counted in [`Flash::violations`], also where the word happens to read as erased.

use crate::prelude::*;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

/// Bytes of a page.
pub const PAGE: usize = 2048;
/// Bytes of a word.
pub const WORD: usize = 8;

/// What the operation that was cut leaves behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutMode {
    /// It was not begun.
    NotDone,
    /// Its first half was done: half of the word, half of the page.
    HalfDone,
    /// Bits on the way are anything: those a word was to clear; in a page each word is erased, old, between, or noise.
    Indeterminate,
}

/// All three.
pub const CUT_MODES: [CutMode; 3] = [CutMode::NotDone, CutMode::HalfDone, CutMode::Indeterminate];

/// How a torn word reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TornReads {
    /// Always the same.
    Stable,
    /// Each undecided bit at random at every read.
    Unstable,
    /// As an uncorrectable ECC error.
    Fail,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Word {
    /// Erased in one uncut operation, not programmed since.
    Erased,
    Programmed,
    /// Left by a cut; the mask has the undecided bits.
    Torn(u64),
}

/// Why the flash did nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// The supply is cut.
    NoPower,
    /// A torn word was read.
    Ecc,
    /// The caller's mistake.
    Request(NorFlashErrorKind),
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::NoPower | Self::Ecc => NorFlashErrorKind::Other,
            Self::Request(kind) => *kind,
        }
    }
}

/// The flash. A clone is another chip with the same contents.
#[derive(Clone, Debug)]
pub struct Flash {
    values: Vec<u64>,
    words: Vec<Word>,
    cut: Option<(u64, CutMode)>,
    powered: bool,
    noise: ChaCha8Rng,
    /// How torn words read.
    pub torn_reads: TornReads,
    /// Writes and erases are acknowledged and do nothing, as in an emulator without a flash controller.
    pub swallows: bool,
    /// Words whose bits stay as they are when they are programmed: worn out.
    pub stuck_words: Vec<usize>,
    /// Operations so far.
    pub operations: u64,
    /// Words that were programmed though not erased.
    pub violations: u64,
    /// Erases of each page.
    pub erases: Vec<u64>,
}

impl Flash {
    /// Erased flash.
    pub fn erased(pages: usize) -> Self {
        let words = pages * PAGE / WORD;
        Self {
            values: vec![u64::MAX; words],
            words: vec![Word::Erased; words],
            cut: None,
            powered: true,
            noise: ChaCha8Rng::seed_from_u64(0),
            torn_reads: TornReads::Stable,
            swallows: false,
            stuck_words: Vec::new(),
            operations: 0,
            violations: 0,
            erases: vec![0; pages],
        }
    }

    /// Flash that was programmed with one byte all over.
    pub fn filled(pages: usize, byte: u8) -> Self {
        let mut flash = Self::erased(pages);
        flash.values.fill(u64::from_le_bytes([byte; WORD]));
        flash.words.fill(Word::Programmed);
        flash
    }

    /// Cuts the supply before this operation, counted from now: 0 is the next one. The seed is of the undecided bits.
    pub fn cut_before(&mut self, operation: u64, mode: CutMode, seed: u64) {
        self.cut = Some((self.operations + operation, mode));
        self.noise = ChaCha8Rng::seed_from_u64(seed);
    }

    /// Switches the supply on again; a cut that did not come is forgotten. Returns whether it came.
    pub fn power_up(&mut self) -> bool {
        self.cut = None;
        !std::mem::replace(&mut self.powered, true)
    }

    /// Flips one bit: rot.
    pub fn flip(&mut self, bit: usize) {
        self.values[bit / 64] ^= 1 << (bit % 64);
    }

    /// Bits of the whole flash that read 0 or 1 because they were programmed.
    pub fn programmed_bits(&self) -> impl Iterator<Item = usize> + '_ {
        let programmed = |word: &(usize, &Word)| *word.1 == Word::Programmed;
        self.words.iter().enumerate().filter(programmed).flat_map(|(word, _)| 64 * word..64 * (word + 1))
    }

    /// Counts an operation; tells if and how it is cut.
    fn begin(&mut self) -> Result<Option<CutMode>, FlashError> {
        if !self.powered {
            return Err(FlashError::NoPower);
        }
        let cut = self.cut.filter(|(at, _)| *at == self.operations);
        self.operations += 1;
        self.powered = cut.is_none();
        Ok(cut.map(|(_, mode)| mode))
    }

    fn program(&mut self, word: usize, value: u64) -> Result<(), FlashError> {
        let cut = self.begin()?;
        if cut != Some(CutMode::NotDone) && self.words[word] != Word::Erased {
            self.violations += 1;
        }
        let old = self.values[word];
        let value = if self.stuck_words.contains(&word) { old } else { value };
        (self.values[word], self.words[word]) = match cut {
            None => (old & value, Word::Programmed),
            Some(CutMode::NotDone) => return Err(FlashError::NoPower),
            Some(CutMode::HalfDone) => (old & (value | !0 << 32), Word::Torn(0)),
            Some(CutMode::Indeterminate) => {
                let undecided = old & !value;
                let noise = self.noise.next_u64();
                (old & (value | noise), Word::Torn(undecided))
            }
        };
        cut.map_or(Ok(()), |_| Err(FlashError::NoPower))
    }

    fn erase_page(&mut self, page: usize) -> Result<(), FlashError> {
        let cut = self.begin()?;
        let words = page * PAGE / WORD..(page + 1) * PAGE / WORD;
        if cut != Some(CutMode::NotDone) {
            self.erases[page] += 1;
        }
        for (i, word) in words.enumerate() {
            let old = self.values[word];
            (self.values[word], self.words[word]) = match cut {
                None => (u64::MAX, Word::Erased),
                Some(CutMode::NotDone) => continue,
                Some(CutMode::HalfDone) if i < PAGE / WORD / 2 => (u64::MAX, Word::Torn(0)),
                Some(CutMode::HalfDone) => continue,
                Some(CutMode::Indeterminate) => {
                    let noise = self.noise.next_u64();
                    match self.noise.random_range(0..4) {
                        0 => (u64::MAX, Word::Torn(0)),
                        1 => (old, Word::Torn(0)),
                        2 => (old | noise, Word::Torn(!old)),
                        _ => (noise, Word::Torn(u64::MAX)),
                    }
                }
            };
        }
        cut.map_or(Ok(()), |_| Err(FlashError::NoPower))
    }
}

impl ErrorType for Flash {
    type Error = FlashError;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        check_read(self, offset, bytes.len()).map_err(FlashError::Request)?;
        if !self.powered {
            return Err(FlashError::NoPower);
        }
        let (first, last) = (offset as usize / WORD, (offset as usize + bytes.len()).div_ceil(WORD));
        let mut words = Vec::with_capacity((last - first) * WORD);
        for word in first..last {
            let value = match (self.words[word], self.torn_reads) {
                (Word::Torn(_), TornReads::Fail) => return Err(FlashError::Ecc),
                (Word::Torn(undecided), TornReads::Unstable) => self.values[word] ^ (self.noise.next_u64() & undecided),
                _ => self.values[word],
            };
            words.extend(value.to_le_bytes());
        }
        bytes.copy_from_slice(&words[offset as usize % WORD..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.values.len() * WORD
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        check_erase(self, from, to).map_err(FlashError::Request)?;
        if self.swallows {
            return Ok(());
        }
        (from as usize / PAGE..to as usize / PAGE).try_for_each(|page| self.erase_page(page))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check_write(self, offset, bytes.len()).map_err(FlashError::Request)?;
        if self.swallows {
            return Ok(());
        }
        for (i, word) in bytes.chunks_exact(WORD).enumerate() {
            let value = word.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte));
            self.program(offset as usize / WORD + i, value)?;
        }
        Ok(())
    }
}
