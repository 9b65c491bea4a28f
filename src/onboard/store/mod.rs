//! What survives a power cut: a ring of records in NOR flash.
//!
//! In: a payload at each stop and at each boot. Out, after the next boot: the newest whole payload of this train and
//! layout, or why there is none.
//!
//! ```text
//! page 0            page 1            page 2            page 3
//! [ 11 ] [ 12 ]     [ 13 ] [ 14 ]     [ 15 ] [    ]     [ 9 ] [ 10 ]         slots with their sequence numbers
//!                                     newest  next
//! ```
//!
//! What makes it safe:
//!
//! - **Only a page that was erased since the mount is written to**, and no word twice. A cut may leave words (or a
//!   whole page, when an erase is cut) that read as erased and are not; they are never trusted, because the first write
//!   after a boot begins a new page. That is the "skip a slot after a boot" rule and more: it also covers a word that
//!   an earlier boot tore and nobody can see. With two slots a page it costs the same wear.
//! - The pages of the two newest records are never erased, so the newest may rot and the one before it is still there.
//! - A read that fails is a damaged slot. On STM32L4 a torn word may raise the ECC NMI: the driver has to survive it
//!   and return an error from `read`.
//! - Every erase and every record is read back. A flash that swallows them (an emulator's, or a worn one) gives a named
//!   error after attempts on half of the pages.
//!
//! A sequence number (serial arithmetic) says which record is the newest. After a mount it skips one, so that a record
//! torn before the boot can never tie with a new one.
//!
//! The header also carries the **boot epoch** ([`Store::advance_epoch`]), so that it outlives a change of train or
//! layout.
//!
//! ```
//! # use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
//! use rundown::onboard::store::{Identity, Store};
//! use rundown::onboard::train_id::TrainId;
//! # struct Ram([u8; 8192]);
//! # impl ErrorType for Ram { type Error = core::convert::Infallible; }
//! # impl ReadNorFlash for Ram {
//! #     const READ_SIZE: usize = 1;
//! #     fn read(&mut self, at: u32, to: &mut [u8]) -> Result<(), Self::Error> { to.copy_from_slice(&self.0[at as usize..][..to.len()]); Ok(()) }
//! #     fn capacity(&self) -> usize { 8192 }
//! # }
//! # impl NorFlash for Ram {
//! #     const WRITE_SIZE: usize = 8;
//! #     const ERASE_SIZE: usize = 2048;
//! #     fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> { self.0[from as usize..to as usize].fill(0xFF); Ok(()) }
//! #     fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), Self::Error> { self.0[at as usize..][..bytes.len()].copy_from_slice(bytes); Ok(()) }
//! # }
//! # let flash = Ram([0xFF; 8192]);
//! let identity = Identity { train: TrainId::of("2451"), layout: 1 };
//! let mut store = Store::<_, 1024>::mount(flash)?;
//! assert!(store.newest(identity)?.is_none());
//! store.append(identity, b"learned")?;
//!
//! let mut after_boot = Store::<_, 1024>::mount(store.release())?;
//! assert_eq!(after_boot.newest(identity)?.unwrap().payload, b"learned");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod epoch;
mod error;
pub mod persisted;
mod record;

pub use error::{AppendError, EpochError, Refused, TooFewPages};
pub use record::{Identity, OVERHEAD};

use embedded_storage::nor_flash::{NorFlash, NorFlashError};
use record::{ERASED, Header};

/// Fewest pages: two that hold the newest records, one to write to, one spare.
pub const LEAST_PAGES: u32 = 4;

/// How often what happened since the mount; the scan's finding stands in `damaged_slots`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StoreCounters {
    /// Records stored and read back.
    pub stored: u32,
    /// Pages erased.
    pub erased: u32,
    /// Errors of the driver while storing.
    pub driver_errors: u32,
    /// Pages that did not read as erased.
    pub not_erased: u32,
    /// Records that did not read as written.
    pub not_written: u32,
    /// At the mount: slots that were neither erased nor held a whole record (cut writes, bit rot, failed reads).
    pub damaged_slots: u32,
}

