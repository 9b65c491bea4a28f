//! Messages on a serial line: checksum, COBS, and a zero byte behind.
//!
//! In: a message. Out: bytes without a zero but the last, at most [`MAX_SERIAL`]; and back.
//!
//! ```text
//! COBS(message | crc32c) | 00
//! ```
//!
//! COBS (Cheshire and Baker, 1997) replaces every zero by the distance to the next one, so that a zero byte is nothing
//! but the end of a message. Whatever was lost or added, the decoder is in step again at the next zero: garbage costs
//! at most the one message that it ran into. Zeros in a row are fine, so a sender may begin with one to end what noise
//! began.
//!
//! A flip in the message's own bytes is found by the checksum for certain (up to five bits). A flip in one of the COBS
//! distances moves bytes, and one that makes or unmakes a zero cuts or joins messages; these meet the checksum as
//! arbitrary bytes and pass with a chance of 2^-32. `link_serial.rs` in `board-tests` tries every single and
//! double flip of some messages.

use super::checksum::{self, ChecksumError, LengthError};
use super::{Counters, Link, LinkError, MAX_CHECKED, MAX_MESSAGE, Message, count, write_whole};
use cobs::{DecodeResult, DecoderState};
use embedded_io::{Read, ReadReady, Write};
use heapless::Vec;

/// Largest message on the line: COBS adds one byte and one more for each 254, then comes the zero.
pub const MAX_SERIAL: usize = cobs::max_encoding_length(MAX_CHECKED) + 1;

/// Bytes of a full block of COBS: its code, 255, stands for no zero.
const FULL_BLOCK: usize = 254;

/// Bytes that one call of [`SerialLink::receive`] takes at most, so that a babbling line cannot hold up the caller.
const BYTES_PER_CALL: usize = 2 * MAX_SERIAL;

errors! {
    /// Why the bytes between two zeros are no message.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum SerialError {
        /// The zero came before the end that COBS had announced.
        Cobs { decoded: usize } => "message: expected the end that it announced, found a zero after {decoded} bytes",
        TooLong { capacity: usize } => "message: expected at most {capacity} bytes, found more",
        /// Too few bytes, or the wrong ones.
        Checksum(error: ChecksumError) => "{error}",
    }
}

impl SerialError {
    /// Counts the cause.
    pub fn count(self, counters: &mut Counters) {
        count(match self {
            Self::Cobs { .. } => &mut counters.coding,
            Self::TooLong { .. } => &mut counters.too_long,
            Self::Checksum(ChecksumError::TooShort { .. }) => &mut counters.too_short,
            Self::Checksum(ChecksumError::Mismatch { .. }) => &mut counters.checksum,
        });
    }
}

/// The bytes of one message on the line, with the zero behind.
///
/// # Errors
/// [`LengthError`] when the message is empty or too long.
///
/// ```
/// let bytes = rundown_wire::link::serial::encode(&[0x11, 0x00, 0x22]).unwrap();
/// // Two bytes on is the first zero, six on the end.
/// assert_eq!(bytes[..4], [0x02, 0x11, 0x06, 0x22]);
/// assert_eq!(bytes.last(), Some(&0));
/// ```
pub fn encode(message: &[u8]) -> Result<Vec<u8, MAX_SERIAL>, LengthError> {
    let error = LengthError { found: message.len() };
    if message.is_empty() || message.len() > MAX_MESSAGE {
        return Err(error);
    }
    let checksum = checksum::crc32c(message).to_le_bytes();
    // The buffer is made for the largest message, so nothing below fails.
    let mut bytes: Vec<u8, MAX_SERIAL> = Vec::new();
    // A third of what the encoder of `cobs` costs: nearly no message has a full block.
    for has_full_blocks in [false, true] {
        bytes.clear();
        bytes.push(0).map_err(|_| error)?;
        bytes.extend_from_slice(message).and_then(|()| bytes.extend_from_slice(&checksum)).map_err(|_| error)?;
        if has_full_blocks {
            end_full_blocks(&mut bytes).map_err(|_| error)?;
        }
        if zeros_to_distances(&mut bytes) <= FULL_BLOCK {
            break;
        }
    }
    bytes.push(0).map_err(|_| error)?;
    Ok(bytes)
}

