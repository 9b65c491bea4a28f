//! One path or several, and words that stand for a choice.

use crate::error::refused;
use pyo3::prelude::*;
use rundown::estimator::config::Mode;
use rundown_files::recording::DirectionChoice;
use std::path::PathBuf;

/// A path, or a list of paths.
#[derive(FromPyObject)]
pub enum Paths {
    One(PathBuf),
    Several(Vec<PathBuf>),
}

impl From<Paths> for Vec<PathBuf> {
    fn from(paths: Paths) -> Self {
        match paths {
            Paths::One(path) => vec![path],
            Paths::Several(paths) => paths,
        }
    }
}

/// `up`, `down` or `auto`.
pub fn direction(word: &str) -> PyResult<DirectionChoice> {
    chosen(
        "direction",
        word,
        &[("auto", DirectionChoice::Auto), ("up", DirectionChoice::Up), ("down", DirectionChoice::Down)],
    )
}

/// `paper`, `gated` or `measured`.
pub fn mode(word: &str) -> PyResult<Mode> {
    chosen("mode", word, &[("paper", Mode::Paper), ("gated", Mode::Gated), ("measured", Mode::Measured)])
}

/// The value of a word; `-` and `_` are one, as the command has the one and Python the other.
pub fn chosen<T: Copy>(what: &str, word: &str, choices: &[(&str, T)]) -> PyResult<T> {
    let found = choices.iter().find(|(name, _)| name.replace('-', "_") == word.replace('-', "_"));
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        refused(format!("{what}: expected {}, found {word:?}", names.join(", ")))
    })
}
