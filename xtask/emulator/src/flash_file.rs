//! The flash of the test board, in a file: it survives QEMU, as a flash survives the loss of power.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// QEMU wants the whole PSRAM of the board; the file is sparse.
pub(crate) const SIZE: u64 = 16 << 20;
/// Where the board's memory map puts the flash's contents, from the beginning of the file.
const KEY: u64 = 0xF800;
const PROVOKE: u64 = 0x1_0000;

/// The file behind the flash of [`crate::Board::Mps2`]. Its errors are those of the file.
#[derive(Clone, Debug)]
pub struct FlashFile {
    path: PathBuf,
}

impl FlashFile {
    /// A new, erased flash.
    pub fn erased(path: &Path) -> io::Result<Self> {
        let mut file = File::create(path)?;
        file.write_all(&vec![0xFF; PROVOKE as usize])?;
        file.set_len(SIZE)?;
        Ok(Self { path: path.to_owned() })
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the provisioning record.
    pub fn put_key(&self, record: &[u8]) -> io::Result<()> {
        self.put(KEY, record)
    }

    /// Makes the firmware fail: see [`Provoke`].
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
#[expect(missing_docs, reason = "named after what happens")]
pub enum Provoke {
    TickHangs = 1,
    LinkHangs = 2,
    Panic = 3,
    StackOverflow = 4,
    /// An instruction that does not exist.
    Fault = 5,
}
