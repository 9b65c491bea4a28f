//! Files before their rows: of those that are read alike, columns, clocks and units decided.

use super::clock::ClockKind;
use super::columns::{self, Columns, How};
use super::evidence::SeenRows;
use super::letters;
use super::mapping::{SAY_IT, SourceMapping, line};
use super::meaning::Meaning;
use super::results;
use super::source::row::{Header, refused};
use super::source::{SourceFile, are_equal, unpacked_name};
use super::{units, zone};
use rundown_files::folder::MANIFEST;
use rundown_files::refusal::ReadError;
use rundown_files::run_set::{ending, first_of, is_index, is_packed, skipped_in, without_results};
use rundown_pages::numbers::counted;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Files that are read in the same way.
#[derive(Clone, Debug)]
pub struct Group {
    pub sources: Vec<SourceFile>,
    pub mapping: SourceMapping,
    pub columns: Columns,
    /// What a person should know of the columns.
    pub notes: Vec<String>,
    /// What a person is to be warned of.
    pub doubts: Vec<String>,
    /// What a person has to say before these files can be imported.
    pub question: Option<String>,
    /// Of each file, whether its own rows deny what was decided of all.
    pub denied: Vec<bool>,
}

impl Group {
    /// # Errors
    /// What the mapping asks for and the files do not have.
    pub fn new(sources: Vec<SourceFile>, mapping: SourceMapping) -> Result<Self, ReadError> {
        let first = sources.first().ok_or_else(|| refused(Path::new(""), "expected a file, found none"))?;
        let columns = columns::find(&first.headers, &mapping, first.layout.decimal.unwrap_or('.'));
        let columns = columns.map_err(|error| refused(&first.path, error))?;
        let (notes, doubts, denied) = (Vec::new(), Vec::new(), Vec::new());
        let mut group = Self { sources, mapping, columns, notes, doubts, question: None, denied };
        group.question = group.decide().err();
        Ok(group)
    }

    /// Of each of some files with the same header, whether its rows deny what was decided.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn deny(&self, sources: &[SourceFile]) -> Result<Vec<bool>, ReadError> {
        let mut seen = SeenRows::default();
        sources.iter().try_for_each(|source| seen.look(source, &self.columns))?;
        Ok(seen.denied(&self.columns))
    }

    /// Clock and units.
    fn decide(&mut self) -> Result<(), String> {
        let Self { sources, mapping, columns, notes, doubts, denied, .. } = self;
        if let Some(first) = sources.first() {
            let doubt = code_page(first, mapping);
            needed(columns, first)
                .map_err(|missing| doubt.as_ref().map_or(missing.clone(), |doubt| format!("{missing}; {doubt}")))?;
            notes.extend(doubt);
            notes.extend(first.words_of_signals());
            notes.extend(first.words_of_qualities());
            notes.extend(first.words_of_thousandths());
        }
        let mut seen = SeenRows::default();
        for source in &*sources {
            seen.look(source, columns).map_err(|error| error.to_string())?;
        }
        seen.are_there()?;
        notes.extend(seen.no_run(columns, mapping));
        notes.extend(seen.clock(columns, mapping)?);
        notes.extend(seen.exchanged(columns, mapping)?);
        notes.extend(seen.positions(columns));
        notes.extend(seen.signed(columns, mapping));
        notes.extend(seen.unit_alone(columns));
        if let Some(first) = sources.first() {
            needed(columns, first).map_err(|missing| format!("{missing}; {}", notes.join("; ")))?;
        }
        // Where two columns have a name for the same, the other one may be the one that agrees.
        let headers: &[Header] = sources.first().map_or(&[], |first| &first.headers);
        let other = columns.repeated(headers).into_iter().chain(columns.outranked(headers));
        let also: String = other.map(|note| format!("; {note}")).collect();
        notes.extend(seen.units(columns).map_err(|why| why + &also)?);
        // The way by a location of which nothing named the unit is known now.
        notes.extend(seen.exchanged(columns, mapping)?);
        doubts.extend(seen.doubt(columns));
        *denied = seen.denied(columns);
        notes.extend(notes_of(columns, sources.first().map_or(&[], |first| &first.headers)));
        Ok(())
    }

    /// What is to be said of these files.
    pub fn said(&self) -> Vec<String> {
        let of_files = self.sources.iter().filter_map(SourceFile::doubt_of_qualities);
        self.notes.iter().chain(&self.doubts).cloned().chain(of_files).collect()
    }

    /// The question with the file that asks it.
    pub fn asked(&self) -> Option<ReadError> {
        let path = self.sources.first().map(|source| source.path.clone()).unwrap_or_default();
        self.question.as_ref().map(|question| refused(&path, question))
    }

    /// What repeats the reading of these files.
    pub fn mapped(&self) -> SourceMapping {
        let layout = self.sources.first().map(|source| source.layout.clone()).unwrap_or_default();
        SourceMapping {
            files: self.sources.iter().map(|source| source.path.clone()).collect(),
            layout,
            columns: self.columns.mapped(),
            ..self.mapping.clone()
        }
    }
}

