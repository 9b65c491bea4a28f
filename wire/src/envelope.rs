//! A message: one byte for the version, then one value in postcard.
//!
//! The version changes only when bytes of a frame that was released would be read as something else. New frames are
//! appended to the enums under the same version; a receiver that does not know one counts it and goes on.

use postcard::ser_flavors::Flavor;
use serde::{Serialize, de::DeserializeOwned};

/// Version of the messages that this library writes; it reads this one.
pub const VERSION: u8 = 1;

/// Largest message, bytes. With its checksum below the 655 bytes up to which CRC-32C finds any five flipped bits.
pub const MAX_MESSAGE: usize = 512;

errors! {
    /// Why a message was not read.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum DecodeError {
        Empty => "message: expected a version, found nothing",
        Version { found: u8 } => "message: expected version {VERSION}, found {found}",
        /// An unknown frame, a value that cannot be, or the end of the message inside a frame.
        Malformed => "message: expected a frame of version {VERSION}, found an unknown or a cut one",
        TooLong { left: usize } => "message: expected its end behind the frame, found {left} bytes more",
    }

    /// The buffer is shorter than the message.
    #[derive(Eq)]
    pub struct EncodeError => "buffer: expected room for the message, at most {MAX_MESSAGE} bytes, found less";
}

/// Writes version and value; gives back the part of the buffer that was written.
///
/// # Errors
/// [`EncodeError`]: the buffer is too short.
pub fn encode<'a, T: Serialize>(value: &T, buffer: &'a mut [u8]) -> Result<&'a [u8], EncodeError> {
    let mut message = Writing { buffer, length: 0 };
    message.append(&[VERSION]);
    let length = postcard::serialize_with_flavor(value, message).map_err(|_| EncodeError)?;
    buffer.get(..length).ok_or(EncodeError)
}

/// A message that is being written. What finds no room is counted, and no write fails: on the board a check behind each
/// of some 200 fields would take 3 kB.
struct Writing<'a> {
    buffer: &'a mut [u8],
    length: usize,
}

impl Writing<'_> {
    // Of its own, for the same reason.
    #[inline(never)]
    fn append(&mut self, bytes: &[u8]) {
        let end = self.length + bytes.len();
        if let Some(free) = self.buffer.get_mut(self.length..end) {
            free.copy_from_slice(bytes);
        }
        self.length = end;
    }
}

impl Flavor for Writing<'_> {
    type Output = usize;

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.append(&[byte]);
        Ok(())
    }

    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        self.append(bytes);
        Ok(())
    }

    fn finalize(self) -> postcard::Result<usize> {
        Ok(self.length)
    }
}

/// Reads a whole message.
///
/// # Errors
/// [`DecodeError`]; nothing panics, whatever the bytes are.
pub fn decode<T: DeserializeOwned>(message: &[u8]) -> Result<T, DecodeError> {
    let (&version, rest) = message.split_first().ok_or(DecodeError::Empty)?;
    if version != VERSION {
        return Err(DecodeError::Version { found: version });
    }
    match postcard::take_from_bytes(rest) {
        Ok((value, [])) => Ok(value),
        Ok((_, left)) => Err(DecodeError::TooLong { left: left.len() }),
        Err(_) => Err(DecodeError::Malformed),
    }
}
