//! The train as its runs have shown it: the description with what was learned in the place of what was stated.
//!
//! In: a replay, its folder, or the recording of a board, and the train file it was made with. Out: a [`LearnedTrain`],
//! which is a train file again, and which of its values are learned.
//!
//! | value | from |
//! |---|---|
//! | r0, r1, r2 | the vehicle after the unit's last run, where the board would publish it as learned |
//! | largest tractive effort, largest power | the described capability, or what drivers used where that is more: a [`Limit`] |
//! | all else | the description: mass, rotating mass factor, length, brake; it must be that with which the results were made |
//!
//! What drivers used is their habit: the median over the runs of the largest effort at low speed, and of the largest
//! power. It is no bound of the train: what they did not demand was not observed. Fewer than [`LEAST_RUNS`] runs show
//! no habit. Runs that the replay set aside count nowhere.

use rundown::model::resistance::Davis;
use rundown::tick::foresight::ORDINARY_SCATTER;
use rundown_files::folder::Provenance;
use rundown_files::refusal::{Place, ReadError};
use rundown_files::statistics::mean_median;
use rundown_files::train_file::TrainFile;
use rundown_wire::Learned;
use serde::Deserialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Runs that must have shown a limit before it counts as a habit.
pub const LEAST_RUNS: usize = 3;

/// A limit of the train, and how much of it drivers used; N or W.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// As the train file states it.
    pub described: f64,
    /// Median over the runs.
    pub used: Option<Used>,
}

/// What drivers used of a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Used {
    pub median: f64,
    pub runs: usize,
}

