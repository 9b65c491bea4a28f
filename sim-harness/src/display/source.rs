//! Where frames come from.
//!
//! In: a [`FrameSource`]. Out: its messages, in a [`Hub`], and what becomes of it.
//!
//! A port, a connection or an interface that fails is opened again, after [`FIRST_PAUSE`], then twice as long, at most
//! [`LONGEST_PAUSE`]; a source that brings frames begins with the first pause again. A recording is the bytes of a
//! serial line, or what `rundown link --record` writes (`docs/formats.md`); its first bytes show which.

use super::hub::{Connection, Hub};
use super::{demo, player::Player};
use crate::link::record::{Way, recorded_line};
use crate::{link::Clock, link::address::Address};
use rundown::link::serial::Decoder;
use rundown::link::{Counters, Link};
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::{fmt, fs::File, time::Duration};

pub const FIRST_PAUSE: Duration = Duration::from_millis(250);
pub const LONGEST_PAUSE: Duration = Duration::from_secs(4);
/// How often a silent link is polled.
const POLL: Duration = Duration::from_millis(5);
/// How often the end of a file that grows is looked at.
const FOLLOW: Duration = Duration::from_millis(100);
/// First bytes of a recording in text.
const TEXT: &[u8] = b"time_us,";

#[derive(Clone, Debug)]
pub enum FrameSource {
    Board {
        address: Address,
        /// On a CAN bus another computer answers the board.
        listen_only: bool,
    },
    File {
        path: PathBuf,
        /// It grows: its end is not the end.
        follow: bool,
    },
    Stdin,
    Demo,
}

impl fmt::Display for FrameSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Board { address, .. } => address.fmt(f),
            Self::File { path, .. } => path.display().fmt(f),
            Self::Stdin => f.write_str("standard input"),
            Self::Demo => f.write_str("simulated runs"),
        }
    }
}

impl FrameSource {
    pub const fn is_tried_again(&self) -> bool {
        matches!(self, Self::Board { .. } | Self::File { follow: true, .. })
    }

    /// Whether it has an end and a pace of its own.
    pub const fn is_recording(&self) -> bool {
        matches!(self, Self::File { follow: false, .. } | Self::Demo)
    }

    /// Opens what must be there at once: a file that does not grow. All others may come later.
    pub fn open(self) -> io::Result<Open> {
        let named =
            |path: &PathBuf, error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        Ok(match self {
            Self::Board { address, listen_only } => Open::Board(address, listen_only),
            Self::File { path, follow: true } => Open::Growing(path),
            Self::File { path, .. } if path.is_dir() => {
                let found = io::Error::new(io::ErrorKind::IsADirectory, "expected a recording, found a folder");
                return Err(named(&path, found));
            }
            Self::File { path, follow: false } => {
                let file = File::open(&path).map_err(|error| named(&path, error))?;
                Open::Recording(Box::new(file))
            }
            Self::Stdin => Open::Recording(Box::new(io::stdin())),
            Self::Demo => Open::Demo,
        })
    }
}

pub enum Open {
    Board(Address, bool),
    Recording(Box<dyn Read + Send>),
    /// A file that somebody writes to, or will.
    Growing(PathBuf),
    Demo,
}

impl Open {
    /// Hands all that comes to the hub: until the end of a recording, for ever from a board. `speed` is for recordings;
    /// none: at once.
    pub fn run(self, hub: &Hub, speed: Option<f64>) {
        match self {
            Self::Board(address, listen_only) => board(&address, listen_only, hub),
            Self::Growing(path) => growing(&path, hub, speed),
            Self::Recording(reader) => {
                hub.connection(Connection::Open);
                let read = recording(reader, hub, &mut Player::new(hub, speed));
                hub.connection(match read {
                    Ok(()) => Connection::Ended,
                    Err(error) => Connection::Lost(error.to_string()),
                });
            }
            Self::Demo => {
                hub.connection(Connection::Open);
                let mut player = Player::new(hub, speed);
                let played = demo::play(|message| player.message(message));
                player.flush();
                hub.connection(match played {
                    Ok(()) => Connection::Ended,
                    Err(error) => Connection::Lost(error),
                });
            }
        }
    }
}

