//! Boot epoch: a number that rises with every boot, so that what was signed for an earlier one is refused.
//!
//! It stands in the header of every record. An epoch is given out only when **two** records with it were stored and
//! read back: if one of them rots, the other still keeps it from being given out again. The next one is above the
//! highest epoch of *any* whole record. Where records were stored but none with an epoch is left, there is no new epoch
//! (fail closed): a board in that state has to be provisioned again, with its store erased and a new key. Damage to the
//! first page alone is no such state: the first start was cut while it wrote there, and the next epoch is 2, whether 1
//! was given out or not.

use super::record::Identity;
use super::{EpochError, Store};
use embedded_storage::nor_flash::NorFlash;

impl<F: NorFlash, const SLOT: usize> Store<F, SLOT> {
    /// Stores the payload under the next epoch, twice, and returns the epoch. Once a boot, before anything else is
    /// stored.
    ///
    /// # Errors
    /// [`EpochError`]: there is no epoch for this boot; storing payloads goes on.
    pub fn advance_epoch(&mut self, identity: Identity, payload: &[u8]) -> Result<u32, EpochError> {
        let last = self.epoch.ok_or(EpochError::Lost { damaged_slots: self.counters.damaged_slots })?;
        let next = last.checked_add(1).ok_or(EpochError::Exhausted)?;
        // Taken even if storing fails: it may have reached the flash, and is never given out.
        self.epoch = Some(next);
        for _ in 0..2 {
            self.append(identity, payload).map_err(EpochError::NotStored)?;
        }
        Ok(next)
    }
}
