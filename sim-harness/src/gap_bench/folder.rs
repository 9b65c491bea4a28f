//! Sets of others: a folder that holds sets as `rundown simulate` writes them, and a key for each in its folder `keys`.

use super::answer;
use super::score::{MOST_RIVALS, is_significant, one_to_one};
use super::table::{reliability, yes};
use rundown_gap::answer::whole::Answer;
use rundown_gap::input::Input;
use rundown_gap::named::Named;
use rundown_gap::verdict::Verdict;
use rundown_pages::numbers::counted;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Column that a set without efforts lacks.
const EFFORT: &str = "effort_n_per_kg";

/// What a set hides: `keys/NAME.json` of the set in the folder `NAME`. Other fields are left alone.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Key {
    /// The effects; none: nothing is hidden.
    pub effects: Vec<Hidden>,
    /// How large they are, in a word.
    #[serde(default)]
    pub magnitude_class: String,
    /// Names that are as good, by the variant `effort` or `no-effort`.
    #[serde(default)]
    pub also_accepted: BTreeMap<String, Vec<String>>,
}

/// A hidden effect.
#[derive(Clone, Debug, Deserialize)]
pub struct Hidden {
    /// Its name in the catalogue, or `unknown`.
    pub name: String,
}

/// A name that was given.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Name {
    /// The name.
    pub name: &'static str,
    /// How sure.
    pub confidence: f64,
    /// Others that the data do not separate from it.
    pub rivals: Vec<&'static str>,
    /// The key has it, or one that is as good, or has one of at most two rivals.
    pub right: bool,
}

/// A set beside its key.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JudgedSet {
    /// Folder of the set.
    pub set: String,
    /// With or without an effort column.
    pub effort: bool,
    /// The verdict in one word; none where it was refused.
    pub verdict: Option<&'static str>,
    /// `magnitude_class` of the key; empty without one.
    pub size: String,
    /// Names of the key.
    pub hidden: Vec<String>,
    /// Names given.
    pub found: Vec<Name>,
    /// What is but a candidate.
    pub candidates: Vec<&'static str>,
    /// Each effect of the key has its name, or one that is as good, and nothing else is named.
    pub named: bool,
    /// The same, where a name may have up to two rivals.
    pub shared: bool,
    /// Probability of the residuals without a gap; none where it was refused.
    pub p_value: Option<f64>,
    /// Share of the gap that is gone on hold-out runs; none where there was nothing to remove.
    pub removed: Option<f64>,
    /// Why it was not investigated.
    pub refused: Option<String>,
    /// There is a key, and no folder of that name: nothing was there to be investigated, or refused.
    pub absent: bool,
}

/// The sets of a folder: name and key.
///
/// # Errors
/// The file that could not be read.
pub fn keys(folder: &Path) -> io::Result<Vec<(String, Key)>> {
    let of = |path: &Path, error: &dyn std::fmt::Display| io::Error::other(format!("{}: {error}", path.display()));
    let keys = folder.join("keys");
    let mut found = Vec::new();
    for entry in fs::read_dir(&keys).map_err(|error| of(&keys, &error))? {
        let path: PathBuf = entry?.path();
        let (Some(name), Some("json")) =
            (path.file_stem().and_then(|name| name.to_str()), path.extension().and_then(|end| end.to_str()))
        else {
            continue;
        };
        let text = fs::read_to_string(&path).map_err(|error| of(&path, &error))?;
        found.push((name.to_owned(), serde_json::from_str(&text).map_err(|error| of(&path, &error))?));
    }
    if found.is_empty() {
        return Err(of(&keys, &"expected a key NAME.json for each set, found none"));
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(found)
}

/// Investigates a set, with its efforts or without, and compares with the key.
///
/// # Errors
/// No folder for a copy could be made.
pub fn judge(folder: &Path, name: &str, key: &Key, effort: bool) -> io::Result<JudgedSet> {
    let set = folder.join(name);
    if !set.is_dir() {
        let lacking = format!("expected the set of keys/{name}.json, found no such folder");
        let judged = JudgedSet::of(name, key, effort, Err(format!("{}: {lacking}", set.display())));
        return Ok(JudgedSet { absent: true, ..judged });
    }
    let answer = if effort {
        investigate(&set)
    } else {
        let copy = tempfile::tempdir()?;
        let copied = without_effort(&set, copy.path()).map_err(|error| format!("{}: {error}", set.display()));
        copied.and_then(|()| investigate(copy.path()))
    };
    Ok(JudgedSet::of(name, key, effort, answer.map(|answer| Answered::of(&answer))))
}

fn investigate(set: &Path) -> Result<Answer, String> {
    let input = Input::of_set(set).map_err(|refusal| refusal.to_string())?;
    answer(input).map_err(|refusal| refusal.to_string())
}

/// Copies a set and leaves the column of the efforts out.
fn without_effort(set: &Path, to: &Path) -> io::Result<()> {
    for file in ["train.toml", "track.toml"] {
        fs::copy(set.join(file), to.join(file))?;
    }
    fs::create_dir_all(to.join("runs"))?;
    for entry in fs::read_dir(set.join("runs"))? {
        let path = entry?.path();
        let Some(name) = path.file_name().filter(|_| path.extension().is_some_and(|end| end == "csv")) else {
            continue;
        };
        let mut reader = csv::Reader::from_path(&path)?;
        let mut writer = csv::Writer::from_path(to.join("runs").join(name))?;
        let kept: Vec<bool> = reader.headers()?.iter().map(|column| column != EFFORT).collect();
        let cells = |row: &csv::StringRecord| -> csv::StringRecord {
            row.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(cell, _)| cell.to_owned()).collect()
        };
        writer.write_record(&cells(reader.headers()?))?;
        for row in reader.records() {
            writer.write_record(&cells(&row?))?;
        }
        writer.flush()?;
    }
    Ok(())
}

