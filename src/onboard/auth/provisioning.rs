//! The key and where it comes from: a record of 64 bytes in a flash page of its own, written when the board is
//! provisioned, never part of an image.
//!
//! ```text
//! offset 0      4        6      8       12    28        36          60
//!        | magic | version | 0xFF | key id | key | train id | 0xFF ... | CRC-32C |
//! ```
//!
//! Little-endian. A page that was never written reads 0xFF: unprovisioned, and everything secured is refused.

use crate::onboard::bytes::take;
use crate::onboard::train_id::TrainId;
use core::fmt;
use rundown_wire::errors;
use rundown_wire::link::checksum::crc32c;

const MAGIC: [u8; 4] = *b"RDky";
const VERSION: u16 = 1;
/// Bytes of a record.
pub const SIZE: usize = 64;
const CRC_AT: usize = SIZE - 4;

/// An AES-128 key. Shown nowhere: `Debug` hides it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Key([u8; 16]);

impl Key {
    /// A key; 16 bytes of a cryptographic random source.
    pub const fn new(bytes: [u8; 16]) -> Self {
        Self(bytes)
    }

    pub(super) fn bytes(&self) -> [u8; 16] {
        self.0
    }
}

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Key(hidden)")
    }
}

/// What a board is given when it is put into a train.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Provisioning {
    /// Name of the key, to be shown; it says nothing of the key.
    pub key_id: u32,
    /// The key that this board shares with its operator, and with no other board.
    pub key: Key,
    /// The train.
    pub train: TrainId,
}

errors! {
    /// Why a board has no key.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum ProvisioningError {
        Unprovisioned => "provisioning: expected a key, found a page that was never written: `rundown provision` makes one",
        WrongMagic { found: [u8; 4] } => "provisioning: expected magic {MAGIC:?}, found {found:?}",
        Damaged => "provisioning: expected the CRC of its bytes, found another one: write it again",
        OtherVersion { expected: u16, found: u16 } => "provisioning: expected version {expected}, found {found}",
        TrivialKey => "provisioning: expected a random key, found equal bytes",
        Unreadable => "provisioning: flash could not be read",
    }
}

/// Where a board has its provisioning. A key that is read each time it is used stands in the flash, which a probe
/// cannot read from `RDP` level 1 on, and for that time on the stack, not in the variables, which it can.
pub trait KeySource {
    /// What the board was given.
    ///
    /// # Errors
    /// Why there is no key.
    fn provisioning(&self) -> Result<Provisioning, ProvisioningError>;
}

/// Read once.
impl KeySource for Result<Provisioning, ProvisioningError> {
    fn provisioning(&self) -> Result<Provisioning, ProvisioningError> {
        *self
    }
}

impl Provisioning {
    /// Reads a record.
    ///
    /// # Errors
    /// [`ProvisioningError`] says why there is no key.
    ///
    /// ```
    /// use rundown::onboard::auth::{Key, Provisioning, ProvisioningError};
    /// use rundown::onboard::train_id::TrainId;
    ///
    /// assert_eq!(Provisioning::from_bytes(&[0xFF; 64]), Err(ProvisioningError::Unprovisioned));
    ///
    /// let key = Key::new(*b"0123456789abcdef");
    /// let provisioning = Provisioning { key_id: 1, key, train: TrainId::of("2451") };
    /// assert_eq!(Provisioning::from_bytes(&provisioning.to_bytes()), Ok(provisioning));
    /// ```
    pub fn from_bytes(record: &[u8; SIZE]) -> Result<Self, ProvisioningError> {
        if record.iter().all(|byte| *byte == 0xFF) {
            return Err(ProvisioningError::Unprovisioned);
        }
        Self::parse(record).unwrap_or(Err(ProvisioningError::Damaged))
    }

