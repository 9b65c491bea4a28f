//! The tick task: what the board does with messages and with the clock. The board, the emulator and the host run the
//! same.
//!
//! ```text
//! message -> authentication -> request -+-> measurement -> newest -> tick -> Estimator::step -> frames
//!                                       +-> train, track, settings, commands -> answer
//! ```
//!
//! In: whole messages from the link, and the ticks of a clock. Out: whole messages to the link, records to the flash.
//! No clock, no heap, no waiting: what finds no room in the link is counted and dropped.
//!
//! Each request gets one answer: a measurement the frames of its tick (at once in lockstep, at the next tick else),
//! everything else an [`Answer`]. A refused request has changed nothing but its counter; a part of a list
//! of curves or targets empties it.
//!
//! No call does everything: a tick and the end of a run are done in pieces, and between them the board does what else
//! there is to do.
//!
//! - `requests`: what may be asked, and when
//! - `pieces`: what a tick and the end of a run do one after another
//! - `report`: which frames a tick sends
//! - `snapshots`: the whole state, in pieces, out and in
//! - `keeping`: what survives the power

mod keeping;
mod pieces;
mod report;
mod requests;
mod snapshots;

use crate::Real;
use crate::coast_ahead::Steady;
use crate::estimator::run_state::{MAX_SNAPSHOT, RunState};
use crate::estimator::{Estimator, RunSummary, StepError, Taken};
use crate::model::effects::Effects;
use crate::model::track::Track;
use crate::onboard::auth::{KeySource, Provisioning, ProvisioningError, Verifier};
use crate::onboard::event::{self, Event};
use crate::onboard::outbox::WhenFull;
use crate::onboard::store::Store;
use crate::onboard::store::persisted::Lifetime;
use crate::tick::digest;
use crate::tick::estimate::Estimate;
use crate::tick::measurement::Measurement;
use crate::tick::memory::Vehicle;
use crate::tick::plausibility::{Order, is_later, is_out_of_range, is_time};
use crate::tick::published::Published;
use crate::uplink::{self, Command, Pace, Request, Uplink};
use embedded_storage::nor_flash::NorFlash;
use heapless::Deque;
use pieces::Due;
use rundown_wire::{Answer, Body, Health, Memory, REFUSALS, Refusal};
use snapshots::SnapshotBuffer;

/// Bytes of a record of the store: two fit in a page of the STM32L4.
pub const SLOT: usize = 1024;
/// Kind of the secured messages for [`Verifier::open`].
pub const DATA_ID: u16 = 1;

/// Standing for as long as this ends a run, s: the stop at a terminus, and longer than any on the way.
const LONG_STOP_S: f32 = 300.0;
/// A longer step between two rows ends none by itself, s.
const LONGEST_STEP_S: f32 = 60.0;
/// Slower than this the train has not yet run, m/s.
const MOVING_MPS: Real = 3.0;

/// Refusals that are answered in a second to either kind of message that anybody can send; the line is for estimates.
const REFUSALS_A_SECOND: u8 = 8;
/// A sender whose numbers leap by as many has restarted, and lost nothing.
const LEAST_RESTART: u16 = 1000;

/// Who vouches for a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// Nobody, and it says so.
    Open,
    /// Nobody, though it is marked as secured.
    Unproven,
    /// Who has the key: all of it is answered.
    Authentic,
}

/// What the task needs of the board around it.
pub trait Port {
    /// Hands a message to the link. What finds no room is counted in [`Health::not_sent`].
    fn send(&mut self, message: &[u8], when_full: WhenFull);
    /// How the hardware is.
    fn health(&self) -> Health;
    /// Seconds since the start; none: no clock, so nothing is limited by time.
    fn uptime_s(&self) -> Option<u32> {
        None
    }
}

/// The room that a task needs beside itself; zeros, for a static. 56 kB.
pub struct Room {
    summary: RunSummary,
    track: Track,
    incoming: Track,
    effects: Effects,
    kept_effects: Effects,
    snapshot: [u8; MAX_SNAPSHOT],
}

impl Room {
    /// Nothing is in it.
    pub const EMPTY: Self = Self {
        summary: RunSummary::NONE,
        track: Track::empty(),
        incoming: Track::empty(),
        effects: Effects::NONE,
        kept_effects: Effects::NONE,
        snapshot: [0; MAX_SNAPSHOT],
    };
}

