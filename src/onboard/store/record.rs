//! One record as it lies in a slot.
//!
//! ```text
//! offset  0  4       6       8         12     16        24       24 + length
//!         +--+-------+-------+---------+------+---------+--------+--------+--------
//!         |magic|layout|length|sequence|epoch |train id |payload |CRC-32C | 0xFF ...
//!         +--+-------+-------+---------+------+---------+--------+--------+--------
//! ```
//!
//! Little-endian. The CRC covers all before it and is written last, so a record that was cut has none.

use crate::onboard::bytes::{put, take};
use crate::onboard::train_id::TrainId;
use core::fmt;
use rundown_wire::link::checksum::crc32c;

const MAGIC: [u8; 4] = *b"RDst";
/// Bytes before the payload.
const HEADER: usize = 24;
/// Bytes of a record that are not payload.
pub const OVERHEAD: usize = HEADER + 4;
/// What erased flash reads as.
pub(super) const ERASED: u8 = 0xFF;

/// What a payload is of: it is given back only to the one who asks for the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The train that it describes.
    pub train: TrainId,
    /// Version of the payload's layout.
    pub layout: u16,
}

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "train {}, layout {}", self.train, self.layout)
    }
}

/// What stands before the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub identity: Identity,
    pub sequence: u32,
    pub epoch: u32,
    pub length: u16,
}

impl Header {
    /// This record is later than the other. Serial arithmetic (RFC 1982): the sequence may wrap.
    pub fn is_later_than(&self, other: &Self) -> bool {
        let ahead = self.sequence.wrapping_sub(other.sequence);
        ahead != 0 && ahead < 1 << 31
    }
}

/// Writes a record to the front of a slot, erased bytes behind it. Returns its length; `None`: it does not fit.
pub(super) fn encode(slot: &mut [u8], header: &Header, payload: &[u8]) -> Option<usize> {
    slot.fill(ERASED);
    let length = HEADER + payload.len();
    let mut space = &mut *slot;
    put(&mut space, &MAGIC)?;
    put(&mut space, &header.identity.layout.to_le_bytes())?;
    put(&mut space, &header.length.to_le_bytes())?;
    put(&mut space, &header.sequence.to_le_bytes())?;
    put(&mut space, &header.epoch.to_le_bytes())?;
    put(&mut space, &header.identity.train.0.to_le_bytes())?;
    put(&mut space, payload)?;
    let crc = crc32c(slot.get(..length)?).to_le_bytes();
    put(&mut slot.get_mut(length..)?, &crc)?;
    Some(length + crc.len())
}

/// Reads the record in a slot: its header and payload. `None`: it is not a whole record.
pub(super) fn decode(slot: &[u8]) -> Option<(Header, &[u8])> {
    let mut bytes = slot;
    if take(&mut bytes)? != MAGIC {
        return None;
    }
    let layout = u16::from_le_bytes(take(&mut bytes)?);
    let length = u16::from_le_bytes(take(&mut bytes)?);
    let sequence = u32::from_le_bytes(take(&mut bytes)?);
    let epoch = u32::from_le_bytes(take(&mut bytes)?);
    let train = TrainId(u64::from_le_bytes(take(&mut bytes)?));
    let (payload, mut bytes) = bytes.split_at_checked(usize::from(length))?;
    let crc = u32::from_le_bytes(take(&mut bytes)?);
    if crc32c(slot.get(..HEADER + payload.len())?) != crc {
        return None;
    }
    let header = Header { identity: Identity { train, layout }, sequence, epoch, length };
    Some((header, payload))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER_OF_THREE: Header = Header {
        identity: Identity { train: TrainId(0x0807_0605_0403_0201), layout: 2 },
        sequence: 0x0D0C_0B0A,
        epoch: 5,
        length: 3,
    };

    #[test]
    fn record_is_these_bytes() {
        let mut slot = [0; 32];
        assert_eq!(encode(&mut slot, &HEADER_OF_THREE, b"abc"), Some(31));
        let before_crc =
            [b'R', b'D', b's', b't', 2, 0, 3, 0, 10, 11, 12, 13, 5, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, b'a', b'b', b'c'];
        assert_eq!(slot[..27], before_crc);
        assert_eq!(slot[31], ERASED);
        assert_eq!(decode(&slot), Some((HEADER_OF_THREE, b"abc".as_slice())));
    }

    #[test]
    fn every_flipped_bit_of_a_record_is_found() {
        let mut slot = [0; 32];
        let length = encode(&mut slot, &HEADER_OF_THREE, b"abc").unwrap();
        for bit in 0..8 * length {
            slot[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(decode(&slot), None, "bit {bit}");
            slot[bit / 8] ^= 1 << (bit % 8);
        }
    }

    #[test]
    fn a_record_longer_than_its_slot_does_not_fit() {
        assert_eq!(encode(&mut [0; 30], &HEADER_OF_THREE, b"abc"), None);
        assert_eq!(encode(&mut [0; 20], &HEADER_OF_THREE, b"abc"), None);
    }

    #[test]
    fn later_goes_over_the_wrap() {
        let at = |sequence| Header { sequence, ..HEADER_OF_THREE };
        assert!(at(1).is_later_than(&at(0)));
        assert!(at(2).is_later_than(&at(u32::MAX)));
        assert!(!at(u32::MAX).is_later_than(&at(2)));
        assert!(!at(7).is_later_than(&at(7)));
    }
}
