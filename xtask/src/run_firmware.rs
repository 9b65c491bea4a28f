//! `cargo xtask run`: the firmware in the emulator, its serial line for other programs.

use crate::{firmware, setup};
use emulator::{Board, Emulator, Settings};
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Port of the serial line.
const PORT: u16 = 5475;
/// Where the provisioning record lies in the flash of the reference board.
const KEY_ADDRESS: u32 = 0x080F_F800;

/// A program that takes nothing for so long has hung: it must not hold up the board and the others.
const TAKES: Duration = Duration::from_secs(1);

/// Until the emulator ends.
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
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, PORT)).map_err(|error| format!("port {PORT}: {error}"))?;
    println!(
        "serial line at 127.0.0.1:{PORT}, for one program that talks and any number that listen; the firmware starts with the first; Ctrl-C ends it"
    );
    let first = listener.accept().map_err(|error| error.to_string())?.0;
    let settings = Settings { preloads, ..Settings::new(board).map_err(|error| error.to_string())? };
    let mut emulator = Emulator::start(&settings).map_err(|error| error.to_string())?;
    let asked = end_with_signal(emulator.line()).map_err(|error| error.to_string())?;
    let shared = share(emulator.line(), first, listener).map_err(|error| error.to_string());
    // Before this program: what asks it to end knows nothing of QEMU.
    drop(emulator);
    asked.end();
    shared
}

/// The signal that asked this program to end, where one has.
#[derive(Clone, Debug, Default)]
struct AskedToEnd(Arc<AtomicI32>);

#[cfg(unix)]
impl AskedToEnd {
    /// Ends as the signal would have done.
    fn end(&self) {
        let signal = self.0.load(Ordering::SeqCst);
        if signal != 0 {
            // It returns only for a signal that does not end a program.
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    }
}

/// Hangs up the line where this program is asked to end, so that what reads it comes to its end and takes QEMU along.
#[cfg(unix)]
fn end_with_signal(line: &TcpStream) -> io::Result<AskedToEnd> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let (asked, line) = (AskedToEnd::default(), line.try_clone()?);
    let mut signals = signal_hook::iterator::Signals::new([SIGHUP, SIGINT, SIGTERM])?;
    let told = asked.clone();
    thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            told.0.store(signal, Ordering::SeqCst);
            let _ = line.shutdown(Shutdown::Both);
        }
    });
    Ok(asked)
}

#[cfg(not(unix))]
impl AskedToEnd {
    fn end(&self) {}
}

#[cfg(not(unix))]
fn end_with_signal(_: &TcpStream) -> io::Result<AskedToEnd> {
    Ok(AskedToEnd::default())
}

/// Programs at the serial line.
type Others = Arc<Mutex<Vec<TcpStream>>>;

/// All hear the board, and the board hears all.
fn share(line: &TcpStream, first: TcpStream, listener: TcpListener) -> io::Result<()> {
    line.set_read_timeout(None)?;
    let others = Others::default();
    join(first, line, &others)?;
    let (to_line, more) = (line.try_clone()?, Arc::clone(&others));
    thread::spawn(move || {
        for other in listener.incoming().flatten() {
            if let Err(error) = join(other, &to_line, &more) {
                println!("{error}");
            }
        }
    });
    forward(&mut &*line, |bytes| {
        let mut others = others.lock().unwrap_or_else(PoisonError::into_inner);
        others.retain_mut(|other| other.write_all(bytes).is_ok());
        Ok(())
    })
}

/// From now on this program hears the board, and what it says goes there.
fn join(other: TcpStream, line: &TcpStream, others: &Others) -> io::Result<()> {
    println!("{} connected", other.peer_addr()?);
    other.set_write_timeout(Some(TAKES))?;
    let (mut from, mut to) = (other.try_clone()?, line.try_clone()?);
    others.lock().unwrap_or_else(PoisonError::into_inner).push(other);
    // Ends when the program hangs up.
    thread::spawn(move || forward(&mut from, |bytes| to.write_all(bytes)));
    Ok(())
}

/// Bytes as they come, nothing is held back, until the end.
fn forward(from: &mut impl Read, mut give: impl FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
    let mut bytes = [0; 1024];
    loop {
        let count = from.read(&mut bytes)?;
        let Some(bytes) = bytes.get(..count).filter(|bytes| !bytes.is_empty()) else {
            return Ok(());
        };
        give(bytes)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair() -> (TcpStream, TcpStream) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let here = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        (here, listener.accept().unwrap().0)
    }

    fn heard(program: &mut TcpStream, bytes: usize) -> Vec<u8> {
        program.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        let mut heard = vec![0; bytes];
        program.read_exact(&mut heard).unwrap();
        heard
    }

    #[test]
    fn all_hear_the_board_and_the_board_hears_all() {
        let (line, mut board) = pair();
        let (mut first, accepted) = pair();
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let shared = thread::spawn(move || share(&line, accepted, listener));
        let mut second = TcpStream::connect(address).unwrap();
        // The board hears a program only once that one has joined.
        second.write_all(b"hello").unwrap();
        assert_eq!(heard(&mut board, 5), b"hello");
        board.write_all(b"frame").unwrap();
        assert_eq!(heard(&mut first, 5), b"frame");
        assert_eq!(heard(&mut second, 5), b"frame");
        // Who hangs up leaves the others as they are.
        drop(first);
        for _ in 0..3 {
            board.write_all(b"again").unwrap();
            assert_eq!(heard(&mut second, 5), b"again");
        }
        second.write_all(b"there").unwrap();
        assert_eq!(heard(&mut board, 5), b"there");
        // The end of the emulator is the end.
        drop(board);
        shared.join().unwrap().unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_signal_hangs_up_the_line() {
        let (mut here, there) = pair();
        here.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        let asked = end_with_signal(&there).unwrap();
        signal_hook::low_level::raise(signal_hook::consts::SIGTERM).unwrap();
        assert_eq!(here.read(&mut [0; 1]).unwrap(), 0);
        assert_eq!(asked.0.load(Ordering::SeqCst), signal_hook::consts::SIGTERM);
    }
}