/// The state of the board's application.
pub struct Task<'a, F, K = Result<Provisioning, ProvisioningError>> {
    estimator: Estimator<&'a mut Track, &'a mut Effects>,
    train_id: Option<u64>,
    track_id: Option<u32>,
    /// Digest of train, track, configuration and effects.
    setup: u32,
    /// The track that is coming in, and its id.
    incoming: &'a mut Track,
    incoming_id: u32,

    vehicle: Vehicle,
    run: &'a mut RunState,
    /// Features of the run under way, and at its end what it has taught.
    summary: &'a mut RunSummary,
    /// Effects that are read from the store, before they are believed.
    kept_effects: &'a mut Effects,
    running: bool,
    /// What of the last call is still to be done, and the estimate that it is about.
    due: Due,
    estimate: Option<Estimate>,
    /// What of its readings was taken.
    taken: Taken,
    /// The train has run since the run began.
    moved: bool,
    standing_since_s: Option<Real>,
    published: Published,
    /// The coast-ahead prediction that was published last.
    coast: Steady,
    /// Standard deviation of r by the description alone, which `published` is judged by.
    initial_sds: [Real; 2],

    pace: Pace,
    newest: Option<Measurement>,
    /// Time of the last measurement taken.
    last_time_s: Option<Real>,
    silent_ticks: u32,
    tick: u32,
    sequence: u16,
    last_uplink: Option<u16>,
    last_message: Option<u32>,
    missed: u32,
    duplicate: u32,
    refusals: [u32; REFUSALS],
    /// The second that is under way, and what messages that nobody vouches for have got in it.
    second: u32,
    open_refusals: u8,
    unproven_refusals: u8,
    open_status: bool,
    heartbeat_only: bool,

    verifier: Verifier<K>,
    store: Option<Store<F, SLOT>>,
    lifetime: Lifetime,
    memory: Memory,
    /// Effects were received since the start: those in the store are of the past.
    effects_received: bool,
    /// They are not in the store yet.
    effects_unsaved: bool,
    records: [u32; 2],
    snapshot: SnapshotBuffer<'a>,
    events: Deque<Event, { event::WAITING }>,
}

