//! The firmware's application: bytes of a serial line into the tick task, its messages onto the line. Board and host
//! call these functions, and differ in nothing else.

use crate::estimator::run_state::RunState;
use crate::link::Counters;
use crate::link::serial::{self, Decoder};
use crate::onboard::auth::{KeySource, Provisioning, ProvisioningError};
use crate::onboard::event::Event;
use crate::onboard::outbox::WhenFull;
use crate::onboard::task::{Port, Room, Task};
use embedded_storage::nor_flash::NorFlash;
use rundown_wire::Health;

/// The hardware, as far as the application asks about it.
pub trait Hardware: Copy {
    /// How it is. Takes its time: the stack is searched.
    fn health(&self) -> Health;
    /// Seconds since the start; none: no clock.
    fn uptime_s(&self) -> Option<u32> {
        None
    }
    /// What links beside the serial line have counted.
    fn other_links(&self) -> Counters {
        Counters::ZERO
    }
    /// Something happened, for the log.
    fn log(&self, _: &Event) {}
}

impl<F: Fn() -> Health + Copy> Hardware for F {
    fn health(&self) -> Health {
        self()
    }
}

/// State of the application.
pub struct Application<'a, F, K = Result<Provisioning, ProvisioningError>> {
    task: Task<'a, F, K>,
    decoder: Decoder,
    messages: Counters,
}

impl<'a, F: NorFlash, K: KeySource> Application<'a, F, K> {
    /// After the start of the board.
    pub fn new(keys: K, flash: F, heartbeat_only: bool, run: &'a mut RunState, room: &'a mut Room) -> Self {
        Self {
            task: Task::new(keys, flash, heartbeat_only, run, room),
            decoder: Decoder::new(),
            messages: Counters::ZERO,
        }
    }

    /// A byte came over the line. What it asks for is begun; the rest is done by [`Application::go_on`], before the
    /// next byte.
    pub fn receive_byte(&mut self, byte: u8, hardware: impl Hardware, send: &mut impl FnMut(&[u8], WhenFull) -> bool) {
        match self.decoder.push(byte) {
            Ok(Some(message)) => {
                self.messages.received = self.messages.received.saturating_add(1);
                let mut line = AnswerPort { send, hardware, messages: &mut self.messages };
                self.task.begin_message(message, &mut line);
                self.log(hardware);
            }
            Ok(None) => {}
            Err(error) => error.count(&mut self.messages),
        }
    }

    /// A whole message came over another link, which counts for itself; as a byte of the line.
    pub fn receive_message(
        &mut self,
        message: &[u8],
        hardware: impl Hardware,
        send: &mut impl FnMut(&[u8], WhenFull) -> bool,
    ) {
        let mut line = AnswerPort { send, hardware, messages: &mut self.messages };
        self.task.begin_message(message, &mut line);
        self.log(hardware);
    }

    /// A tick of the clock; the rest is done by [`Application::go_on`].
    pub fn tick(&mut self, hardware: impl Hardware, send: &mut impl FnMut(&[u8], WhenFull) -> bool) {
        let mut line = AnswerPort { send, hardware, messages: &mut self.messages };
        self.task.begin_tick(&mut line);
        self.log(hardware);
    }

    /// Something is still to be done.
    pub fn is_busy(&self) -> bool {
        self.task.is_busy()
    }

    /// The next piece of it.
    pub fn go_on(&mut self, hardware: impl Hardware, send: &mut impl FnMut(&[u8], WhenFull) -> bool) {
        let mut line = AnswerPort { send, hardware, messages: &mut self.messages };
        self.task.go_on(&mut line);
        self.log(hardware);
    }

    fn log(&mut self, hardware: impl Hardware) {
        while let Some(event) = self.task.next_event() {
            hardware.log(&event);
        }
    }
}

/// The line as the task sees it.
struct AnswerPort<'a, S, H> {
    send: &'a mut S,
    hardware: H,
    messages: &'a mut Counters,
}

impl<S: FnMut(&[u8], WhenFull) -> bool, H: Hardware> Port for AnswerPort<'_, S, H> {
    fn send(&mut self, message: &[u8], when_full: WhenFull) {
        let sent = serial::encode(message).is_ok_and(|frame| (self.send)(&frame, when_full));
        if sent {
            self.messages.sent = self.messages.sent.saturating_add(1);
        }
    }

    fn health(&self) -> Health {
        Health { messages: self.messages.and(&self.hardware.other_links()), ..self.hardware.health() }
    }

    fn uptime_s(&self) -> Option<u32> {
        self.hardware.uptime_s()
    }
}
