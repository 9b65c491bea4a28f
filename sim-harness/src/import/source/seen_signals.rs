//! The signals of a table that has one in each row, as they are seen in its rows.

use super::row::{Header, RowField};
use crate::import::meaning::Meaning;
use crate::import::units;
use std::collections::HashMap;

/// Several trains or sources share their names where more values than this share stand beside another one of the same
/// signal and time, and are off by more than this share of all that the signal goes: one that is read several times
/// within the second that is written is not.
const MOST_BESIDE: f64 = 0.05;
const FAR_BESIDE: f64 = 0.03;

/// All of them, in the order in which they come.
#[derive(Default)]
pub struct SeenSignals {
    pub all: Vec<SeenSignal>,
    index: HashMap<String, usize>,
    rows: usize,
    /// A signal of motion has a unit that it may have: the column of units has no vehicles.
    pub is_measured: bool,
}

/// A signal of the file.
#[derive(Default)]
pub struct SeenSignal {
    pub name: String,
    /// In the order in which they come.
    units: Vec<String>,
    /// The first value.
    pub value: RowField,
    /// The least and the largest number.
    range: Option<[f64; 2]>,
    /// The first and last of its rows, and how many there are.
    pub ends: [usize; 2],
    pub rows: usize,
    last: RowField,
    /// What its last row shares with others, if the column of units has units of measure, and if it has vehicles.
    keys: [String; 2],
    /// How many values stand beside another one, and how far they are from it in all; of both again.
    beside: [(usize, f64); 2],
}

impl SeenSignals {
    /// Sees a row. `keys`: what it shares with others of its time, as in [`SeenSignal`].
    pub fn see(&mut self, name: String, value: Option<&RowField>, unit: Option<String>, keys: [String; 2]) {
        let number = self.rows;
        let at = *self.index.entry(name).or_insert_with_key(|name| {
            self.all.push(SeenSignal { name: name.clone(), ends: [number; 2], ..SeenSignal::default() });
            self.all.len() - 1
        });
        let signal = &mut self.all[at];
        signal.ends[1] = number;
        signal.rows += 1;
        self.rows += 1;
        if let Some(unit) = unit.filter(|unit| !signal.units.contains(unit)) {
            let meaning = Meaning::of_name(&Header::new(&signal.name).name);
            let may_have = |meaning: Meaning| units::by_name(meaning, &unit).is_some();
            self.is_measured |=
                may_have(Meaning::Speed) || meaning == Some(Meaning::Location) && may_have(Meaning::Location);
            signal.units.push(unit);
        }
        if let Some(value) = value.filter(|value| **value != RowField::Empty) {
            signal.take(value, keys);
        }
    }
}

impl SeenSignal {
    fn take(&mut self, value: &RowField, keys: [String; 2]) {
        let read = value.number();
        for ((before, key), (count, off)) in self.keys.iter().zip(&keys).zip(&mut self.beside) {
            if before == key && self.last != *value {
                *count += 1;
                *off += read.zip(self.last.number()).map_or(0.0, |(a, b)| (a - b).abs());
            }
        }
        if let Some(read) = read {
            let [low, high] = self.range.unwrap_or([read; 2]);
            self.range = Some([low.min(read), high.max(read)]);
        }
        if self.value == RowField::Empty {
            self.value = value.clone();
        }
        (self.keys, self.last) = (keys, value.clone());
    }

    /// The first unit that a signal with this name may have.
    pub fn unit(&self, name: &str) -> Option<String> {
        let fits =
            |unit: &&String| Meaning::of_name(name).is_some_and(|meaning| units::by_name(meaning, unit).is_some());
        self.units.iter().find(fits).or(self.units.first()).cloned()
    }

    /// Its name, how many values stand beside another one, and its rows, where many do, far from it. `has_vehicles`:
    /// whether the column of units has vehicles.
    pub fn far_beside(&self, has_vehicles: bool) -> Option<(String, usize, usize)> {
        let (count, off) = self.beside[usize::from(has_vehicles)];
        let [low, high] = self.range?;
        let are_many = count as f64 > MOST_BESIDE * self.rows as f64;
        (are_many && off > FAR_BESIDE * (high - low) * count as f64).then(|| (self.name.clone(), count, self.rows))
    }
}
