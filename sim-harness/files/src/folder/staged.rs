//! Results on their way into their folder.

use super::manifest::{Listed, MANIFEST, Provenance};
use crate::WriteError;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Component, Path, PathBuf};

/// Complete results within the folder that gets them.
const READY: &str = ".rundown-ready";
/// Results that are being written, within the folder that gets them.
const NEW: &str = ".rundown-new";

/// A folder beside that of the results, in which they are written. Where it is dropped it is removed.
#[derive(Debug)]
pub struct Staged {
    command: String,
    out: PathBuf,
    folder: PathBuf,
    /// Its name is not used up yet: as soon as it is, another command may take it.
    is_there: bool,
    /// As long as it is held no other command writes into the same place.
    _lock: Option<File>,
}

impl Staged {
    /// # Errors
    /// The place is no folder, another command is writing there, or nothing can be written there.
    pub fn begin(command: &str, out: &Path) -> Result<Self, WriteError> {
        let failed = |source| WriteError { path: out.to_owned(), source };
        if let Some(file) = out.ancestors().find(|path| path.is_file()) {
            let message = format!("expected a folder or a free name, {} is a file", file.display());
            return Err(failed(io::Error::new(io::ErrorKind::NotADirectory, message)));
        }
        let place = resolved(out).map_err(failed)?;
        let begin = || {
            let parent = place.parent().unwrap_or(Path::new(""));
            if !parent.as_os_str().is_empty() {
                fs::create_dir_all(parent)?;
            }
            let (folder, lock) = stage(&place)?;
            let staged = Self { command: command.to_owned(), out: place.clone(), folder, is_there: true, _lock: lock };
            finish(&place)?;
            // Of a manifest that is not ours it is said now, not after the work.
            Listed::read(&place)?;
            Ok(staged)
        };
        begin().map_err(failed)
    }

    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// Puts what was written in its place.
    ///
    /// # Errors
    /// It cannot be put there; where a folder lies in the way of a file, nothing is.
    pub fn done(mut self, provenance: &Provenance) -> Result<(), WriteError> {
        let put = entries(&self.folder).and_then(|files| {
            self.put(provenance, &files)?;
            Ok(files)
        });
        let files = put.map_err(|source| WriteError { path: self.out.clone(), source })?;
        for file in files.iter().map(PathBuf::as_path).chain([Path::new(MANIFEST)]) {
            log::info!("wrote {}", self.out.join(file).display());
        }
        Ok(())
    }

    fn put(&mut self, provenance: &Provenance, files: &BTreeSet<PathBuf>) -> io::Result<()> {
        let Self { command, out, folder, is_there, .. } = self;
        let old = Listed::read(out)?.unwrap_or_default();
        let own = old.files(command).unwrap_or_default();
        let listed = old.files_but_of(&[]);
        let manifest = provenance.manifest(command, folder, files, old.others(command, files))?;
        fs::write(folder.join(MANIFEST), manifest)?;
        if !out.exists() {
            fs::rename(&*folder, out)?;
            *is_there = false;
            return Ok(());
        }
        in_the_way(out, files)?;
        not_ours(out, files, &listed, provenance)?;
        fs::set_permissions(&*folder, fs::metadata(&*out)?.permissions())?;
        // The old folder gets the name of the new one, and is locked under it until it is gone.
        if is_all_of_it(out, &own)?
            && let Ok(_old) = locked(out)
            && exchange(folder, out).is_ok()
        {
            // The results are in place: what cannot be removed is left to the next command.
            let _ = fs::remove_dir_all(&*folder);
            *is_there = false;
            return Ok(());
        }
        fs::rename(&*folder, out.join(READY))?;
        *is_there = false;
        forward(out)
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if self.is_there {
            // One that cannot be removed is removed by the next command.
            let _ = fs::remove_dir_all(&self.folder);
        }
    }
}

/// A path as it will be when the results are in place: people are shown no other.
pub fn shown(path: &Path) -> PathBuf {
    let part = |part: Component| match part.as_os_str().to_str() {
        Some(NEW | READY) => None,
        Some(name) => Some(name.strip_prefix('.').and_then(|name| name.strip_suffix(NEW)).unwrap_or(name).into()),
        None => Some(part.as_os_str().to_owned()),
    };
    path.components().filter_map(part).collect::<PathBuf>()
}

/// The folder itself where a link leads to it, or its name is none.
fn resolved(out: &Path) -> io::Result<PathBuf> {
    if out.exists() && (out.is_symlink() || out.file_name().is_none()) {
        out.canonicalize()
    } else {
        Ok(out.to_owned())
    }
}

/// A new folder, beside the place if that is possible, else in it.
fn stage(out: &Path) -> io::Result<(PathBuf, Option<File>)> {
    let within = out.join(NEW);
    let Some(name) = out.file_name().filter(|_| !is_mounted(out)) else { return empty(within) };
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(NEW);
    match empty(out.with_file_name(hidden)) {
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied && out.is_dir() => empty(within),
        made => made,
    }
}

/// Makes a folder, in place of what a stopped command left.
fn empty(folder: PathBuf) -> io::Result<(PathBuf, Option<File>)> {
    loop {
        let is_new = match fs::create_dir(&folder) {
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
            made => made.is_ok(),
        };
        let lock = match locked(&folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            lock => lock?,
        };
        // In between another command may have removed it, and made one of the same name.
        if !is_still(&folder, lock.as_ref()) {
            continue;
        }
        if is_new {
            return Ok((folder, lock));
        }
        fs::remove_dir_all(&folder)?;
    }
}

