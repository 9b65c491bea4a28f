//! A train or track of another tool in; the train or track file out.

use crate::exchange::{self, ForeignFile, draft};
use crate::output::files;
use rundown_files::WriteError;
use rundown_files::refusal::{Place, ReadError};
use rundown_files::track_file::TrackFile;
use std::collections::BTreeMap;
use std::path::Path;

/// What a file of another tool became.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Converted {
    /// `train` or `track`.
    pub kind: &'static str,
    /// The train or track file, TOML.
    pub text: String,
    /// Every field that is not kept, or read in a certain sense.
    pub notes: Vec<String>,
}

impl Converted {
    /// Writes the file.
    ///
    /// # Errors
    /// [`WriteError`]: then there is none, or the one that was there.
    pub fn write(&self, out: &Path) -> Result<(), WriteError> {
        files::whole(out, &self.text)
    }
}

/// The field of a train of this name, which may be set.
///
/// # Errors
/// What is expected instead.
pub fn field(name: &str) -> Result<&'static str, String> {
    let found = draft::FIELDS.into_iter().find(|field| *field == name);
    found.ok_or_else(|| format!("expected a field of {}, found {name:?}", draft::FIELDS.join(", ")))
}

/// Reads a file of SFERA, SUMO, OSRD, railtoolkit or ALTRIOS; `set` has values that a train lacks there, or that
/// replace its own.
///
/// # Errors
/// [`ReadError`] with the place; a value that neither has is refused by name.
pub fn convert(path: &Path, set: &BTreeMap<&'static str, f64>) -> Result<Converted, ReadError> {
    let text = std::fs::read_to_string(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
    log::info!("read {}", path.display());
    let refused = |field: &str, message: String| ReadError::from(Place::of_file(path).refuse(field, message));
    match exchange::read(path, &text)? {
        ForeignFile::Train(draft) => {
            let train = draft.complete(path, set)?;
            let text = toml::to_string(&train).map_err(|error| refused("", error.to_string()))?;
            Ok(Converted { kind: "train", text, notes: draft.notes })
        }
        ForeignFile::Track(track, notes) => {
            if let Some(field) = set.keys().next() {
                return Err(refused(&format!("--set {field}"), "expected a train, found a running path".to_owned()));
            }
            let text = toml::to_string(&track).map_err(|error| refused("", error.to_string()))?;
            TrackFile::parse(path, &text)?;
            Ok(Converted { kind: "track", text, notes })
        }
    }
}
