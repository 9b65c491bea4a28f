//! Why something was not stored, or not given back.

use super::record::Identity;
use embedded_storage::nor_flash::NorFlashErrorKind;
use rundown_wire::errors;

errors! {
    /// The flash cannot hold a store.
    #[derive(Eq)]
    pub struct TooFewPages { least: u32, found: u32 } => "store: expected at least {least} flash pages, found {found}";

    /// Why a payload was not stored, after the last attempt. What was stored before is kept.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum AppendError {
        TooLong { most: usize, found: usize } => "payload: expected at most {most} bytes, found {found}",
        Driver(kind: NorFlashErrorKind) => "store: flash driver reported {kind:?}",
        /// A page was erased without error and still does not read as erased: the flash swallows erases, or is worn
        /// out.
        NotErased { page: u32 } => "store: page {page} was erased but does not read as erased",
        /// A record was written without error and reads otherwise: the flash swallows writes, or is worn out.
        NotWritten { page: u32, slot: u32 } => "store: slot {slot} of page {page} does not read as written",
    }

    /// Why what is stored is not given back.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum Refused {
        OtherTrain { expected: Identity, found: Identity } => "record: expected that of {expected}, found {found}",
        OtherLayout { expected: Identity, found: Identity } => "record: expected that of {expected}, found {found}",
        /// Slots that are neither erased nor hold a whole record.
        Damaged { slots: u32 } => "store: expected a whole record, found {slots} damaged slots",
    }

    /// Why there is no boot epoch. Whoever needs one must do without.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum EpochError {
        /// Something was stored, but no record with an epoch is left: a new one could repeat an old one.
        Lost { damaged_slots: u32 } => "epoch: none of the stored ones is left, {damaged_slots} damaged slots",
        Exhausted => "epoch: expected one that is left, found the last one used",
        NotStored(error: AppendError) => "epoch: not stored: {error}",
    }
}
