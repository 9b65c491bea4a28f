//! Train descriptions: a TOML file, see [`TrainFile`]. Out: the estimator's [`Train`].

use crate::effect_file::{self, EffectEntry};
use crate::toml_file::{self, TomlFile};
use crate::{exchanged::Described, refusal::ReadError};
use rundown::model::train::{Train, TrainDescription};
use rundown::{model::bounds::OutOfRange, model::resistance::Davis};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What a train file holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "named with their units")]
pub struct TrainFile {
    pub name: String,
    /// Mass as loaded, kg.
    pub mass_kg: f64,
    /// Rotating mass factor γ.
    pub rotating_mass_factor: f64,
    pub length_m: f64,
    pub max_tractive_effort_n: f64,
    pub max_power_w: f64,
    /// Largest deceleration by brake, m/s², positive.
    pub max_brake_mps2: f64,
    /// Manufacturer's Davis coefficients: N/kg, N/(kg m/s), N/(kg (m/s)²), per rotating mass γ m.
    pub davis: Davis,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effect: Vec<EffectEntry>,
}

impl TrainFile {
    /// Reads and checks a train file.
    ///
    /// # Errors
    /// [`ReadError`] names file, line and column.
    pub fn read(path: &Path) -> Result<(Self, Train), ReadError> {
        Self::parse(path, &toml_file::text_of(path)?)
    }

    /// Reads and checks a text; `path` is for the messages.
    ///
    /// # Errors
    /// As [`TrainFile::read`].
    pub fn parse(path: &Path, text: &str) -> Result<(Self, Train), ReadError> {
        let file = TomlFile::parse(path, text);
        checked(file.map_err(|error| Described::Train.or_exchanged(error, path, text))?)
    }

    /// The estimator's train.
    ///
    /// # Errors
    /// [`OutOfRange`] names the field that is out of range.
    pub fn train(&self) -> Result<Train, OutOfRange> {
        Train::try_new(self.description())
    }

    /// The file of a description, without effects.
    pub fn of(name: impl Into<String>, description: &TrainDescription) -> Self {
        let TrainDescription { mass_kg, rotating_mass_factor, length_m, davis, .. } = *description;
        let TrainDescription { max_tractive_effort_n, max_power_w, max_brake_mps2, .. } = *description;
        Self {
            name: name.into(),
            mass_kg,
            rotating_mass_factor,
            length_m,
            max_tractive_effort_n,
            max_power_w,
            max_brake_mps2,
            davis,
            effect: Vec::new(),
        }
    }

    fn description(&self) -> TrainDescription {
        TrainDescription {
            mass_kg: self.mass_kg,
            rotating_mass_factor: self.rotating_mass_factor,
            length_m: self.length_m,
            davis: self.davis,
            max_tractive_effort_n: self.max_tractive_effort_n,
            max_power_w: self.max_power_w,
            max_brake_mps2: self.max_brake_mps2,
        }
    }
}

fn checked(file: TomlFile<TrainFile>) -> Result<(TrainFile, Train), ReadError> {
    effect_file::check(&file, &file.values.effect)?;
    match file.values.train() {
        Ok(train) => Ok((file.values, train)),
        Err(error) => Err(file.refuse_error(&[], &error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRAIN: &str = "name = \"unit\"\nmass_kg = 364000\nrotating_mass_factor = 1.06\nlength_m = 162\n\
        max_tractive_effort_n = 192920.0\nmax_power_w = 2036377.8\nmax_brake_mps2 = 0.66\n\
        [davis]\nr0 = 0.00738\nr1 = 1.6e-4\nr2 = 2.8e-5\n";

    fn parse(text: &str) -> Result<(TrainFile, Train), ReadError> {
        TrainFile::parse("train.toml".as_ref(), text)
    }

    #[test]
    fn a_train_is_read() {
        let (file, train) = parse(TRAIN).unwrap();
        assert_eq!(file.name, "unit");
        assert_eq!(train.length_m(), 162.0);
        assert_eq!(train.davis().r2, 2.8e-5);
        assert!((train.rotating_mass_kg() - 385_840.0).abs() < 1e-6);
    }

    #[test]
    fn refusals_name_line_and_column() {
        let error = |from: &str, to: &str| parse(&TRAIN.replace(from, to)).unwrap_err().to_string();
        assert_eq!(error("r0 = 0.00738", "r0 = 7.38"), "train.toml:9:6: davis.r0: expected 0.00001 to 1, found 7.38");
        assert_eq!(
            error("mass_kg = 364000", "mass_kg = nan"),
            "train.toml:2:11: mass_kg: expected 1000 to 100000000, found NaN"
        );
        assert!(
            error("length_m", "lenght_m")
                .starts_with("train.toml:4:1: unknown field `lenght_m`, expected one of `name`")
        );
        assert!(error("[davis]", "[davies]").starts_with("train.toml:8:2: unknown field `davies`"));
        assert_eq!(error("r2 = 2.8e-5\n", ""), "train.toml:8:1: missing field `r2`");
    }
}
