//! One state, written by the source's thread, read by every view.
//!
//! In: messages of the board and to it, damage, what becomes of the connection. Out: [`View`]s under one lock, and a
//! wait for the next change.

use super::{sent::SentSetup, setup::Setup, state::State};
use rundown_wire::{Reader, Received, Tally};
use serde::Serialize;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Ticks without a frame after which what is shown is old.
const SILENT_TICKS: f64 = 2.5;
/// Period that is assumed until frames of the board show it, s.
const TICK_S: f64 = 10.0;
/// However fast a recording is played, a screen is not old before, s.
const LEAST_SILENCE_S: f64 = 2.0;

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "state", content = "error")]
pub enum Connection {
    #[default]
    Opening,
    Open,
    /// It failed, for this reason; it is tried again.
    Lost(String),
    /// A recording is at its end.
    Ended,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkHealth {
    pub source: String,
    pub connection: Connection,
    pub reconnects: u32,
    /// Time since the last frame, s; none before the first.
    pub age_s: Option<f64>,
    /// The present values are old: no frame for more than two ticks.
    pub silent: bool,
    #[serde(flatten)]
    pub tally: Tally,
}

struct Inner {
    reader: Reader,
    state: State,
    sent: SentSetup,
    setup: Setup,
    described: u32,
    connection: Connection,
    opened: u32,
    damaged: u32,
    heard: Option<Instant>,
    version: u64,
    on_message: OnMessage,
}

/// Told of every message, and of the frame that it is.
pub type OnMessage = Box<dyn FnMut(&[u8], Option<&Received>) + Send>;

pub struct Hub {
    source: String,
    speed: f64,
    files: Setup,
    inner: Mutex<Inner>,
    changed: Condvar,
}

/// What a view sees, while it holds the lock.
pub struct View<'a> {
    pub state: &'a State,
    pub link: LinkHealth,
    /// Train and track: of the files, else as described to the board.
    pub setup: &'a Setup,
    /// Counts changes of the setup.
    pub described: u32,
    pub version: u64,
}

impl Hub {
    /// Of a source with this name, whose time goes `speed` times as fast, of a train and track with these files.
    pub fn new(source: String, speed: f64, files: Setup, on_message: OnMessage) -> Self {
        Self {
            source,
            speed,
            files: files.clone(),
            inner: Mutex::new(Inner {
                reader: Reader::new(),
                state: State::default(),
                sent: SentSetup::default(),
                setup: files,
                described: 0,
                connection: Connection::Opening,
                opened: 0,
                damaged: 0,
                heard: None,
                version: 0,
                on_message,
            }),
            changed: Condvar::new(),
        }
    }

    pub fn message(&self, message: &[u8]) {
        let mut inner = self.lock();
        let received = inner.reader.message(message);
        if let Some(received) = &received {
            inner.heard = Some(Instant::now());
            inner.state.take(received);
        }
        (inner.on_message)(message, received.as_ref());
        self.change(inner);
    }

    /// This was sent to the board.
    pub fn sent(&self, message: &[u8]) {
        let mut inner = self.lock();
        let Some(described) = inner.sent.hear(message) else {
            return;
        };
        let setup = self.files.clone().or(described);
        if setup != inner.setup {
            inner.setup = setup;
            inner.described = inner.described.wrapping_add(1);
            self.change(inner);
        }
    }

    /// So many pieces of the line were no message.
    pub fn damaged(&self, more: u32) {
        if more > 0 {
            let mut inner = self.lock();
            inner.damaged = inner.damaged.saturating_add(more);
            self.change(inner);
        }
    }

    pub fn connection(&self, connection: Connection) {
        let mut inner = self.lock();
        if connection == Connection::Open {
            inner.opened = inner.opened.saturating_add(1);
        }
        inner.connection = connection;
        self.change(inner);
    }

    pub fn view<T>(&self, look: impl FnOnce(View<'_>) -> T) -> T {
        let inner = self.lock();
        look(self.view_of(&inner))
    }

    /// Waits until something has changed since `version`, or so long.
    pub fn wait<T>(&self, version: u64, longest: Duration, look: impl FnOnce(View<'_>) -> T) -> T {
        let (inner, _) = self
            .changed
            .wait_timeout_while(self.lock(), longest, |inner| inner.version == version)
            .unwrap_or_else(PoisonError::into_inner);
        look(self.view_of(&inner))
    }

    fn view_of<'a>(&self, inner: &'a Inner) -> View<'a> {
        let age_s = inner.heard.map(|heard| heard.elapsed().as_secs_f64());
        let dt_s = inner.state.now.estimate.map(|estimate| f64::from(estimate.dt_s));
        let tick_s = dt_s.filter(|dt_s| *dt_s > 0.0).unwrap_or(TICK_S) / self.speed;
        let longest_s = (SILENT_TICKS * tick_s).max(LEAST_SILENCE_S);
        let mut tally = *inner.reader.tally();
        tally.damaged = tally.damaged.saturating_add(inner.damaged);
        View {
            state: &inner.state,
            link: LinkHealth {
                source: self.source.clone(),
                connection: inner.connection.clone(),
                reconnects: inner.opened.saturating_sub(1),
                age_s,
                silent: age_s.is_none_or(|age_s| age_s > longest_s),
                tally,
            },
            setup: &inner.setup,
            described: inner.described,
            version: inner.version,
        }
    }

    // A view that panicked has changed nothing.
    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, mut inner: MutexGuard<'_, Inner>) {
        inner.version = inner.version.wrapping_add(1);
        drop(inner);
        self.changed.notify_all();
    }
}
