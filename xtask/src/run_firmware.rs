//! `cargo xtask run`: the firmware in the emulator, its serial line for another program.

use crate::{firmware, setup};
use emulator::{Board, Emulator, Settings};
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::thread;

/// Port of the serial line.
const PORT: u16 = 5475;

/// Until the other side hangs up, or the emulator ends.
pub fn run_firmware(board: Board) -> Result<(), String> {
    setup::setup()?;
    firmware::firmware(board)?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, PORT))
        .map_err(|error| format!("port {PORT}: {error}"))?;
    println!(
        "serial line at 127.0.0.1:{PORT}, the firmware starts when somebody connects; Ctrl-C ends it"
    );
    let (other, from) = listener.accept().map_err(|error| error.to_string())?;
    println!("{from} connected");
    let settings = Settings::new(board).map_err(|error| error.to_string())?;
    let mut emulator = Emulator::start(&settings).map_err(|error| error.to_string())?;
    join(emulator.line(), other).map_err(|error| error.to_string())
}

/// Both directions, until the other side ends.
fn join(line: &TcpStream, other: TcpStream) -> io::Result<()> {
    line.set_read_timeout(None)?;
    let (mut from_line, mut to_other) = (line.try_clone()?, other.try_clone()?);
    // Ends with the emulator.
    thread::spawn(move || copy(&mut from_line, &mut to_other));
    copy(&mut &other, &mut &*line)
}

/// Byte by byte as they come, nothing is held back.
fn copy(from: &mut impl Read, to: &mut impl Write) -> io::Result<()> {
    let mut bytes = [0; 1024];
    loop {
        let count = from.read(&mut bytes)?;
        let Some(bytes) = bytes.get(..count).filter(|bytes| !bytes.is_empty()) else {
            return Ok(());
        };
        to.write_all(bytes)?;
    }
}
