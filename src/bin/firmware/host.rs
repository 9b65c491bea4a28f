//! The application over stdin and stdout: what the board does with its serial line, without a board. Its clock does not tick; ask for lockstep.
//!
//! ```text
//! firmware KEY [RECORDS]      KEY: provisioning record; RECORDS: file that plays the flash, made if it is missing
//! ```

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use rundown::estimator::run_state::RunState;
use rundown::onboard::application::Application;
use rundown::onboard::auth::provisioning::{Provisioning, SIZE};
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
        io::Error::other(format!("{key}: a provisioning record has {SIZE} bytes"))
    })?;
    let flash = FileFlash::open(records.map(PathBuf::from))?;
    let provisioning = Provisioning::from_bytes(&key);
    let (mut run, mut room) = (Box::new(RunState::idle()), Box::new(Room::EMPTY));
    let mut application = Application::new(provisioning, flash, false, &mut run, &mut room);
    let (mut stdin, mut stdout) = (io::stdin().lock(), io::stdout().lock());
    let mut written = Ok(());
    let mut send = |frame: &[u8]| {
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
            application.receive(*byte, Health::default, &mut send);
        }
        let taken = bytes.len();
        stdin.consume(taken);
    }
}

const PAGE: usize = 2048;
const PAGES: usize = 8;

/// The board's pages for records, in memory and in a file.
struct FileFlash {
    bytes: Vec<u8>,
    path: Option<PathBuf>,
}

/// Why the pages could not be used.
#[derive(Debug)]
enum FileFlashError {
    Request(NorFlashErrorKind),
    File,
}

impl NorFlashError for FileFlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Request(kind) => *kind,
            Self::File => NorFlashErrorKind::Other,
        }
    }
}

impl FileFlash {
    fn open(path: Option<PathBuf>) -> io::Result<Self> {
        let bytes = match &path {
            Some(path) if path.exists() => std::fs::read(path)?,
            _ => vec![0xFF; PAGE * PAGES],
        };
        if bytes.len() != PAGE * PAGES {
            return Err(io::Error::other(format!("the records must have {} bytes", PAGE * PAGES)));
        }
        Ok(Self { bytes, path })
    }

    fn save(&self) -> Result<(), FileFlashError> {
        match &self.path {
            Some(path) => std::fs::write(path, &self.bytes).map_err(|_| FileFlashError::File),
            None => Ok(()),
        }
    }
}

impl ErrorType for FileFlash {
    type Error = FileFlashError;
}

impl ReadNorFlash for FileFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FileFlashError> {
        check_read(self, offset, bytes.len()).map_err(FileFlashError::Request)?;
        let from = offset as usize;
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for FileFlash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FileFlashError> {
        check_erase(self, from, to).map_err(FileFlashError::Request)?;
        self.bytes[from as usize..to as usize].fill(0xFF);
        self.save()
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FileFlashError> {
        check_write(self, offset, bytes.len()).map_err(FileFlashError::Request)?;
        let from = offset as usize;
        self.bytes[from..from + bytes.len()].copy_from_slice(bytes);
        self.save()
    }
}