/// The newest payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Restored<'a> {
    /// What was stored.
    pub payload: &'a [u8],
    /// Its number.
    pub sequence: u32,
    /// The slot that follows holds something that is no record (a cut write, or bit rot): a newer record may be lost.
    pub fallen_back: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct SlotPlace {
    page: u32,
    slot: u32,
}

/// A whole record and where it lies.
#[derive(Clone, Copy, Debug)]
struct WholeRecord {
    place: SlotPlace,
    header: Header,
}

/// What a slot holds.
enum Slot {
    Erased,
    Whole(Header),
    Damaged,
}

/// A ring of records in NOR flash, SLOT bytes each. See the [module](self).
#[derive(Clone, Debug)]
pub struct Store<F, const SLOT: usize> {
    flash: F,
    pages: u32,
    newest: Option<WholeRecord>,
    previous: Option<WholeRecord>,
    fallen_back: bool,
    /// Next slot of the page that was erased since the mount.
    open: Option<SlotPlace>,
    /// Page that was begun last.
    last_page: u32,
    /// Number that was given last.
    sequence: u32,
    /// Highest epoch of any record; `None`: there are records and none has one.
    epoch: Option<u32>,
    counters: StoreCounters,
    buffer: [u8; SLOT],
}

impl<F: NorFlash, const SLOT: usize> Store<F, SLOT> {
    /// Largest payload, bytes.
    pub const CAPACITY: usize = SLOT - OVERHEAD;
    /// Records in a page.
    pub const SLOTS_PER_PAGE: u32 = {
        assert!(SLOT > OVERHEAD && SLOT <= F::ERASE_SIZE && SLOT < u16::MAX as usize);
        assert!(SLOT.is_multiple_of(F::READ_SIZE) && SLOT.is_multiple_of(F::WRITE_SIZE));
        (F::ERASE_SIZE / SLOT) as u32
    };

    /// Looks through the whole flash; nothing is written. A slot that does not fit the flash's page and word size does
    /// not build.
    ///
    /// # Errors
    /// [`TooFewPages`]: fewer than [`LEAST_PAGES`].
    pub fn mount(flash: F) -> Result<Self, TooFewPages> {
        let pages = u32::try_from(flash.capacity() / F::ERASE_SIZE).unwrap_or(u32::MAX);
        if pages < LEAST_PAGES {
            return Err(TooFewPages { least: LEAST_PAGES, found: pages });
        }
        let mut store = Self {
            flash,
            pages,
            newest: None,
            previous: None,
            fallen_back: false,
            open: None,
            last_page: pages - 1,
            sequence: 0,
            epoch: Some(0),
            counters: StoreCounters::default(),
            buffer: [ERASED; SLOT],
        };
        store.scan();
        Ok(store)
    }