#[cfg(unix)]
fn locked(folder: &Path) -> io::Result<Option<File>> {
    let file = File::open(folder)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => {
            let message = "another rundown command is writing there";
            Err(io::Error::new(io::ErrorKind::ResourceBusy, message))
        }
        // A file system without locks: two commands at a time are not noticed.
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

#[cfg(not(unix))]
fn locked(_: &Path) -> io::Result<Option<File>> {
    Ok(None)
}

/// The path leads to the folder that is locked.
#[cfg(unix)]
fn is_still(folder: &Path, lock: Option<&File>) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |found: fs::Metadata| (found.dev(), found.ino());
    lock.is_none_or(|lock| lock.metadata().map(id).ok() == fs::metadata(folder).map(id).ok())
}

#[cfg(not(unix))]
fn is_still(_: &Path, _: Option<&File>) -> bool {
    true
}

/// It lies on another file system than its name.
#[cfg(unix)]
fn is_mounted(out: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let parent = out.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let device = |path: &Path| fs::metadata(path).ok().map(|found| found.dev());
    out.exists() && device(out) != device(parent)
}

#[cfg(not(unix))]
fn is_mounted(_: &Path) -> bool {
    false
}

/// Two folders change their names at once.
#[cfg(any(target_os = "linux", target_os = "macos"))]
fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE)?)
}

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// The folder holds nothing but what its manifest lists, and nobody stands in it: it may be exchanged as a whole.
fn is_all_of_it(out: &Path, own: &BTreeSet<PathBuf>) -> io::Result<bool> {
    let stands_in = std::env::current_dir()?.starts_with(out.canonicalize()?);
    Ok(!stands_in && entries(out)?.iter().all(|path| path == Path::new(MANIFEST) || own.contains(path)))
}

/// A file of the new results cannot replace a folder, nor lie in a file.
fn in_the_way(out: &Path, files: &BTreeSet<PathBuf>) -> io::Result<()> {
    for path in files.iter().map(|file| out.join(file)) {
        let above = path.ancestors().skip(1).take_while(|above| *above != out).find(|above| above.is_file());
        if let Some(wrong) = path.is_dir().then_some(path.as_path()).or(above) {
            let found = if wrong.is_dir() { "a folder" } else { "a file" };
            let message = format!("{} is {found} and lies in the way", wrong.display());
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
        }
    }
    Ok(())
}

/// A file of the new results takes the place of earlier results alone: of none that was read for them, and of none that
/// no manifest lists.
fn not_ours(
    out: &Path,
    files: &BTreeSet<PathBuf>,
    listed: &BTreeSet<PathBuf>,
    provenance: &Provenance,
) -> io::Result<()> {
    let read: BTreeSet<PathBuf> = provenance.inputs().filter_map(|path| fs::canonicalize(path).ok()).collect();
    for file in files {
        let path = out.join(file);
        let why = match fs::canonicalize(&path) {
            Ok(there) if read.contains(&there) => "was read for the results",
            Ok(_) if !listed.contains(file) => "is there and no result of rundown",
            _ => continue,
        };
        let message = format!("{} {why}, which would take its place; choose another folder", path.display());
        return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
    }
    Ok(())
}

/// Brings to its end what a stopped command left; one that is still at it is let be.
fn finish(out: &Path) -> io::Result<()> {
    match locked(&out.join(READY)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
        Ok(_lock) => forward(out),
    }
}

/// Brings complete results to their places, file by file, the manifest last. Can be repeated wherever it was stopped.
fn forward(out: &Path) -> io::Result<()> {
    let ready = out.join(READY);
    if !ready.is_dir() {
        return Ok(());
    }
    if let Some(listed) = Listed::read(&ready)? {
        let new = listed.files(listed.command()).unwrap_or_default();
        let old = Listed::read(out)?.and_then(|old| old.files(listed.command())).unwrap_or_default();
        for stale in old.difference(&new) {
            remove(out, stale)?;
        }
        for file in &new {
            let (from, to) = (ready.join(file), out.join(file));
            if from.exists() {
                fs::create_dir_all(to.parent().unwrap_or(out))?;
                fs::rename(from, to)?;
            }
        }
        fs::rename(ready.join(MANIFEST), out.join(MANIFEST))?;
    }
    // The results are in place: what cannot be removed is left to the next command.
    let _ = fs::remove_dir_all(&ready);
    Ok(())
}

/// Removes a file of earlier results, and the folders above it that are empty then.
fn remove(out: &Path, file: &Path) -> io::Result<()> {
    match fs::remove_file(out.join(file)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    let above = file.ancestors().skip(1).filter(|above| !above.as_os_str().is_empty());
    // One that is not empty stays, and so do those above it.
    let _ = above.map(|above| fs::remove_dir(out.join(above))).take_while(Result::is_ok).count();
    Ok(())
}

/// Files below a folder, relative to it; folders where there is nothing in them.
fn entries(folder: &Path) -> io::Result<BTreeSet<PathBuf>> {
    fn walk(root: &Path, below: &Path, found: &mut BTreeSet<PathBuf>) -> io::Result<()> {
        for entry in fs::read_dir(root.join(below))? {
            let entry = entry?;
            let path = below.join(entry.file_name());
            let before = found.len();
            if entry.file_type()?.is_dir() {
                walk(root, &path, found)?;
            }
            if found.len() == before {
                found.insert(path);
            }
        }
        Ok(())
    }
    let mut found = BTreeSet::new();
    walk(folder, Path::new(""), &mut found)?;
    Ok(found)
}

#[cfg(test)]
mod tests;
