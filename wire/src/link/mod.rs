//! Messages in and out of the board: over a serial line or over CAN, the same bytes.
//!
//! In and out: a *message*, 1 to [`MAX_MESSAGE`] bytes of any content. Below it, from the message down to the wire:
//!
//! ```text
//!            serial                                       CAN
//! message -> checksum -> COBS, 0x00 -> bytes     message -> checksum -> isotp -> can frames -> controller
//!            [checksum]  [serial]                           [checksum]  [isotp]  [can]      \-> slcan -> bytes
//! ```
//!
//! | question | module |
//! |---|---|
//! | is it the message that was sent? | [`checksum`]: CRC-32C, on both links |
//! | where does it begin and end on a serial line? | [`serial`]: COBS between zero bytes |
//! | how does it fit into frames of 8 or 64 bytes? | [`isotp`]: ISO 15765-2 with flow control |
//! | what is a frame? | [`can`]: classic and FD |
//! | what does the message link over CAN do? | [`can_link`] |
//! | what if the controller sits behind a serial line? | [`slcan`]: Lawicel ASCII |
//!
//! What arrives is either the message that was sent or nothing: whatever else comes is dropped and counted by cause
//! ([`Counters`]). A link neither repeats nor orders messages, and does not know who sent them; sequence, age and
//! origin are matters of the message's content.
//!
//! Nothing here waits, allocates or reads a clock. Time comes in as `now_us`, microseconds of any clock that only goes
//! forward; with 64 bits it never wraps. The state machines ([`serial::Decoder`], [`slcan::LineDecoder`],
//! [`isotp::Sender`], [`isotp::Receiver`]) know of no port; [`serial::SerialLink`] and [`can_link::CanLink`] tie them
//! to one.
//!
//! An empty message does not exist: ISO-TP has no frame for it, and its CRC-32C is four zero bytes, so that a single
//! flipped bit in front of a run of zeros would make one.
//!
//! `docs/link.md` shows the bytes.

pub mod can;
pub mod can_link;
pub mod checksum;
pub mod isotp;
pub mod serial;
pub mod slcan;

use core::fmt;
use serde::{Deserialize, Serialize};

pub use crate::envelope::MAX_MESSAGE;

/// Largest message with its checksum.
pub const MAX_CHECKED: usize = MAX_MESSAGE + checksum::CHECKSUM_BYTES;

/// A received message.
pub type Message = heapless::Vec<u8, MAX_MESSAGE>;

/// A link that carries messages. No call waits for the other side.
pub trait Link {
    /// How the port below fails.
    type PortError;

    /// Takes one message to be sent. Over CAN the rest of a long message leaves during later calls of
    /// [`receive`](Self::receive).
    ///
    /// # Errors
    /// [`LinkError::Busy`] while the message before is not out yet, [`LinkError::Length`] for a length that is none,
    /// and those of the port. In every case nothing of the message was taken for sent.
    fn send(&mut self, message: &[u8], now_us: u64) -> Result<(), LinkError<Self::PortError>>;

    /// The next message that arrived whole, if there is one. Does what is due on the link, so call it often.
    ///
    /// A damaged message is no error of the call: it is dropped and counted.
    ///
    /// # Errors
    /// Those of the port.
    fn receive(&mut self, now_us: u64) -> Result<Option<Message>, LinkError<Self::PortError>>;

    /// Whether a message taken by [`send`](Self::send) is still on its way out.
    fn is_sending(&self) -> bool;

    /// What happened so far.
    fn counters(&self) -> Counters;
}

impl<L: Link + ?Sized> Link for &mut L {
    type PortError = L::PortError;

    fn send(&mut self, message: &[u8], now_us: u64) -> Result<(), LinkError<L::PortError>> {
        (**self).send(message, now_us)
    }

    fn receive(&mut self, now_us: u64) -> Result<Option<Message>, LinkError<L::PortError>> {
        (**self).receive(now_us)
    }

    fn is_sending(&self) -> bool {
        (**self).is_sending()
    }

    fn counters(&self) -> Counters {
        (**self).counters()
    }
}

/// Why a call on a link failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LinkError<E> {
    /// The port below failed.
    Port(E),
    /// The port took a part of the message or nothing, and no more. What the other side has of it, it drops.
    Full,
    /// The message before is still on its way out.
    Busy,
    /// A message has 1 to [`MAX_MESSAGE`] bytes.
    Length {
        /// Bytes of the message.
        found: usize,
    },
}

impl<E: fmt::Display> fmt::Display for LinkError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(error) => write!(f, "port: {error}"),
            Self::Full => f.write_str("the port takes no more bytes"),
            Self::Busy => f.write_str("the message before is still being sent"),
            Self::Length { found } => write!(f, "expected 1 to {MAX_MESSAGE} bytes, found {found}"),
        }
    }
}

impl<E: core::error::Error> core::error::Error for LinkError<E> {}

