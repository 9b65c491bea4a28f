//! `rundown import`: what people have becomes run logs.
//!
//! ```text
//! source -> columns, clock, evidence (analysis, alike) -> rows -> cutter -> stretch (motion, cut) -> staged -> chainage, line -> write, skeleton
//! ```
//!
//! In: tables as text, sheets, GPX, NMEA, JSON lines, Parquet, and what `import.toml` says about them. Out: a folder of
//! run logs with its index, `import.toml` that repeats the import, and an account of whatever was left out or changed.
//! Text is streamed; of the runs only what places them on a common chainage is held.

pub(crate) mod account;
mod alike;
mod analysis;
mod chainage;
mod clock;
mod columns;
mod cubic;
mod cut;
mod cutter;
mod evidence;
mod geo;
mod letters;
mod line;
mod listed;
mod mapping;
mod meaning;
mod motion;
mod number;
mod odometer;
mod overlaps;
mod preview;
mod results;
mod rows;
mod skeleton;
mod source;
mod speeds;
mod staged;
mod still;
mod stretch;
mod units;
mod write;
mod zone;

use crate::alike::few;
use account::{Account, INVERTED, ROWS, ROWS_TOO_SHORT, SCALED, SHIFTED};
use analysis::Group;
use chainage::{Given, Placed, Placing};
use cutter::Cutter;
use listed::Indexes;
use mapping::{Chainage, Mapping};
use overlaps::{Ends, OVERLAPS};
use rows::Converter;
use rundown_files::WriteError;
use rundown_files::folder::{self, Provenance};
use rundown_files::refusal::{Place as FilePlace, ReadError};
use rundown_files::track_file::TrackFile;
use rundown_pages::numbers::counted;
use serde_json::{Value, json};
use source::SourceFile;
use source::row::Event;
use staged::Staged;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use stretch::{Odometer, Stretch};
use thiserror::Error;

pub use mapping::Method;

/// Runs that are said on the screen.
const SHOWN: usize = 20;

/// Why an import gave nothing.
#[derive(Debug, Error)]
pub enum ImportError {
    /// No file can be read, or a person has to answer a question first.
    #[error("{message}")]
    Nothing {
        /// All that is wrong, a line each.
        message: String,
        /// What is wrong with the first file, where it is one.
        first: Option<Box<ReadError>>,
    },
    /// The mapping or the track is wrong.
    #[error(transparent)]
    Refused(#[from] ReadError),
    /// Something is to be warned of, and nothing may be.
    #[error("{0}")]
    Strict(String),
    /// The folder cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl ImportError {
    /// Refused files, and what is to be said beside them.
    fn nothing(refused: Vec<ReadError>, more: impl IntoIterator<Item = String>) -> Self {
        let lines: Vec<String> = few(refused.iter().map(ToString::to_string)).into_iter().chain(more).collect();
        Self::Nothing { message: lines.join("\n"), first: refused.into_iter().next().map(Box::new) }
    }
}

/// What came of an import.
#[derive(Debug, Default)]
pub struct Imported {
    /// What was done, for people.
    pub lines: Vec<String>,
    /// What a person may want to know, as the evidence for units and clocks.
    pub notes: Vec<String>,
    /// Files that cannot be read, or of which a person has to say more.
    pub errors: Vec<ReadError>,
    /// What was left out or changed.
    pub warnings: Vec<String>,
    /// How many run logs were written.
    pub runs: usize,
    /// How many runs cannot be put on the chainage.
    pub left_out: usize,
}

impl Imported {
    /// What was done, and where the run logs are.
    pub fn words(&self, out: &Path) -> String {
        let lines: String = self.lines.iter().map(|line| format!("{line}\n")).collect();
        format!("{lines}{} in {}\n", counted(self.runs, "run", "runs"), out.display())
    }
}

/// What an import would do.
#[derive(Debug)]
pub struct Preview {
    /// In words.
    pub found: Imported,
    groups: Vec<Group>,
}

impl Preview {
    /// The speeds as they would be imported, as SVG.
    pub fn picture(&self) -> String {
        preview::picture(&self.groups)
    }
}

/// Files to import, and how.
#[derive(Debug)]
pub struct ImportOrder {
    /// Files, or folders of files; without any those that the mapping names.
    pub files: Vec<PathBuf>,
    mapping: Mapping,
    /// The file of the mapping, where there is one.
    mapping_file: Option<PathBuf>,
    /// Folder for the run logs.
    pub out: PathBuf,
    /// Where a track to begin with is written, too.
    pub track_out: Option<PathBuf>,
    /// Nothing is written where anything is to be warned of.
    pub strict: bool,
}

/// The files, those that are read alike together.
struct Grouped {
    groups: Vec<Group>,
    /// Files that cannot be read, or of which a person has to say more.
    errors: Vec<ReadError>,
    /// On files that are not read.
    notes: Vec<String>,
}

impl ImportOrder {
    /// Files to import into the folder `out`, and an `import.toml` that says what they do not.
    ///
    /// # Errors
    /// [`ReadError`] of that file.
    pub fn new(files: Vec<PathBuf>, mapping: Option<PathBuf>, out: PathBuf) -> Result<Self, ReadError> {
        let read = mapping.as_deref().map(Mapping::read).transpose()?.unwrap_or_default();
        Ok(Self { files, mapping: read, mapping_file: mapping, out, track_out: None, strict: false })
    }