/// What is said of names that look as if they were read with the wrong code page; nothing where a person named it.
fn code_page(source: &SourceFile, mapping: &SourceMapping) -> Option<String> {
    let is_assumed = mapping.layout.encoding.is_none() && source.layout.encoding.as_deref() == Some(letters::ASSUMED);
    let strange = source.headers.iter().find(|header| is_assumed && letters::are_strange(&header.written))?;
    Some(format!("column {:?}: {}", strange.written, letters::REMEDY))
}

fn needed(columns: &Columns, source: &SourceFile) -> Result<(), String> {
    let place = columns.has(Meaning::Location) || (columns.has(Meaning::Latitude) && columns.has(Meaning::Longitude));
    let needed = [
        (columns.has(Meaning::Time), Meaning::Time, "time"),
        (place, Meaning::Location, "location (or latitude and longitude)"),
    ];
    let missing: Vec<(Meaning, &str)> =
        needed.iter().filter(|(is, ..)| !is).map(|(_, meaning, name)| (*meaning, *name)).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let names: Vec<&str> = source.headers.iter().map(|header| header.written.as_str()).collect();
    let hint = source.hint_of_signals().unwrap_or_default();
    Err(format!(
        "expected columns for {}, found {}; {SAY_IT} (with their headers): {}{hint}",
        missing.iter().map(|(_, name)| *name).collect::<Vec<_>>().join(" and "),
        names.join(", "),
        line(missing.iter().map(|(meaning, _)| (*meaning, "HEADER", String::new())))
    ))
}

fn notes_of(columns: &Columns, headers: &[Header]) -> Vec<String> {
    let mut notes = Vec::new();
    for (meaning, column) in &columns.of {
        if meaning.is_force() && headers[column.index].unit.as_deref().is_some_and(|unit| unit.trim() == "%") {
            notes.push(format!(
                "column {:?} is not used: per cent are of what there is at each speed; expected N/kg, N or kN",
                column.header
            ));
        } else if column.unit.is_none()
            && *meaning != Meaning::Time
            && let Some(first) = units::of(*meaning).first()
        {
            notes.push(format!(
                "column {:?} is not used: its unit{} is not known; {SAY_IT} (or another unit): {}",
                column.header,
                column.unknown_unit().map_or(String::new(), |unit| format!(" {unit:?}")),
                line([(*meaning, column.header.as_str(), format!("unit = {:?}", first.name))])
            ));
        }
        if meaning.is_force()
            && column.unit.is_some_and(|unit| unit.name != "N/kg")
            && columns.rotating_mass_kg.is_none()
        {
            notes.push(format!("column {:?} is not used: a force needs rotating_mass_kg in [[source]]", column.header));
        }
        if column.how == How::Assumed {
            notes.push(format!(
                "column {:?} is taken to be in {}",
                column.header,
                column.unit.map_or("", |unit| unit.name)
            ));
        }
    }
    if !columns.has(Meaning::Speed) {
        notes.push(format!(
            "no column has a speed: it is computed from the locations, and says nothing beyond them{}",
            columns.remedy(Meaning::Speed, headers)
        ));
    }
    let remedy = columns.remedy(Meaning::Location, headers);
    if !columns.has(Meaning::Location) && !remedy.is_empty() {
        notes.push(format!("no column has a location: it is computed from latitude and longitude{remedy}"));
    }
    notes.extend(columns.repeated(headers));
    notes.extend(columns.outranked(headers));
    let nameless = columns.nameless(headers);
    if !nameless.is_empty() && !notes.iter().any(|note| note.contains(&nameless)) {
        notes.push(format!("not used, for no name of theirs is known: {nameless}"));
    }
    let local = !columns.kind.has_unit();
    if local && !columns.has_zone {
        notes.extend(zone::believed(columns));
    }
    if let Some(zone) = columns.zone_name.as_ref().filter(|_| columns.has_zone || columns.kind == ClockKind::Unix) {
        notes.push(format!("zone {zone:?} is not used: the times have their own, or count from 1970 UTC"));
    }
    notes
}

