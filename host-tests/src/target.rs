//! The firmware in the emulator beside the task on the host: the same messages in, and frame by frame the same bytes
//! out.

use crate::board::{PROVISIONING, Wire, task};
use crate::flash::Flash;
use crate::prelude::*;
use emulator::{Board, Emulator, NoImage, Settings};
use rundown::link::serial::{self, SerialLink};
use rundown::link::{Counters, Link, LinkError, Message};
use rundown::onboard::task::Task;
use rundown_wire::{Body, Health};
use sim_harness::link::port::HostPort;
use sim_harness::session::{Heard, PATIENCE, Session};
use std::error::Error;
use std::time::Instant;

/// Where the provisioning record lies in the flash of the reference board.
const KEY_ADDRESS: u32 = 0x080F_F800;

/// How to start the firmware of the reference board with a key in its flash.
///
/// # Errors
/// It is not built: that takes a compiler which plain `cargo test` does not bring.
pub fn firmware() -> Result<Settings, NoImage> {
    let preloads = vec![(KEY_ADDRESS, PROVISIONING.to_bytes().to_vec())];
    Ok(Settings { preloads, ..Settings::new(Board::L475Emulated)? })
}

/// The task on the host, as a link: what is sent goes in, what comes out is received.
struct HostBoard {
    task: Task<'static, Flash>,
    wire: Wire,
}

impl Link for HostBoard {
    type PortError = std::convert::Infallible;

    fn send(&mut self, message: &[u8], _now_us: u64) -> Result<(), LinkError<Self::PortError>> {
        self.task.receive(message, &mut self.wire);
        Ok(())
    }

    fn receive(&mut self, _now_us: u64) -> Result<Option<Message>, LinkError<Self::PortError>> {
        if self.wire.messages.is_empty() {
            return Ok(None);
        }
        let message = self.wire.messages.remove(0);
        Ok(Message::from_slice(&message).ok())
    }

    fn is_sending(&self) -> bool {
        false
    }

    fn counters(&self) -> Counters {
        Counters::ZERO
    }
}

/// A session with the task on the host.
fn on_host() -> Session<impl Link<PortError = std::convert::Infallible>> {
    let board = HostBoard { task: task(Ok(PROVISIONING), Flash::erased(8), false), wire: Wire::default() };
    Session::new(board, Desk::new(PROVISIONING))
}

/// A session with the firmware in the emulator, once it says that it is there.
///
/// # Errors
/// It does not say that it has started.
pub fn on_target(
    emulator: &mut Emulator,
) -> Result<Session<impl Link<PortError = std::io::Error> + use<>>, Box<dyn Error>> {
    let port = HostPort::tcp(emulator.line().try_clone()?)?;
    let mut session = Session::new(SerialLink::new(port), Desk::new(PROVISIONING));
    let begin = Instant::now();
    while session.listen()?.is_none() {
        if begin.elapsed() > PATIENCE {
            return Err("the firmware does not say that it has started".into());
        }
        std::thread::yield_now();
    }
    Ok(session)
}

/// A comparison that went through.
#[derive(Clone, Debug)]
pub struct Same {
    /// Measurements.
    pub ticks: usize,
    /// Frames that were the same, byte by byte.
    pub frames: usize,
    /// Their bytes on the serial line.
    pub line_bytes: usize,
    /// What the firmware said of itself last.
    pub health: Health,
    /// Every message of the firmware.
    pub messages: Vec<Vec<u8>>,
}

/// Plays runs to both, one after another. All frames must be the same, but for [`Body::Health`] and [`Body::Versions`],
/// which tell of the hardware and the build.
///
/// # Errors
/// The first tick whose frames differ, with both; or why a session ended.
pub fn compare(
    settings: &Settings,
    description: &Description,
    direction: Direction,
    runs: &[&[Measurement]],
) -> Result<Same, Box<dyn Error>> {
    let mut emulator = Emulator::start(settings)?;
    let mut target = on_target(&mut emulator)?;
    let mut host = on_host();
    host.prepare(description, direction, Pace::Lockstep)?;
    target.prepare(description, direction, Pace::Lockstep)?;
    let ticks = runs.iter().map(|log| log.len()).sum();
    let mut same = Same { ticks, frames: 0, line_bytes: 0, health: Health::default(), messages: Vec::new() };
    let mut check = |what: &dyn Fn() -> String, expected: Vec<Heard>, found: Vec<Heard>| {
        for heard in &found {
            same.line_bytes += serial::encode(&heard.message).map_or(0, |frame| frame.len());
            same.messages.push(heard.message.clone());
            if let Body::Health(health) = heard.frame.body {
                same.health = health;
            }
        }
        let (expected, found) = (comparable(&expected), comparable(&found));
        if expected == found {
            same.frames += found.len();
            return Ok(());
        }
        let pair = expected.iter().zip(&found).find(|(a, b)| a != b);
        Err(match pair {
            Some((expected, found)) => format!(
                "{}: the frames differ\n  host     {:02x?}\n           {:?}\n  firmware {:02x?}\n           {:?}",
                what(),
                expected.message,
                expected.frame,
                found.message,
                found.frame
            ),
            None => format!("{}: {} frames of the host, {} of the firmware", what(), expected.len(), found.len()),
        })
    };
    for (run, log) in runs.iter().enumerate() {
        if run > 0 {
            let command = Request::Command(Command::Begin { direction, track_id: description.track_id() });
            let [expected, found] = [host.ask(command.clone(), "a run")?, target.ask(command, "a run")?];
            check(&|| format!("begin of run {}", run + 1), expected, found)?;
        }
        for (tick, measurement) in log.iter().enumerate() {
            let (expected, found) = (host.measure(measurement)?, target.measure(measurement)?);
            let what = || format!("run {}, tick {}, {} s", run + 1, tick + 1, measurement.time_s);
            check(&what, expected, found)?;
        }
        check(&|| format!("end of run {}", run + 1), host.end_run()?, target.end_run()?)?;
    }
    Ok(same)
}

fn comparable(frames: &[Heard]) -> Vec<&Heard> {
    let of_the_task = |heard: &&Heard| !matches!(heard.frame.body, Body::Health(_) | Body::Versions(_));
    frames.iter().filter(of_the_task).collect()
}
