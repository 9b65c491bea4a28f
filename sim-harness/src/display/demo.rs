//! Runs of the case study through the board's task, without a board: frames to look at.
//!
//! In: nothing. Out: messages, as a board sends them in lockstep. The train is 8 % better than described, the board
//! knows of the weak section at the departure and of its strong motors.

use crate::session::{self, Heard, Session};
use crate::study::case::{case_study, fleet_run};
use rundown::link::{Counters, Link, LinkError, Message};
use rundown::model::effects::{Effect, Effects, PowerLimitSection, TractionScale};
use rundown::onboard::auth::{Key, Provisioning};
use rundown::onboard::flash::{MemoryFlash, RECORDS};
use rundown::onboard::outbox::WhenFull;
use rundown::onboard::task::{Port, Room, Task};
use rundown::{estimator::config::Config, estimator::run_state::RunState, onboard::train_id::TrainId, uplink::Pace};
use rundown_desk::{Description, Desk};
use rundown_files::{recording::Recording, track_file::TrackFile, train_file::TrainFile};
use rundown_wire::Health;
use std::{collections::VecDeque, convert::Infallible};

/// Runs of a demonstration: a morning's.
pub const RUNS: usize = 6;
/// The same ones every time.
const SEED: u64 = 1;
/// Not a secret: this board exists in this process only.
const PROVISIONING: Provisioning =
    Provisioning { key_id: 1, key: Key::new(*b"not a secret key"), train: TrainId(0x2451) };

/// Train and track of the runs, as described.
pub fn described() -> Result<(TrainFile, TrackFile), String> {
    let simulation = case_study().map_err(|error| error.to_string())?;
    Ok((simulation.train, simulation.track))
}

/// Plays all runs; each message of the board is given to `say`.
pub fn play(say: impl FnMut(&[u8])) -> Result<(), String> {
    play_runs(RUNS, say)
}

/// Plays the first runs.
pub fn play_runs(runs: usize, mut say: impl FnMut(&[u8])) -> Result<(), String> {
    let simulation = case_study().map_err(|error| error.to_string())?;
    let train = simulation.train.train().map_err(|error| error.to_string())?;
    let description =
        Description { effects: effects()?, ..session::description(&train, &simulation.track, Config::default()) };
    let (mut run, mut room) = (Box::new(RunState::idle()), Box::new(Room::EMPTY));
    let task = Task::new(Ok(PROVISIONING), MemoryFlash::ERASED, false, &mut run, &mut room);
    let board = Board { task, wire: Outbox::default() };
    let mut session = Session::new(board, Desk::new(PROVISIONING));
    let mut tell = |heard: &[Heard]| heard.iter().for_each(|heard| say(&heard.message));
    for index in 0..runs {
        let case = fleet_run(&simulation, SEED, index).map_err(|error| error.to_string())?;
        let Recording { direction, rows, .. } = case.recording;
        let said = |error: session::SessionError| error.to_string();
        tell(&session.prepare(&description, direction, Pace::Lockstep).map_err(said)?);
        for row in &rows {
            tell(&session.measure(&row.measurement()).map_err(said)?);
        }
        tell(&session.end_run().map_err(said)?);
    }
    Ok(())
}

fn effects() -> Result<Effects, String> {
    let section = PowerLimitSection { from_m: 0.0, to_m: 4000.0, factor: 0.95 };
    Effects::try_new([Effect::PowerLimitSection(section), Effect::TractionScale(TractionScale { factor: 1.3 })])
        .map_err(|error| error.to_string())
}

/// What the task says.
#[derive(Default)]
struct Outbox(VecDeque<Message>);

impl Port for Outbox {
    fn send(&mut self, message: &[u8], _: WhenFull) {
        // The task says nothing that is longer.
        self.0.extend(Message::from_slice(message));
    }

    fn health(&self) -> Health {
        Health::default()
    }
}

/// The task as a link: what is sent goes in, what comes out is received.
struct Board<'a> {
    task: Task<'a, MemoryFlash<[u8; RECORDS]>>,
    wire: Outbox,
}

impl Link for Board<'_> {
    type PortError = Infallible;

    fn send(&mut self, message: &[u8], _now_us: u64) -> Result<(), LinkError<Infallible>> {
        self.task.receive(message, &mut self.wire);
        Ok(())
    }

    fn receive(&mut self, _now_us: u64) -> Result<Option<Message>, LinkError<Infallible>> {
        Ok(self.wire.0.pop_front())
    }

    fn is_sending(&self) -> bool {
        false
    }

    fn counters(&self) -> Counters {
        Counters::ZERO
    }
}
