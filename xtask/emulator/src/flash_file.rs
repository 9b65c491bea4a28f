//! The flash of the test board, in a file: it survives QEMU, as a flash survives the loss of power.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// QEMU wants the whole PSRAM of the board; the file is sparse.
pub(crate) const SIZE: u64 = 16 << 20;
/// Where the board's memory map puts the flash's contents, from the beginning of the file.
const KEY: u64 = 0xF800;
const PROVOKE: u64 = 0x1_0000;

/// The file behind the flash of [`crate::Board::Mps2`].
#[derive(Clone, Debug)]
pub struct FlashFile {
    path: PathBuf,
}

impl FlashFile {
    /// Size of the region for records, bytes.
    pub const RECORDS: usize = 16 << 10;

    /// A new, erased flash.
    ///
    /// # Errors
    /// Those of the file.
    pub fn erased(path: &Path) -> io::Result<Self> {
        let mut file = File::create(path)?;
        file.write_all(&vec![0xFF; PROVOKE as usize])?;
        file.set_len(SIZE)?;
        Ok(Self { path: path.to_owned() })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The records as they stand. May be called while the firmware runs.
    ///
    /// # Errors
    /// Those of the file.
    pub fn records(&self) -> io::Result<Vec<u8>> {
        let mut records = vec![0; Self::RECORDS];
        File::open(&self.path)?.read_exact(&mut records)?;
        Ok(records)
    }

    /// Changes records, as bit rot would.
    ///
    /// # Errors
    /// Those of the file.
    pub fn put_records(&self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        self.put(offset, bytes)
    }

    /// Writes the provisioning record.
    ///
    /// # Errors
    /// Those of the file.
    pub fn put_key(&self, record: &[u8]) -> io::Result<()> {
        self.put(KEY, record)
    }

    /// Makes the firmware fail: see [`Provoke`].
    ///
    /// # Errors
    /// Those of the file.
    pub fn provoke(&self, what: Provoke, again_and_again: bool) -> io::Result<()> {
        let word = what as u32 | u32::from(again_and_again) << 8;
        self.put(PROVOKE, &word.to_le_bytes())
    }

    fn put(&self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        let mut file = OpenOptions::new().write(true).open(&self.path)?;
        file.seek(SeekFrom::Start(offset))?;
        file.write_all(bytes)
    }
}

/// What goes wrong in the firmware of the test board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Provoke {
    /// The tick task hangs.
    TickHangs = 1,
    /// The link task hangs.
    LinkHangs = 2,
    /// A panic.
    Panic = 3,
    /// The stack overflows.
    StackOverflow = 4,
    /// An instruction that does not exist.
    Fault = 5,
}
