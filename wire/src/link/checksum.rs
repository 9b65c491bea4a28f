//! A message with its CRC-32C, the same on every link.
//!
//! In: a message. Out: the message and four bytes, little endian.
//!
//! ```text
//! message | crc32c(message)        reflected polynomial 0x82F63B78, start and final xor 0xFFFFFFFF
//! ```
//!
//! CRC-32C finds every error of up to five bits in messages up to 655 bytes, and every burst of up to 32 bits (Koopman,
//! 32-Bit Cyclic Redundancy Codes for Internet Applications, DSN 2002).
//!
//! Over CAN, too, although each frame has a CRC of its own. ISO-TP has none over the message, and its sequence number
//! comes round after 16 frames; between controller and program the frame's CRC is gone, and SLCAN turns a flipped bit
//! of one hex digit into another hex digit. Four bytes close all three holes.

use super::{MAX_CHECKED, MAX_MESSAGE};
use heapless::Vec;

/// Bytes that the checksum adds.
pub const CHECKSUM_BYTES: usize = 4;

/// What half a byte does to the checksum.
const HALF_BYTES: [u32; 16] = {
    let mut table = [0; 16];
    let mut half = 0;
    while half < table.len() {
        let mut crc = half as u32;
        let mut bit = 0;
        while bit < 4 {
            crc = (crc >> 1) ^ (0x82F6_3B78 * (crc & 1));
            bit += 1;
        }
        table[half] = crc;
        half += 1;
    }
    table
};

/// The CRC-32C of bytes that come one after another. By halves of a byte: a table for whole ones takes 1 kB of the
/// board's flash.
#[derive(Clone, Copy, Debug)]
pub struct Crc32c(u32);

impl Crc32c {
    /// Of no bytes.
    pub const START: Self = Self(!0);

    /// Takes more bytes in.
    #[inline(never)]
    pub fn update(&mut self, bytes: &[u8]) {
        let mut crc = self.0;
        for &byte in bytes {
            crc ^= u32::from(byte);
            for _ in 0..2 {
                crc = (crc >> 4) ^ HALF_BYTES[crc as usize % 16];
            }
        }
        self.0 = crc;
    }

    /// Of all bytes so far.
    pub const fn value(self) -> u32 {
        !self.0
    }
}

errors! {
    /// A message that cannot be sent because of its length.
    #[derive(Eq)]
    pub struct LengthError { found: usize } => "expected 1 to {MAX_MESSAGE} bytes, found {found}";

    /// Why checked bytes are no message.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum ChecksumError {
        TooShort { found: usize } => "expected at least 5 bytes, found {found}",
        Mismatch { expected: u32, found: u32 } => "expected checksum {expected:08x}, found {found:08x}",
    }
}

/// CRC-32C of some bytes.
///
/// ```
/// assert_eq!(rundown_wire::link::checksum::crc32c(b"123456789"), 0xE306_9283);
/// ```
pub fn crc32c(bytes: &[u8]) -> u32 {
    let mut crc = Crc32c::START;
    crc.update(bytes);
    crc.value()
}

/// The message followed by its checksum.
///
/// # Errors
/// [`LengthError`] when it is empty or longer than [`MAX_MESSAGE`].
///
/// ```
/// let checked = rundown_wire::link::checksum::append(b"123456789").unwrap();
/// assert_eq!(checked, *b"123456789\x83\x92\x06\xE3");
/// assert_eq!(rundown_wire::link::checksum::check(&checked), Ok(&b"123456789"[..]));
/// ```
pub fn append(message: &[u8]) -> Result<Vec<u8, MAX_CHECKED>, LengthError> {
    let error = LengthError { found: message.len() };
    if message.is_empty() {
        return Err(error);
    }
    let mut checked = Vec::from_slice(message).map_err(|_| error)?;
    checked.extend_from_slice(&crc32c(message).to_le_bytes()).map_err(|_| error)?;
    Ok(checked)
}

/// The message within checked bytes.
///
/// # Errors
/// [`ChecksumError`] when they are too short or their checksum is another one.
pub fn check(checked: &[u8]) -> Result<&[u8], ChecksumError> {
    match checked.split_last_chunk::<CHECKSUM_BYTES>() {
        Some((message, checksum)) if !message.is_empty() => {
            let (expected, found) = (crc32c(message), u32::from_le_bytes(*checksum));
            if expected == found { Ok(message) } else { Err(ChecksumError::Mismatch { expected, found }) }
        }
        _ => Err(ChecksumError::TooShort { found: checked.len() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::MAX_MESSAGE;

    #[test]
    fn an_empty_message_does_not_exist() {
        assert_eq!(append(&[]), Err(LengthError { found: 0 }));
        // Four zeros are the empty message's checksum.
        assert_eq!(crc32c(&[]), 0);
        assert_eq!(check(&[0; 4]), Err(ChecksumError::TooShort { found: 4 }));
    }

    #[test]
    fn the_largest_message_fits_and_one_more_byte_does_not() {
        assert_eq!(append(&[7; MAX_MESSAGE]).unwrap().len(), MAX_CHECKED);
        for found in MAX_MESSAGE + 1..MAX_MESSAGE + 6 {
            assert_eq!(append(&[7; 600][..found]), Err(LengthError { found }));
        }
    }
}