fn board(address: &Address, listen_only: bool, hub: &Hub) -> ! {
    let mut pause = FIRST_PAUSE;
    loop {
        let opened = if listen_only { address.listen() } else { address.open() };
        let error = match opened {
            Ok(mut link) => {
                hub.connection(Connection::Open);
                let (error, heard) = listen(&mut link, hub);
                if heard {
                    pause = FIRST_PAUSE;
                }
                error
            }
            Err(error) => error.to_string(),
        };
        hub.connection(Connection::Lost(error));
        std::thread::sleep(pause);
        pause = (2 * pause).min(LONGEST_PAUSE);
    }
}

/// Until the link fails: why, and whether it has brought anything.
fn listen(link: &mut impl Link<PortError = io::Error>, hub: &Hub) -> (String, bool) {
    let clock = Clock::new();
    let (mut damaged, mut heard) = (0, false);
    loop {
        let received = link.receive(clock.now_us());
        let now = dropped(&link.counters());
        hub.damaged(now.saturating_sub(damaged));
        damaged = now;
        match received {
            Ok(Some(message)) => {
                heard = true;
                hub.message(&message);
            }
            Ok(None) => std::thread::sleep(POLL),
            Err(error) => return (error.to_string(), heard),
        }
    }
}

/// Messages that arrived and were not taken.
fn dropped(counters: &Counters) -> u32 {
    let Counters { checksum, coding, too_long, too_short, sequence, timeout, .. } = *counters;
    [checksum, coding, too_long, too_short, sequence, timeout].into_iter().fold(0, u32::saturating_add)
}

fn recording(mut reader: impl Read, hub: &Hub, player: &mut Player<'_>) -> io::Result<()> {
    let mut head = Vec::new();
    reader.by_ref().take(TEXT.len() as u64).read_to_end(&mut head)?;
    let is_text = head == TEXT;
    let reader = BufReader::new(io::Cursor::new(head).chain(reader));
    if is_text {
        lines(reader, hub, player)?;
    } else {
        bytes(reader, hub, player)?;
    }
    player.flush();
    Ok(())
}

fn bytes(mut reader: impl BufRead, hub: &Hub, player: &mut Player<'_>) -> io::Result<()> {
    let mut decoder: Decoder = Decoder::new();
    let (mut read, mut heard) = (0, false);
    loop {
        let bytes = reader.fill_buf()?;
        if bytes.is_empty() {
            return if heard { Ok(()) } else { Err(no_recording(read)) };
        }
        for byte in bytes {
            match decoder.push(*byte) {
                Ok(Some(message)) => {
                    heard = true;
                    player.message(message);
                }
                Ok(None) => {}
                Err(_) => hub.damaged(1),
            }
        }
        let taken = bytes.len();
        read += taken;
        reader.consume(taken);
    }
}

/// Of a file that is something else: what a line lost is counted, but not one message came of all of it.
fn no_recording(read: usize) -> io::Error {
    let message = format!("expected a recording of frames, found none in {read} bytes");
    io::Error::new(io::ErrorKind::InvalidData, message)
}

/// Longest line that is looked at: a message of the largest size has half of it.
const LONGEST_LINE: u64 = 4096;

fn lines(mut reader: impl BufRead, hub: &Hub, player: &mut Player<'_>) -> io::Result<()> {
    let mut line = Vec::new();
    // The header has been seen.
    reader.skip_until(b'\n')?;
    loop {
        line.clear();
        if reader.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line)? == 0 {
            return Ok(());
        }
        match recorded_line(&line) {
            Ok(None) => {}
            Ok(Some(recorded)) if recorded.way == Way::Received => player.message(&recorded.message),
            Ok(Some(recorded)) => hub.sent(&recorded.message),
            Err(_) => hub.damaged(1),
        }
    }
}

/// A file may appear later, and be rewritten.
fn growing(path: &Path, hub: &Hub, speed: Option<f64>) -> ! {
    loop {
        let followed = File::open(path).and_then(|file| {
            hub.connection(Connection::Open);
            let file = Growing { file, at: 0 };
            recording(file, hub, &mut Player::new(hub, speed))
        });
        hub.connection(match followed {
            Ok(()) => Connection::Opening,
            Err(error) => Connection::Lost(format!("{}: {error}", path.display())),
        });
        std::thread::sleep(FOLLOW);
    }
}

/// A file that grows. Its end is waited at; it ends where it is shorter than it was, for then it is another one.
struct Growing {
    file: File,
    at: u64,
}

impl Read for Growing {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.file.read(buffer)? {
                0 if self.file.metadata()?.len() < self.at => return Ok(0),
                0 => std::thread::sleep(FOLLOW),
                read => {
                    self.at += read as u64;
                    return Ok(read);
                }
            }
        }
    }
}