impl<F: NorFlash, K: KeySource> Task<'_, F, K> {
    /// One message from the link, and all that it asks for.
    pub fn receive(&mut self, message: &[u8], port: &mut impl Port) {
        self.begin_message(message, port);
        self.finish(port);
    }

    /// One tick of the board's clock, all of it.
    pub fn tick(&mut self, port: &mut impl Port) {
        self.begin_tick(port);
        self.finish(port);
    }

    /// The first piece of [`Task::receive`]; the others by [`Task::go_on`].
    pub fn begin_message(&mut self, message: &[u8], port: &mut impl Port) {
        self.finish(port);
        let digest = digest::of_bytes(message);
        if self.last_message.replace(digest) == Some(digest) {
            self.duplicate = self.duplicate.saturating_add(1);
            return;
        }
        self.begin_second(port.uptime_s());
        match self.read(message) {
            (Origin::Open, Ok(Uplink { request: Request::Command(Command::Status), .. }))
                if core::mem::replace(&mut self.open_status, true) =>
            {
                self.duplicate = self.duplicate.saturating_add(1);
            }
            (origin, Ok(uplink)) => self.dispatch(&uplink, origin, port),
            (origin, Err(refusal)) => self.refuse(0, refusal, origin, port),
        }
    }

    /// Allows again what anybody may ask for a few times a second, where the clock shows another one.
    fn begin_second(&mut self, uptime_s: Option<u32>) {
        if uptime_s != Some(self.second) {
            self.second = uptime_s.unwrap_or_default();
            self.open_refusals = 0;
            self.unproven_refusals = 0;
            self.open_status = false;
        }
    }

    fn dispatch(&mut self, uplink: &Uplink, origin: Origin, port: &mut impl Port) {
        self.count_missed(uplink.sequence, origin);
        let result = match &uplink.request {
            // A board in a crash loop only says how it is.
            request if self.heartbeat_only && !matches!(request, Request::Command(Command::Status)) => {
                Err(Refusal::HeartbeatOnly)
            }
            Request::Measurement(measurement) => match self.measurement(measurement) {
                Ok(()) if self.pace == Pace::Lockstep => {
                    self.due = Due::Estimate(uplink.sequence, origin);
                    return;
                }
                Ok(()) => return,
                refused => refused,
            },
            other => self.carry_out(other, uplink.sequence, port),
        };
        match result {
            Err(refusal) => self.refuse(uplink.sequence, refusal, origin, port),
            // The end of a run is answered when it has ended.
            Ok(()) if self.is_busy() => {}
            Ok(()) => self.answer(uplink.sequence, Ok(()), port),
        }
    }

    /// The first piece of [`Task::tick`]; the others by [`Task::go_on`].
    pub fn begin_tick(&mut self, port: &mut impl Port) {
        self.finish(port);
        if self.newest.is_some() {
            self.due = Due::Estimate(0, Origin::Authentic);
        } else {
            self.be_silent(port);
        }
    }

    /// A tick of the clock without an estimate.
    #[inline(never)]
    fn be_silent(&mut self, port: &mut impl Port) {
        if self.pace == Pace::Clock {
            self.silent_ticks = self.silent_ticks.saturating_add(1);
            self.send_status(port);
        }
    }

    /// Who vouches for a message, and the request inside it, if it may come this way.
    #[inline(never)]
    fn read(&mut self, message: &[u8]) -> (Origin, Result<Uplink, Refusal>) {
        let (origin, payload) = match self.payload(message) {
            Ok(found) => found,
            Err((origin, refusal)) => return (origin, Err(refusal)),
        };
        (origin, uplink::decode(payload).ok_or(Refusal::Malformed))
    }

    fn payload<'m>(&mut self, message: &'m [u8]) -> Result<(Origin, &'m [u8]), (Origin, Refusal)> {
        let refused = |refusal| (Origin::Open, refusal);
        let [version, protection, open @ ..] = message else {
            return Err(refused(Refusal::Malformed));
        };
        if *version != uplink::VERSION {
            return Err(refused(Refusal::Version));
        }
        match *protection {
            // Before it is read: what must be secured costs nothing here.
            uplink::OPEN => match uplink::may_come_open(&self.estimator.config().security, open) {
                Some(true) => Ok((Origin::Open, open)),
                Some(false) => Err(refused(Refusal::NotSecured)),
                None => Err(refused(Refusal::Malformed)),
            },
            // Without the store it has no epoch to check it by.
            uplink::SECURED if self.heartbeat_only => Err(refused(Refusal::HeartbeatOnly)),
            uplink::SECURED => match self.verifier.open(DATA_ID, message) {
                Ok(checked) => Ok((Origin::Authentic, checked.get(2..).unwrap_or_default())),
                Err(error) => Err((Origin::Unproven, refusal_of(error))),
            },
            _ => Err(refused(Refusal::Malformed)),
        }
    }

    /// Takes a measurement for the tick that comes, or refuses it.
    fn measurement(&mut self, measurement: &Measurement) -> Result<(), Refusal> {
        if !self.described() {
            return Err(Refusal::NotDescribed);
        }
        if !self.running {
            return Err(Refusal::NotRunning);
        }
        if self.pace == Pace::Clock {
            let (last_s, time_s) = (self.last_time_s, measurement.time_s);
            let is_better = |waiting: Measurement| self.comes_before(time_s, waiting.time_s);
            if !is_time(time_s) || self.newest.is_some_and(|waiting| !is_better(waiting)) {
                let out_of_range = is_out_of_range(last_s, time_s);
                return Err(if out_of_range { Refusal::OutOfRange } else { Refusal::TimeNotIncreasing });
            }
        }
        self.newest = Some(*measurement);
        Ok(())
    }

    /// Whether a measurement of this time takes the place of one that waits: it goes on better from those before, or is
    /// newer; of two that no clock shows either waits, which the estimator judges.
    fn comes_before(&self, time_s: Real, waiting_s: Real) -> bool {
        let (now, before) = (self.order(time_s), self.order(waiting_s));
        let is_next = match now {
            // The first and the last by turns: one of them may be right.
            Order::Other => self.silent_ticks.is_multiple_of(2),
            Order::Same | Order::Agreeing | Order::Pause | Order::Next => is_later(waiting_s, time_s),
        };
        now > before || now == before && is_next
    }

    fn order(&self, time_s: Real) -> Order {
        self.run.plausibility.order(&self.estimator.config().plausibility, time_s)
    }

    /// The estimate of the newest measurement.
    #[inline(never)]
    fn step(&mut self) -> Result<(), Refusal> {
        // There is one where this is due.
        let Some(measurement) = self.newest.take() else {
            return Ok(());
        };
        let is_set = self.order(measurement.time_s) < Order::Pause;
        let (estimate, taken) = self.estimator.estimate(self.run, &measurement).map_err(|error| match error {
            StepError::TimeNotIncreasing { .. } => Refusal::TimeNotIncreasing,
            StepError::TimeOutOfRange { .. } => Refusal::OutOfRange,
        })?;
        (self.estimate, self.taken) = (Some(estimate), taken);
        // Where the clock was set, what came before it says nothing of how long the train has stood.
        if is_set {
            self.standing_since_s = None;
        }
        self.last_time_s = Some(measurement.time_s);
        self.silent_ticks = 0;
        self.tick = self.tick.wrapping_add(1);
        Ok(())
    }

    fn count_missed(&mut self, sequence: u16, origin: Origin) {
        // Where measurements are secured, whoever only reaches the line shall not make losses: an open number counts
        // where it is the next one, as the sender's own requests of a status have it.
        let next = self.last_uplink.is_none_or(|last| sequence == last.wrapping_add(1));
        if origin == Origin::Open && self.estimator.config().security.secured_measurements && !next {
            return;
        }
        if let Some(last) = self.last_uplink.replace(sequence) {
            let gap = sequence.wrapping_sub(last).wrapping_sub(1);
            if gap < LEAST_RESTART {
                self.missed = self.missed.saturating_add(u32::from(gap));
            }
        }
    }

    fn answer(&mut self, to: u16, result: Result<(), Refusal>, port: &mut impl Port) {
        self.answer_as(to, result, WhenFull::DropOldest, port);
    }

    /// Answers with a refusal or, where this second has had enough of them, counts it only.
    fn refuse(&mut self, to: u16, refusal: Refusal, origin: Origin, port: &mut impl Port) {
        let refusals = match origin {
            Origin::Open => &mut self.open_refusals,
            Origin::Unproven => &mut self.unproven_refusals,
            Origin::Authentic => return self.answer(to, Err(refusal), port),
        };
        if *refusals >= REFUSALS_A_SECOND {
            return self.count_refusal(refusal);
        }
        *refusals += 1;
        self.answer_as(to, Err(refusal), WhenFull::DropThis, port);
    }

    #[inline(never)]
    fn answer_as(&mut self, to: u16, result: Result<(), Refusal>, when_full: WhenFull, port: &mut impl Port) {
        if let Err(refusal) = result {
            self.count_refusal(refusal);
            self.note(Event::Refused(refusal));
        }
        self.send_as(Body::Answer(Answer { to, result }), when_full, port);
    }

    fn count_refusal(&mut self, refusal: Refusal) {
        if let Some(count) = self.refusals.get_mut(refusal as usize) {
            *count = count.saturating_add(1);
        }
    }

    /// For whoever reads the board's log.
    fn note(&mut self, event: Event) {
        // A full ring drops it: the frames have it too.
        let _noted = self.events.push_back(event).is_ok();
    }

    /// What has happened since this was asked last, oldest first; to be asked after each call, or later events are
    /// dropped.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    fn described(&self) -> bool {
        self.train_id.is_some() && self.track_id.is_some()
    }
}

fn refusal_of(refused: crate::onboard::auth::Refusal) -> Refusal {
    use crate::onboard::auth::Refusal as Auth;
    match refused {
        Auth::Unprovisioned(_) | Auth::NoEpoch(_) => Refusal::Unprovisioned,
        Auth::WrongLength { .. } => Refusal::Malformed,
        Auth::Stale { .. } | Auth::OtherEpoch { .. } => Refusal::Stale,
        Auth::WrongMac => Refusal::WrongMac,
    }
}