    /// How the runs come onto one chainage, and a track whose centre line or stops give it; what is not given here
    /// stays as the mapping says it.
    pub fn place_by(&mut self, method: Option<Method>, track: Option<PathBuf>) {
        let said = &mut self.mapping.chainage;
        said.method = method.or(said.method);
        said.track = track.or(said.track.take());
    }

    fn groups(&self) -> Result<Grouped, ImportError> {
        let given = if self.files.is_empty() { self.mapping.files() } else { self.files.clone() };
        let (files, notes) = analysis::files(&given)?;
        if files.is_empty() {
            let mapping = self.mapping_file.as_deref().unwrap_or(Path::new("import.toml"));
            return Err(analysis::no_files(&given, mapping, &notes).into());
        }
        let (groups, mut errors) = alike::analyse(&files, &self.mapping);
        errors.extend(groups.iter().filter_map(Group::asked));
        if groups.is_empty() { Err(ImportError::nothing(errors, notes)) } else { Ok(Grouped { groups, errors, notes }) }
    }

    /// What would be done, also where a question is still open. Writes nothing.
    ///
    /// # Errors
    /// No file can be read.
    pub fn preview(&self) -> Result<Preview, ImportError> {
        let Grouped { groups, errors, mut notes } = self.groups()?;
        let lines = groups.iter().map(preview::words).collect();
        notes.extend(groups.iter().flat_map(Group::said));
        Ok(Preview { found: Imported { lines, notes, errors, ..Imported::default() }, groups })
    }

    /// Imports, and writes the folder.
    ///
    /// # Errors
    /// Nothing usable came out, or it cannot be written.
    pub fn import(&self) -> Result<Imported, ImportError> {
        let given = self.given()?;
        let Grouped { mut groups, errors, notes } = self.groups()?;
        groups.retain(|group| group.question.is_none());
        if groups.is_empty() {
            return Err(ImportError::nothing(errors, []));
        }
        write::may_write(&self.out)?;
        self.track_out.as_deref().map_or(Ok(()), skeleton::may_replace)?;
        let (track, mut done) = folder::write("import", &self.out, &self.provenance(&groups), |folder| {
            self.fill(&groups, errors, given, folder)
        })?;
        done.notes.splice(0..0, notes);
        if let Some(path) = &self.track_out {
            crate::output::files::whole(path, &track)?;
        }
        Ok(done)
    }

    /// When the work begins, and what it reads.
    fn provenance(&self, groups: &[Group]) -> Provenance {
        let sources = groups.iter().flat_map(|group| &group.sources).map(|source| source.path.clone());
        let said = self.mapping_file.iter().chain(&self.mapping.chainage.track).cloned();
        let files: Vec<PathBuf> = said.chain(sources).collect();
        Provenance::begin(&files)
    }

