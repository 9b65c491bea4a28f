//! Messages over CAN: checksum, ISO-TP, one identifier for each direction.
//!
//! In: messages, a controller. Out: messages.
//!
//! The controller is anything with the non-blocking trait of `embedded-can` and [`CanFrame`]: a driver on the board,
//! [`Slcan`](super::slcan::Slcan) behind a serial line, a socket on a Linux host. Frames with other identifiers are
//! left alone, so the bus may be shared.

use super::can::{CanFrame, standard};
use super::checksum::{self, ChecksumError};
use super::isotp::pdu::{FrameData, Pdu, parse};
use super::isotp::{Config, ReceiveError, Receiver, SendError, Sender};
use super::{Counters, Link, LinkError, MAX_CHECKED, Message, count};
use embedded_can::{Frame, Id, nb::Can};

/// Frames to the board. CiA 301 uses neither 0x680 to 0x6DF nor, so high, anything that a brake or a door waits for.
pub const TO_BOARD: Id = standard(0x6D0);

/// Frames from the board.
pub const FROM_BOARD: Id = standard(0x6D1);

/// Frames that one call of [`CanLink::receive`] takes, and sends, at most, so that a babbling bus cannot hold up the
/// caller.
const FRAMES_PER_CALL: usize = 128;

/// A [`Link`] over a CAN controller.
#[derive(Debug)]
pub struct CanLink<C> {
    controller: C,
    config: Config,
    transmit_id: Id,
    receive_id: Id,
    sender: Sender<MAX_CHECKED>,
    receiver: Receiver<MAX_CHECKED>,
    // Flow control first: the other side waits for it.
    answer: Option<CanFrame>,
    frame: Option<CanFrame>,
    counters: Counters,
}

impl<C> CanLink<C> {
    /// The board's side.
    pub const fn board(controller: C, config: Config) -> Self {
        Self::new(controller, config, FROM_BOARD, TO_BOARD)
    }

    /// The host's side.
    pub const fn host(controller: C, config: Config) -> Self {
        Self::new(controller, config, TO_BOARD, FROM_BOARD)
    }

    /// A link with these identifiers.
    pub const fn new(controller: C, config: Config, transmit_id: Id, receive_id: Id) -> Self {
        Self {
            controller,
            config,
            transmit_id,
            receive_id,
            sender: Sender::new(config),
            receiver: Receiver::new(config),
            answer: None,
            frame: None,
            counters: Counters::ZERO,
        }
    }

    /// The controller below.
    pub const fn controller_mut(&mut self) -> &mut C {
        &mut self.controller
    }

    fn count_sent(&mut self, error: SendError) {
        count(match error {
            SendError::Timeout { .. } => &mut self.counters.timeout,
            SendError::FlowStatus { .. } => &mut self.counters.coding,
            SendError::Overflow | SendError::TooManyWaits | SendError::Busy | SendError::Length { .. } => {
                &mut self.counters.refused
            }
        });
    }

    fn count_received(&mut self, error: ReceiveError) {
        count(match error {
            ReceiveError::Sequence { .. } | ReceiveError::Interrupted { .. } => &mut self.counters.sequence,
            // The rest of a payload that has been counted, or frames of another sender.
            ReceiveError::NotStarted => return,
            ReceiveError::FrameLength { .. } => &mut self.counters.coding,
            ReceiveError::Overflow { .. } => &mut self.counters.too_long,
            ReceiveError::Timeout { .. } => &mut self.counters.timeout,
        });
    }

    fn frame_of(&mut self, data: &FrameData) -> Option<CanFrame> {
        let frame = CanFrame::try_new(self.transmit_id, self.config.format, data).ok();
        if frame.is_none() {
            // Cannot be reached: ISO-TP makes frames of the format's lengths.
            count(&mut self.counters.coding);
        }
        frame
    }

