//! Which train: a short number made of the operator's name for it, carried by every stored record and entering every
//! MAC.

use core::fmt;
use crc::{CRC_64_XZ, Crc, NoTable};

/// CRC without a table: a name is hashed once, so 2 KiB of flash are not worth it.
const HASH: Crc<u64, NoTable> = Crc::<u64, NoTable>::new(&CRC_64_XZ);

/// Hash of a train's id. Separates trains; it does not authenticate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrainId(pub u64);

impl TrainId {
    /// CRC-64/XZ of the id as UTF-8, as common tools compute it too.
    ///
    /// ```
    /// use rundown::onboard::train_id::TrainId;
    ///
    /// assert_eq!(TrainId::of("123456789"), TrainId(0x995D_C9BB_DF19_39FA)); // check value of the CRC catalogue
    /// assert_ne!(TrainId::of("2451"), TrainId::of("2452"));
    /// ```
    pub fn of(id: &str) -> Self {
        Self(HASH.checksum(id.as_bytes()))
    }
}

impl fmt::Display for TrainId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}