    /// Out: the track, and what is to be said.
    fn fill(
        &self,
        groups: &[Group],
        mut errors: Vec<ReadError>,
        given: Given,
        folder: &Path,
    ) -> Result<(String, Imported), ImportError> {
        let mut account = Account::default();
        let mut staged = Vec::new();
        let mut names = HashSet::new();
        let sources = groups.iter().flat_map(|group| &group.sources);
        let (listed, unread) = Indexes::find(sources.map(|source| source.path.as_path()));
        errors.extend(unread);
        for group in groups {
            for source in &group.sources {
                let read = self.read(source, group, folder, &mut names, &mut account);
                match read {
                    Ok(mut runs) => {
                        listed.keep(&source.path, &mut runs);
                        staged.extend(runs);
                    }
                    Err(ImportError::Refused(error)) => errors.push(error),
                    Err(error) => return Err(error),
                }
            }
        }
        if staged.is_empty() {
            let none = format!("expected at least one run in {} rows, found none", account.times(ROWS));
            let places = account.places.values().flatten().cloned();
            return Err(ImportError::nothing(errors, account.lines().chain(places).chain([none])));
        }
        let placed = chainage::place(&staged, self.mapping.chainage.method, given);
        let (track, mut done) = self.write(groups, &staged, &placed, &account, folder)?;
        done.notes.extend_from_slice(&listed.doubts);
        done.warnings.extend(listed.doubts);
        if self.strict {
            // Notes are the evidence for units and clocks.
            let errors = errors.iter().map(ToString::to_string);
            let said: Vec<String> = errors.chain(done.warnings.iter().cloned()).collect();
            if !said.is_empty() {
                let text = said.join("\n");
                return Err(ImportError::Strict(format!(
                    "{text}\n--strict: expected nothing to be warned of, found {}; nothing was written",
                    counted(said.len(), "warning", "warnings")
                )));
            }
        }
        Ok((track, Imported { errors, ..done }))
    }

    fn given(&self) -> Result<Given, ImportError> {
        let Some(path) = &self.mapping.chainage.track else { return Ok(Given::default()) };
        let (track, _) = TrackFile::read(path)?;
        let stops_m = track.stops_m();
        if track.centre_line.is_empty() && stops_m.len() < chainage::LEAST_STOPS {
            let expected = format!(
                "expected a centre line, or at least 3 stops, found {}",
                counted(stops_m.len(), "stop", "stops")
            );
            return Err(ReadError::from(FilePlace::of_file(path).refuse("stop", expected)).into());
        }
        Ok(Given { line: track.centre_line, stops_m })
    }

    fn read(
        &self,
        source: &SourceFile,
        group: &Group,
        folder: &Path,
        names: &mut HashSet<String>,
        account: &mut Account,
    ) -> Result<Vec<Staged>, ImportError> {
        let mut cutter = Cutter::new(self.mapping.runs);
        let mut converter = Converter::new(&source.path, &group.columns);
        let before = [ROWS, ROWS_TOO_SHORT].map(|what| account.times(what));
        let mut runs = Vec::new();
        let mut failure = None;
        let mut before_by_run: HashMap<(String, String), (Odometer, Ends)> = HashMap::new();
        let shown = source.path.display();
        source.sheets.lost().for_each(|lost| account.place(OTHER_SHEETS, || format!("{shown}: {lost}")));
        let mut take = |stretch: Stretch, account: &mut Account| -> Result<(), WriteError> {
            let (odometer, ends) = before_by_run.entry((stretch.unit.clone(), stretch.run.clone())).or_default();
            for piece in stretch.pieces(&self.mapping.runs, odometer, account) {
                let name = name_of(&source.path, &piece.run, names);
                if ends.is_early(&piece) {
                    account.place(OVERLAPS, || format!("{shown}: {name}"));
                }
                let run = Staged::new(&piece, name, &source.path, folder);
                runs.push(run.map_err(|error| crate::output::files::failed(folder, error))?);
            }
            Ok(())
        };
        source.rows(&mut |event| {
            match event {
                Event::Row(line, fields) => {
                    account.count(ROWS, 1);
                    let record = converter.record(line, fields, account);
                    let done = record.map(|record| cutter.push(record)).into_iter().flatten();
                    failure = done.map(|stretch| take(stretch, account)).find_map(Result::err);
                }
                Event::Bad(line, message) => {
                    account.place("lines that cannot be read, left out", || {
                        format!("{}:{line}: {message}", source.path.display())
                    });
                }
                Event::LeftOut(line, what, message) => {
                    account.place(what, || format!("{}:{line}: {message}", source.path.display()));
                }
                Event::Ragged(line, fields) => converter.ragged(line, fields, account),
                Event::Sheet(name) => {
                    converter.sheet(&source.path, name);
                    cutter.sheet(name);
                }
            }
            failure.is_none()
        })?;
        failure.map_or(Ok(()), Err)?;
        cutter.end().try_for_each(|stretch| take(stretch, account))?;
        let [rows, too_short] =
            [(ROWS, before[0]), (ROWS_TOO_SHORT, before[1])].map(|(what, n)| account.times(what) - n);
        if 2 * too_short > rows && rows > MIXED_ROWS {
            account.place(MIXED, || format!("{}: {too_short} of {rows} rows", source.path.display()));
        } else if runs.is_empty() && rows > 0 {
            account
                .place(WITHOUT_RUN, || format!("{}: {}", source.path.display(), counted(rows as usize, "row", "rows")));
        }
        Ok(runs)
    }

