//! Which runs, in which order, of which unit, in which direction.
//!
//! In: files and folders as given on the command line. Out: [`RunSet`].
//!
//! A folder stands for all its `*.csv` in the order of their names; one without any that has a folder `runs`, as a data
//! set of `rundown simulate`, stands for that. The index [`INDEX`] beside the logs gives departure, unit, driver and
//! direction; when every run stands in an index the runs go in the order of departure, otherwise as given. `runs.csv`
//! and `index.csv` are never taken for logs, so that `logs/*.csv` works; neither are the results that a `manifest.json`
//! beside the logs lists.

use crate::effect_file::day_of;
use crate::folder::{MANIFEST, results_in};
use crate::refusal::{Place, ReadError, Refusal};
use crate::run_log::STDIN;
use rundown::model::direction::Direction;
use serde::Deserialize;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Name of the index beside the logs.
pub const INDEX: &str = "runs.csv";
/// Its column of dates.
const DEPARTURE: &str = "departure_utc";
/// Its columns.
const COLUMNS: [&str; 5] = ["file", DEPARTURE, "unit", "direction", "driver"];
/// How one looks.
const DATE: &str = "2025-03-01T08:00:00Z";
/// Tables that lie beside logs and are none.
const NOT_LOGS: [&str; 2] = [INDEX, "index.csv"];
/// How the names of compressed files end.
pub const PACKED: [&str; 8] = ["gz", "tgz", "zip", "bz2", "xz", "zst", "7z", "rar"];
/// Skipped files of a kind that are named.
const NAMED: usize = 3;

/// One log to be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunFile {
    /// Where it lies.
    pub path: PathBuf,
    /// Name of the run in every output: the file's without `.csv`, and its folder's before it where two are alike.
    pub name: String,
    /// Unit of the index; empty without one. A vehicle's memory is that of its unit.
    pub unit: String,
    /// Driver of the index; empty without one.
    pub driver: String,
    /// Direction of the index.
    pub direction: Option<Direction>,
    /// Departure of the index, compared as text.
    pub departure_utc: Option<String>,
}

/// The runs in the order in which they are replayed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunSet {
    /// The runs.
    pub files: Vec<RunFile>,
    /// What a person may want to know: about the order, dates that cannot be read, files that are no logs.
    pub notes: Vec<String>,
    /// Of these, what an index has and that cannot be read: dates, columns, or nothing at all.
    pub doubts: Vec<String>,
}

#[derive(Clone, Debug, Deserialize)]
struct IndexRow {
    file: String,
    #[serde(default)]
    departure_utc: String,
    #[serde(default)]
    unit: String,
    #[serde(default)]
    direction: String,
    #[serde(default)]
    driver: String,
}

impl RunSet {
    /// Finds the runs behind files and folders. Whether a named file exists is found out when it is read.
    ///
    /// # Errors
    /// [`ReadError`] when a folder or an index cannot be read.
    pub fn find(arguments: &[PathBuf]) -> Result<Self, ReadError> {
        let arguments: Vec<PathBuf> = arguments.iter().map(|path| log_folder(path)).collect();
        let mut paths = Vec::new();
        let mut skipped = Vec::new();
        for argument in &arguments {
            if argument.is_dir() {
                paths.extend(logs_of(argument)?);
                skipped.extend(skipped_in(argument, is_packed));
            } else if !is_table(argument) {
                paths.push(argument.clone());
            }
        }
        let mut set = Self { notes: without_results(&mut paths), ..Self::default() };
        set.notes.extend(skipped);
        let mut indexes: HashMap<PathBuf, HashMap<String, IndexRow>> = HashMap::new();
        for path in paths {
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            if !indexes.contains_key(&folder) {
                let (rows, doubts) = read_index(&folder.join(INDEX))?;
                set.doubts.extend(doubts.iter().map(Refusal::to_string));
                indexes.insert(folder.clone(), rows);
            }
            let row = indexes[&folder].get(&file_name(&path));
            set.files.push(RunFile::new(path, row));
        }
        set.notes.extend_from_slice(&set.doubts);
        for folder in arguments.iter().filter(|argument| argument.is_dir()) {
            set.notes.extend(indexes.get(folder).and_then(|index| set.missing(folder, index)));
        }
        set.order();
        tell_apart(&mut set.files);
        Ok(set)
    }