/// Files of the arguments, and what is to be said of those left out: results of Rundown. A folder is its files in the
/// order of their names; an index beside named files is none of them.
///
/// # Errors
/// A folder cannot be read.
pub fn files(arguments: &[PathBuf]) -> Result<(Vec<PathBuf>, Vec<String>), ReadError> {
    const ENDS: [&str; 19] = [
        "csv", "tsv", "txt", "log", "dat", "asc", "xlsx", "xls", "xlsm", "xlsb", "ods", "gpx", "nmea", "nma", "json",
        "jsonl", "ndjson", "parquet", "pq",
    ];
    let is_log = |path: &Path| {
        let end = ending(&unpacked_name(path));
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        path.is_file() && ENDS.contains(&&*end) && !["index.csv", "import.json", MANIFEST].contains(&&*name)
    };
    let (mut files, mut skipped) = (Vec::new(), Vec::new());
    for argument in arguments {
        if !argument.is_dir() {
            files.push(argument.clone());
            continue;
        }
        let packed = skipped_in(argument, |path| is_packed(path) && !is_log(path));
        let entries = std::fs::read_dir(argument)
            .and_then(|entries| entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>());
        let mut inside = entries.map_err(|source| ReadError::Io { path: argument.clone(), source })?;
        inside.sort();
        skipped.extend(packed.into_iter().chain(other_kinds(argument, &inside, &ENDS)));
        inside.retain(|path| is_log(path));
        files.extend(inside);
    }
    files.retain(|path| !is_index(path));
    let mut notes = without_results(&mut files);
    notes.extend(skipped);
    notes.extend(results::left_out(&mut files));
    notes.extend(packed_again(&mut files));
    let (before, mut seen) = (files.len(), HashSet::new());
    files.retain(|path| seen.insert(path.canonicalize().unwrap_or_else(|_| path.clone())));
    let again = before - files.len();
    if again > 0 {
        notes.push(format!("{} given again, read once", counted(again, "file is", "files are")));
    }
    notes.extend(files.iter().filter(|path| path.to_str().is_none()).map(|path| without_a_name(path)));
    Ok((files, notes))
}

/// Leaves out what gzip made of other files that are read. Out: that it is so.
fn packed_again(files: &mut Vec<PathBuf>) -> Option<String> {
    let all: HashSet<PathBuf> = files.iter().cloned().collect();
    let is_again = |path: &Path| {
        let inner = unpacked_name(path);
        inner != path && all.contains(&inner) && are_equal(path, &inner).unwrap_or(false)
    };
    let before = files.len();
    files.retain(|path| !is_again(path));
    let again = counted(before - files.len(), "compressed file holds", "compressed files hold");
    (files.len() < before).then(|| format!("{again} what a file beside it holds: read once"))
}

/// Names of skipped files that are shown.
const NAMED: usize = 5;

/// The files of a folder that are skipped for the ends of their names, but for those of Rundown and of the system, and
/// those that are said to be compressed.
fn other_kinds(folder: &Path, inside: &[PathBuf], ends: &[&str]) -> Option<String> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let is_other = |path: &&PathBuf| {
        let end = ending(path);
        let is_own = end == "toml" || end == "html" || name(path).starts_with('.');
        path.is_file() && !is_own && !ends.contains(&&*end) && !is_packed(path)
    };
    let names: Vec<String> = inside.iter().filter(is_other).map(|path| name(path)).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{}: skipped {} of other kinds ({}); a log among them is read if it is named itself",
            folder.display(),
            counted(names.len(), "file", "files"),
            first_of(&names, NAMED)
        )
    })
}

/// `import.toml` is a text.
fn without_a_name(path: &Path) -> String {
    let path = path.display();
    format!("{path}: its name is no UTF-8; import.toml has it as shown here, so name the file to repeat the import")
}

/// That nothing is there to be read, and what was left out; folders in a folder are not entered.
pub fn no_files(arguments: &[PathBuf], mapping: &Path, notes: &[String]) -> ReadError {
    let expected = |hint: &str| format!("expected files to import, found none{hint}");
    let Some(folder) = arguments.iter().find(|argument| argument.is_dir()) else {
        let hint: String = notes.iter().map(|note| format!("; {note}")).collect();
        return refused(arguments.first().map_or(mapping, PathBuf::as_path), expected(&hint));
    };
    let inside = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut folders: Vec<String> = inside.filter(|path| path.is_dir()).map(|path| path.display().to_string()).collect();
    folders.sort();
    let named =
        (!folders.is_empty()).then(|| format!("folders in it are not entered, name one: {}", folders.join(", ")));
    let hint: String = notes.iter().cloned().chain(named).map(|hint| format!("; {hint}")).collect();
    refused(folder, expected(&hint))
}
