//! A folder of results: the old one or the new one, whenever the command that writes it is stopped, with a manifest of
//! what belongs together.
//!
//! ```text
//! .NAME.rundown-new     beside the folder: what is being written; a later command removes what a stopped one left
//! NAME                  the new folder takes the place of the old one in one step of the file system
//! NAME/.rundown-ready   where the folder also holds files of others: complete results on their way, file by file, into it;
//!                       a later command brings that to its end
//! ```
//!
//! The manifest keeps the lists of other commands that wrote there before. Files that no manifest lists are never
//! removed. What is promised holds for a command that is stopped, not for a loss of power: nothing is forced onto the
//! disk.

mod manifest;
mod staged;

pub use manifest::{FIELDS, MANIFEST, Provenance};
pub use staged::shown;

use crate::WriteError;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Writes the folder `out` by `write`, which gets the folder to write into. Where `write` fails, `out` stays as it is.
///
/// # Errors
/// Those of `write`, and [`WriteError`] where the folder cannot take its place.
pub fn write<T, E: From<WriteError>>(
    command: &str,
    out: &Path,
    provenance: &Provenance,
    write: impl FnOnce(&Path) -> Result<T, E>,
) -> Result<T, E> {
    let staged = staged::Staged::begin(command, out)?;
    let written = write(staged.path())?;
    staged.done(provenance)?;
    Ok(written)
}

/// Asks whether [`write()`] could put results there, before the work that makes them.
///
/// # Errors
/// [`WriteError`] where it could not.
pub fn try_place(command: &str, out: &Path) -> Result<(), WriteError> {
    staged::Staged::begin(command, out).map(drop)
}

/// The files, relative to the folder, that its manifest lists as results of a command; none where that command wrote
/// nothing there.
///
/// # Errors
/// [`WriteError`] where the manifest cannot be read or is another program's.
pub fn files_of(command: &str, folder: &Path) -> Result<Option<BTreeSet<PathBuf>>, WriteError> {
    let listed = manifest::Listed::read(folder).map_err(|source| WriteError { path: folder.to_owned(), source })?;
    Ok(listed.and_then(|listed| listed.files(command)))
}

/// Commands whose results are run logs.
const MAKE_LOGS: [&str; 2] = ["import", "simulate"];

/// The files, relative to the folder, that its manifest lists as results and that are no run logs; none where the
/// manifest is another program's.
pub fn results_in(folder: &Path) -> BTreeSet<PathBuf> {
    let listed = manifest::Listed::read(folder).ok().flatten();
    listed.map(|listed| listed.files_but_of(&MAKE_LOGS)).unwrap_or_default()
}