impl<E> From<checksum::LengthError> for LinkError<E> {
    fn from(error: checksum::LengthError) -> Self {
        Self::Length { found: error.found }
    }
}

impl<E> From<WriteError<E>> for LinkError<E> {
    fn from(error: WriteError<E>) -> Self {
        match error {
            WriteError::Port(error) => Self::Port(error),
            WriteError::Full => Self::Full,
        }
    }
}

/// Why a port did not take all bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WriteError<E> {
    Port(E),
    Full,
}

/// Writes all bytes. `write_all` of `embedded-io` panics when the port takes nothing, which a full ring may well do.
pub(crate) fn write_whole<P: embedded_io::Write>(port: &mut P, mut bytes: &[u8]) -> Result<(), WriteError<P::Error>> {
    while !bytes.is_empty() {
        let taken = port.write(bytes).map_err(WriteError::Port)?;
        bytes = match bytes.get(taken..) {
            Some(rest) if taken > 0 => rest,
            _ => return Err(WriteError::Full),
        };
    }
    Ok(())
}

/// What a link has counted since it was made. Counts stay at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Messages taken to be sent.
    pub sent: u32,
    /// Messages received whole.
    pub received: u32,
    /// Dropped: the CRC-32C is another one.
    pub checksum: u32,
    /// Dropped: bytes or frames that the coding does not have (COBS, SLCAN, ISO-TP).
    pub coding: u32,
    /// Dropped: longer than the buffer.
    pub too_long: u32,
    /// Dropped: shorter than one byte and its checksum.
    pub too_short: u32,
    /// Dropped, CAN: a frame of the message was lost, came twice or out of order, or another message began before its
    /// end.
    pub sequence: u32,
    /// Dropped, CAN, received or sent: the other side fell silent within the message.
    pub timeout: u32,
    /// Dropped, CAN, sent: the other side has no room or asked to wait too often.
    pub refused: u32,
}

impl Counters {
    /// Nothing happened yet.
    pub const ZERO: Self = Self {
        sent: 0,
        received: 0,
        checksum: 0,
        coding: 0,
        too_long: 0,
        too_short: 0,
        sequence: 0,
        timeout: 0,
        refused: 0,
    };

    /// Those of two links together.
    #[inline]
    pub const fn and(&self, other: &Self) -> Self {
        Self {
            sent: self.sent.saturating_add(other.sent),
            received: self.received.saturating_add(other.received),
            checksum: self.checksum.saturating_add(other.checksum),
            coding: self.coding.saturating_add(other.coding),
            too_long: self.too_long.saturating_add(other.too_long),
            too_short: self.too_short.saturating_add(other.too_short),
            sequence: self.sequence.saturating_add(other.sequence),
            timeout: self.timeout.saturating_add(other.timeout),
            refused: self.refused.saturating_add(other.refused),
        }
    }
}

/// Adds one, and stays at the largest value.
pub(crate) fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A link with something to say of each call.
    struct Talking {
        sent: heapless::Vec<u8, 4>,
        is_sending: bool,
    }

    impl Link for Talking {
        type PortError = &'static str;

        fn send(&mut self, message: &[u8], _now_us: u64) -> Result<(), LinkError<&'static str>> {
            self.sent.extend_from_slice(message).map_err(|_| LinkError::Full)
        }

        fn receive(&mut self, _now_us: u64) -> Result<Option<Message>, LinkError<&'static str>> {
            Ok(Message::from_slice(b"heard").ok())
        }

        fn is_sending(&self) -> bool {
            self.is_sending
        }

        fn counters(&self) -> Counters {
            Counters { sent: 7, ..Counters::ZERO }
        }
    }

    /// What [`Link`] says, whoever it is.
    fn ask(mut link: impl Link<PortError = &'static str>) -> (Option<Message>, bool, u32) {
        link.send(b"ab", 0).unwrap();
        (link.receive(0).unwrap(), link.is_sending(), link.counters().sent)
    }

    #[test]
    fn a_borrowed_link_is_the_link() {
        for is_sending in [false, true] {
            let mut link = Talking { sent: heapless::Vec::new(), is_sending };
            assert_eq!(ask(&mut link), (Message::from_slice(b"heard").ok(), is_sending, 7));
            assert_eq!(link.sent, *b"ab");
        }
    }

    #[test]
    fn the_counts_of_two_links_add_up_and_stay_at_the_largest() {
        let counts = |[sent, received, checksum, coding, too_long, too_short, sequence, timeout, refused]: [u32; 9]| {
            Counters { sent, received, checksum, coding, too_long, too_short, sequence, timeout, refused }
        };
        let (one, other) = (counts([1, 2, 3, 4, 5, 6, 7, 8, 9]), counts([10, 20, 30, 40, 50, 60, 70, 80, 90]));
        assert_eq!(one.and(&other), counts([11, 22, 33, 44, 55, 66, 77, 88, 99]));
        assert_eq!(one.and(&counts([u32::MAX; 9])), counts([u32::MAX; 9]));
    }
}
