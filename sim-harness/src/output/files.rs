//! Files of results; what cannot be written is named.

use rundown_files::WriteError;
use rundown_files::table::{self, Record};
use std::io::{self, BufWriter, Write};
use std::{fs::File, path::Path};

pub fn failed(path: &Path, source: io::Error) -> WriteError {
    WriteError { path: path.to_owned(), source }
}

/// Makes a folder with those above it.
pub fn folder(path: &Path) -> Result<(), WriteError> {
    std::fs::create_dir_all(path).map_err(|source| failed(path, source))
}

pub fn text(path: &Path, text: &str) -> Result<(), WriteError> {
    std::fs::write(path, text).map_err(|source| failed(path, source))?;
    log::info!("wrote {}", path.display());
    Ok(())
}

pub fn records(path: &Path, records: &[Record]) -> Result<(), WriteError> {
    file(path, |file| table::write_csv(file, records))
}

/// A file whose content is written bit by bit.
pub fn file(path: &Path, content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), WriteError> {
    let written = File::create(path).and_then(|file| {
        let mut file = BufWriter::new(file);
        content(&mut file)?;
        file.flush()
    });
    written.map_err(|source| failed(path, source))?;
    log::info!("wrote {}", path.display());
    Ok(())
}