    /// The files that are read: the logs, and the indexes beside them.
    pub fn paths(&self) -> Vec<PathBuf> {
        let indexes: BTreeSet<PathBuf> = self.files.iter().map(|file| file.path.with_file_name(INDEX)).collect();
        let logs = self.files.iter().map(|file| file.path.clone());
        logs.chain(indexes.into_iter().filter(|index| index.is_file())).collect()
    }

    /// Logs that only the index of a folder knows.
    fn missing(&self, folder: &Path, index: &HashMap<String, IndexRow>) -> Option<String> {
        let there: HashSet<&Path> = self.files.iter().map(|file| file.path.as_path()).collect();
        let mut names: Vec<&str> = index.keys().map(String::as_str).collect();
        names.retain(|name| !there.contains(folder.join(name).as_path()));
        names.sort_unstable();
        let (count, names) = (names.len(), names.join(", "));
        let place = folder.join(INDEX);
        (count > 0).then(|| format!("{}: {count} of its runs are not in this folder: {names}", place.display()))
    }

    fn order(&mut self) {
        let indexed = self.files.iter().filter(|file| file.departure_utc.is_some()).count();
        if indexed == self.files.len() {
            // By the instant, for their clocks may be of several zones; what is no date comes last.
            let day = |file: &RunFile| file.departure_utc.as_deref().and_then(day_of).unwrap_or(f64::INFINITY);
            self.files.sort_by(|a, b| day(a).total_cmp(&day(b)).then_with(|| a.departure_utc.cmp(&b.departure_utc)));
        } else if indexed > 0 {
            let all = self.files.len();
            let note = format!(
                "{indexed} of {all} runs stand in {INDEX}: the order is that of the arguments, not of departure"
            );
            self.notes.push(note);
        }
    }
}

impl RunFile {
    fn new(path: PathBuf, row: Option<&IndexRow>) -> Self {
        let stem = if path == Path::new(STDIN) { OsStr::new("stdin") } else { path.file_stem().unwrap_or_default() };
        let name = stem.to_string_lossy().into_owned();
        let departure = row.map(|row| row.departure_utc.clone());
        Self {
            path,
            name,
            unit: row.map(|row| row.unit.clone()).unwrap_or_default(),
            driver: row.map(|row| row.driver.clone()).unwrap_or_default(),
            direction: row.and_then(|row| direction(&row.direction).ok().flatten()),
            departure_utc: departure.filter(|text| !text.is_empty()),
        }
    }
}