/// What an answer says that a key can judge.
#[derive(Default)]
struct Answered {
    verdict: Option<&'static str>,
    /// Names with their confidence and rivals.
    names: Vec<(&'static str, f64, Vec<&'static str>)>,
    candidates: Vec<&'static str>,
    p_value: Option<f64>,
    removed: Option<f64>,
}

impl Answered {
    fn of(answer: &Answer) -> Self {
        let found = &answer.found;
        let rivals = |named: &Named| named.ambiguous_with.iter().map(|kind| kind.name()).collect();
        Self {
            verdict: Some(found.verdict.name()),
            names: found.named.iter().map(|one| (one.effect.name(), one.confidence, rivals(one))).collect(),
            candidates: found.candidates.iter().map(|one| one.effect.name()).collect(),
            p_value: Some(found.p_value),
            removed: found.gap.removed,
        }
    }
}

impl JudgedSet {
    fn of(set: &str, key: &Key, effort: bool, said: Result<Answered, String>) -> Self {
        let variant = if effort { "effort" } else { "no-effort" };
        let accepted = key.also_accepted.get(variant).cloned().unwrap_or_default();
        let hidden: Vec<String> = key.effects.iter().map(|effect| effect.name.clone()).collect();
        let is_key = |name: &str| hidden.iter().chain(&accepted).any(|key| key == name);
        let (said, refused) = match said {
            Ok(said) => (said, None),
            Err(reason) => (Answered::default(), Some(reason)),
        };
        let judged = |(name, confidence, rivals): (&'static str, f64, Vec<&'static str>)| {
            let right = is_key(name) || rivals.len() <= MOST_RIVALS && rivals.iter().any(|rival| is_key(rival));
            Name { name, confidence, rivals, right }
        };
        let found: Vec<Name> = said.names.into_iter().map(judged).collect();
        let keys: Vec<&str> = hidden.iter().map(String::as_str).collect();
        let of = |with_rivals: bool| {
            let fits = |key: &str, name: &&Name| {
                // What is as good is so for the whole set, and so for any effect that is not named itself.
                let as_good = |given: &str| given == key || accepted.iter().any(|name| name == given);
                let few = with_rivals && name.rivals.len() <= MOST_RIVALS;
                as_good(name.name) || few && name.rivals.iter().any(|rival| as_good(rival))
            };
            refused.is_none() && found.len() == hidden.len() && one_to_one(&keys, &found, |name| name.name, fits)
        };
        let (named, shared) = (of(false), of(true));
        Self {
            set: set.to_owned(),
            effort,
            verdict: said.verdict,
            size: key.magnitude_class.clone(),
            named,
            shared,
            hidden,
            p_value: said.p_value,
            removed: said.removed,
            found,
            candidates: said.candidates,
            refused,
            absent: false,
        }
    }

