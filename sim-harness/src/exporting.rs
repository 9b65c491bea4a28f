//! What was learned of a train, in files for other tools: the results of a replay or a board's recording in, a folder
//! out.

use crate::exchange::sfera::{self, Identity};
use crate::exchange::{self, provenance};
use crate::learned_train;
use crate::output::files;
use rundown_files::WriteError;
use rundown_files::folder;
use rundown_files::refusal::ReadError;
use std::io::Write;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use thiserror::Error;

pub use crate::exchange::ExchangeFormat;
pub use crate::exchange::sfera::Traction;
pub use crate::learned_train::Results;

/// Largest speeds that a train may have, km/h.
pub const MAX_SPEED_KMH: RangeInclusive<u16> = 1..=600;

/// The learned train, in each export.
const TRAIN: &str = "train.toml";
/// So much faster than the top speed runs may go, km/h: wheels and drivers are not exact.
const FASTER_KMH: f64 = 5.0;

/// What is to be exported: the arguments of `rundown export`.
#[derive(Clone, Debug)]
pub struct ExportOrder {
    /// What was learned.
    pub replay: Results,
    /// Description of the train with which the replay was made.
    pub train: PathBuf,
    /// Files to write, beside `train.toml`.
    pub formats: Vec<ExchangeFormat>,
    /// Unit, where the replay has several.
    pub unit: Option<String>,
    /// RICS code of the railway undertaking, for SFERA.
    pub company: Option<String>,
    /// Energy, for SFERA and OSRD.
    pub traction: Option<Traction>,
    /// Largest speed of the train, of [`MAX_SPEED_KMH`].
    pub max_speed_kmh: u16,
    /// Identifier of the train characteristics, for SFERA; without it the name of the train.
    pub id: Option<String>,
    /// Major version of the train characteristics, for SFERA.
    pub tc_version: String,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// Names of the files in the folder.
    pub files: Vec<&'static str>,
    /// The train, and what its values are, for people.
    pub said: String,
    /// What a person may want to know.
    pub notes: Vec<String>,
}