fn direction(text: &str) -> Result<Option<Direction>, String> {
    match text {
        "" => Ok(None),
        "up" => Ok(Some(Direction::Up)),
        "down" => Ok(Some(Direction::Down)),
        other => Err(format!("expected `up` or `down`, found {other:?}")),
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn is_table(path: &Path) -> bool {
    NOT_LOGS.contains(&file_name(path).as_str())
}

/// Leaves out what commands wrote beside the logs, by the manifests there. Out: a note for each folder.
pub fn without_results(paths: &mut Vec<PathBuf>) -> Vec<String> {
    let of = |path: &PathBuf| path.parent().unwrap_or(Path::new("")).to_owned();
    let folders: BTreeSet<PathBuf> = paths.iter().map(of).collect();
    let note = |folder: PathBuf| {
        let results = results_in(&folder);
        let before = paths.len();
        paths.retain(|path| path.strip_prefix(&folder).map_or(true, |name| !results.contains(name)));
        let (count, place) = (before - paths.len(), folder.join(MANIFEST));
        (count > 0).then(|| {
            format!("{}: {count} of the files in this folder are results of a command, and no logs", place.display())
        })
    };
    folders.into_iter().filter_map(note).collect()
}

/// It has the name and the columns of an index.
pub fn is_index(path: &Path) -> bool {
    let has_files = || {
        let header = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_path(path).ok()?;
        Some({ header }.headers().ok()?.iter().any(|name| name == "file"))
    };
    NOT_LOGS.iter().any(|name| file_name(path).eq_ignore_ascii_case(name)) && has_files().unwrap_or(false)
}

/// The folder `runs` of a data set, else the path itself.
fn log_folder(path: &Path) -> PathBuf {
    let runs = path.join("runs");
    let is_data_set = runs.is_dir() && matches!(logs_of(path), Err(ReadError::Refused(_)));
    if is_data_set { runs } else { path.to_owned() }
}

/// The first names of some, and whether there are more.
pub fn first_of(names: &[String], most: usize) -> String {
    let more = if names.len() > most { ", ..." } else { "" };
    format!("{}{more}", names[..names.len().min(most)].join(", "))
}

/// By its name a compressed file.
pub fn is_packed(path: &Path) -> bool {
    PACKED.contains(&&*ending(path))
}

/// How the name of a file ends, in small letters.
pub fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// What looks like a log in a folder and cannot be read as one: compressed files, and links to nothing.
pub fn skipped_in(folder: &Path, is_packed: impl Fn(&Path) -> bool) -> Option<String> {
    let (mut packed, mut dangling) = (Vec::new(), Vec::new());
    for path in std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()) {
        if path.is_symlink() && !path.exists() {
            dangling.push(file_name(&path));
        } else if is_packed(&path) && path.is_file() {
            packed.push(file_name(&path));
        }
    }
    let count = packed.len() + dangling.len();
    let of = |mut names: Vec<String>, what: &str| {
        names.sort();
        (!names.is_empty()).then(|| format!("{} {what} ({})", names.len(), first_of(&names, NAMED)))
    };
    let parts = [of(packed, "compressed, to be unpacked first"), of(dangling, "linked to nothing")];
    let parts = parts.into_iter().flatten().collect::<Vec<String>>().join(", ");
    let files = if count == 1 { "file" } else { "files" };
    (count > 0).then(|| format!("{}: skipped {count} {files}: {parts}", folder.display()))
}

/// The logs of a folder in the order of their names.
fn logs_of(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let error = |source| ReadError::io(folder, source);
    let results = results_in(folder);
    let mut logs = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(error)? {
        let entry = entry.map_err(error)?;
        let path = entry.path();
        let is_csv = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
        let is_result = results.contains(Path::new(&entry.file_name()));
        if is_csv && path.is_file() && !is_table(&path) && !is_result {
            logs.push(path);
        }
    }
    logs.sort();
    if logs.is_empty() {
        let skipped = skipped_in(folder, is_packed).map(|skipped| format!("; {skipped}")).unwrap_or_default();
        let message = format!("expected run logs (*.csv) in this folder, found none{skipped}");
        return Err(ReadError::of_file(folder, message));
    }
    Ok(logs)
}

/// The rows of an index by the name of their file, and what of it cannot be read.
type Index = (HashMap<String, IndexRow>, Vec<Refusal>);

/// An index; nothing when there is none.
fn read_index(path: &Path) -> Result<Index, ReadError> {
    match std::fs::read(path) {
        Ok(bytes) => {
            log::info!("read {}", path.display());
            parse_index(path, &bytes)
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Index::default()),
        Err(source) => Err(ReadError::io(path, source)),
    }
}

fn parse_index(path: &Path, bytes: &[u8]) -> Result<Index, ReadError> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(bytes);
    let mut rows = HashMap::new();
    let place = |position: Option<&csv::Position>| match position {
        Some(position) => Place::of_line(path, position.line()),
        None => Place::of_file(path),
    };
    let refused = |error: csv::Error| -> Refusal { place(error.position()).refuse("", error.to_string()) };
    let header = reader.headers().map_err(refused)?.clone();
    let (mut undated, mut unread): (Option<Refusal>, usize) = (None, 0);
    for record in reader.records() {
        let record = record.map_err(refused)?;
        let row: IndexRow = record.deserialize(Some(&header)).map_err(refused)?;
        direction(&row.direction).map_err(|message| place(record.position()).refuse("direction", message))?;
        if !row.departure_utc.is_empty() && day_of(&row.departure_utc).is_none() {
            unread += 1;
            let column = header.iter().position(|name| name == DEPARTURE).map(|at| at + 1);
            let found = format!("expected a date as {DATE}, found {:?}", row.departure_utc);
            let here = Place { column, ..place(record.position()) };
            undated.get_or_insert_with(|| here.refuse(DEPARTURE, found));
        }
        // Only the name counts: an index may lie beside its logs and still name their folder.
        rows.insert(file_name(Path::new(&row.file)), row);
    }
    if let Some(undated) = &mut undated {
        let more = if unread > 1 { format!(", and {} more like this", unread - 1) } else { String::new() };
        undated.message += &format!("{more}; the run has no date, and comes after those that have one");
    }
    let line = header.position().map_or(1, csv::Position::line);
    let nothing = rows.is_empty().then(|| {
        let columns = COLUMNS.join(", ");
        place(None).refuse("", format!("expected a row for each log, found none; its columns are {columns}"))
    });
    Ok((rows, unknown_columns(path, line, &header).into_iter().chain(nothing).chain(undated).collect()))
}