    /// For people, one line.
    pub fn line(&self) -> String {
        let word = match (self.named, self.shared) {
            _ if self.absent => "absent",
            (true, _) => "named",
            (false, true) => "shared",
            (false, false) => "missed",
        };
        let hidden = if self.hidden.is_empty() { "nothing".to_owned() } else { self.hidden.join(" + ") };
        let name = |name: &Name| {
            let rivals = if name.rivals.is_empty() { String::new() } else { format!(" or {}", name.rivals.join(", ")) };
            format!("{}{rivals} ({:.2})", name.name, name.confidence)
        };
        let found: Vec<String> = self.found.iter().map(name).collect();
        let found = if found.is_empty() { "nothing".to_owned() } else { found.join(" + ") };
        let candidates = match &self.candidates[..] {
            [] => String::new(),
            names => format!("; candidates {}", names.join(", ")),
        };
        let efforts = if self.effort { "effort" } else { "no effort" };
        let said = match (self.verdict, self.p_value) {
            (Some(verdict), Some(p_value)) => format!("{found}{candidates}, {verdict}, p {p_value:.3}"),
            _ if self.absent => "no set".to_owned(),
            _ => format!("refused: {}", self.refused.as_deref().unwrap_or_default()),
        };
        format!("{word:<6} {:<8} {efforts:<9} {:<6} {hidden}: {said}\n", self.set, self.size)
    }
}

/// Shares that were named, false names, p-values, and how often a confidence is right.
///
/// Keys without a set are no part of them, and are named above.
pub fn tables(judged: &[JudgedSet]) -> String {
    let (absent, judged): (Vec<&JudgedSet>, Vec<&JudgedSet>) = judged.iter().partition(|one| one.absent);
    let names: Vec<(f64, bool)> =
        judged.iter().flat_map(|one| &one.found).map(|name| (name.confidence, name.right)).collect();
    [without_set(&absent), shares(&judged), reliability(&names)].concat()
}

