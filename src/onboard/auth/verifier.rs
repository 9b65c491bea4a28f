//! The board's side.

use super::error::Refusal;
use super::mac::{Freshness, Recipient, TRAILER, Trailer};
use super::provisioning::{KeySource, Provisioning, ProvisioningError};
use crate::onboard::store::EpochError;
use crate::onboard::train_id::TrainId;

/// Data id of the announcement; the direction already keeps it apart from messages to the board.
pub(super) const ANNOUNCEMENT: u16 = 0;

/// Opens sealed messages; one for each boot.
#[derive(Clone, Debug)]
pub struct Verifier<K = Result<Provisioning, ProvisioningError>> {
    keys: K,
    /// That the board is provisioned for.
    train: Option<TrainId>,
    epoch: Result<u32, EpochError>,
    /// Counter that was accepted last; 0: none yet.
    last: u32,
}

impl<K: KeySource> Verifier<K> {
    /// `epoch` is what [`Store::advance_epoch`](crate::onboard::store::Store::advance_epoch) gave at this boot.
    /// Without a key or an epoch every message is refused with that cause.
    pub fn new(keys: K, epoch: Result<u32, EpochError>) -> Self {
        let train = keys.provisioning().map(|provisioning| provisioning.train).ok();
        Self { keys, train, epoch, last: 0 }
    }

    /// The message inside a secured one, if it is of this kind, for this boot, and new.
    ///
    /// # Errors
    /// [`Refusal`]; nothing changes, only the caller's counters.
    pub fn open<'a>(&mut self, data_id: u16, secured: &'a [u8]) -> Result<&'a [u8], Refusal> {
        let provisioning = self.keys.provisioning();
        let provisioning = provisioning.as_ref().map_err(|error| Refusal::Unprovisioned(*error))?;
        let expected = self.epoch.map_err(Refusal::NoEpoch)?;
        let too_short = Refusal::WrongLength { least: TRAILER, found: secured.len() };
        let (message, trailer) = secured.split_last_chunk::<TRAILER>().ok_or(too_short)?;
        let trailer = Trailer::from_bytes(trailer).ok_or(too_short)?;
        if !trailer.is_of(provisioning, Recipient::Board, data_id, message) {
            return Err(Refusal::WrongMac);
        }
        let Freshness { epoch, counter } = trailer.freshness;
        if epoch != expected {
            return Err(Refusal::OtherEpoch { expected, found: epoch });
        }
        if counter <= self.last {
            return Err(Refusal::Stale { last: self.last, found: counter });
        }
        self.last = counter;
        Ok(message)
    }

    /// The train that the board is provisioned for.
    pub fn train(&self) -> Option<TrainId> {
        self.train
    }

    /// Epoch and last counter; `None` while everything secured is refused.
    pub fn freshness(&self) -> Option<Freshness> {
        let (Some(_), Ok(epoch)) = (self.train, self.epoch) else {
            return None;
        };
        Some(Freshness { epoch, counter: self.last })
    }

    /// [`Verifier::freshness`] with a MAC, for the status frame: what [`Signer::new`](super::Signer::new) begins with.
    #[inline(never)]
    pub fn announcement(&self) -> Option<[u8; TRAILER]> {
        let freshness = self.freshness()?;
        match &self.keys.provisioning() {
            Ok(provisioning) => {
                Some(Trailer::sign(provisioning, Recipient::Desk, ANNOUNCEMENT, freshness, &[]).to_bytes())
            }
            Err(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Key, SealError, Signer};
    use super::*;
    use crate::onboard::train_id::TrainId;

    #[test]
    fn the_last_counter_of_an_epoch_is_used_and_none_after_it() {
        let provisioning = Provisioning { key_id: 1, key: Key::new(*b"0123456789abcdef"), train: TrainId::of("2451") };
        let mut board = Verifier::new(Ok(provisioning), Ok(u32::MAX));
        board.last = u32::MAX - 1;
        let mut desk = Signer::new(&provisioning, &board.announcement().unwrap()).unwrap();
        let mut buffer = [0; 32];
        let last = desk.seal(2, b"last", &mut buffer).unwrap();
        assert_eq!(board.open(2, last), Ok(b"last".as_slice()));
        assert!(matches!(board.open(2, last), Err(Refusal::Stale { .. })));
        assert_eq!(desk.seal(2, b"more", &mut [0; 32]), Err(SealError::CounterExhausted));

        // A counter that restarts is stale.
        let freshness = Freshness { epoch: u32::MAX, counter: 0 };
        let wrapped = Trailer::sign(&provisioning, Recipient::Board, 2, freshness, &[]);
        let (last, found) = (u32::MAX, 0);
        assert_eq!(board.open(2, &wrapped.to_bytes()), Err(Refusal::Stale { last, found }));
    }
}
