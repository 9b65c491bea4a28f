//! Trains in the files of other tools: written of what was learned, and read.
//!
//! | format | file | written | read |
//! |---|---|---|---|
//! | SFERA 3.00 | XML | `sfera` | `sfera` |
//! | SUMO 1.28, vehicle type | XML | `sumo`, `sumo-table` | `sumo` |
//! | OSRD, RailJSON 3.4, rolling stock | JSON | `osrd` | `osrd` |
//! | railtoolkit 2022.05, as TrainRuns reads it | YAML | `trainruns` | `trainruns`, tracks `running_path` |
//! | ALTRIOS 1.1, rail vehicle | YAML | `altrios` | `altrios` |

mod altrios;
pub mod draft;
mod effort_curve;
mod number;
mod osrd;
pub(crate) mod provenance;
mod running_path;
pub(crate) mod sfera;
mod sumo;
mod sumo_table;
mod trainruns;
mod xml;
mod yaml;

use crate::learned_train::LearnedTrain;
use draft::Draft;
use rundown_files::refusal::{Place, ReadError};
use rundown_files::track_file::TrackFile;
use sfera::{Identity, Traction};
use std::path::Path;
use sumo::Form;

/// A format to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ExchangeFormat {
    /// Train characteristics of the UIC's SFERA, XML
    Sfera,
    /// Vehicle type of SUMO, an additional file
    Sumo,
    /// The same with tables of traction and resistance over speed
    SumoTable,
    /// Rolling stock of OSRD, JSON
    Osrd,
    /// Rolling stock of railtoolkit, which TrainRuns.jl reads, YAML
    Trainruns,
    /// Rail vehicle of ALTRIOS, YAML
    Altrios,
}

impl ExchangeFormat {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Sfera, Self::Sumo, Self::SumoTable, Self::Osrd, Self::Trainruns, Self::Altrios];

    /// As `--to` takes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sfera => "sfera",
            Self::Sumo => "sumo",
            Self::SumoTable => "sumo-table",
            Self::Osrd => "osrd",
            Self::Trainruns => "trainruns",
            Self::Altrios => "altrios",
        }
    }

    /// Name of the file.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Sfera => "sfera.xml",
            Self::Sumo => "sumo.add.xml",
            Self::SumoTable => "sumo.table.add.xml",
            Self::Osrd => "osrd.json",
            Self::Trainruns => "trainruns.yaml",
            Self::Altrios => "altrios.yaml",
        }
    }
}

/// The content of a file. `Err`: why the format cannot hold the train.
pub fn write(format: ExchangeFormat, learned: &LearnedTrain, identity: &Identity) -> Result<Vec<u8>, String> {
    let train = &learned.train;
    let max_speed_kmh = f64::from(identity.max_speed_kmh);
    let said = provenance::sentences(learned, train.mass_kg);
    match format {
        ExchangeFormat::Sfera => {
            let said = provenance::sentences(learned, sfera::stated_mass_kg(train));
            let mut bytes = Vec::new();
            sfera::write(&mut bytes, train, identity, &said).map_err(|error| error.to_string())?;
            Ok(bytes)
        }
        ExchangeFormat::Sumo | ExchangeFormat::SumoTable => {
            let form = if format == ExchangeFormat::Sumo { Form::Parameters } else { Form::Tables };
            sumo::write(train, max_speed_kmh, form, &said).map_err(|error| error.to_string())
        }
        ExchangeFormat::Osrd => {
            let voltage_v = match identity.traction {
                Traction::Electrical { volts, .. } => Some(volts),
                Traction::Battery | Traction::Diesel | Traction::Hydrogen => None,
            };
            Ok(osrd::write(train, max_speed_kmh, voltage_v, &said).into_bytes())
        }
        ExchangeFormat::Trainruns => trainruns::write(train, max_speed_kmh, &said).map(String::into_bytes),
        ExchangeFormat::Altrios => Ok(altrios::write(train, max_speed_kmh, &said).into_bytes()),
    }
}

/// What a file of another tool holds.
pub enum ForeignFile {
    Train(Draft),
    /// With what was lost or needs to be known.
    Track(TrackFile, Vec<String>),
}

/// Reads a file of any of the formats, recognised by its content.
pub fn read(path: &Path, text: &str) -> Result<ForeignFile, ReadError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let has = |word: &str| text.contains(word);
    if has(running_path::SCHEMA) {
        return running_path::read(path, text).map(|(track, notes)| ForeignFile::Track(track, notes));
    }
    let reader = if has("<TC_Features") || has(":TC_Features") {
        sfera::read
    } else if has("<vType") {
        sumo::read
    } else if has(trainruns::SCHEMA) {
        trainruns::read
    } else if has("\"rolling_resistance\"") {
        osrd::read
    } else if has("rolling_ratio") {
        altrios::read
    } else {
        let expected =
            "expected a train of SFERA, SUMO, OSRD, railtoolkit or ALTRIOS, or a running path of railtoolkit";
        return Err(Place::of_file(path).refuse("", format!("{expected}, found none of them")).into());
    };
    reader(path, text).map(ForeignFile::Train)
}

#[cfg(test)]
mod tests;