/// The keys that have no set, in a sentence. Nothing where each has one.
fn without_set(absent: &[&JudgedSet]) -> String {
    let mut names: Vec<&str> = absent.iter().map(|one| one.set.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    if names.is_empty() {
        return String::new();
    }
    format!(
        "{} no set, and no part in what follows: {}.\n\n",
        counted(names.len(), "key has", "keys have"),
        names.join(", ")
    )
}

fn shares(judged: &[&JudgedSet]) -> String {
    let mut text = String::from(
        "### Sets of others\n\nNamed: every effect, or one that the key takes for as good, and no other. Shared: the same, where it may stand among at most two \
        rivals. Wrong: sets with a name that is not the key's.\n\n\
        | effort column | hidden | size | sets | named | named or shared | wrong | nothing named but `candidate` | p-value below 0.05 | refused |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut groups: BTreeMap<(bool, usize, &str), Vec<&JudgedSet>> = BTreeMap::new();
    for &one in judged {
        let size = if one.hidden.is_empty() { "" } else { &one.size };
        groups.entry((!one.effort, one.hidden.len(), size)).or_default().push(one);
    }
    for ((without, hidden, size), sets) in groups {
        let count = |of: &dyn Fn(&JudgedSet) -> bool| sets.iter().filter(|one| of(one)).count();
        text.push_str(&format!(
            "| {} | {hidden} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
            yes(!without),
            if size.is_empty() { "-" } else { size },
            sets.len(),
            count(&|one| one.named),
            count(&|one| one.named || one.shared),
            count(&|one| one.found.iter().any(|name| !name.right)),
            count(&|one| one.verdict == Some(Verdict::Candidate.name())),
            count(&|one| one.p_value.is_some_and(is_significant)),
            count(&|one| one.refused.is_some()),
        ));
    }
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(hidden: &[&str], found: &[(&'static str, f64, bool)]) -> JudgedSet {
        JudgedSet {
            set: "a".to_owned(),
            effort: true,
            verdict: Some(if found.is_empty() { Verdict::Candidate } else { Verdict::Explained }.name()),
            size: "faint".to_owned(),
            hidden: hidden.iter().map(ToString::to_string).collect(),
            found: found
                .iter()
                .map(|&(name, confidence, right)| Name { name, confidence, rivals: Vec::new(), right })
                .collect(),
            candidates: Vec::new(),
            named: false,
            shared: false,
            p_value: Some(0.01),
            removed: None,
            refused: None,
            absent: false,
        }
    }

    #[test]
    fn a_key_without_a_set_is_no_refused_one() {
        let folder = tempfile::tempdir().unwrap();
        let absent = judge(folder.path(), "lost", &Key::default(), true).unwrap();
        assert!(absent.absent && absent.line().starts_with("absent lost"), "{}", absent.line());
        let text = tables(&[absent.clone(), absent, judged(&["mass_error"], &[])]);
        assert!(text.starts_with("1 key has no set, and no part in what follows: lost.\n"), "{text}");
        assert!(
            !text.contains("| yes | 0 |") && text.contains("| yes | 1 | faint | 1 | 0 | 0 | 0 | 1 | 1 | 0 |"),
            "{text}"
        );
    }

    #[test]
    fn names_are_counted_by_confidence_and_sets_by_what_they_hide() {
        let sets = [
            judged(&[], &[("low_adhesion", 0.95, false)]),
            judged(&["mass_error"], &[("mass_error", 0.96, true)]),
            judged(&["mass_error"], &[]),
        ];
        let text = tables(&sets);
        assert!(text.contains("| yes | 0 | - | 1 | 0 | 0 | 1 | 0 | 1 | 0 |"), "{text}");
        assert!(text.contains("| yes | 1 | faint | 2 | 0 | 0 | 0 | 1 | 2 | 0 |"), "{text}");
        assert!(text.contains("| 0.9 to 0.99 | 2 | 0.95 | 0.50 (1/2) |"), "{text}");
    }

    #[test]
    fn of_two_effects_each_needs_a_name_of_its_own() {
        let is = |key: &str, name: &&Name| name.name == key || name.name == "alias";
        let of = |names: &[&'static str]| judged(&[], &names.iter().map(|n| (*n, 1.0, true)).collect::<Vec<_>>()).found;
        let matched = |names: &[&'static str]| one_to_one(&["a", "b"], &of(names), |name| name.name, is);
        assert!(matched(&["b", "a"]));
        assert!(matched(&["alias", "a"]), "the alias stands for b");
        assert!(!matched(&["a", "c"]));
        assert!(!matched(&["a", "a"]));
    }

    #[test]
    fn a_refused_set_is_not_one_in_which_nothing_was_rightly_found() {
        let refused = JudgedSet::of("a", &Key::default(), true, Err("runs: nothing".to_owned()));
        assert!(!refused.named && !refused.shared);
        assert!(refused.line().contains("nothing: refused: runs: nothing"), "{}", refused.line());
        assert!(tables(&[refused]).contains("| yes | 0 | - | 1 | 0 | 0 | 0 | 0 | 0 | 1 |"));
    }

    #[test]
    fn a_set_is_named_by_its_key_shared_by_few_rivals_and_missed_by_what_is_too_much() {
        let hides = |names: &[&str], accepted: &[&str]| Key {
            effects: names.iter().map(|name| Hidden { name: (*name).to_owned() }).collect(),
            also_accepted: BTreeMap::from([("effort".to_owned(), accepted.iter().map(ToString::to_string).collect())]),
            ..Key::default()
        };
        let of = |key: &Key, names: &[(&'static str, &[&'static str])], effort| {
            let names = names.iter().map(|(name, rivals)| (*name, 0.9, rivals.to_vec())).collect();
            let judged = JudgedSet::of("a", key, effort, Ok(Answered { names, ..Answered::default() }));
            (judged.named, judged.shared, judged.found.iter().map(|name| name.right).collect::<Vec<_>>())
        };
        let wind = hides(&["steady_wind"], &["unknown"]);
        assert_eq!(of(&wind, &[("steady_wind", &[])], true), (true, true, vec![true]));
        assert_eq!(of(&wind, &[("unknown", &[])], true), (true, true, vec![true]));
        assert_eq!(of(&wind, &[("unknown", &[])], false), (false, false, vec![false]));
        let rivals: [&'static str; 3] = ["steady_wind", "tunnel_drag", "warm_up"];
        assert_eq!(of(&wind, &[("davis_error", &rivals[..2])], true), (false, true, vec![true]));
        assert_eq!(of(&wind, &[("davis_error", &rivals)], true), (false, false, vec![false]));
        let two: [(&'static str, &[&'static str]); 2] = [("steady_wind", &[]), ("davis_error", &[])];
        assert_eq!(of(&wind, &two, true), (false, false, vec![true, false]));
        assert_eq!(of(&hides(&[], &[]), &[], true), (true, true, vec![]));
    }

    #[test]
    fn the_column_of_the_efforts_is_left_out_and_nothing_else() {
        let (from, to) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        fs::create_dir(from.path().join("runs")).unwrap();
        for file in ["train.toml", "track.toml"] {
            fs::write(from.path().join(file), file).unwrap();
        }
        let log = "time_s,location_m,effort_n_per_kg,speed_kmh\n0,1.5,0.2,7\n10,,,8\n";
        fs::write(from.path().join("runs/a.csv"), log).unwrap();
        fs::write(from.path().join("runs/runs.csv"), "file,direction\na.csv,up\n").unwrap();
        without_effort(from.path(), to.path()).unwrap();
        let read = |file: &str| fs::read_to_string(to.path().join(file)).unwrap();
        assert_eq!(read("runs/a.csv"), "time_s,location_m,speed_kmh\n0,1.5,7\n10,,8\n");
        assert_eq!(read("runs/runs.csv"), "file,direction\na.csv,up\n");
        assert_eq!(read("track.toml"), "track.toml");
    }
}
