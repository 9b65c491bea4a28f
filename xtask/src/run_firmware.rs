//! `cargo xtask run`: the firmware in the emulator, its serial line for another program.

use crate::{firmware, setup};
use emulator::{Board, Emulator, Settings};
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::thread;

/// Port of the serial line.
const PORT: u16 = 5475;
/// Where the provisioning record lies in the flash of the reference board.
const KEY_ADDRESS: u32 = 0x080F_F800;

/// Until the other side hangs up, or the emulator ends.
///
/// `key` is the provisioning record that the board is given. Without it the board refuses everything that is secured.
pub fn run_firmware(board: Board, key: Option<&str>) -> Result<(), String> {
    let mut preloads = Vec::new();
    if let Some(path) = key {
        let record = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
        preloads.push((KEY_ADDRESS, record));
    }
    setup::setup()?;
    firmware::firmware(board)?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, PORT))
        .map_err(|error| format!("port {PORT}: {error}"))?;
    println!(
        "serial line at 127.0.0.1:{PORT}, the firmware starts when somebody connects; Ctrl-C ends it"
    );
    let (other, from) = listener.accept().map_err(|error| error.to_string())?;
    println!("{from} connected");
    let settings = Settings {
        preloads,
        ..Settings::new(board).map_err(|error| error.to_string())?
    };
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