    fn on_frame(&mut self, frame: &CanFrame, now_us: u64) -> Option<Message> {
        if frame.id() != self.receive_id || frame.is_remote_frame() {
            return None;
        }
        let pdu = match parse(frame.data()) {
            Ok(Pdu::FlowControl(answer)) => {
                if let Err(error) = self.sender.on_flow_control(answer, now_us) {
                    self.count_sent(error);
                }
                return None;
            }
            Ok(pdu) => pdu,
            Err(_) => {
                count(&mut self.counters.coding);
                return None;
            }
        };
        let outcome = self.receiver.on_frame(pdu, frame.data().len(), now_us);
        if let Some(error) = outcome.dropped {
            self.count_received(error);
        }
        if let Some(answer) = outcome.answer {
            self.answer = self.frame_of(&answer.encode(self.config.format));
        }
        if !outcome.complete {
            return None;
        }
        match checksum::check(self.receiver.payload()) {
            Ok(message) => match Message::from_slice(message) {
                Ok(message) => {
                    count(&mut self.counters.received);
                    return Some(message);
                }
                // Cannot be reached: the receiver's buffer is a message and its checksum.
                Err(_) => count(&mut self.counters.too_long),
            },
            Err(ChecksumError::TooShort { .. }) => count(&mut self.counters.too_short),
            Err(ChecksumError::Mismatch { .. }) => count(&mut self.counters.checksum),
        }
        None
    }
}

impl<C: Can<Frame = CanFrame>> CanLink<C> {
    /// Sends what is due until the controller is full.
    fn transmit(&mut self, now_us: u64) -> Result<(), LinkError<C::Error>> {
        for _ in 0..FRAMES_PER_CALL {
            if self.answer.is_none() && self.frame.is_none() {
                match self.sender.next_frame(now_us) {
                    Ok(Some(data)) => self.frame = self.frame_of(&data),
                    Ok(None) => {}
                    Err(error) => self.count_sent(error),
                }
            }
            let is_answer = self.answer.is_some();
            let slot = if is_answer { &mut self.answer } else { &mut self.frame };
            let Some(frame) = slot.as_ref() else {
                return Ok(());
            };
            match self.controller.transmit(frame) {
                // A frame that a controller gives back had to make way for one of higher priority. All of ours have the
                // same, so there is none.
                Ok(_) => {
                    *slot = None;
                    if !is_answer {
                        self.sender.confirm(now_us);
                    }
                }
                Err(nb::Error::WouldBlock) => return Ok(()),
                Err(nb::Error::Other(error)) => return Err(LinkError::Port(error)),
            }
        }
        Ok(())
    }
}

impl<C: Can<Frame = CanFrame>> Link for CanLink<C> {
    type PortError = C::Error;

    fn send(&mut self, message: &[u8], now_us: u64) -> Result<(), LinkError<C::Error>> {
        let checked = checksum::append(message)?;
        if self.is_sending() {
            return Err(LinkError::Busy);
        }
        self.sender.start(&checked).map_err(|_| LinkError::Length { found: message.len() })?;
        count(&mut self.counters.sent);
        self.transmit(now_us)
    }

    fn receive(&mut self, now_us: u64) -> Result<Option<Message>, LinkError<C::Error>> {
        for _ in 0..FRAMES_PER_CALL {
            let frame = match self.controller.receive() {
                Ok(frame) => frame,
                Err(nb::Error::WouldBlock) => break,
                Err(nb::Error::Other(error)) => return Err(LinkError::Port(error)),
            };
            let message = self.on_frame(&frame, now_us);
            self.transmit(now_us)?;
            if message.is_some() {
                return Ok(message);
            }
        }
        if let Err(error) = self.receiver.check_time(now_us) {
            self.count_received(error);
        }
        self.transmit(now_us)?;
        Ok(None)
    }

    fn is_sending(&self) -> bool {
        !self.sender.is_idle() || self.frame.is_some()
    }

    fn counters(&self) -> Counters {
        self.counters
    }
}
