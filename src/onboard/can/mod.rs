//! CAN on the board: frames between a bxCAN controller and the link task, through two bounded queues, so that nobody
//! waits for the other.
//!
//! ```text
//! bus <-> mailboxes <-- interrupt: Bxcan::serve --> queues <-- link task: Ends --> CanLink --> messages
//! ```
//!
//! | question | module |
//! |---|---|
//! | which bit timing? | [`timing`] |
//! | which registers, in which order? | [`bxcan`] |
//! | which message goes next? | [`mod@line`] |
//!
//! Classic frames with the identifiers of [`can_link`](crate::link::can_link); the controller drops all others itself.

pub mod bxcan;
pub mod line;
pub mod timing;

use crate::link::can::{CLASSIC_BYTES, CanFrame, Format};
use embedded_can::{ErrorKind, ExtendedId, Frame, Id, StandardId, nb::Can};
use embedded_hal_nb::nb;
use heapless::spsc::{Consumer, Producer};

/// A frame as the controller's mailboxes hold it: 16 bytes, where a [`CanFrame`] has room for FD.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mailbox {
    /// Identifier and kind: RIR, and TIR without the request.
    pub identifier: u32,
    /// Data length code.
    pub length: u32,
    /// Data bytes 0 to 3 and 4 to 7, the lowest first.
    pub data: [u32; 2],
}

const STANDARD_SHIFT: u32 = 21;
const EXTENDED_SHIFT: u32 = 3;
const EXTENDED: u32 = 1 << 2;
const REMOTE: u32 = 1 << 1;
const LENGTH: u32 = 0xF;

impl Mailbox {
    /// The mailbox of a frame; none for FD, which the controller does not have.
    pub fn of(frame: &CanFrame) -> Option<Self> {
        let identifier = match frame.id() {
            Id::Standard(id) => u32::from(id.as_raw()) << STANDARD_SHIFT,
            Id::Extended(id) => id.as_raw() << EXTENDED_SHIFT | EXTENDED,
        };
        let kind = match frame.format() {
            Some(Format::Classic) => 0,
            Some(Format::Fd { .. }) => return None,
            None => REMOTE,
        };
        let mut bytes = [0; CLASSIC_BYTES];
        for (to, byte) in bytes.iter_mut().zip(frame.data()) {
            *to = *byte;
        }
        let bits = u64::from_le_bytes(bytes);
        let length = u32::try_from(frame.dlc()).ok()?;
        Some(Self { identifier: identifier | kind, length, data: [bits as u32, (bits >> 32) as u32] })
    }

    /// The frame of a mailbox. A length code above 8 means 8 bytes, as ISO 11898-1 has it.
    pub fn frame(&self) -> Option<CanFrame> {
        let id = if self.identifier & EXTENDED != 0 {
            Id::Extended(ExtendedId::new(self.identifier >> EXTENDED_SHIFT)?)
        } else {
            Id::Standard(StandardId::new((self.identifier >> STANDARD_SHIFT) as u16)?)
        };
        let length = (self.length & LENGTH).min(CLASSIC_BYTES as u32) as usize;
        if self.identifier & REMOTE != 0 {
            return CanFrame::new_remote(id, length);
        }
        let [low, high] = self.data;
        let bytes = (u64::from(high) << 32 | u64::from(low)).to_le_bytes();
        CanFrame::try_new(id, Format::Classic, bytes.get(..length)?).ok()
    }
}

/// The link task's ends of the queues: a controller for [`CanLink`](crate::link::can_link::CanLink).
pub struct Ends<'a> {
    /// Frames that came.
    pub incoming: Consumer<'a, Mailbox>,
    /// Frames that are to go. After a frame was put in, somebody must wake the interrupt.
    pub outgoing: Producer<'a, Mailbox>,
}

impl Can for Ends<'_> {
    type Frame = CanFrame;
    type Error = ErrorKind;

    fn transmit(&mut self, frame: &CanFrame) -> nb::Result<Option<CanFrame>, ErrorKind> {
        let mailbox = Mailbox::of(frame).ok_or(nb::Error::Other(ErrorKind::Other))?;
        self.outgoing.enqueue(mailbox).map_err(|_| nb::Error::WouldBlock)?;
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<CanFrame, ErrorKind> {
        let mailbox = self.incoming.dequeue().ok_or(nb::Error::WouldBlock)?;
        mailbox.frame().ok_or(nb::Error::Other(ErrorKind::Other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mailbox_has_the_bits_of_the_manual() {
        let id = StandardId::new(0x6D0).unwrap();
        let frame = CanFrame::new(id, &[0x10, 0x18, 1, 2, 3, 4]).unwrap();
        let mailbox = Mailbox::of(&frame).unwrap();
        assert_eq!(mailbox, Mailbox { identifier: 0xDA00_0000, length: 6, data: [0x0201_1810, 0x0403] });
        assert_eq!(mailbox.frame(), Some(frame));
    }

    #[test]
    fn extended_and_remote_frames_come_back_as_they_were() {
        let extended = ExtendedId::new(0x1ABC_DEF0).unwrap();
        for frame in [
            CanFrame::new(extended, &[]).unwrap(),
            CanFrame::new(extended, &[0xFF; 8]).unwrap(),
            CanFrame::new_remote(extended, 8).unwrap(),
            CanFrame::new_remote(StandardId::MAX, 0).unwrap(),
        ] {
            assert_eq!(Mailbox::of(&frame).and_then(|mailbox| mailbox.frame()), Some(frame));
        }
    }

    #[test]
    fn a_frame_of_fd_has_no_mailbox_and_a_length_above_eight_is_eight() {
        let fd = CanFrame::try_new(StandardId::ZERO, Format::Fd { bit_rate_switch: false }, &[1; 12]).unwrap();
        assert_eq!(Mailbox::of(&fd), None);
        let mailbox = Mailbox { length: 15, ..Mailbox::default() };
        assert_eq!(mailbox.frame().unwrap().data(), [0; 8]);
    }
}
