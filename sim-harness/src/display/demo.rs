//! Runs of the case study through the board's task, without a board: frames to look at.
//!
//! In: nothing. Out: messages, as a board sends them in lockstep. The train is 8 % better than described, the board knows of the weak section at the departure and of its strong motors.

use crate::desk::{Description, Desk};
use crate::session::{Heard, Session};
use crate::study::case::{case_study, fleet_run};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use rundown::link::{Counters, Link, LinkError, Message};
use rundown::model::effects::{Effect, Effects, PowerLimitSection, TractionScale};
use rundown::onboard::auth::{Key, Provisioning};
use rundown::onboard::task::{Port, Room, Task};
use rundown::{
    estimator::config::Config, estimator::run_state::RunState, onboard::train_id::TrainId, onboard::uplink::Pace,
};
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
        Description { effects: effects()?, ..Description::new(&train, &simulation.track, Config::default()) };
    let (mut run, mut room) = (Box::new(RunState::idle()), Box::new(Room::EMPTY));
    let task = Task::new(Ok(PROVISIONING), RamFlash::default(), false, &mut run, &mut room);
    let board = Board { task, wire: Outbox::default() };
    let mut session = Session::new(board, Desk::new(PROVISIONING));
    let mut tell = |heard: &[Heard]| heard.iter().for_each(|heard| say(&heard.message));
    for index in 0..runs {
        let case = fleet_run(&simulation, SEED, index).map_err(|error| error.to_string())?;
        let Recording { direction, rows, .. } = case.recording;
        let said = |error: crate::session::SessionError| error.to_string();
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
    fn send(&mut self, message: &[u8]) -> bool {
        Message::from_slice(message).is_ok_and(|message| {
            self.0.push_back(message);
            true
        })
    }

    fn health(&self) -> Health {
        Health::default()
    }
}

/// The task as a link: what is sent goes in, what comes out is received.
struct Board<'a> {
    task: Task<'a, RamFlash>,
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

const PAGE: usize = 2048;
const PAGES: usize = 8;

/// Pages for records that no power cut meets.
struct RamFlash(Vec<u8>);

impl Default for RamFlash {
    fn default() -> Self {
        Self(vec![0xFF; PAGE * PAGES])
    }
}

impl RamFlash {
    fn at(&mut self, offset: u32, length: usize) -> Result<&mut [u8], NorFlashErrorKind> {
        let from = offset as usize;
        self.0.get_mut(from..from.saturating_add(length)).ok_or(NorFlashErrorKind::OutOfBounds)
    }
}

impl ErrorType for RamFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for RamFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        bytes.copy_from_slice(self.at(offset, bytes.len())?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for RamFlash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        self.at(from, (to - from) as usize)?.fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        self.at(offset, bytes.len())?.copy_from_slice(bytes);
        Ok(())
    }
}
