//! The account of an import: whatever was left out or changed, counted, with the first places.

use serde::Serialize;
use std::collections::BTreeMap;

/// Places that are spelled out of each kind; the rest is counted.
const EXAMPLES: usize = 20;

/// What happened to the rows of some files.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Account {
    /// How often what happened.
    pub counts: BTreeMap<&'static str, u64>,
    /// The first places: `file:line:column: field: expected X, found Y`.
    pub places: BTreeMap<&'static str, Vec<String>>,
}

impl Account {
    pub fn count(&mut self, what: &'static str, times: u64) {
        if times > 0 {
            *self.counts.entry(what).or_default() += times;
        }
    }

    /// Once more, with its place.
    pub fn place(&mut self, what: &'static str, place: impl FnOnce() -> String) {
        self.count(what, 1);
        let places = self.places.entry(what).or_default();
        if places.len() < EXAMPLES {
            places.push(place());
        }
    }

    pub fn times(&self, what: &str) -> u64 {
        self.counts.get(what).copied().unwrap_or(0)
    }

    /// What was left out or changed; to bring runs onto one chainage is what an import is for.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        self.but(&[ROWS, SHIFTED, INVERTED])
    }

    /// Rows are no loss.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.but(&[ROWS])
    }

    fn but(&self, usual: &'static [&str]) -> impl Iterator<Item = String> {
        let counts = self.counts.iter().filter(|(what, _)| !usual.contains(what));
        counts.map(|(what, times)| format!("{what}: {times}"))
    }
}

pub const ROWS: &str = "rows";
pub const SHIFTED: &str = "runs shifted onto the chainage";
pub const INVERTED: &str = "runs inverted";
