//! YAML into a type, refused with its place.

use rundown_files::refusal::{Place, ReadError};
use serde::de::DeserializeOwned;
use std::path::Path;

/// Reads `text` as `expected`, which is for the message.
pub(super) fn read<T: DeserializeOwned>(path: &Path, text: &str, expected: &str) -> Result<T, ReadError> {
    serde_saphyr::from_str(text).map_err(|error| {
        let error = error.without_snippet();
        let at = error.location();
        let [line, column] = [at.map(|at| at.line() as usize), at.map(|at| at.column() as usize)];
        let place = Place { file: path.to_owned(), line, column };
        let found = error.to_string().replace('\n', ", ");
        place.refuse("", format!("expected {expected}, found {found}")).into()
    })
}
