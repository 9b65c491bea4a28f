//! `manifest.json`: which command wrote a folder, from what, when, and which files belong together.

use jiff::Timestamp;
use rayon::prelude::*;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Component, Path, PathBuf};

/// Name of the manifest in its folder.
pub const MANIFEST: &str = "manifest.json";

/// What stands in `manifest.json`: path, unit, meaning, when it is null.
pub const FIELDS: &[[&str; 4]] = &[
    ["rundown", "", "version of the writer", ""],
    ["git", "", "commit of the writer", "it was built without `RUNDOWN_GIT`"],
    ["command", "", "the command: `replay`, `study`, ...", ""],
    ["arguments[]", "", "the command line as given, without the program", ""],
    ["started", "", "when the command began, ISO 8601, UTC", ""],
    ["ended", "", "when the last file was there", ""],
    ["inputs[].file", "", "a file that was read, as found from the command line", ""],
    ["inputs[].bytes", "B", "its size", "it cannot be read"],
    ["inputs[].sha256", "", "its digest", "it cannot be read"],
    ["outputs[].file", "", "a file of this folder, all but the manifest", ""],
    ["outputs[].bytes", "B", "its size", ""],
    ["outputs[].sha256", "", "its digest", ""],
];

/// When a command began, and what it read.
#[derive(Clone, Debug)]
pub struct Provenance {
    started: Timestamp,
    inputs: Vec<Value>,
}

impl Provenance {
    /// Now, with these files, which are read for their digests.
    pub fn begin(inputs: &[PathBuf]) -> Self {
        let started = Timestamp::now();
        let listed = |path: &PathBuf| {
            let found = digest(path).ok();
            let (bytes, sha256) = found.unzip();
            json!({ "file": path.display().to_string(), "bytes": bytes, "sha256": sha256 })
        };
        Self { started, inputs: inputs.par_iter().map(listed).collect() }
    }

    /// The manifest of the files of a folder.
    pub(super) fn manifest(&self, command: &str, folder: &Path, files: &BTreeSet<PathBuf>) -> io::Result<String> {
        let files: Vec<&PathBuf> = files.iter().collect();
        let listed = |path: &&PathBuf| {
            let (bytes, sha256) = digest(&folder.join(path))?;
            Ok(json!({ "file": slashed(path), "bytes": bytes, "sha256": sha256 }))
        };
        let outputs = files.par_iter().map(listed).collect::<io::Result<Vec<Value>>>()?;
        let arguments: Vec<String> = std::env::args_os().skip(1).map(|word| word.display().to_string()).collect();
        let value = json!({
            "rundown": env!("CARGO_PKG_VERSION"),
            "git": option_env!("RUNDOWN_GIT"),
            "command": command,
            "arguments": arguments,
            "started": format!("{:.3}", self.started),
            "ended": format!("{:.3}", Timestamp::now()),
            "inputs": self.inputs,
            "outputs": outputs,
        });
        Ok(format!("{value:#}\n"))
    }
}

/// What the manifest of a folder says that belongs to it.
#[derive(Debug, Default)]
pub(super) struct Listed {
    pub command: String,
    pub files: BTreeSet<PathBuf>,
}

impl Listed {
    /// Of the manifest in a folder; none where there is no manifest.
    pub(super) fn read(folder: &Path) -> io::Result<Option<Self>> {
        let path = folder.join(MANIFEST);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error),
        };
        let foreign = || {
            let message = format!("expected no {MANIFEST} there, or one of rundown; found another one");
            io::Error::new(io::ErrorKind::AlreadyExists, message)
        };
        let value: Value = serde_json::from_str(&text).map_err(|_| foreign())?;
        let (Some(command), Some(outputs)) = (value["command"].as_str(), value["outputs"].as_array()) else {
            return Err(foreign());
        };
        let file = |output: &Value| output["file"].as_str().map(PathBuf::from).filter(|path| is_below(path));
        let files = outputs.iter().map(file).collect::<Option<_>>().ok_or_else(foreign)?;
        Ok(Some(Self { command: command.to_owned(), files }))
    }
}

/// It leads to no place outside its folder.
fn is_below(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_)))
}

fn slashed(path: &Path) -> String {
    let parts: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    parts.join("/")
}

/// Size and SHA-256 of a file.
fn digest(path: &Path) -> io::Result<(u64, String)> {
    let mut hash = Sha256::new();
    let bytes = io::copy(&mut File::open(path)?, &mut Hashing(&mut hash))?;
    Ok((bytes, hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()))
}

struct Hashing<'a>(&'a mut Sha256);

impl io::Write for Hashing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
