//! The firmware's application: bytes of a serial line into the tick task, its messages onto the line. Board and host call these functions, and differ in nothing else.

use crate::estimator::run_state::RunState;
use crate::link::Counters;
use crate::link::serial::{self, Decoder};
use crate::onboard::auth::{Provisioning, ProvisioningError};
use crate::onboard::task::{Port, Room, Task};
use embedded_storage::nor_flash::NorFlash;
use rundown_wire::Health;

/// State of the application.
pub struct Application<'a, F> {
    task: Task<'a, F>,
    decoder: Decoder,
    messages: Counters,
}

impl<'a, F: NorFlash> Application<'a, F> {
    /// After the start of the board.
    pub fn new(
        provisioning: Result<Provisioning, ProvisioningError>,
        flash: F,
        heartbeat_only: bool,
        run: &'a mut RunState,
        room: &'a mut Room,
    ) -> Self {
        Self {
            task: Task::new(provisioning, flash, heartbeat_only, run, room),
            decoder: Decoder::new(),
            messages: Counters::ZERO,
        }
    }

    /// A byte came over the line. `health` is asked when a status is due.
    pub fn receive(&mut self, byte: u8, health: impl Fn() -> Health + Copy, send: &mut impl FnMut(&[u8]) -> bool) {
        match self.decoder.push(byte) {
            Ok(Some(message)) => {
                self.messages.received = self.messages.received.saturating_add(1);
                let mut line = AnswerPort { send, health, messages: &mut self.messages };
                self.task.receive(message, &mut line);
            }
            Ok(None) => {}
            Err(error) => error.count(&mut self.messages),
        }
    }

    /// A tick of the clock.
    pub fn tick(&mut self, health: impl Fn() -> Health, send: &mut impl FnMut(&[u8]) -> bool) {
        let mut line = AnswerPort { send, health, messages: &mut self.messages };
        self.task.tick(&mut line);
    }
}

/// The line as the task sees it.
struct AnswerPort<'a, S, H> {
    send: &'a mut S,
    health: H,
    messages: &'a mut Counters,
}

impl<S: FnMut(&[u8]) -> bool, H: Fn() -> Health> Port for AnswerPort<'_, S, H> {
    fn send(&mut self, message: &[u8]) -> bool {
        let sent = serial::encode(message).is_ok_and(|frame| (self.send)(&frame));
        if sent {
            self.messages.sent = self.messages.sent.saturating_add(1);
        }
        sent
    }

    fn health(&self) -> Health {
        Health { messages: *self.messages, ..(self.health)() }
    }
}