/// Why nothing was written.
#[derive(Debug, Error)]
pub enum ExportError {
    /// An argument is missing or wrong.
    #[error("{name}: {reason}")]
    Argument {
        /// Its name, with `_` between words.
        name: &'static str,
        /// What was expected, and what was found.
        reason: String,
    },
    /// The replay or the train was refused.
    #[error(transparent)]
    Refused(#[from] ReadError),
    /// A format cannot hold the train: its file, and why.
    #[error("{0}")]
    NoPlace(String),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl ExportOrder {
    /// Writes the files into the folder `out`, which is made when it does not exist.
    ///
    /// # Errors
    /// [`ExportError`]: then the folder is as it was.
    pub fn export(&self, out: &Path) -> Result<Exported, ExportError> {
        let begun = self.replay.provenance(&self.train);
        let learned = learned_train::read(&self.replay, &self.train, self.unit.as_deref())?;
        let train = &learned.train;
        let identity = self.identity(&train.name)?;
        let mut written = Vec::new();
        for format in &self.formats {
            let name = format.file_name();
            let content = exchange::write(*format, &learned, &identity);
            written.push((name, content.map_err(|why| ExportError::NoPlace(format!("{name}: {why}")))?));
        }
        let text = toml::to_string(train).map_err(|error| files::failed(out, std::io::Error::other(error)))?;
        written.push((TRAIN, text.clone().into_bytes()));
        let kept = earlier(out, &written)?;
        of_one_origin(out, &kept, &text)?;
        folder::write("export", out, &begun, |folder| -> Result<(), WriteError> {
            for (name, content) in &written {
                files::file(&folder.join(name), |file| Write::write_all(file, content))?;
            }
            let keep = |name: &PathBuf| std::fs::copy(out.join(name), folder.join(name)).map(drop);
            kept.iter().try_for_each(keep).map_err(|error| files::failed(out, error))
        })?;
        let files: Vec<&str> = written.iter().map(|(name, _)| *name).collect();
        let said = provenance::sentences(&learned, train.mass_kg).join("\n");
        let [mass_t, factor] = [train.mass_kg / 1000.0, train.rotating_mass_factor];
        let place = format!("files: {} in {}", files.join(", "), out.display());
        let said = format!("train: {}, {mass_t:.0} t, rotating mass factor {factor}\n{said}\n{place}\n", train.name);
        let note = "the train has named effects, which only train.toml can hold";
        let mut notes = learned.notes.clone();
        notes.extend((!train.effect.is_empty()).then(|| note.to_owned()));
        if let Some([_, to_kmh]) =
            learned.learned_kmh.filter(|[_, to_kmh]| *to_kmh > f64::from(self.max_speed_kmh) + FASTER_KMH)
        {
            let max_kmh = self.max_speed_kmh;
            notes.push(format!(
                "--max-speed {max_kmh} km/h, though the runs taught the resistance up to {to_kmh:.0} km/h"
            ));
        }
        if !kept.is_empty() {
            let names: Vec<String> = kept.iter().map(|name| name.display().to_string()).collect();
            notes.push(format!("{}: kept as an earlier export wrote them: {}", out.display(), names.join(", ")));
        }
        Ok(Exported { files, said, notes })
    }

    /// What the formats need beside the train; an argument that none of them reads may be missing.
    fn identity(&self, name: &str) -> Result<Identity, ExportError> {
        let wrong = |name, reason: String| ExportError::Argument { name, reason };
        let needs = |some: &[ExchangeFormat]| self.formats.iter().any(|format| some.contains(format));
        let found = self.max_speed_kmh;
        if !MAX_SPEED_KMH.contains(&found) {
            let (least, most) = (MAX_SPEED_KMH.start(), MAX_SPEED_KMH.end());
            return Err(wrong("max_speed", format!("expected {least} to {most} km/h, found {found}")));
        }
        let company = match &self.company {
            Some(code) => {
                sfera::company(code).map_err(|reason| wrong("company", format!("{reason}, found {code:?}")))?
            }
            None if needs(&[ExchangeFormat::Sfera]) => {
                return Err(wrong("company", "expected for sfera, found none".to_owned()));
            }
            None => String::new(),
        };
        if needs(&[ExchangeFormat::Sfera, ExchangeFormat::Osrd]) && self.traction.is_none() {
            return Err(wrong("traction", "expected for sfera and osrd, found none".to_owned()));
        }
        Ok(Identity {
            company,
            id: self.id.clone().unwrap_or_else(|| name.to_owned()),
            version: self.tc_version.clone(),
            traction: self.traction.unwrap_or(Traction::Diesel),
            max_speed_kmh: self.max_speed_kmh,
        })
    }
}

/// What stays is of these results, too: then the earlier export wrote the same train.
fn of_one_origin(out: &Path, kept: &[PathBuf], train: &str) -> Result<(), WriteError> {
    let before = std::fs::read_to_string(out.join(TRAIN));
    if kept.is_empty() || before.is_ok_and(|before| before == train) {
        return Ok(());
    }
    let names: Vec<String> = kept.iter().map(|name| name.display().to_string()).collect();
    let message = format!("{} there: of an export of other results, whose {TRAIN} is another one", names.join(", "));
    Err(files::failed(out, std::io::Error::new(std::io::ErrorKind::AlreadyExists, message)))
}

/// Files of earlier exports that this one does not write: another format is no reason to lose them.
fn earlier(out: &Path, written: &[(&str, Vec<u8>)]) -> Result<Vec<PathBuf>, WriteError> {
    let is_new = |name: &Path| written.iter().any(|(new, _)| name == Path::new(new));
    let before = folder::files_of("export", out)?.unwrap_or_default();
    Ok(before.into_iter().filter(|name| !is_new(name) && out.join(name).is_file()).collect())
}
