//! `import.toml`: what a person says about the files, and what an import writes down so that it can be repeated.

use super::clock::{ClockKind, DateOrder};
use super::meaning::Meaning;
use super::source::row::Layout;
use rundown_files::refusal::ReadError;
use rundown_files::toml_file::TomlFile;
use serde::{Deserialize, Serialize, Serializer};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mapping {
    #[serde(default)]
    pub runs: RunCuts,
    #[serde(default)]
    pub chainage: Chainage,
    #[serde(default, rename = "source", skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<SourceMapping>,
}

/// Where a day is cut into runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RunCuts {
    pub gap_s: f64,
    pub standing_s: f64,
    pub turn_m: f64,
    pub min_length_m: f64,
    pub min_duration_s: f64,
}

impl Default for RunCuts {
    fn default() -> Self {
        Self { gap_s: 600.0, standing_s: 600.0, turn_m: 300.0, min_length_m: 500.0, min_duration_s: 60.0 }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chainage {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<Method>,
    /// A track whose centre line is taken instead of one made from the runs.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "shown")]
    pub track: Option<PathBuf>,
}

/// How many runs come onto one chainage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The locations are the chainage already
    AsIs,
    /// Shift each run so that the places where trains stop agree
    Stops,
    /// Project latitude and longitude on a centre line that is made from the runs
    Line,
    /// Shift each run so that its speeds over the location agree with those of the others
    Align,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::AsIs, Self::Stops, Self::Line, Self::Align];

    /// As `--chainage` takes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::AsIs => "as-is",
            Self::Stops => "stops",
            Self::Line => "line",
            Self::Align => "align",
        }
    }
}

/// A path as a person sees it: a text holds no bytes that are no letters.
fn shown<S: Serializer>(track: &Option<PathBuf>, serializer: S) -> Result<S::Ok, S::Error> {
    track.as_ref().map(|path| path.to_string_lossy()).serialize(serializer)
}

fn all_shown<S: Serializer>(files: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(files.iter().map(|path| path.to_string_lossy()))
}

/// What is said about some files; about all where it names none.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourceMapping {
    #[serde(default, skip_serializing_if = "Vec::is_empty", serialize_with = "all_shown")]
    pub files: Vec<PathBuf>,
    /// Unit (vehicle) of all rows, where no column has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Zone of local times without one, as `Europe/Berlin`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zone: Option<String>,
    /// By which an effort in N or kN is divided.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotating_mass_kg: Option<f64>,
    #[serde(default)]
    pub layout: Layout,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub columns: BTreeMap<Meaning, ColumnMapping>,
}

/// A column. An empty name: not used.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnMapping {
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Of a time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<ClockKind>,
    /// Of a date.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<DateOrder>,
    /// Of a speed: below zero the train goes back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signed: Option<bool>,
}

impl Mapping {
    /// # Errors
    /// [`ReadError`] names file, line and column.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let file: TomlFile<Self> = TomlFile::read(path)?;
        let RunCuts { gap_s, standing_s, turn_m, min_length_m, min_duration_s } = file.values.runs;
        let named = [
            ("gap_s", gap_s),
            ("standing_s", standing_s),
            ("turn_m", turn_m),
            ("min_length_m", min_length_m),
            ("min_duration_s", min_duration_s),
        ];
        for (name, value) in named {
            if !(0.0..=1e9).contains(&value) {
                return Err(file.refuse_dotted(&format!("runs.{name}"), format!("expected 0 or more, found {value}")));
            }
        }
        Ok(file.values)
    }

    /// All files that are named.
    pub fn files(&self) -> Vec<PathBuf> {
        self.sources.iter().flat_map(|source| source.files.clone()).collect()
    }

    /// What is said about a file: what names it goes before what names none, and that before the only one there is.
    pub fn of_file(&self, path: &Path) -> SourceMapping {
        let named = |source: &&SourceMapping| {
            source
                .files
                .iter()
                .any(|file| file == path || file.file_name().is_some() && file.file_name() == path.file_name())
        };
        let exact = self.sources.iter().find(|source| source.files.iter().any(|file| file == path));
        let found = exact.or_else(|| self.sources.iter().find(named));
        let found = found.or_else(|| self.sources.iter().find(|source| source.files.is_empty()));
        // A new file of the one recorder that an earlier import knew.
        let found = found.or_else(|| self.sources.first().filter(|_| self.sources.len() == 1));
        found.cloned().unwrap_or_default()
    }
}

/// Said before a [`line`].
pub const SAY_IT: &str = "write this into a file for --mapping";

/// The line for `--mapping` that says more of columns, as it can be pasted.
pub fn line<'a>(columns: impl IntoIterator<Item = (Meaning, &'a str, String)>) -> String {
    let column = |(meaning, header, said): (Meaning, &str, String)| {
        let said = if said.is_empty() { String::new() } else { format!(", {said}") };
        format!("columns.{} = {{ name = {}{said} }}", meaning.key(), toml::Value::from(header))
    };
    let columns: Vec<String> = columns.into_iter().map(column).collect();
    format!("source = [{{ {} }}]", columns.join(", "))
}
