//! `manifest.json`: which command wrote a folder, from what, when, and which files belong together.

use jiff::Timestamp;
use rayon::prelude::*;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
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
    [
        "earlier[].*",
        "",
        "the manifest of another command that wrote into this folder before, with the files that are still its own",
        "",
    ],
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

    /// The files that were read.
    pub(super) fn inputs(&self) -> impl Iterator<Item = PathBuf> {
        self.inputs.iter().filter_map(|input| input["file"].as_str().map(PathBuf::from))
    }

    /// With what was read for something before, too.
    #[must_use]
    pub fn and(mut self, before: &Self) -> Self {
        for input in &before.inputs {
            if !self.inputs.contains(input) {
                self.inputs.push(input.clone());
            }
        }
        self
    }

    /// The manifest of the files of a folder. `earlier` are the manifests of other commands whose files stay.
    pub(super) fn manifest(
        &self,
        command: &str,
        folder: &Path,
        files: &BTreeSet<PathBuf>,
        earlier: Vec<Value>,
    ) -> io::Result<String> {
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
            "earlier": earlier,
        });
        Ok(format!("{value:#}\n"))
    }
}

/// What the manifest of a folder says that belongs to it, by command.
#[derive(Debug, Default)]
pub(super) struct Listed {
    last: String,
    /// The manifest of each command that has files there, without those of the others.
    manifests: BTreeMap<String, Value>,
}

impl Listed {
    /// Of the manifest in a folder; none where there is no manifest.
    pub(super) fn read(folder: &Path) -> io::Result<Option<Self>> {
        let text = match fs::read_to_string(folder.join(MANIFEST)) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error),
        };
        let listed = serde_json::from_str(&text).ok().and_then(Self::of);
        let foreign = || {
            let message = format!("expected no {MANIFEST} there, or one of rundown; found another one");
            io::Error::new(io::ErrorKind::AlreadyExists, message)
        };
        listed.map(Some).ok_or_else(foreign)
    }

    fn of(mut value: Value) -> Option<Self> {
        // One by which no other command had files there may have none.
        let earlier = value.as_object_mut()?.remove("earlier").unwrap_or_else(|| json!([]));
        let last = value["command"].as_str()?.to_owned();
        let mut manifests = BTreeMap::new();
        for manifest in earlier.as_array()?.iter().chain([&value]) {
            outputs(manifest)?;
            manifests.insert(manifest["command"].as_str()?.to_owned(), manifest.clone());
        }
        Some(Self { last, manifests })
    }

    /// The command that wrote last.
    pub(super) fn command(&self) -> &str {
        &self.last
    }

    /// The files of a command; none where it has none there.
    pub(super) fn files(&self, command: &str) -> Option<BTreeSet<PathBuf>> {
        self.manifests.get(command).and_then(outputs)
    }

    /// The files of all commands but these.
    pub(super) fn files_but_of(&self, commands: &[&str]) -> BTreeSet<PathBuf> {
        let others = self.manifests.iter().filter(|(command, _)| !commands.contains(&command.as_str()));
        others.filter_map(|(_, manifest)| outputs(manifest)).flatten().collect()
    }

    /// The manifests of other commands, each with the files that are its own when these have been written by `command`.
    pub(super) fn others(mut self, command: &str, written: &BTreeSet<PathBuf>) -> Vec<Value> {
        self.manifests.remove(command);
        for manifest in self.manifests.values_mut() {
            let outputs = manifest.get_mut("outputs").and_then(Value::as_array_mut);
            outputs
                .into_iter()
                .for_each(|outputs| outputs.retain(|output| file(output).is_some_and(|file| !written.contains(&file))));
        }
        self.manifests
            .into_values()
            .filter(|manifest| outputs(manifest).is_some_and(|files| !files.is_empty()))
            .collect()
    }
}

/// Files that a manifest lists; none where it is no manifest of rundown.
fn outputs(manifest: &Value) -> Option<BTreeSet<PathBuf>> {
    manifest["outputs"].as_array()?.iter().map(file).collect()
}

fn file(output: &Value) -> Option<PathBuf> {
    output["file"].as_str().map(PathBuf::from).filter(|path| is_below(path))
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
