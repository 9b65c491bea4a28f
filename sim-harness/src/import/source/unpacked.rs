//! Text that gzip made small, as the text that it is.

use super::row;
use flate2::read::MultiGzDecoder;
use rundown_files::refusal::ReadError;
use std::fs::File;
use std::io::{BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

/// What a file of gzip begins with.
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// The bytes of a file, unpacked.
pub fn bytes(path: &Path) -> Result<Box<dyn Read>, ReadError> {
    let io = |error| row::io(path, error);
    let mut file = File::open(path).map_err(io)?;
    let mut head = Vec::new();
    file.by_ref().take(GZIP.len() as u64).read_to_end(&mut head).map_err(io)?;
    let is_packed = head == GZIP;
    let whole = Cursor::new(head).chain(file);
    Ok(if is_packed { Box::new(MultiGzDecoder::new(BufReader::new(whole))) } else { Box::new(whole) })
}

/// Both hold the same, one of them packed.
///
/// # Errors
/// [`ReadError`] when one of them cannot be read.
pub fn are_equal(a: &Path, b: &Path) -> Result<bool, ReadError> {
    let [mut of_a, mut of_b] = [bytes(a)?, bytes(b)?].map(|read| BufReader::new(read).bytes());
    loop {
        match (of_a.next().transpose(), of_b.next().transpose()) {
            (Ok(None), Ok(None)) => return Ok(true),
            (Ok(x), Ok(y)) if x == y => {}
            (Ok(_), Ok(_)) => return Ok(false),
            (Err(error), _) => return Err(row::io(a, error)),
            (_, Err(error)) => return Err(row::io(b, error)),
        }
    }
}

/// The name of a file without the `.gz` that packing added.
pub fn name(path: &Path) -> PathBuf {
    let is_packed = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("gz"));
    if is_packed { path.with_extension("") } else { path.to_owned() }
}