/// Columns of an index that are not read: a date or a unit under another name would be lost without a word.
fn unknown_columns(path: &Path, line: u64, header: &csv::StringRecord) -> Option<Refusal> {
    let unknown = |(_, name): &(usize, &str)| !name.is_empty() && !COLUMNS.contains(name);
    let unknown: Vec<(usize, &str)> = (1..).zip(header).filter(unknown).collect();
    let (column, _) = *unknown.first()?;
    let names: Vec<String> = unknown.iter().map(|(_, name)| format!("{name:?}")).collect();
    let (columns, names) = (COLUMNS.join(", "), names.join(", "));
    let place = Place { column: Some(column), ..Place::of_line(path, line) };
    Some(place.refuse("", format!("expected columns among {columns}, found {names}, which are not read")))
}

/// Runs of one name get their folder's name before it, and a number when that is not enough: no output overwrites
/// another.
fn tell_apart(files: &mut [RunFile]) {
    let mut counts: HashMap<String, usize> = HashMap::new();
    for file in files.iter() {
        *counts.entry(file.name.clone()).or_default() += 1;
    }
    let mut taken: HashMap<String, usize> = HashMap::new();
    for file in files {
        if counts[&file.name] > 1
            && let Some(folder) = file.path.parent().and_then(Path::file_name)
        {
            file.name = format!("{}_{}", folder.to_string_lossy(), file.name);
        }
        let number = taken.entry(file.name.clone()).or_default();
        *number += 1;
        if *number > 1 {
            file.name = format!("{}_{number}", file.name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        folder
    }

    fn names(set: &RunSet) -> Vec<&str> {
        set.files.iter().map(|file| file.name.as_str()).collect()
    }

    #[test]
    fn a_folder_is_its_logs_in_the_order_of_names() {
        let folder = folder(&[("b.csv", ""), ("a.csv", ""), ("index.csv", ""), ("x.txt", ""), ("sub/c.csv", "")]);
        let set = RunSet::find(&[folder.path().to_owned()]).unwrap();
        assert_eq!(names(&set), ["a", "b"]);
    }

    #[test]
    fn results_beside_the_logs_are_none() {
        let manifest =
            |command: &str, file: &str| format!(r#"{{"command": "{command}", "outputs": [{{"file": "{file}"}}]}}"#);
        let folder = folder(&[("a.csv", ""), ("features.csv", ""), (MANIFEST, &manifest("replay", "features.csv"))]);
        let set = RunSet::find(&[folder.path().to_owned()]).unwrap();
        assert_eq!((names(&set), set.notes.len()), (vec!["a"], 0));
        let named = ["a.csv", "features.csv"].map(|name| folder.path().join(name));
        let set = RunSet::find(&named).unwrap();
        assert_eq!(names(&set), ["a"]);
        assert!(set.notes[0].contains("manifest.json: 1 of the files"), "{:?}", set.notes);
        // An import makes logs, and the manifest of another program says nothing.
        for text in [manifest("import", "a.csv"), "{}".to_owned()] {
            std::fs::write(folder.path().join(MANIFEST), text).unwrap();
            assert_eq!(names(&RunSet::find(&named).unwrap()), ["a", "features"]);
        }
    }

    #[test]
    fn a_data_set_is_its_folder_of_runs_and_logs_beside_one_come_first() {
        let folder = folder(&[
            ("set/runs/a.csv", ""),
            ("set/runs/runs.csv", "file,unit\na.csv,7\n"),
            ("set/truth/a.csv", ""),
            ("mixed/b.csv", ""),
            ("mixed/runs/c.csv", ""),
        ]);
        let set = RunSet::find(&[folder.path().join("set")]).unwrap();
        assert_eq!((names(&set), set.files[0].unit.as_str()), (vec!["a"], "7"));
        let set = RunSet::find(&[folder.path().join("mixed")]).unwrap();
        assert_eq!(names(&set), ["b"]);
    }

    #[test]
    fn an_index_gives_order_unit_and_direction() {
        let index = "# by hand\nfile,departure_utc,unit,direction\na.csv,2025-02-01T08:00,9,down\nb.csv,2025-01-01T08:00,7,up\n";
        let folder = folder(&[("a.csv", ""), ("b.csv", ""), ("runs.csv", index)]);
        let files = ["a.csv", "b.csv", "runs.csv"].map(|name| folder.path().join(name));
        let set = RunSet::find(&files).unwrap();
        assert_eq!(names(&set), ["b", "a"]);
        assert_eq!(set.files[1].direction, Some(Direction::Down));
        assert_eq!(set.files[1].unit, "9");
        assert!(set.notes.is_empty());
    }

    #[test]
    fn departures_of_several_zones_are_ordered_by_their_instants() {
        let index =
            "file,departure_utc\na.csv,2025-01-01T08:00:00Z\nb.csv,2025-01-01T09:30:00+02:00\nc.csv,2025-01-01T08:15\n";
        let folder = folder(&[("a.csv", ""), ("b.csv", ""), ("c.csv", ""), ("runs.csv", index)]);
        assert_eq!(names(&RunSet::find(&[folder.path().to_owned()]).unwrap()), ["b", "a", "c"]);
    }

    #[test]
    fn a_run_that_is_not_in_the_index_keeps_the_given_order_and_is_reported() {
        let index = "file,departure_utc\na.csv,2025-02-01T08:00\n";
        let folder = folder(&[("a.csv", ""), ("b.csv", ""), ("runs.csv", index)]);
        let set = RunSet::find(&[folder.path().join("b.csv"), folder.path().join("a.csv")]).unwrap();
        assert_eq!(names(&set), ["b", "a"]);
        assert_eq!(set.notes.len(), 1);
    }

    #[test]
    fn a_log_that_only_the_index_knows_is_reported() {
        let index = "file\nc.csv\na.csv\nb.csv\n";
        let folder = folder(&[("a.csv", ""), ("runs.csv", index)]);
        let set = RunSet::find(&[folder.path().to_owned()]).unwrap();
        assert_eq!(set.notes.len(), 1);
        let expected = "runs.csv: 2 of its runs are not in this folder: b.csv, c.csv";
        assert!(set.notes[0].ends_with(expected), "{}", set.notes[0]);
        let one = RunSet::find(&[folder.path().join("a.csv")]).unwrap();
        assert!(one.notes.is_empty(), "one log of many is asked for");
    }

    #[test]
    fn a_wrong_index_is_refused_with_its_place() {
        let index = "file,direction\nb.csv,up\na.csv,upp\n";
        let folder_a = folder(&[("a.csv", ""), ("runs.csv", index)]);
        let error = RunSet::find(&[folder_a.path().to_owned()]).unwrap_err().to_string();
        assert!(error.contains("runs.csv:3: direction: expected `up` or `down`, found \"upp\""), "{error}");
        let folder_b = folder(&[("a.csv", ""), ("runs.csv", "name\na\n")]);
        let error = RunSet::find(&[folder_b.path().to_owned()]).unwrap_err().to_string();
        assert!(error.contains("missing field `file`"), "{error}");
    }

    #[test]
    fn a_date_that_cannot_be_read_is_said_with_its_place() {
        let index = "file,unit,departure_utc\na.csv,7,2025-03-01T08:00:00Z\nb.csv,7,01.03.2025 09:00\nc.csv,7,noon\n";
        let folder = folder(&[("a.csv", ""), ("b.csv", ""), ("c.csv", ""), ("runs.csv", index)]);
        let set = RunSet::find(&[folder.path().to_owned()]).unwrap();
        let expected = "runs.csv:3:3: departure_utc: expected a date as 2025-03-01T08:00:00Z, \
            found \"01.03.2025 09:00\", and 1 more like this; the run has no date, and comes after those that have one";
        assert_eq!(set.notes.len(), 1, "{:?}", set.notes);
        assert!(set.notes[0].ends_with(expected), "{:?}", set.notes);
    }

    #[test]
    fn columns_of_an_index_that_are_not_known_are_said() {
        let folder = folder(&[("a.csv", ""), ("runs.csv", "file,when,unit,veh\na.csv,2025-03-01,7,9\n")]);
        let set = RunSet::find(&[folder.path().to_owned()]).unwrap();
        let said = "runs.csv:1:2: expected columns among file, departure_utc, unit, direction, driver, \
            found \"when\", \"veh\", which are not read";
        assert!(set.notes.len() == 1 && set.notes[0].ends_with(said), "{:?}", set.notes);
        assert_eq!(set.doubts, set.notes);
    }

    #[test]
    fn an_empty_index_is_said() {
        let said = "runs.csv: expected a row for each log, found none; its columns are file, departure_utc, unit, \
            direction, driver";
        for text in ["", "\n", "# a comment\n", "file,unit\n"] {
            let folder = folder(&[("a.csv", ""), ("runs.csv", text)]);
            let set = RunSet::find(&[folder.path().to_owned()]).unwrap();
            assert!(set.notes.len() == 1 && set.notes[0].ends_with(said), "{text:?}: {:?}", set.notes);
        }
    }

    #[test]
    fn runs_of_one_name_are_distinguished() {
        let folder = folder(&[("x/run.csv", ""), ("y/run.csv", "")]);
        let set =
            RunSet::find(&[folder.path().join("x"), folder.path().join("y"), folder.path().join("y/run.csv")]).unwrap();
        assert_eq!(names(&set), ["x_run", "y_run", "y_run_2"]);
    }

    #[test]
    #[cfg(unix)]
    fn compressed_logs_and_links_to_nothing_are_counted_and_named() {
        let folder = folder(&[("a.csv", ""), ("b.csv.gz", ""), ("c.CSV.ZIP", ""), ("read.me", "")]);
        std::os::unix::fs::symlink("nowhere.csv", folder.path().join("d.csv")).unwrap();
        let said =
            "skipped 3 files: 2 compressed, to be unpacked first (b.csv.gz, c.CSV.ZIP), 1 linked to nothing (d.csv)";
        let set = RunSet::find(&[folder.path().to_owned()]).unwrap();
        assert!(names(&set) == ["a"] && set.notes.len() == 1 && set.notes[0].ends_with(said), "{:?}", set.notes);
        std::fs::remove_file(folder.path().join("a.csv")).unwrap();
        let error = RunSet::find(&[folder.path().to_owned()]).unwrap_err().to_string();
        assert!(error.contains("found none; ") && error.ends_with(said), "{error}");
    }

    #[test]
    fn a_folder_without_logs_is_refused() {
        let folder = folder(&[("runs.csv", "file\n")]);
        let error = RunSet::find(&[folder.path().to_owned()]).unwrap_err().to_string();
        assert!(error.ends_with("expected run logs (*.csv) in this folder, found none"), "{error}");
    }
}
