//! What survives the power: read when the board starts and when its train is described, written at each end of a run.

use super::pieces::Due;
use super::snapshots::SnapshotBuffer;
use super::{Room, SLOT, Task};
use crate::coast_ahead::Steady;
use crate::estimator::config::Mode;
use crate::estimator::run_state::RunState;
use crate::estimator::{Estimator, Taken};
use crate::onboard::auth::{KeySource, Verifier};
use crate::onboard::event::Event;
use crate::onboard::store::persisted::{LAYOUT, Lifetime, NotRestored, Persisted};
use crate::onboard::store::{EpochError, Identity, Refused, Store};
use crate::onboard::train_id::TrainId;
use crate::tick::published::Published;
use crate::tick::snapshot::InPlace;
use crate::uplink::Pace;
use embedded_storage::nor_flash::NorFlash;
use heapless::{Deque, Vec};
use rundown_wire::{Memory, REFUSALS};

impl<'a, F: NorFlash, K: KeySource> Task<'a, F, K> {
    /// The task of a board that has just started. `heartbeat_only`: it has started too often in a short time, and only
    /// says how it is.
    pub fn new(keys: K, flash: F, heartbeat_only: bool, run: &'a mut RunState, room: &'a mut Room) -> Self {
        run.reset();
        let estimator = Estimator::undescribed(&mut room.track, &mut room.effects);
        let vehicle = estimator.new_vehicle();
        // What is in the flash may be why it fell.
        let mut store = if heartbeat_only { None } else { Store::mount(flash).ok() };
        let train = keys.provisioning().map(|provisioning| provisioning.train);
        let epoch = match (&mut store, train) {
            (Some(store), Ok(train)) => next_epoch(store, train),
            _ => Err(EpochError::Lost { damaged_slots: 0 }),
        };
        let memory = match epoch {
            Err(EpochError::NotStored(_)) => Memory::ReadOnly,
            Ok(_) | Err(EpochError::Lost { .. } | EpochError::Exhausted) => Memory::Empty,
        };
        Self {
            estimator,
            train_id: None,
            track_id: None,
            setup: 0,
            incoming: &mut room.incoming,
            incoming_id: 0,
            vehicle,
            run,
            summary: &mut room.summary,
            kept_effects: &mut room.kept_effects,
            running: false,
            due: Due::Nothing,
            estimate: None,
            taken: Taken::NOTHING,
            moved: false,
            standing_since_s: None,
            published: Published::default(),
            coast: Steady::NONE,
            initial_sds: [0.0; 2],
            pace: Pace::Clock,
            newest: None,
            last_time_s: None,
            silent_ticks: 0,
            tick: 0,
            sequence: 0,
            last_uplink: None,
            last_message: None,
            missed: 0,
            duplicate: 0,
            refusals: [0; REFUSALS],
            second: 0,
            open_refusals: 0,
            unproven_refusals: 0,
            open_status: false,
            heartbeat_only,
            verifier: Verifier::new(keys, epoch),
            store,
            lifetime: Lifetime::default(),
            memory,
            effects_received: false,
            effects_unsaved: false,
            records: [0; 2],
            snapshot: SnapshotBuffer::new(&mut room.snapshot),
            events: Deque::new(),
        }
    }

    /// Gives the flash back.
    pub fn release(self) -> Option<F> {
        self.store.map(Store::release)
    }

    /// The vehicle of the train that was just described: as it was kept, or as its manufacturer describes it.
    #[inline(never)]
    pub(super) fn restore_vehicle(&mut self) {
        self.vehicle = self.estimator.new_vehicle();
        let (Some(store), Some(train)) = (&mut self.store, self.verifier.train()) else {
            return;
        };
        let mut persisted = Persisted::ZEROED;
        let loaded = persisted.load_in(store, train);
        let loaded = match loaded {
            Ok(Some(fallen_back)) => {
                self.lifetime = persisted.lifetime;
                persisted
                    .vehicle_and_effects(&self.estimator.train().davis(), &mut self.vehicle, self.kept_effects)
                    .map(|()| Some(fallen_back))
            }
            other => other,
        };
        // A vehicle that is not believed takes nothing else away.
        if !self.effects_received && matches!(loaded, Ok(Some(_)) | Err(NotRestored::Vehicle(_))) {
            core::mem::swap(self.estimator.effects_mut(), self.kept_effects);
        }
        let found = match loaded {
            Ok(Some(true)) => Memory::RestoredOlder,
            Ok(Some(false)) => Memory::Restored,
            Ok(None) => Memory::Empty,
            Err(NotRestored::Refused(Refused::Damaged { .. })) => Memory::Empty,
            Err(NotRestored::Refused(_)) => Memory::Foreign,
            Err(_) => Memory::Implausible,
        };
        if self.memory != Memory::ReadOnly {
            self.memory = found;
        }
        self.note(Event::Vehicle(self.memory));
    }

    /// Keeps the vehicle; once a run. What the paper's mode carries from run to run is not kept: it is the end of the
    /// last run, and would stand in place of what many have taught.
    pub(super) fn keep(&mut self) {
        self.lifetime.runs = self.lifetime.runs.saturating_add(1);
        if self.keeps() {
            self.write();
        }
    }

    /// The vehicle is one that is kept.
    pub(super) fn keeps(&self) -> bool {
        self.estimator.config().mode != Mode::Paper
    }

    /// Back to the manufacturer's description, in the flash too.
    pub(super) fn forget(&mut self) {
        self.vehicle = self.estimator.new_vehicle();
        self.write();
    }

    pub(super) fn write(&mut self) {
        let mut persisted = Persisted::new(&self.vehicle, self.estimator.effects());
        persisted.lifetime = self.lifetime;
        let written = match (&mut self.store, self.verifier.train()) {
            (Some(store), Some(train)) => persisted.save(store, train).is_ok(),
            _ => false,
        };
        let [written_count, failed_count] = &mut self.records;
        let count = if written { written_count } else { failed_count };
        *count = count.saturating_add(1);
        let event = if written { Event::Kept(*count) } else { Event::NotKept };
        self.note(event);
        self.effects_unsaved &= !written;
        if !written {
            self.memory = Memory::ReadOnly;
        }
    }
}

/// The epoch of this start, stored with what was stored before.
fn next_epoch<F: NorFlash>(store: &mut Store<F, SLOT>, train: TrainId) -> Result<u32, EpochError> {
    let identity = Identity { train, layout: LAYOUT };
    // Of another train or layout: it is of no use, and the epoch stands in the header of every record.
    let mut payload: Vec<u8, SLOT> = Vec::new();
    if let Ok(Some(restored)) = store.newest(identity) {
        // A payload is shorter than its slot.
        let _fits = payload.extend_from_slice(restored.payload).is_ok();
    }
    store.advance_epoch(identity, &payload)
}
