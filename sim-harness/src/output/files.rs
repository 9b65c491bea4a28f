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
    std::fs::write(path, text).map_err(|source| failed(path, source))
}

/// A file of its own, outside of a folder of results: written beside its place and renamed. What is no file, as a pipe,
/// is written into.
pub fn whole(path: &Path, content: &str) -> Result<(), WriteError> {
    if path.exists() && !path.is_file() {
        return text(path, content);
    }
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut beside = tempfile::Builder::new();
    // As any new file: what the user's mask leaves of it.
    #[cfg(unix)]
    beside.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let written = beside.tempfile_in(parent).and_then(|mut file| {
        file.write_all(content.as_bytes())?;
        if let Ok(before) = path.metadata() {
            file.as_file().set_permissions(before.permissions())?;
        }
        file.persist(path).map_err(|error| error.error)
    });
    written.map_err(|source| failed(path, source))?;
    log::info!("wrote {}", path.display());
    Ok(())
}

/// A file that is not there yet: what it keeps cannot be had again. Devices and pipes are written to.
pub fn fresh(path: &Path) -> Result<File, WriteError> {
    let file = if path.exists() && !path.is_file() { File::create(path) } else { File::create_new(path) };
    file.map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => {
            failed(path, io::Error::new(source.kind(), "is there already; choose another name"))
        }
        _ => failed(path, source),
    })
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
    written.map_err(|source| failed(path, source))
}
