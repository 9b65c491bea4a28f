//! A board on the host: the tick task over a flash and a link of test's own, and a desk that talks to it.

use crate::described::{description, measurements, with_targets};
use crate::flash::Flash;
use crate::prelude::*;
use rundown::estimator::run_state::RunState;
use rundown::onboard::auth::{Key, Provisioning, ProvisioningError};
use rundown::onboard::event::Event;
use rundown::onboard::outbox::WhenFull;
use rundown::onboard::task::{Port, Room, Task};
use rundown_wire::{Answer, Downlink, Estimate, Health, Refusal, SnapshotPart, Status};

/// The first frame of a kind: `said!(frames, Status)`.
#[macro_export]
macro_rules! said {
    ($frames:expr, $kind:ident) => {
        $frames.iter().find_map(|frame: &rundown_wire::Downlink| match &frame.body {
            rundown_wire::Body::$kind(said) => Some(said.clone()),
            _ => None,
        })
    };
}

/// The key and the train of the board.
pub const PROVISIONING: Provisioning =
    Provisioning { key_id: 1, key: Key::new(*b"not a secret key"), train: TrainId(0x2451) };

/// A link that keeps what it is given.
#[derive(Debug, Default)]
pub struct Wire {
    /// Messages that wait to be read.
    pub messages: Vec<Vec<u8>>,
    /// How many more find room; none: all.
    pub room: Option<usize>,
    /// What the board says of itself.
    pub health: Health,
}

impl Port for Wire {
    fn send(&mut self, message: &[u8], _: WhenFull) {
        match &mut self.room {
            Some(0) => {
                self.health.not_sent += 1;
                return;
            }
            Some(room) => *room -= 1,
            None => {}
        }
        self.messages.push(message.to_vec());
    }

    fn health(&self) -> Health {
        self.health
    }

    /// No clock, unless a test sets it.
    fn uptime_s(&self) -> Option<u32> {
        Some(self.health.uptime_s).filter(|now_s| *now_s > 0)
    }
}

/// A task of its own. Its memory is never given back, as on a board; a test starts a few.
pub fn task(
    provisioning: Result<Provisioning, ProvisioningError>,
    flash: Flash,
    heartbeat_only: bool,
) -> Task<'static, Flash> {
    let run = Box::leak(Box::new(RunState::idle()));
    let room = Box::leak(Box::new(Room::EMPTY));
    Task::new(provisioning, flash, heartbeat_only, run, room)
}

/// A board and who talks to it.
pub struct Board {
    /// The application.
    pub task: Task<'static, Flash>,
    /// Its link.
    pub wire: Wire,
    /// The other end.
    pub desk: Desk,
    /// What happened, for the log.
    pub log: Vec<Event>,
}

impl Board {
    /// Starts with this flash.
    pub fn start(flash: Flash) -> Self {
        Self {
            task: task(Ok(PROVISIONING), flash, false),
            wire: Wire::default(),
            desk: Desk::new(PROVISIONING),
            log: Vec::new(),
        }
    }

    /// With empty flash and a run of the description under way in lockstep.
    pub fn running(description: &Description) -> Self {
        let mut board = Self::start(Flash::erased(8));
        board.prepare(description, Direction::Up);
        board
    }

    /// Power goes and comes: nothing stays but the flash. The desk goes on.
    pub fn restart(self) -> Self {
        let flash = self.task.release().expect("a store");
        Self { desk: self.desk, ..Self::start(flash) }
    }

    /// Hands over a message and reads the frames that it brings.
    pub fn say(&mut self, message: &[u8]) -> Vec<Downlink> {
        self.task.receive(message, &mut self.wire);
        self.log_events();
        self.heard()
    }

    /// One tick of the clock.
    pub fn tick(&mut self) -> Vec<Downlink> {
        self.task.tick(&mut self.wire);
        self.log_events();
        self.heard()
    }

    fn log_events(&mut self) {
        self.log.extend(std::iter::from_fn(|| self.task.next_event()));
    }

    /// The frames that wait, each read and heard by the desk.
    pub fn heard(&mut self) -> Vec<Downlink> {
        let read = |message: Vec<u8>| {
            let frame = Downlink::decode(&message).expect("a frame of this version");
            self.desk.hear(&frame).expect("the same key");
            frame
        };
        self.wire.messages.drain(..).map(read).collect()
    }

    /// Asks something that changes the board.
    pub fn ask(&mut self, request: Request) -> Result<(), Refusal> {
        let message = self.desk.secured(request).expect("announced");
        answer(&self.say(&message)).expect("an answer").result
    }

    /// Ends the run and reads the frames that this brings.
    pub fn end(&mut self) -> Vec<Downlink> {
        let message = self.desk.secured(Request::Command(Command::End)).expect("announced");
        self.say(&message)
    }

    /// A measurement; in lockstep its frames come back.
    pub fn measure(&mut self, measurement: &Measurement) -> Vec<Downlink> {
        let message = self.desk.open(Request::Measurement(*measurement));
        self.say(&message.expect("short"))
    }

    /// Its status.
    pub fn status(&mut self) -> Status {
        let message = self.desk.open(Request::Command(Command::Status));
        said!(self.say(&message.expect("short")), Status).expect("a status")
    }

    /// A whole snapshot.
    pub fn snapshot(&mut self) -> Vec<SnapshotPart> {
        loop {
            self.ask(Request::Command(Command::Snapshot)).expect("a run");
            if let Some(parts) = self.desk.snapshot() {
                return parts.to_vec();
            }
        }
    }

    /// Describes train and track, as after a restart.
    pub fn describe(&mut self, description: &Description) {
        self.status();
        for request in description.requests(PROVISIONING.train.0) {
            self.ask(request).expect("described");
        }
    }

    /// Describes train and track and begins a run in lockstep.
    pub fn prepare(&mut self, description: &Description, direction: Direction) {
        self.status();
        let messages = self.desk.prepare(description, direction, Pace::Lockstep);
        for message in messages.expect("announced") {
            let frames = self.say(&message);
            assert_eq!(answer(&frames).map(|answer| answer.result), Some(Ok(())));
        }
    }
}

/// The answer among frames.
pub fn answer(frames: &[Downlink]) -> Option<Answer> {
    said!(frames, Answer)
}

/// The estimate among frames.
pub fn estimate(frames: &[Downlink]) -> Option<Estimate> {
    said!(frames, Estimate)
}

/// A description of the train and the line of the case study, and a simulated run.
pub fn described() -> (Description, Vec<Measurement>) {
    let scenario = Scenario::default();
    (description(Config::default(), &scenario), measurements(&simulate(&scenario, 3)))
}

/// The same with the line's targets.
pub fn case_study() -> (Description, Vec<Measurement>) {
    let (_, log) = described();
    (with_targets(Config::default(), &Scenario::default()), log)
}

/// A board with a run under way, its description, and what it is to measure.
pub fn running((description, log): (Description, Vec<Measurement>)) -> (Board, Description, Vec<Measurement>) {
    (Board::running(&description), description, log)
}