    /// The newest payload, if it is of this identity. `Ok(None)`: nothing was ever stored.
    ///
    /// # Errors
    /// [`Refused`] says whose record was found instead, or that none is whole.
    pub fn newest(&mut self, identity: Identity) -> Result<Option<Restored<'_>>, Refused> {
        let newest = self.newest.filter(|kept| self.is_still(kept));
        let kept = newest.or_else(|| self.previous.filter(|kept| self.is_still(kept)));
        let Some((found, payload)) = kept.and_then(|_| record::decode(&self.buffer)) else {
            let slots = self.counters.damaged_slots;
            return match (slots, self.newest) {
                (0, None) => Ok(None),
                _ => Err(Refused::Damaged { slots }),
            };
        };
        let (expected, found, sequence) = (identity, found.identity, found.sequence);
        if found.train != expected.train {
            return Err(Refused::OtherTrain { expected, found });
        }
        if found.layout != expected.layout {
            return Err(Refused::OtherLayout { expected, found });
        }
        Ok(Some(Restored { payload, sequence, fallen_back: self.fallen_back || newest.is_none() }))
    }

    /// Stores a payload and reads it back. Returns its number. Takes a page erase when a new page begins, on every
    /// other attempt at worst. An attempt that fails is followed by one on the next page, as many times as half of the
    /// pages: the pages behind the newest record are the same at each start, and a few that are worn out side by side
    /// must not end all storing.
    ///
    /// # Errors
    /// [`AppendError`] of the last attempt. What was stored before is kept.
    pub fn append(&mut self, identity: Identity, payload: &[u8]) -> Result<u32, AppendError> {
        let length = u16::try_from(payload.len())
            .ok()
            .filter(|length| usize::from(*length) <= Self::CAPACITY)
            .ok_or(Self::too_long(payload))?;
        let mut left = self.pages / 2;
        loop {
            left -= 1;
            match self.attempt(identity, payload, length) {
                Err(_) if left > 0 => {}
                done => return done,
            }
        }
    }

    /// What happened so far.
    pub fn counters(&self) -> &StoreCounters {
        &self.counters
    }

    /// The driver, to ask it what only it knows.
    pub fn flash(&self) -> &F {
        &self.flash
    }

    /// The driver. Who writes to the flash by it, mounts again.
    pub fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Gives the flash back.
    pub fn release(self) -> F {
        self.flash
    }

    fn attempt(&mut self, identity: Identity, payload: &[u8], length: u16) -> Result<u32, AppendError> {
        // Each attempt has its own number: one that seemed to fail may turn out whole after the next boot.
        self.sequence = self.sequence.wrapping_add(1);
        let header = Header { identity, sequence: self.sequence, epoch: self.epoch.unwrap_or(0), length };
        let written = self.place().and_then(|place| self.write(place, &header, payload).map(|()| place));
        match written {
            Ok(place) => {
                self.previous = self.newest;
                self.newest = Some(WholeRecord { place, header });
                self.fallen_back = false;
                self.counters.stored = self.counters.stored.saturating_add(1);
                Ok(header.sequence)
            }
            Err(error) => {
                self.open = None;
                let counter = match error {
                    AppendError::NotErased { .. } => &mut self.counters.not_erased,
                    AppendError::NotWritten { .. } => &mut self.counters.not_written,
                    AppendError::Driver(_) | AppendError::TooLong { .. } => &mut self.counters.driver_errors,
                };
                *counter = counter.saturating_add(1);
                Err(error)
            }
        }
    }

    /// The slot to write to: the next one of the open page, or the first of a newly erased one.
    fn place(&mut self) -> Result<SlotPlace, AppendError> {
        if let Some(place) = self.open {
            return Ok(place);
        }
        let page = self.next_page();
        self.last_page = page;
        let start = page * F::ERASE_SIZE as u32;
        self.counters.erased = self.counters.erased.saturating_add(1);
        self.flash.erase(start, start + F::ERASE_SIZE as u32).map_err(|error| AppendError::Driver(error.kind()))?;
        for slot in 0..Self::SLOTS_PER_PAGE {
            if !matches!(self.read(SlotPlace { page, slot }), Slot::Erased) {
                return Err(AppendError::NotErased { page });
            }
        }
        let place = SlotPlace { page, slot: 0 };
        self.open = Some(place);
        Ok(place)
    }

    fn write(&mut self, place: SlotPlace, header: &Header, payload: &[u8]) -> Result<(), AppendError> {
        let bytes = record::encode(&mut self.buffer, header, payload)
            .and_then(|length| self.buffer.get(..length.next_multiple_of(F::WRITE_SIZE)))
            .ok_or(Self::too_long(payload))?;
        let start = self.offset(place);
        self.flash.write(start, bytes).map_err(|error| AppendError::Driver(error.kind()))?;
        // Whole, by its checksum, as the next start asks; the driver has compared the bytes.
        if !self.is_still(&WholeRecord { place, header: *header }) {
            return Err(AppendError::NotWritten { page: place.page, slot: place.slot });
        }
        self.open = self.after(place);
        Ok(())
    }

    /// The page after the last one in the ring that holds neither of the two newest records.
    fn next_page(&self) -> u32 {
        let holds = |kept: &Option<WholeRecord>, page| kept.is_some_and(|kept| kept.place.page == page);
        let mut page = self.page_after(self.last_page);
        for _ in 0..2 {
            if holds(&self.newest, page) || holds(&self.previous, page) {
                page = self.page_after(page);
            }
        }
        page
    }

    /// The next page of the ring.
    fn page_after(&self, page: u32) -> u32 {
        if page + 1 < self.pages { page + 1 } else { 0 }
    }

    /// Finds the two newest records, the highest epoch, and what is damaged.
    fn scan(&mut self) {
        let mut highest = 0;
        let (mut used, mut cut) = (false, 0);
        for page in 0..self.pages {
            for slot in 0..Self::SLOTS_PER_PAGE {
                let place = SlotPlace { page, slot };
                match self.read(place) {
                    Slot::Erased => {}
                    Slot::Damaged => {
                        self.counters.damaged_slots += 1;
                        // The first start writes to the first page, the next one to another: damage to that page alone
                        // is a first start that was cut, and no epoch above 1 was given out.
                        if page == 0 { cut = 1 } else { used = true }
                    }
                    Slot::Whole(header) => {
                        used = true;
                        highest = highest.max(header.epoch);
                        self.take_up(WholeRecord { place, header });
                    }
                }
            }
        }
        self.epoch = (highest > 0 || !used).then_some(highest.max(cut));
        if let Some(newest) = self.newest {
            self.last_page = newest.place.page;
            self.sequence = newest.header.sequence.wrapping_add(1);
            self.fallen_back = self.is_followed_by_damage(newest.place);
        }
    }

    /// Keeps a record that was found if it is one of the two newest.
    fn take_up(&mut self, found: WholeRecord) {
        let later = |than: &Option<WholeRecord>| than.is_none_or(|kept| found.header.is_later_than(&kept.header));
        if later(&self.newest) {
            self.previous = self.newest;
            self.newest = Some(found);
        } else if later(&self.previous) {
            self.previous = Some(found);
        }
    }

    /// Where the next record was written, or would have been: the next slot, or a new page if a boot lies between.
    fn is_followed_by_damage(&mut self, place: SlotPlace) -> bool {
        let in_page = self.after(place).map(|next| self.read(next));
        let next = match in_page {
            Some(Slot::Erased) | None => self.read(SlotPlace { page: self.page_after(place.page), slot: 0 }),
            Some(held) => held,
        };
        matches!(next, Slot::Damaged)
    }

    /// The next slot of the same page.
    fn after(&self, place: SlotPlace) -> Option<SlotPlace> {
        let slot = place.slot + 1;
        (slot < Self::SLOTS_PER_PAGE).then_some(SlotPlace { slot, ..place })
    }

    /// The record can still be read; it then lies in the buffer.
    fn is_still(&mut self, kept: &WholeRecord) -> bool {
        matches!(self.read(kept.place), Slot::Whole(header) if header == kept.header)
    }

    /// Reads a slot into the buffer.
    fn read(&mut self, place: SlotPlace) -> Slot {
        let offset = self.offset(place);
        if self.flash.read(offset, &mut self.buffer).is_err() {
            return Slot::Damaged;
        }
        if self.buffer.iter().all(|byte| *byte == ERASED) {
            return Slot::Erased;
        }
        match record::decode(&self.buffer) {
            Some((header, _)) => Slot::Whole(header),
            None => Slot::Damaged,
        }
    }

    fn too_long(payload: &[u8]) -> AppendError {
        AppendError::TooLong { most: Self::CAPACITY, found: payload.len() }
    }

    fn offset(&self, place: SlotPlace) -> u32 {
        place.page * F::ERASE_SIZE as u32 + place.slot * SLOT as u32
    }
}
