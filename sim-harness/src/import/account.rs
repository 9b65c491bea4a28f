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

    /// What was left out or changed. NaN is what tables write into empty fields, and to bring runs onto one chainage is
    /// what an import is for.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        self.but(&[ROWS, SHIFTED, INVERTED, NO_NUMBER])
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

/// What stands in `import.json`.
pub const FIELDS: &[[&str; 4]] = &[
    ["chainage", "", "how the runs came onto one chainage", ""],
    ["runs[].run", "", "name of the run: that of its log without `.csv`", ""],
    ["runs[].source", "", "file from which it comes", ""],
    ["runs[].lines[]", "", "first and last line of the run in that file", ""],
    ["runs[].begins_because", "", "why the run begins there", ""],
    ["runs[].rows", "", "rows of the run", ""],
    ["runs[].direction", "", "`up` or `down`; empty for a run that is left out", ""],
    ["runs[].from_m", "m", "least location; 0 for a run that is left out", ""],
    ["runs[].to_m", "m", "largest location; 0 for a run that is left out", ""],
    ["runs[].placed.offset_m", "m", "what was added to its locations", "absent: it was placed otherwise"],
    ["runs[].placed.inverted", "", "whether its locations were counted backwards", "absent: it was placed otherwise"],
    ["runs[].placed.scale", "", "by what its distances were multiplied", "absent: it was placed otherwise"],
    ["runs[].placed.how", "", "by what the offset was found", "absent: it was placed otherwise"],
    [
        "runs[].placed.on_the_line",
        "1",
        "share of its rows that are on the centre line",
        "absent: it was placed otherwise",
    ],
    ["runs[].placed.left_out", "", "why it is left out", "absent: it is not"],
    ["counts.*", "", "how often what is named was left out or changed", ""],
    ["places.*", "", "of each kind the first 20 places: `file:line:column: field: expected X, found Y`", ""],
    ["notes[]", "", "what the import noticed", ""],
];

pub const ROWS: &str = "rows";
pub const NO_NUMBER: &str = "fields with NaN, taken as empty";
pub const ROWS_TOO_SHORT: &str = "rows of pieces too short, left out";
pub const SHIFTED: &str = "runs shifted onto the chainage";
pub const INVERTED: &str = "runs inverted";
pub const SCALED: &str = "runs with distances of another wheel, put right by the stops of the track";