impl Limit {
    /// What the train can do: as described, or more where drivers had more.
    pub fn capability(&self) -> f64 {
        self.used.map_or(self.described, |used| used.median.max(self.described))
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct LearnedTrain {
    pub train: TrainFile,
    pub davis_sd: [f64; 3],
    /// Runs from which the resistance was learned.
    pub runs: usize,
    /// Speeds at which it was learned, km/h.
    pub learned_kmh: Option<[f64; 2]>,
    /// Largest tractive effort, N.
    pub effort: Limit,
    /// Largest power, W.
    pub power: Limit,
    /// What a person should know of where it comes from.
    pub notes: Vec<String>,
}

#[derive(Debug, Deserialize)]
struct ReplayJson {
    train: String,
    /// The train file; a version before this field did not write it.
    #[serde(default)]
    described: Option<Value>,
    carried: bool,
    /// A version before this field was read wrote it, too.
    #[serde(default)]
    mode: String,
    runs: Vec<Run>,
}

#[derive(Debug, Deserialize)]
struct Run {
    unit: String,
    used: bool,
    learning_steps: usize,
    learned_kmh: Option<[f64; 2]>,
    vehicle: LearnedVehicle,
    foresight: Foresight,
    features: Features,
}

#[derive(Debug, Deserialize)]
struct Foresight {
    published: String,
    #[serde(default)]
    coast_scatter: f64,
}

#[derive(Debug, Deserialize)]
struct LearnedVehicle {
    r0: f64,
    r1: f64,
    r2: f64,
    sd_r0: f64,
    sd_r1: f64,
    sd_r2: f64,
}

#[derive(Debug, Deserialize)]
struct Features {
    max_effort_mean_n_per_kg: Option<f64>,
    power_max_w_per_kg: Option<f64>,
}

/// What was learned, by a replay or a board.
#[derive(Clone, Debug)]
pub enum Results {
    /// Folder with the results of a replay, or the recording of a board.
    At(PathBuf),
    /// A replay that is in memory.
    Replayed {
        /// `replay.json`.
        json: String,
        /// The train as it was described.
        train: Box<TrainFile>,
        /// What it was made from.
        provenance: Provenance,
    },
}

impl Results {
    /// For a folder with what is made of these and the description of the train.
    pub(crate) fn provenance(&self, train: &Path) -> Provenance {
        match self {
            Self::At(path) => Provenance::begin(&[file_of(path), train.to_owned()]),
            Self::Replayed { provenance, .. } => Provenance::begin(&[train.to_owned()]).and(provenance),
        }
    }
}

/// Where the results are: `replay.json` of a folder, or a recording.
fn file_of(results: &Path) -> PathBuf {
    if results.is_file() { results.to_owned() } else { results.join("replay.json") }
}

/// Reads the train, and what was learned of it; `unit` where the replay has several.
///
/// # Errors
/// [`ReadError`] of the train file, or of the results.
pub fn read(results: &Results, train: &Path, unit: Option<&str>) -> Result<LearnedTrain, ReadError> {
    let (described, _) = TrainFile::read(train)?;
    match results {
        Results::At(path) => at(path, described, unit),
        Results::Replayed { train, .. } if **train != described => {
            let message = "expected the train that was replayed, found another one in the train file";
            Err(Place::of_file("replay").refuse("train", message).into())
        }
        Results::Replayed { json, .. } => of_json(Path::new("replay"), json, described, unit),
    }
}

/// Of a folder, or of a board's recording.
fn at(results: &Path, described: TrainFile, unit: Option<&str>) -> Result<LearnedTrain, ReadError> {
    let path = file_of(results);
    if results.is_file() && !results.ends_with("replay.json") {
        return of_board(path, described, unit);
    }
    if !path.exists() {
        let expected = "expected the folder that `rundown replay --out` makes, found no such file";
        return Err(Place::of_file(path).refuse("", expected).into());
    }
    let text = std::fs::read_to_string(&path).map_err(|source| ReadError::Io { path: path.clone(), source })?;
    log::info!("read {}", path.display());
    of_json(&path, &text, described, unit)
}

/// Of the text of a `replay.json`; `path` is for the messages.
fn of_json(path: &Path, text: &str, described: TrainFile, unit: Option<&str>) -> Result<LearnedTrain, ReadError> {
    let results: ReplayJson = serde_json::from_str(text).map_err(|error| {
        let place = Place { file: path.to_owned(), line: Some(error.line()), column: Some(error.column()) };
        place.refuse("", format!("expected the results of `rundown replay`, found {error}"))
    })?;
    let wrong = |(field, message): Wrong| ReadError::from(Place::of_file(path).refuse(field, message));
    let replayed = results.described.clone();
    let unsaid = "it does not say which values the train had, of which it knows the name; the train file is believed";
    let mut learned = learn(described.clone(), results, unit).map_err(wrong)?;
    match replayed {
        Some(replayed) => is_same_train(&described, &replayed).map_err(wrong)?,
        None => learned.notes.push(format!("{}: {unsaid}", path.display())),
    }
    Ok(learned)
}

/// A train of the same name with other values would make other forces of what was learned per mass.
fn is_same_train(described: &TrainFile, replayed: &Value) -> Result<(), Wrong> {
    let failed = |error: serde_json::Error| ("described", error.to_string());
    // Read back as the results were: the last bit of a number may move on that way.
    let text = serde_json::to_string(described).map_err(failed)?;
    let expected: Value = serde_json::from_str(&text).map_err(failed)?;
    let differing = differing("", &expected, replayed).join("; ");
    let expected = "expected the train of the train file, found another one";
    if differing.is_empty() { Ok(()) } else { Err(("described", format!("{expected}: {differing}"))) }
}

/// `davis.r0 is 0.0074 there and 0.0070 in the train file`.
fn differing(name: &str, here: &Value, there: &Value) -> Vec<String> {
    let (Value::Object(mine), Value::Object(theirs)) = (here, there) else {
        let said = |value: &Value| if value.is_null() { "missing".to_owned() } else { value.to_string() };
        let text = || format!("{name} is {} there and {} in the train file", said(there), said(here));
        return if here == there { Vec::new() } else { vec![text()] };
    };
    let keys = mine.keys().chain(theirs.keys().filter(|key| !mine.contains_key(*key)));
    let of = |key: &String| {
        let dot = if name.is_empty() { "" } else { "." };
        let value = |of: &serde_json::Map<String, Value>| of.get(key).cloned().unwrap_or_default();
        differing(&format!("{name}{dot}{key}"), &value(mine), &value(theirs))
    };
    keys.flat_map(of).collect()
}

#[cfg(not(feature = "link"))]
fn of_board(path: PathBuf, _: TrainFile, _: Option<&str>) -> Result<LearnedTrain, ReadError> {
    let expected =
        "expected the folder of a replay, found a file; recordings of a board are read by the command `rundown export`";
    Err(Place::of_file(path).refuse("", expected).into())
}

#[cfg(feature = "link")]
fn of_board(path: PathBuf, described: TrainFile, unit: Option<&str>) -> Result<LearnedTrain, ReadError> {
    let crate::recorded_board::BoardRecording { ends, train, missing, missing_runs, cut, .. } =
        crate::recorded_board::read(&path)?;
    let mut notes = Vec::new();
    let is_described = |sent: TrainFile| {
        TrainFile { name: described.name.clone(), effect: described.effect.clone(), ..sent } == described
    };
    match train.map(is_described) {
        Some(true) => (),
        Some(false) => {
            let message = "expected the train that was described to the board, found another one in the train file";
            return Err(Place::of_file(path).refuse("train", message).into());
        }
        None => notes.push(format!(
            "{}: it does not say which train was described to the board; the train file is believed",
            path.display()
        )),
    }
    if let Some(cut) = cut {
        notes.push(format!(
            "{}: it is cut off, the last {cut} were left out; the last run that ended counts",
            path.display()
        ));
    }
    if missing > 0 {
        notes.push(format!(
            "{}: {} lost, damaged or unknown; the last run that ended counts",
            path.display(),
            rundown_pages::numbers::counted(missing as usize, "message is", "messages are")
        ));
    }
    if !missing_runs.is_empty() {
        let gap =
            |[first, last]: &[u32; 2]| if first == last { first.to_string() } else { format!("{first} to {last}") };
        let gaps: Vec<String> = missing_runs.iter().map(gap).collect();
        let word = if missing_runs.len() == 1 && missing_runs[0][0] == missing_runs[0][1] { "run" } else { "runs" };
        notes.push(format!(
            "{}: without the end of the board's {word} {}: what these taught counts, and of their frames nobody knows how many were lost",
            path.display(),
            gaps.join(", ")
        ));
    }
    let runs = ends.iter().map(Run::of_board).collect();
    let results =
        ReplayJson { train: described.name.clone(), described: None, carried: true, mode: String::new(), runs };
    let learned = learn(described, results, unit);
    let learned = learned.map_err(|(field, message)| Place::of_file(path).refuse(field, message))?;
    Ok(LearnedTrain { notes, ..learned })
}

#[cfg(feature = "link")]
impl Run {
    /// A board has one unit, and uses each of its runs. At which speeds it learned it does not say.
    fn of_board(end: &crate::recorded_board::RunEnd) -> Self {
        let [r0, r1, r2] = end.summary.vehicle_davis.map(|value| f64::from(value.value));
        let [sd_r0, sd_r1, sd_r2] = end.summary.vehicle_davis.map(|value| f64::from(value.sd));
        let effort = end.features.as_ref().and_then(|features| features.max_effort.as_ref());
        let power = end.features.as_ref().and_then(|features| features.max_power_w_per_kg);
        Self {
            unit: String::new(),
            used: true,
            learning_steps: usize::from(end.summary.learned_s > 0.0),
            learned_kmh: None,
            vehicle: LearnedVehicle { r0, r1, r2, sd_r0, sd_r1, sd_r2 },
            foresight: Foresight { published: end.published.as_str().to_owned(), coast_scatter: 1.0 },
            features: Features {
                max_effort_mean_n_per_kg: effort
                    .filter(|line| line.effort_n_per_kg.count > 0)
                    .map(|line| f64::from(line.effort_n_per_kg.mean)),
                power_max_w_per_kg: power.map(f64::from),
            },
        }
    }
}

/// A field of the results, and what is wrong with it.
type Wrong = (&'static str, String);

fn learn(described: TrainFile, results: ReplayJson, unit: Option<&str>) -> Result<LearnedTrain, Wrong> {
    if results.train != described.name {
        let (found, expected) = (results.train, described.name);
        return Err(("train", format!("expected `{expected}`, as in the train file, found `{found}`")));
    }
    if !results.carried {
        let expected = "expected a vehicle that is carried from run to run";
        return Err(("carried", format!("{expected}, found a replay made with --no-carry")));
    }
    if results.mode == "paper" {
        let expected = "expected `gated` or `measured`, which learn the resistance";
        let found = "found `paper`, whose estimate follows no true resistance and whose interval is no measure of it";
        return Err(("mode", format!("{expected}, {found}")));
    }
    let mut units: Vec<&String> = results.runs.iter().map(|run| &run.unit).collect();
    units.sort();
    units.dedup();
    let chosen = match (unit, units.as_slice()) {
        (None, [only]) => only.as_str(),
        (Some(named), _) if units.iter().any(|unit| *unit == named) => named,
        _ => {
            let found = unit.map_or_else(|| "none named".to_owned(), |unit| format!("{unit:?}"));
            return Err(("unit", format!("expected one of {units:?}, found {found}")));
        }
    };
    let all = results.runs.iter().filter(|run| run.unit == chosen);
    let runs: Vec<&Run> = all.clone().filter(|run| run.used).collect();
    let Some(last) = runs.last() else {
        let set_aside = all.count();
        let message = format!("expected at least one that was used, found none; {set_aside} were set aside");
        return Err(("runs", message));
    };
    check_published(last)?;
    let LearnedVehicle { r0, r1, r2, .. } = last.vehicle;
    let rotating_mass_kg = described.rotating_mass_factor * described.mass_kg;
    let limit = |described: f64, value: fn(&Features) -> Option<f64>| {
        let values: Vec<f64> = runs.iter().filter_map(|run| value(&run.features)).collect();
        let runs = values.len();
        let median = mean_median(values).filter(|_| runs >= LEAST_RUNS);
        let used = median.map(|median| Used { median: rotating_mass_kg * median, runs });
        Limit { described, used }
    };
    let effort = limit(described.max_tractive_effort_n, |f| f.max_effort_mean_n_per_kg);
    let power = limit(described.max_power_w, |f| f.power_max_w_per_kg);
    let (max_tractive_effort_n, max_power_w) = (effort.capability(), power.capability());
    let train = TrainFile { davis: Davis { r0, r1, r2 }, max_tractive_effort_n, max_power_w, ..described };
    let speeds_kmh = runs.iter().filter_map(|run| run.learned_kmh);
    train.train().map_err(|error| ("", format!("what was learned is no train: {error}")))?;
    Ok(LearnedTrain {
        train,
        davis_sd: [last.vehicle.sd_r0, last.vehicle.sd_r1, last.vehicle.sd_r2],
        runs: runs.iter().filter(|run| run.learning_steps > 0).count(),
        learned_kmh: speeds_kmh.reduce(|all, one| [all[0].min(one[0]), all[1].max(one[1])]),
        effort,
        power,
        notes: Vec::new(),
    })
}

/// Only what the board would publish as learned is learned.
fn check_published(last: &Run) -> Result<(), Wrong> {
    let Run { unit, foresight: Foresight { published, coast_scatter }, .. } = last;
    if published == Learned::Learned.as_str() {
        return Ok(());
    }
    let advice = if *coast_scatter > ORDINARY_SCATTER {
        &format!(
            "its coasts scatter {coast_scatter:.1} times as much as expected: the notes of the replay say why that may be"
        )
    } else if published == Learned::NotYet.as_str() {
        "replay more runs with coasting, where the notes of the replay do not say otherwise"
    } else {
        "the notes of the replay say what to look at"
    };
    let message = format!(
        "expected a resistance that would be published as learned, \
         found `{published}` after the last run of unit {unit:?}; {advice}"
    );
    Err(("runs", message))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRAIN: &str = "name = \"unit\"\nmass_kg = 364000\nrotating_mass_factor = 1.06\nlength_m = 162\n\
        max_tractive_effort_n = 192920.0\nmax_power_w = 2036377.8\nmax_brake_mps2 = 0.66\n\
        [davis]\nr0 = 0.00738\nr1 = 1.6e-4\nr2 = 2.8e-5\n";

    fn run(unit: &str, r0: f64, effort: &str, power: &str) -> String {
        let to_kmh = 1e4 * r0;
        format!(
            "{{\"unit\":\"{unit}\",\"used\":true,\"learning_steps\":9,\"learned_kmh\":[60.0,{to_kmh}],\"vehicle\":{{\"r0\":{r0},\"r1\":1.5e-4,\"r2\":2.7e-5,\"sd_r0\":1e-4,\"sd_r1\":1e-5,\"sd_r2\":1e-7}},\
            \"foresight\":{{\"published\":\"learned\"}},\"features\":{{\"max_effort_mean_n_per_kg\":{effort},\"power_max_w_per_kg\":{power}}}}}"
        )
    }

    fn learned(runs: &[String], unit: Option<&str>) -> Result<LearnedTrain, Wrong> {
        let (train, _) = TrainFile::parse("t.toml".as_ref(), TRAIN).unwrap();
        let text = format!("{{\"train\":\"unit\",\"carried\":true,\"runs\":[{}]}}", runs.join(","));
        learn(train, serde_json::from_str(&text).unwrap(), unit)
    }

    #[test]
    fn what_the_paper_mode_says_is_none_of_the_vehicle() {
        let (train, _) = TrainFile::parse("t.toml".as_ref(), TRAIN).unwrap();
        let run = run("7", 0.0070, "0.4", "5.0");
        let of = |mode: &str| {
            let text = format!("{{\"train\":\"unit\",\"carried\":true,\"mode\":\"{mode}\",\"runs\":[{run}]}}");
            learn(train.clone(), serde_json::from_str(&text).unwrap(), None)
        };
        assert!(of("gated").is_ok());
        let (field, reason) = of("paper").unwrap_err();
        assert!(field == "mode" && reason.contains("found `paper`"), "{reason}");
    }

    #[test]
    fn the_last_run_has_the_resistance() {
        let runs = [run("7", 0.0070, "0.4", "5.0"), run("7", 0.0071, "0.6", "null"), run("7", 0.0072, "0.5", "5.2")];
        let found = learned(&runs, None).unwrap();
        assert_eq!(found.train.davis.r0, 0.0072);
        assert_eq!(found.learned_kmh, Some([60.0, 72.0]));
        assert_eq!((found.runs, found.davis_sd[0]), (3, 1e-4));
        // Two runs have shown a power.
        assert_eq!(found.power, Limit { described: 2_036_377.8, used: None });
        assert_eq!(found.train.max_power_w, 2_036_377.8);
    }

    #[test]
    fn drivers_who_use_a_part_of_the_lever_take_nothing_from_the_train() {
        let used = |effort: &str| learned(&["0.1", effort, "9.0"].map(|effort| run("7", 0.0070, effort, "null")), None);
        let part = used("0.4").unwrap();
        assert_eq!(part.train.max_tractive_effort_n, 192_920.0);
        assert_eq!(part.effort.used.map(|used| used.runs), Some(3));
        assert!((part.effort.used.unwrap().median - 0.4 * 385_840.0).abs() < 1e-6);
        let more = used("0.6").unwrap();
        assert!((more.train.max_tractive_effort_n - 0.6 * 385_840.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_not_published_is_no_train() {
        let worse = run("7", 0.0070, "null", "null").replace("\"learned\"", "\"predicts_worse\"");
        assert!(learned(std::slice::from_ref(&worse), None).unwrap_err().1.contains("found `predicts_worse`"));
        assert!(learned(&[worse, run("7", 0.0070, "null", "null")], None).is_ok());
    }

    #[test]
    fn what_is_not_yet_learned_is_no_learned_train() {
        let not_yet = run("7", 0.0070, "null", "null").replace("\"learned\"", "\"not_yet\"");
        let (_, error) = learned(&[not_yet], None).unwrap_err();
        assert!(error.contains("found `not_yet`") && error.contains("replay more runs with coasting"), "{error}");
    }

    #[test]
    fn coasts_that_scatter_are_the_reason() {
        let scattered = run("7", 0.0070, "null", "null").replace("\"learned\"", "\"not_yet\",\"coast_scatter\":3.2");
        let (_, error) = learned(&[scattered], None).unwrap_err();
        assert!(error.contains("its coasts scatter 3.2 times as much as expected"), "{error}");
    }

    #[test]
    fn runs_that_were_set_aside_or_taught_nothing_do_not_count() {
        let good = |effort: &str| run("7", 0.0070, effort, "null");
        let aside = good("9.0").replace("\"used\":true", "\"used\":false");
        let idle = good("0.6").replace("\"learning_steps\":9", "\"learning_steps\":0");
        let found = learned(&[good("0.5"), idle, good("0.7"), aside.clone(), aside.clone()], None).unwrap();
        assert_eq!((found.runs, found.effort.used.map(|used| used.runs)), (2, Some(3)));
        assert!((found.effort.used.unwrap().median - 0.6 * 385_840.0).abs() < 1e-6);
        let error = learned(&[aside], None).unwrap_err();
        assert_eq!(error, ("runs", "expected at least one that was used, found none; 1 were set aside".to_owned()));
    }

    #[test]
    fn a_unit_is_asked_for_where_there_are_several() {
        let runs = [run("7", 0.0070, "null", "null"), run("8", 0.0080, "null", "null")];
        let error = learned(&runs, None).unwrap_err();
        assert_eq!(error, ("unit", "expected one of [\"7\", \"8\"], found none named".to_owned()));
        assert_eq!(learned(&runs, Some("8")).unwrap().train.davis.r0, 0.0080);
        assert!(learned(&runs, Some("9")).is_err());
        assert!(learned(&[], None).is_err());
    }

    #[test]
    fn what_no_train_has_is_refused() {
        let (_, error) = learned(&[run("7", -0.1, "null", "null")], None).unwrap_err();
        assert_eq!(error, "what was learned is no train: davis.r0: expected 0.00001 to 1, found -0.1");
    }
}