/// Each zero becomes the distance to the next one, from behind. The longest.
fn zeros_to_distances(bytes: &mut [u8]) -> usize {
    let (mut next, mut longest) = (bytes.len(), 0);
    for (at, byte) in bytes.iter_mut().enumerate().rev() {
        if *byte == 0 {
            longest = longest.max(next - at);
            *byte = (next - at) as u8;
            next = at;
        }
    }
    longest
}

/// One more zero behind each full block, unless it ends the code.
fn end_full_blocks(bytes: &mut Vec<u8, MAX_SERIAL>) -> Result<(), u8> {
    let (mut block, mut at) = (0, 1);
    while at < bytes.len() {
        if block == FULL_BLOCK {
            bytes.push(0)?;
            bytes.iter_mut().skip(at).fold(0, |before, byte| core::mem::replace(byte, before));
            block = 0;
        } else {
            block = if bytes.get(at) == Some(&0) { 0 } else { block + 1 };
        }
        at += 1;
    }
    Ok(())
}

/// Takes bytes one by one and gives messages. `N` is the room for a message with its checksum.
#[derive(Debug, Default)]
pub struct Decoder<const N: usize = MAX_CHECKED> {
    cobs: DecoderState,
    checked: Vec<u8, N>,
    overflow: bool,
}

impl<const N: usize> Decoder<N> {
    /// A decoder at the start of a message.
    pub const fn new() -> Self {
        Self { cobs: DecoderState::Idle, checked: Vec::new(), overflow: false }
    }

    /// Takes the next byte. A zero ends a message, which is then given or refused; nothing between two zeros is no
    /// message and no error.
    ///
    /// # Errors
    /// [`SerialError`] at the zero that ends bytes that are no message. The decoder goes on with what follows.
    ///
    /// ```
    /// use rundown_wire::link::serial::{Decoder, encode};
    ///
    /// let mut decoder: Decoder = Decoder::new();
    /// for byte in [0x55, 0xAA, 0x00] {
    ///     let _garbage_is_refused_at_the_zero = decoder.push(byte);
    /// }
    /// let mut received = 0;
    /// for byte in encode(b"hello").unwrap() {
    ///     if let Ok(Some(message)) = decoder.push(byte) {
    ///         assert_eq!(message, b"hello");
    ///         received += 1;
    ///     }
    /// }
    /// assert_eq!(received, 1);
    /// ```
    pub fn push(&mut self, byte: u8) -> Result<Option<&[u8]>, SerialError> {
        match self.cobs.feed(byte) {
            Ok(DecodeResult::DataStart) => {
                self.checked.clear();
                self.overflow = false;
                Ok(None)
            }
            Ok(DecodeResult::DataContinue(decoded)) => {
                // Refused at the end only: the bytes until then belong to it.
                self.overflow |= self.checked.push(decoded).is_err();
                Ok(None)
            }
            Ok(DecodeResult::NoData) => Ok(None),
            Ok(DecodeResult::DataComplete) | Err(_) if self.overflow => Err(SerialError::TooLong { capacity: N }),
            Ok(DecodeResult::DataComplete) => checksum::check(&self.checked).map(Some).map_err(SerialError::Checksum),
            Err(_) => Err(SerialError::Cobs { decoded: self.checked.len() }),
        }
    }
}

/// A [`Link`] over a serial port.
///
/// On the board the port is the pair of rings between the UART's interrupt and the tasks. Its `write` is given a whole
/// message and must not wait: it takes what it has room for, nothing at all if it likes. The message is then lost
/// ([`LinkError::Full`]), and the next one begins with a zero that ends what went out of it.
#[derive(Debug)]
pub struct SerialLink<P> {
    port: P,
    decoder: Decoder,
    // A message was cut by a port that was full.
    cut: bool,
    counters: Counters,
}

