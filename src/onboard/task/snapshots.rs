//! Snapshots: the run in pieces, a few each tick or each time it is asked for; and back, when the board has lost it.

use super::{Port, Task};
use crate::Real;
use crate::coast_ahead::Steady;
use crate::estimator::run_state::MAX_SNAPSHOT;
use crate::onboard::auth::KeySource;
use crate::plain::{self, Plain as _, plain};
use crate::tick::digest;
use crate::tick::published::Published;
use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;
use rundown_wire::{Body, Refusal, SNAPSHOT_BYTES, SnapshotPart};

/// Pieces in one tick: some 1 kB, a tenth of a second at 115 200 baud. The largest snapshot takes 14 ticks.
const PARTS_PER_TICK: usize = 2;

/// What a run needs beside [`RunState`](crate::estimator::run_state::RunState); stands before it.
struct Around {
    /// Runs that have ended before: a snapshot of one of them would teach twice.
    runs: u32,
    published: Published,
    moved: bool,
    standing_since_s: Option<Real>,
    coast: Steady,
}

plain! {
    struct Around { runs, published, moved, standing_since_s, coast }
}

/// A snapshot on its way out, or in.
pub(super) struct SnapshotBuffer<'a> {
    bytes: &'a mut [u8; MAX_SNAPSHOT],
    /// Head of the parts: tick, setup, digest.
    tick: u32,
    setup: u32,
    crc: u32,
    length: usize,
    /// Where the next part begins.
    next: usize,
    outwards: bool,
}

impl<'a> SnapshotBuffer<'a> {
    pub(super) fn new(bytes: &'a mut [u8; MAX_SNAPSHOT]) -> Self {
        Self { bytes, tick: 0, setup: 0, crc: 0, length: 0, next: 0, outwards: false }
    }

    fn part(&mut self) -> Option<SnapshotPart> {
        if !self.outwards {
            return None;
        }
        let rest = self.bytes.get(self.next..self.length)?;
        let piece = rest.get(..rest.len().min(SNAPSHOT_BYTES))?;
        if piece.is_empty() {
            self.outwards = false;
            return None;
        }
        let part = SnapshotPart {
            tick: self.tick,
            setup: self.setup,
            crc: self.crc,
            total: u16::try_from(self.length).ok()?,
            first: u16::try_from(self.next).ok()?,
            bytes: Vec::from_slice(piece).ok()?,
        };
        self.next += part.bytes.len();
        Some(part)
    }
}

impl<F: NorFlash, K: KeySource> Task<'_, F, K> {
    /// A snapshot of this tick; one that is still on its way out goes first.
    pub(super) fn take_snapshot_of_the_run(&mut self) {
        let buffer = &mut self.snapshot;
        if buffer.outwards {
            return;
        }
        let mut around = Around {
            runs: self.lifetime.runs,
            published: self.published,
            moved: self.moved,
            standing_since_s: self.standing_since_s,
            coast: self.coast,
        };
        let Some(head) = plain::write(&mut around, buffer.bytes).map(<[u8]>::len) else {
            return;
        };
        let Some(rest) = buffer.bytes.get_mut(head..) else {
            return;
        };
        let Ok(length) = self.run.snapshot(rest).map(|bytes| head + bytes.len()) else {
            return;
        };
        buffer.length = length;
        buffer.crc = digest::of_bytes(buffer.bytes.get(..length).unwrap_or_default());
        buffer.tick = self.tick;
        buffer.setup = self.setup;
        buffer.next = 0;
        buffer.outwards = true;
    }

    pub(super) fn send_snapshot_parts(&mut self, port: &mut impl Port) {
        for _ in 0..PARTS_PER_TICK {
            let Some(part) = self.snapshot.part() else {
                return;
            };
            self.send(Body::SnapshotPart(part), port);
        }
    }

    /// A part of a snapshot to go on from; with the last one the run is under way again.
    pub(super) fn take_snapshot(&mut self, part: &SnapshotPart) -> Result<(), Refusal> {
        if !self.described() {
            return Err(Refusal::NotDescribed);
        }
        if part.setup != self.setup {
            return Err(Refusal::Snapshot);
        }
        let buffer = &mut self.snapshot;
        if part.first == 0 {
            buffer.outwards = false;
            buffer.next = 0;
            buffer.length = usize::from(part.total);
            (buffer.tick, buffer.setup, buffer.crc) = (part.tick, part.setup, part.crc);
        }
        let same = !buffer.outwards
            && usize::from(part.first) == buffer.next
            && usize::from(part.total) == buffer.length
            && (part.tick, part.setup, part.crc) == (buffer.tick, buffer.setup, buffer.crc);
        let end = buffer.next + part.bytes.len();
        if !same || end > buffer.length {
            return Err(Refusal::OutOfOrder);
        }
        buffer.bytes.get_mut(buffer.next..end).ok_or(Refusal::Snapshot)?.copy_from_slice(&part.bytes);
        buffer.next = end;
        if end < buffer.length {
            return Ok(());
        }
        let whole = buffer.bytes.get(..end).ok_or(Refusal::Snapshot)?;
        if digest::of_bytes(whole) != buffer.crc {
            return Err(Refusal::Snapshot);
        }
        let mut around = Around::START;
        let run = plain::read(&mut around, whole).ok_or(Refusal::Snapshot)?;
        if around.runs < self.lifetime.runs || self.run.restore(run).is_err() {
            return Err(Refusal::Snapshot);
        }
        self.judge_by_description();
        self.running = true;
        self.published = around.published;
        self.moved = around.moved;
        self.standing_since_s = around.standing_since_s;
        self.coast = around.coast;
        self.newest = None;
        self.last_time_s = None;
        self.tick = part.tick;
        Ok(())
    }
}