    /// The fields cannot run out: they are shorter than the record.
    fn parse(record: &[u8; SIZE]) -> Option<Result<Self, ProvisioningError>> {
        let (covered, mut crc) = record.split_at_checked(CRC_AT)?;
        let mut bytes = covered;
        let found: [u8; 4] = take(&mut bytes)?;
        if found != MAGIC {
            return Some(Err(ProvisioningError::WrongMagic { found }));
        }
        if crc32c(covered) != u32::from_le_bytes(take(&mut crc)?) {
            return Some(Err(ProvisioningError::Damaged));
        }
        let version = u16::from_le_bytes(take(&mut bytes)?);
        let _reserved: [u8; 2] = take(&mut bytes)?;
        let key_id = u32::from_le_bytes(take(&mut bytes)?);
        let key: [u8; 16] = take(&mut bytes)?;
        let train = TrainId(u64::from_le_bytes(take(&mut bytes)?));
        Some(if version != VERSION {
            Err(ProvisioningError::OtherVersion { expected: VERSION, found: version })
        } else if key.iter().all(|byte| Some(byte) == key.first()) {
            Err(ProvisioningError::TrivialKey)
        } else {
            Ok(Self { key_id, key: Key(key), train })
        })
    }

    /// The record to be written to the board, by the tool that provisions it.
    pub fn to_bytes(&self) -> [u8; SIZE] {
        let fields = MAGIC
            .into_iter()
            .chain(VERSION.to_le_bytes())
            .chain([0xFF; 2])
            .chain(self.key_id.to_le_bytes())
            .chain(self.key.0)
            .chain(self.train.0.to_le_bytes());
        let mut covered = [0xFF; CRC_AT];
        covered.iter_mut().zip(fields).for_each(|(byte, field)| *byte = field);
        let whole = covered.into_iter().chain(crc32c(&covered).to_le_bytes());
        let mut record = [0xFF; SIZE];
        record.iter_mut().zip(whole).for_each(|(byte, of_whole)| *byte = of_whole);
        record
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECORD: Provisioning = Provisioning {
        key_id: 0x0403_0201,
        key: Key::new(*b"0123456789abcdef"),
        train: TrainId(0x0807_0605_0403_0201),
    };

    #[test]
    fn record_is_these_bytes() {
        let mut expected = [0xFF; SIZE];
        expected[..8].copy_from_slice(b"RDky\x01\x00\xFF\xFF");
        expected[8..12].copy_from_slice(&[1, 2, 3, 4]);
        expected[12..28].copy_from_slice(b"0123456789abcdef");
        expected[28..36].copy_from_slice(&[1, 2, 3, 4, 5, 6, 7, 8]);
        let crc = crc32c(&expected[..60]);
        expected[60..].copy_from_slice(&crc.to_le_bytes());
        assert_eq!(RECORD.to_bytes(), expected);
    }

    #[test]
    fn every_flipped_bit_is_found() {
        let good = RECORD.to_bytes();
        for bit in 0..8 * SIZE {
            let mut record = good;
            record[bit / 8] ^= 1 << (bit % 8);
            assert!(Provisioning::from_bytes(&record).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn zeroed_flash_trivial_keys_and_other_versions_are_named() {
        assert_eq!(Provisioning::from_bytes(&[0; SIZE]), Err(ProvisioningError::WrongMagic { found: [0; 4] }));
        for byte in [0x00, 0xFF] {
            let trivial = Provisioning { key: Key::new([byte; 16]), ..RECORD };
            assert_eq!(Provisioning::from_bytes(&trivial.to_bytes()), Err(ProvisioningError::TrivialKey));
        }
        let mut other = RECORD.to_bytes();
        other[4] = 2;
        let crc = crc32c(&other[..60]);
        other[60..].copy_from_slice(&crc.to_le_bytes());
        let refused = Provisioning::from_bytes(&other);
        let (expected, found) = (1, 2);
        assert_eq!(refused, Err(ProvisioningError::OtherVersion { expected, found }));
    }

    #[test]
    fn a_key_is_never_shown() {
        use core::fmt::Write;
        let mut shown = heapless::String::<256>::new();
        write!(shown, "{RECORD:?}").unwrap();
        assert!(shown.contains("Key(hidden)"), "{shown}");
        assert!(!shown.contains("48") && !shown.contains("0123"), "{shown}");
    }
}
