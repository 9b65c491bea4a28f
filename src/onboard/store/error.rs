//! Why something was not stored, or not given back.

use super::record::Identity;
use core::fmt;
use embedded_storage::nor_flash::NorFlashErrorKind;

/// The flash cannot hold a store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooFewPages {
    /// How many pages there must be.
    pub least: u32,
    /// How many there are.
    pub found: u32,
}

impl fmt::Display for TooFewPages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { least, found } = self;
        write!(f, "store: expected at least {least} flash pages, found {found}")
    }
}

impl core::error::Error for TooFewPages {}

/// Why a payload was not stored, after the second attempt. What was stored before is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum AppendError {
    /// The payload has `found` bytes, a slot takes `most`.
    TooLong {
        /// Largest payload.
        most: usize,
        /// Bytes of this one.
        found: usize,
    },
    /// The driver reported this.
    Driver(NorFlashErrorKind),
    /// A page was erased without error and still does not read as erased: the flash swallows erases, or is worn out.
    NotErased {
        /// The page.
        page: u32,
    },
    /// A record was written without error and reads otherwise: the flash swallows writes, or is worn out.
    NotWritten {
        /// Page of the slot.
        page: u32,
        /// The slot.
        slot: u32,
    },
}

impl fmt::Display for AppendError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong { most, found } => {
                write!(f, "payload: expected at most {most} bytes, found {found}")
            }
            Self::Driver(kind) => write!(f, "store: flash driver reported {kind:?}"),
            Self::NotErased { page } => {
                write!(f, "store: page {page} was erased but does not read as erased")
            }
            Self::NotWritten { page, slot } => {
                write!(f, "store: slot {slot} of page {page} does not read as written")
            }
        }
    }
}

impl core::error::Error for AppendError {}

/// Why what is stored is not given back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refused {
    /// The newest record is another train's.
    OtherTrain {
        /// Who asked.
        expected: Identity,
        /// Whose it is.
        found: Identity,
    },
    /// The newest record has another layout.
    OtherLayout {
        /// Who asked.
        expected: Identity,
        /// Whose it is.
        found: Identity,
    },
    /// There is no whole record, and so many slots with something else.
    Damaged {
        /// Slots that are neither erased nor hold a whole record.
        slots: u32,
    },
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherTrain { expected, found } | Self::OtherLayout { expected, found } => {
                write!(f, "record: expected that of {expected}, found {found}")
            }
            Self::Damaged { slots } => {
                write!(f, "store: no whole record, {slots} damaged slots")
            }
        }
    }
}

impl core::error::Error for Refused {}

/// Why there is no boot epoch. Whoever needs one must do without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EpochError {
    /// Something was stored, but no record with an epoch is left: a new one could repeat an old one.
    Lost {
        /// Slots that are neither erased nor hold a whole record.
        damaged_slots: u32,
    },
    /// All 2³² - 1 epochs were used.
    Exhausted,
    /// The new epoch could not be stored.
    NotStored(AppendError),
}

impl fmt::Display for EpochError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lost { damaged_slots } => {
                write!(f, "epoch: none of the stored ones is left, {damaged_slots} damaged slots")
            }
            Self::Exhausted => write!(f, "epoch: all are used"),
            Self::NotStored(error) => write!(f, "epoch: not stored: {error}"),
        }
    }
}

impl core::error::Error for EpochError {}
