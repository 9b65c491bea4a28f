//! The board's messages over CAN: those that wait, one after the other into a [`CanLink`], and what comes back.
//!
//! In: the frames of the serial line, which both lines carry alike. Out: messages of the other side. Messages wait in
//! an [`Outbox`]: when the bus does not take them the oldest goes, so that the newest estimate is the one that is sent.

use crate::link::can::CanFrame;
use crate::link::can_link::CanLink;
use crate::link::isotp::Config;
use crate::link::serial::Decoder;
use crate::link::{Counters, Link, Message};
use crate::onboard::outbox::{NoRoom, Outbox, WhenFull};
use embedded_can::nb::Can;

/// A line over the controller `C`, with `N` bytes for messages that wait.
pub struct CanLine<C, const N: usize> {
    link: CanLink<C>,
    waiting: Outbox<N>,
    decoder: Decoder,
}

impl<C, const N: usize> CanLine<C, N> {
    /// The board's side, with classic frames.
    pub const fn new(controller: C) -> Self {
        Self { link: CanLink::board(controller, Config::CLASSIC), waiting: Outbox::new(), decoder: Decoder::new() }
    }

    /// Takes a message as the serial line has it, delimiter included.
    ///
    /// # Errors
    /// [`NoRoom`]: it would not fit into an empty line, or not without dropping another.
    pub fn push(&mut self, frame: &[u8], when_full: WhenFull) -> Result<(), NoRoom> {
        self.waiting.push(frame, when_full)
    }

    /// Messages that had to make way for newer ones.
    pub fn dropped(&self) -> u32 {
        self.waiting.dropped()
    }
}

impl<C: Can<Frame = CanFrame>, const N: usize> CanLine<C, N> {
    /// Sends what is due and gives the next message that came. To be called again while it gives one, and while
    /// [`is_due`](Self::is_due).
    pub fn exchange(&mut self, now_us: u64) -> Option<Message> {
        if self.is_due() {
            self.send_next(now_us);
        }
        // The controller's errors are counted where they arise.
        self.link.receive(now_us).ok().flatten()
    }

    /// A message waits and could go now.
    pub fn is_due(&self) -> bool {
        !self.link.is_sending() && !self.waiting.is_empty()
    }

    /// What the link has counted.
    pub fn counters(&self) -> Counters {
        self.link.counters()
    }

    fn send_next(&mut self, now_us: u64) {
        while let Some(byte) = self.waiting.pop() {
            // A frame that was cut short is none; the next one follows.
            if let Ok(Some(message)) = self.decoder.push(byte) {
                // It is not busy, and the length was right for the serial line.
                let _ = self.link.send(message, now_us);
                return;
            }
        }
    }
}