    fn write(
        &self,
        groups: &[Group],
        staged: &[Staged],
        placed: &Placed,
        account: &Account,
        folder: &Path,
    ) -> Result<(String, Imported), ImportError> {
        let notes = groups.iter().flat_map(Group::said).chain(placed.doubt.clone());
        let mut done = Imported { notes: notes.collect(), ..Imported::default() };
        done.lines.push(format!("chainage: {} ({})", placed.method.name(), placed.why));
        let drivers = staged.iter().any(|run| !run.driver.is_empty());
        let mut index = format!("file,departure_utc,unit,direction{}\n", if drivers { ",driver" } else { "" });
        let (mut runs, mut passed) = (Vec::new(), Vec::new());
        let mut account = account.clone();
        for (run, place) in staged.iter().zip(&placed.places) {
            if let Placing::Out(reason) = place {
                left_out(run, reason, &mut account, &mut done);
                runs.push(entry(run, place, "", (0.0, 0.0)));
                run.forget().map_err(|error| crate::output::files::failed(folder, error))?;
                continue;
            }
            let written = write::run(run, place, placed, folder)?;
            run.forget().map_err(|error| crate::output::files::failed(folder, error))?;
            account.count("rows whose positions are off the centre line, without a location", written.lost);
            moved(place, &mut account);
            let direction = if written.is_up { "up" } else { "down" };
            let departure = run.departure_s.map_or_else(String::new, departure);
            let driver = if drivers { format!(",{}", plain_field(&run.driver)) } else { String::new() };
            index += &format!("{}.csv,{departure},{},{direction}{driver}\n", run.name, plain_field(&run.unit));
            if passed.len() < SHOWN {
                done.lines.push(line_of(run, direction, written.ends_m));
            }
            runs.push(entry(run, place, direction, written.ends_m));
            passed.push(written.passed);
        }
        done.runs = passed.len();
        if passed.is_empty() {
            let none = "expected at least one run on the chainage, found none".to_owned();
            return Err(ImportError::nothing(Vec::new(), done.notes.into_iter().chain([none])));
        }
        if passed.len() > SHOWN {
            done.lines.push(format!("... and {} more runs, all in import.json", passed.len() - SHOWN));
        }
        let track = skeleton::track_toml(&passed, &placed.line);
        let json = json!({
            "chainage": placed.method.name(),
            "runs": runs,
            "counts": account.counts,
            "places": account.places,
            "notes": done.notes,
        });
        let text = |name: &str, text: &str| crate::output::files::text(&folder.join(name), text);
        text("runs.csv", &index)?;
        text("import.toml", &self.repeats(groups, placed)?)?;
        text(write::ACCOUNT, &pretty(&json))?;
        let made_line = !placed.line.is_empty();
        if made_line {
            text("track.toml", &track)?;
        }
        done.warnings = account.warnings().chain(groups.iter().flat_map(|group| group.doubts.clone())).collect();
        done.warnings.extend(placed.doubt.clone());
        done.lines.extend(account.lines());
        Ok((track, done))
    }

