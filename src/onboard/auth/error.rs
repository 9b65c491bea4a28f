//! Why a message is refused, or cannot be sealed.

use super::provisioning::ProvisioningError;
use crate::onboard::store::EpochError;
use rundown_wire::errors;

errors! {
    /// Why a secured message was refused. Nothing was changed by it; the caller counts it.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum Refusal {
        Unprovisioned(cause: ProvisioningError) => "auth: no key: {cause}",
        NoEpoch(cause: EpochError) => "auth: no epoch: {cause}",
        WrongLength { least: usize, found: usize } => "message: expected at least {least} bytes, found {found}",
        /// The MAC is not of this message, kind, direction, train, freshness and key.
        WrongMac => "mac: expected that of this message and key, found another one",
        OtherEpoch { expected: u32, found: u32 } => "epoch: expected {expected}, found {found}",
        Stale { last: u32, found: u32 } => "counter: expected above {last}, found {found}",
    }

    /// Why a message was not sealed.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum SealError {
        BufferTooShort { least: usize, found: usize } => "buffer: expected at least {least} bytes, found {found}",
        CounterExhausted => "auth: all counters of this epoch are used, restart the board",
    }
}
