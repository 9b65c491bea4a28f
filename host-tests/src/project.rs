//! The files of the project, for the tests that hold documents and code to each other.

use crate::prelude::*;

/// Where it lies.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the project")
}

/// A path as documents name it.
pub fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// The text of a file below the root.
pub fn text(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All files below a folder of the project whose names end so, without what is built, kept by git or downloaded.
pub fn files(folder: impl AsRef<Path>, end: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir().expect("a folder").map(|entry| entry.expect("an entry").path()) {
            let name = entry.file_name().unwrap_or_default().to_string_lossy();
            if entry.is_dir() && !name.starts_with('.') && !["target", "out", "corpus", "assets"].contains(&&*name) {
                folders.push(entry);
            } else if name.ends_with(end) {
                found.push(entry);
            }
        }
    }
    found.sort();
    found
}