impl<P> SerialLink<P> {
    /// A link over `port`.
    pub const fn new(port: P) -> Self {
        Self { port, decoder: Decoder::new(), cut: false, counters: Counters::ZERO }
    }

    /// The port below.
    pub const fn port_mut(&mut self) -> &mut P {
        &mut self.port
    }
}

impl<P: Read + ReadReady + Write> Link for SerialLink<P> {
    type PortError = P::Error;

    fn send(&mut self, message: &[u8], _now_us: u64) -> Result<(), LinkError<P::Error>> {
        let bytes = encode(message)?;
        if self.cut {
            write_whole(&mut self.port, &[0])?;
        }
        self.cut = true;
        write_whole(&mut self.port, &bytes)?;
        self.cut = false;
        self.port.flush().map_err(LinkError::Port)?;
        count(&mut self.counters.sent);
        Ok(())
    }

    fn receive(&mut self, _now_us: u64) -> Result<Option<Message>, LinkError<P::Error>> {
        for _ in 0..BYTES_PER_CALL {
            let mut byte = [0];
            if !self.port.read_ready().map_err(LinkError::Port)?
                || self.port.read(&mut byte).map_err(LinkError::Port)? == 0
            {
                return Ok(None);
            }
            let [byte] = byte;
            match self.decoder.push(byte) {
                Ok(None) => {}
                Ok(Some(bytes)) => match Message::from_slice(bytes) {
                    Ok(message) => {
                        count(&mut self.counters.received);
                        return Ok(Some(message));
                    }
                    // The decoder's buffer takes no more than MAX_MESSAGE and the checksum.
                    Err(_) => count(&mut self.counters.too_long),
                },
                Err(error) => error.count(&mut self.counters),
            }
        }
        Ok(None)
    }

    fn is_sending(&self) -> bool {
        false
    }

    fn counters(&self) -> Counters {
        self.counters
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the encoder of `cobs`.
    fn by_the_crate(message: &[u8]) -> Vec<u8, MAX_SERIAL> {
        let mut room = [0; MAX_SERIAL + 1];
        let mut encoder = cobs::CobsEncoder::new(&mut room);
        encoder.push(message).unwrap();
        encoder.push(&checksum::crc32c(message).to_le_bytes()).unwrap();
        let length = encoder.finalize();
        let mut bytes = Vec::from_slice(&room[..length]).unwrap();
        bytes.push(0).unwrap();
        bytes
    }

    #[test]
    fn messages_of_every_length_are_coded_as_the_crate_codes_them() {
        let mut message = [0; MAX_MESSAGE];
        // Zeros after so many bytes: none, each byte, about the length of a block.
        for every in [usize::MAX, 1, 2, 3, 100, 253, 254, 255, 256, 257, 508, 509] {
            for (place, byte) in message.iter_mut().enumerate() {
                *byte = if place % every == every - 1 { 0 } else { 1 + (place * 7 % 255) as u8 };
            }
            for length in 1..=MAX_MESSAGE {
                let message = &message[..length];
                assert_eq!(encode(message).unwrap(), by_the_crate(message), "{length} bytes, zeros every {every}");
            }
        }
    }

    #[test]
    fn a_code_that_ends_with_a_full_block_has_nothing_behind_it() {
        // 250 bytes and a checksum without zeros.
        let mut message = [1; 250];
        while checksum::crc32c(&message).to_le_bytes().contains(&0) {
            message[0] += 1;
        }
        let bytes = encode(&message).unwrap();
        assert_eq!((bytes.len(), bytes[0], bytes[255]), (256, 255, 0));
        assert_eq!(bytes, by_the_crate(&message));
    }
}
