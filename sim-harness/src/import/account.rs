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

    /// Rows are no loss.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.counts.iter().filter(|(what, _)| **what != ROWS).map(|(what, times)| format!("{what}: {times}"))
    }
}

pub const ROWS: &str = "rows";
