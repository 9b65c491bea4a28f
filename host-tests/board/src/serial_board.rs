//! The application behind a serial line of 115 200 bit/s, with the outbox of the firmware: in each byte's time one byte
//! comes at most, and one goes.

use crate::board::{PROVISIONING, answer};
use crate::flash::Flash;
use crate::prelude::*;
use rundown::estimator::run_state::RunState;
use rundown::onboard::application::{Application, Hardware};
use rundown::onboard::outbox::{Outbox, WhenFull};
use rundown::onboard::task::Room;
use rundown_wire::link::serial::{Decoder, encode};
use rundown_wire::{Downlink, Health};

/// Bytes that the line carries in a second, each way.
pub const LINE_BYTES_PER_S: u64 = 11_520;
/// Bytes of frames that may wait, as in the firmware.
const OUTBOX: usize = 4096;
/// Period of the tick, s.
const PERIOD_S: u64 = 10;

/// A board, its line, and who listens.
pub struct SerialBoard {
    application: Application<'static, Flash>,
    outbox: Outbox<OUTBOX>,
    decoder: Decoder,
    /// Bytes' times since the start.
    passed: u64,
    /// Nobody takes what the board sends.
    pub deaf: bool,
    /// The other end.
    pub desk: Desk,
    /// The frames that have arrived, each with the byte's time of its arrival.
    pub heard: Vec<(u64, Downlink)>,
}

/// What the application may ask of its board.
#[derive(Clone, Copy)]
struct State {
    uptime_s: u32,
    not_sent: u32,
}

impl Hardware for State {
    fn health(&self) -> Health {
        Health { uptime_s: self.uptime_s, not_sent: self.not_sent, ..Health::default() }
    }

    fn uptime_s(&self) -> Option<u32> {
        Some(self.uptime_s)
    }
}

impl SerialBoard {
    /// With empty flash. Its memory is never given back, as on a board.
    pub fn start() -> Self {
        let (run, room) = (Box::leak(Box::new(RunState::idle())), Box::leak(Box::new(Room::EMPTY)));
        Self {
            application: Application::new(Ok(PROVISIONING), Flash::erased(8), false, run, room),
            outbox: Outbox::new(),
            decoder: Decoder::new(),
            passed: 0,
            deaf: false,
            desk: Desk::new(PROVISIONING),
            heard: Vec::new(),
        }
    }

    /// Bytes' times since the start.
    pub fn passed(&self) -> u64 {
        self.passed
    }

    /// One byte's time: one comes or none, one goes.
    pub fn pass(&mut self, byte: Option<u8>) {
        let state = State {
            uptime_s: u32::try_from(self.passed / LINE_BYTES_PER_S).expect("no test takes that long"),
            not_sent: self.outbox.dropped(),
        };
        let outbox = &mut self.outbox;
        let mut send = |frame: &[u8], when_full: WhenFull| outbox.push(frame, when_full).is_ok();
        if self.passed.is_multiple_of(PERIOD_S * LINE_BYTES_PER_S) {
            self.application.tick(state, &mut send);
        }
        if let Some(byte) = byte {
            self.application.receive_byte(byte, state, &mut send);
        }
        while self.application.is_busy() {
            self.application.go_on(state, &mut send);
        }
        self.passed += 1;
        let gone = if self.deaf { None } else { self.outbox.pop() };
        // A frame that was cut is none.
        if let Some(Ok(Some(message))) = gone.map(|byte| self.decoder.push(byte)) {
            let frame = Downlink::decode(message).expect("a frame of this version");
            self.desk.hear(&frame).expect("the same key");
            self.heard.push((self.passed, frame));
        }
    }

    /// A whole message comes, back to back.
    pub fn say(&mut self, message: &[u8]) {
        encode(message).expect("short").into_iter().for_each(|byte| self.pass(Some(byte)));
    }

    /// The line is silent.
    pub fn wait(&mut self, seconds: u64) {
        (0..seconds * LINE_BYTES_PER_S).for_each(|_| self.pass(None));
    }

    /// Describes train and track and begins a run by the clock.
    pub fn prepare(&mut self, description: &Description) {
        let status = self.desk.open(Request::Command(Command::Status)).expect("short");
        self.say(&status);
        self.wait(1);
        for message in self.desk.prepare(description, Direction::Up, Pace::Clock).expect("announced") {
            self.heard.clear();
            self.say(&message);
            self.wait(1);
            let frames: Vec<Downlink> = self.heard.drain(..).map(|(_, frame)| frame).collect();
            assert_eq!(answer(&frames).map(|answer| answer.result), Some(Ok(())));
        }
    }
}
