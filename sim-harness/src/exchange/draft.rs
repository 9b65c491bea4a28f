//! A train read from another tool's file, which may not have everything that a train file needs.
//!
//! In: what a reader found, and what the user sets. Out: a checked train file. Nothing is guessed: a value that neither
//! has is refused by name.

use rundown::model::resistance::Davis;
use rundown_files::refusal::{Place, ReadError};
use rundown_files::train_file::TrainFile;
use std::collections::BTreeMap;
use std::path::Path;

/// Values of a train file that may be set, by their names there.
pub const FIELDS: [&str; 6] =
    ["mass_kg", "rotating_mass_factor", "length_m", "max_tractive_effort_n", "max_power_w", "max_brake_mps2"];

/// What a reader found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Draft {
    pub name: String,
    /// By their names in [`FIELDS`].
    pub values: BTreeMap<&'static str, f64>,
    /// A, B, C of the whole train: N, N/(m/s), N/(m/s)².
    pub resistance_n: [f64; 3],
    /// What was lost, or needs to be known.
    pub notes: Vec<String>,
}

impl Draft {
    /// Enters a value that the file has.
    pub fn put(&mut self, field: &'static str, value: Option<f64>) {
        self.values.extend(value.map(|value| (field, value)));
    }

    /// The train file, where `set` gives what the file has not, or replaces what it has.
    pub fn complete(&self, path: &Path, set: &BTreeMap<&'static str, f64>) -> Result<TrainFile, ReadError> {
        let value = |field: &'static str| {
            set.get(field).or_else(|| self.values.get(field)).copied().ok_or_else(|| {
                let message = format!("expected a value, found none in this format; add --set {field}=VALUE");
                ReadError::from(Place::of_file(path).refuse(field, message))
            })
        };
        let (mass_kg, rotating_mass_factor) = (value("mass_kg")?, value("rotating_mass_factor")?);
        let [r0, r1, r2] = self.resistance_n.map(|force| force / (rotating_mass_factor * mass_kg));
        let train = TrainFile {
            name: self.name.clone(),
            mass_kg,
            rotating_mass_factor,
            length_m: value("length_m")?,
            max_tractive_effort_n: value("max_tractive_effort_n")?,
            max_power_w: value("max_power_w")?,
            max_brake_mps2: value("max_brake_mps2")?,
            davis: Davis { r0, r1, r2 },
            effect: Vec::new(),
        };
        train.train().map_err(|error| Place::of_file(path).refuse("", error.to_string()))?;
        Ok(train)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_named_and_can_be_set() {
        let mut draft = Draft { name: "t".to_owned(), resistance_n: [2120.0, 53.0, 10.6], ..Draft::default() };
        let given = [2e5, 1.06, 100.0, 1e5, 1e6];
        FIELDS.into_iter().zip(given).for_each(|(field, value)| draft.put(field, Some(value)));
        let mut set = BTreeMap::new();
        let missing = draft.complete("f.xml".as_ref(), &set).unwrap_err().to_string();
        assert_eq!(
            missing,
            "f.xml: max_brake_mps2: expected a value, found none in this format; add --set max_brake_mps2=VALUE"
        );
        set.insert("max_brake_mps2", 0.5);
        let train = draft.complete("f.xml".as_ref(), &set).unwrap();
        assert!((train.davis.r0 - 0.01).abs() < 1e-15 && (train.davis.r2 - 5e-5).abs() < 1e-18);
        set.insert("mass_kg", 0.0);
        let wrong = draft.complete("f.xml".as_ref(), &set).unwrap_err().to_string();
        assert!(wrong.starts_with("f.xml: mass_kg: expected 1000 to"), "{wrong}");
    }
}
