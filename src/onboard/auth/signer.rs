//! The sender's side: on the desk, in the operator's back office, in tests.

use super::error::{Refusal, SealError};
use super::mac::{Freshness, Recipient, TRAILER, Trailer};
use super::provisioning::Provisioning;
use super::verifier::ANNOUNCEMENT;
use crate::onboard::bytes::put;

/// Seals messages for one board.
#[derive(Clone, Debug)]
pub struct Signer {
    provisioning: Provisioning,
    /// Freshness of the last message, or what the board announced.
    last: Freshness,
}

impl Signer {
    /// Begins with what the board announces in its status.
    ///
    /// # Errors
    /// [`Refusal::WrongMac`]: the announcement is not of this board.
    pub fn new(provisioning: &Provisioning, announcement: &[u8; TRAILER]) -> Result<Self, Refusal> {
        let mut signer = Self { provisioning: *provisioning, last: Freshness { epoch: 0, counter: 0 } };
        signer.hear(announcement)?;
        Ok(signer)
    }

    /// Takes up a later announcement: after a restart of the board the epoch rises. An older one changes nothing.
    ///
    /// # Errors
    /// [`Refusal::WrongMac`]: the announcement is not of this board, nothing changes.
    pub fn hear(&mut self, announcement: &[u8; TRAILER]) -> Result<(), Refusal> {
        let trailer = Trailer::from_bytes(announcement).ok_or(Refusal::WrongMac)?;
        if !trailer.is_of(&self.provisioning, Recipient::Desk, ANNOUNCEMENT, &[]) {
            return Err(Refusal::WrongMac);
        }
        self.last = self.last.max(trailer.freshness);
        Ok(())
    }

    /// Writes message and trailer to the buffer and returns them. Every call uses up a counter, so a message that got
    /// lost is sealed again.
    ///
    /// # Errors
    /// [`SealError`]; no counter is used up.
    pub fn seal<'a>(&mut self, data_id: u16, message: &[u8], buffer: &'a mut [u8]) -> Result<&'a [u8], SealError> {
        let least = message.len() + TRAILER;
        let too_short = SealError::BufferTooShort { least, found: buffer.len() };
        let mut space = buffer.get_mut(..least).ok_or(too_short)?;
        let counter = self.last.counter.checked_add(1);
        let freshness = Freshness { counter: counter.ok_or(SealError::CounterExhausted)?, ..self.last };
        let trailer = Trailer::sign(&self.provisioning, Recipient::Board, data_id, freshness, message);
        put(&mut space, message).ok_or(too_short)?;
        put(&mut space, &trailer.to_bytes()).ok_or(too_short)?;
        self.last = freshness;
        buffer.get(..least).ok_or(too_short)
    }
}
