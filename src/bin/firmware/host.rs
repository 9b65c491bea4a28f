//! The application over stdin and stdout: what the board does with its serial line, without a board. Its clock does not
//! tick; ask for lockstep.
//!
//! ```text
//! firmware KEY [RECORDS]      KEY: provisioning record; RECORDS: file that plays the flash, made if it is missing
//! ```

use rundown::estimator::run_state::RunState;
use rundown::onboard::application::{Application, Hardware};
use rundown::onboard::auth::provisioning::{Provisioning, SIZE};
use rundown::onboard::event::Event;
use rundown::onboard::flash::{Memory, MemoryFlash, RECORDS};
use rundown::onboard::task::Room;
use rundown_wire::Health;
use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};

/// Until stdin ends.
pub fn run() -> io::Result<()> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(key), records, None) = (arguments.next(), arguments.next(), arguments.next()) else {
        return Err(io::Error::other("usage: firmware KEY [RECORDS] <uplink >downlink"));
    };
    let key: [u8; SIZE] = std::fs::read(&key)?.try_into().map_err(|_| {
        let key = Path::new(&key).display();
        io::Error::other(format!("{key}: expected a provisioning record of {SIZE} bytes"))
    })?;
    let flash = MemoryFlash::new(Pages::open(records.map(PathBuf::from))?);
    let provisioning = Provisioning::from_bytes(&key);
    let (mut run, mut room) = (Box::new(RunState::idle()), Box::new(Room::EMPTY));
    let mut application = Application::new(provisioning, flash, false, &mut run, &mut room);
    let (mut stdin, mut stdout) = (io::stdin().lock(), io::stdout().lock());
    let mut written = Ok(());
    let mut send = |frame: &[u8], _| {
        if written.is_ok() {
            written = stdout.write_all(frame).and_then(|()| stdout.flush());
        }
        written.is_ok()
    };
    loop {
        let bytes = stdin.fill_buf()?;
        if bytes.is_empty() {
            return written;
        }
        for byte in bytes {
            application.receive_byte(*byte, Host, &mut send);
            while application.is_busy() {
                application.go_on(Host, &mut send);
            }
        }
        let taken = bytes.len();
        stdin.consume(taken);
    }
}

/// No hardware: nothing is known of it, and what happens is written to stderr.
#[derive(Clone, Copy)]
struct Host;

impl Hardware for Host {
    fn health(&self) -> Health {
        Health::default()
    }

    fn log(&self, event: &Event) {
        let level = if event.is_trouble() { "warn" } else { "info" };
        eprintln!("{level}: {event}");
    }
}

/// The board's pages for records, in memory and, where one is named, in a file.
struct Pages {
    bytes: Vec<u8>,
    path: Option<PathBuf>,
}

impl Pages {
    fn open(path: Option<PathBuf>) -> io::Result<Self> {
        let bytes = match &path {
            Some(path) if path.exists() => std::fs::read(path)?,
            _ => vec![0xFF; RECORDS],
        };
        if bytes.len() != RECORDS {
            let found = bytes.len();
            return Err(io::Error::other(format!("records: expected {RECORDS} bytes, found {found}")));
        }
        Ok(Self { bytes, path })
    }
}

impl AsRef<[u8]> for Pages {
    fn as_ref(&self) -> &[u8] {
        &self.bytes
    }
}

impl AsMut<[u8]> for Pages {
    fn as_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }
}

impl Memory for Pages {
    fn keep(&mut self) -> bool {
        self.path.as_ref().is_none_or(|path| std::fs::write(path, &self.bytes).is_ok())
    }
}
