//! Why a message is refused, or cannot be sealed.

use super::provisioning::ProvisioningError;
use crate::onboard::store::EpochError;
use core::fmt;

/// Why a secured message was refused. Nothing was changed by it; the caller counts it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// The board has no key.
    Unprovisioned(ProvisioningError),
    /// The board has no epoch for this boot.
    NoEpoch(EpochError),
    /// Too short to hold a trailer.
    WrongLength {
        /// Fewest bytes.
        least: usize,
        /// Bytes of this one.
        found: usize,
    },
    /// The MAC is not of this message, kind, direction, train, freshness and key.
    WrongMac,
    /// Rightly signed, but for another boot.
    OtherEpoch {
        /// Epoch of the board.
        expected: u32,
        /// Epoch of the message.
        found: u32,
    },
    /// Rightly signed, but not newer than what was accepted already.
    Stale {
        /// Counter that was accepted last.
        last: u32,
        /// Counter of the message.
        found: u32,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unprovisioned(cause) => write!(f, "auth: no key: {cause}"),
            Self::NoEpoch(cause) => write!(f, "auth: no epoch: {cause}"),
            Self::WrongLength { least, found } => {
                write!(f, "message: expected at least {least} bytes, found {found}")
            }
            Self::WrongMac => write!(f, "auth: wrong MAC"),
            Self::OtherEpoch { expected, found } => {
                write!(f, "epoch: expected {expected}, found {found}")
            }
            Self::Stale { last, found } => {
                write!(f, "counter: expected above {last}, found {found}")
            }
        }
    }
}

impl core::error::Error for Refusal {}

/// Why a message was not sealed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SealError {
    /// The buffer is too short for message and trailer.
    BufferTooShort {
        /// Bytes that are needed.
        least: usize,
        /// Bytes of the buffer.
        found: usize,
    },
    /// All counters of this epoch are used: restart the board.
    CounterExhausted,
}

impl fmt::Display for SealError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BufferTooShort { least, found } => {
                write!(f, "buffer: expected at least {least} bytes, found {found}")
            }
            Self::CounterExhausted => {
                write!(f, "auth: all counters of this epoch are used, restart the board")
            }
        }
    }
}

impl core::error::Error for SealError {}