    /// `import.toml` of this import.
    fn repeats(&self, groups: &[Group], placed: &Placed) -> Result<String, ImportError> {
        let mapping = Mapping {
            runs: self.mapping.runs,
            chainage: Chainage { method: Some(placed.method), track: self.mapping.chainage.track.clone() },
            sources: groups.iter().map(Group::mapped).collect(),
        };
        let text = toml::to_string(&mapping)
            .map_err(|error| crate::output::files::failed(&self.out, std::io::Error::other(error)))?;
        Ok(format!("# Repeats this import: rundown import --mapping import.toml --out FOLDER\n{text}"))
    }
}

/// From so many rows they may be those of several trains.
const MIXED_ROWS: u64 = 100;
const MIXED: &str = "files of which most rows are in pieces too short for a run (where several trains write into one file, \
                     name the column that tells them apart: unit or run, in [source.columns])";

const OTHER_SHEETS: &str = "sheets with other columns, not read";
const WITHOUT_RUN: &str = "files of which no row is in a run";

fn pretty(json: &Value) -> String {
    format!("{json:#}\n")
}

/// File and number, and the run of a column; letters, digits, `-` and `_`.
fn name_of(path: &Path, run: &str, names: &mut HashSet<String>) -> String {
    let inner = source::unpacked_name(path);
    let stem = inner.file_stem().unwrap_or_default().to_string_lossy();
    let stem = if run.is_empty() { stem.into_owned() } else { format!("{stem}_{run}") };
    let stem: String = stem.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).take(80).collect();
    let free =
        (1_u32..).map(|number| format!("{stem}_{number:02}")).find(|name| !names.contains(name)).unwrap_or_default();
    names.insert(free.clone());
    free
}

/// A field of the index.
fn plain_field(text: &str) -> String {
    text.replace([',', '"', '\n', '\r'], "_")
}

fn departure(seconds: f64) -> String {
    let instant = jiff::Timestamp::from_millisecond((1000.0 * seconds).round() as i64);
    instant.map_or_else(|_| String::new(), |instant| instant.to_string())
}

fn moved(place: &Placing, account: &mut Account) {
    if let Placing::Shift { factor, offset_m, .. } = place {
        account.count(SHIFTED, u64::from(*offset_m != 0.0));
        account.count(INVERTED, u64::from(*factor < 0.0));
        account.count(SCALED, u64::from(factor.abs() != 1.0));
    }
}

fn left_out(run: &Staged, reason: &str, account: &mut Account, done: &mut Imported) {
    account.count("runs that cannot be put on the chainage, left out", 1);
    account.count("rows of runs without a place, left out", run.rows as u64);
    done.left_out += 1;
    done.notes.push(format!("{} is left out: {reason}", run.name));
}

fn line_of(run: &Staged, direction: &str, (from_m, to_m): (f64, f64)) -> String {
    let (km, minutes) = ((to_m - from_m) / 1000.0, run.duration_s / 60.0);
    format!(
        "{}: {direction}, {:.3} to {:.3} km, {km:.1} km in {minutes:.0} min, {} rows; begins because {}",
        run.name,
        from_m / 1000.0,
        to_m / 1000.0,
        run.rows,
        run.reason
    )
}

fn entry(run: &Staged, place: &Placing, direction: &str, ends_m: (f64, f64)) -> Value {
    let placed = match place {
        Placing::Shift { factor, offset_m, how } => {
            json!({"offset_m": offset_m, "inverted": *factor < 0.0, "scale": factor.abs(), "how": how})
        }
        Placing::OnLine { share } => json!({"on_the_line": share}),
        Placing::Out(reason) => json!({"left_out": reason}),
    };
    json!({
        "run": run.name,
        "source": run.source,
        "lines": run.lines,
        "begins_because": run.reason,
        "rows": run.rows,
        "direction": direction,
        "from_m": ends_m.0,
        "to_m": ends_m.1,
        "placed": placed,
    })
}
