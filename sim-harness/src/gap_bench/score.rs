//! One investigation beside its key.

use crate::gap_bench::Outcome;
use crate::gap_bench::draw::Set;
use crate::gap_bench::nuisance::{DrawnNuisance, LENGTH_IN_RUNS};
use rundown::model::effects::{DavisError, Effect};
use rundown_check::figure::{Figure, HALF_95};
use rundown_files::statistics::mean;
use rundown_gap::answer::whole::Answer;
use rundown_gap::candidates;
use rundown_gap::named::Named;
use rundown_gap::readings::nuisances::Nuisance;
use rundown_gap::verdict::Verdict;
use rundown_truth::effects::Effect as Hidden;
use rundown_truth::train::{DavisTruth, TrainTruth};
use serde::Serialize;
use serde_json::Value;

/// A name counts as shared with rivals if there are at most so many of them.
pub(super) const MOST_RIVALS: usize = 2;

/// What an investigation is worth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// The verdict in one word; none where the set was refused.
    pub verdict: Option<&'static str>,
    /// Why it was.
    pub refused: Option<String>,
    /// Runs that were left out, though nothing is wrong with the logs of a drawn set.
    pub left_out: usize,
    /// Names of the key, sorted; `unknown` for what is in no catalogue.
    pub key: Vec<&'static str>,
    /// Names found, sorted.
    pub found: Vec<&'static str>,
    /// With what confidence each name was given, and whether it is right: the key has it, or one of its few rivals.
    pub sure: Vec<(f64, bool)>,
    /// What is but a candidate.
    pub candidates: Vec<&'static str>,
    /// With all rivals that were named beside them.
    pub rivals: Vec<&'static str>,
    /// All names of the key, and no other; a refused set has none.
    pub exact: bool,
    /// The same, where a name of the key may stand among at most two rivals of a found one.
    pub shared: bool,
    /// What is unknown was called so, along the right coordinate. `None` where nothing of the key is unknown.
    pub coordinate: Option<bool>,
    /// Relative error of each named effect's size.
    pub size_errors: Vec<f64>,
    /// Intersection over union of each named section.
    pub places: Vec<f64>,
    /// Reported 95 % intervals, and how many of them hold the truth.
    pub intervals: [usize; 2],
    /// Parameters whose interval does not hold the truth, with both.
    pub outside: Vec<String>,
    /// Share of the removable gap that is gone on the hold-out runs; `None` where there was none.
    pub removed: Option<f64>,
    /// The gap on the hold-out runs before and after, and its floor, m/s; none where the set was refused.
    pub gap_mps: Option<[f64; 3]>,
    /// Probability of the residuals without a gap; none where the set was refused.
    pub p_value: Option<f64>,
    /// Nuisances that were told: name, value, standard deviation.
    pub told: Vec<(&'static str, f64, f64)>,
    /// The nuisance that there is, as it should be told, with its value.
    pub nuisance: Option<(&'static str, f64)>,
}

impl Score {
    /// Something is there, and nothing of it was named.
    pub fn is_candidate(&self) -> bool {
        self.verdict == Some(Verdict::Candidate.name())
    }

    /// The residuals say that something is there.
    pub fn is_significant(&self) -> bool {
        self.p_value.is_some_and(is_significant)
    }

    /// Compares.
    pub fn of(set: &Set, outcome: &Outcome) -> Self {
        let answer = outcome.as_ref().ok();
        let found = answer.map(|answer| &answer.found);
        let hidden = &set.scenario.effects;
        let mut key: Vec<&'static str> = hidden.iter().map(key_name).collect();
        key.sort_unstable();
        let named: &[Named] = found.map_or(&[], |f| &f.named);
        let mut names: Vec<&'static str> = named.iter().map(|n| n.effect.name()).collect();
        names.sort_unstable();
        let mut score = Self {
            verdict: found.map(|f| f.verdict.name()),
            refused: outcome.as_ref().err().map(ToString::to_string),
            left_out: answer.map_or(0, |answer| set.request.runs.saturating_sub(answer.input.runs.len())),
            exact: answer.is_some() && names == key,
            shared: found.is_some_and(|found| {
                let named_as_reading = |key: &&'static str| found.nuisances.iter().any(|one| is_reading(key, one));
                let left: Vec<&'static str> = key.iter().copied().filter(|key| !named_as_reading(key)).collect();
                let is_of = |key: &[&'static str]| {
                    names.len() == key.len() && one_to_one(key, named, |n| n.effect.name(), is_rival)
                };
                is_of(&key) || is_of(&left)
            }),
            coordinate: None,
            size_errors: Vec::new(),
            places: Vec::new(),
            intervals: [0, 0],
            outside: Vec::new(),
            removed: found.and_then(|f| f.gap.removed),
            gap_mps: found.map(|f| [f.gap.before, f.gap.after, f.gap.floor]),
            p_value: found.map(|f| f.p_value),
            told: answer.map_or_else(Vec::new, |answer| told(set, answer)),
            nuisance: set
                .request
                .nuisance
                .and_then(|nuisance| nuisance.reported_as().zip(set.drawn.as_ref().and_then(DrawnNuisance::told))),
            sure: named.iter().map(|n| (n.confidence, is_right(&key, n))).collect(),
            candidates: found.map_or_else(Vec::new, |f| f.candidates.iter().map(|n| n.effect.name()).collect()),
            rivals: named.iter().flat_map(|n| n.ambiguous_with.iter().map(|kind| kind.name())).collect(),
            found: names,
            key,
        };
        for effect in hidden {
            if let Some(coordinate) = effect.unknown_coordinate() {
                let right = |n: &Named| n.effect.name() == "unknown" && n.coordinate() == Some(coordinate);
                score.coordinate = Some(named.iter().any(right));
            } else if let Some(one) = named.iter().find(|n| n.effect.name() == effect.name()) {
                score.compare(effect, one, &set.scenario.train);
            }
        }
        score
    }

    fn compare(&mut self, hidden: &Hidden, found: &Named, train: &TrainTruth) {
        let truth = parameters(hidden);
        let json = found.json();
        for (name, low, high) in &found.intervals {
            if let Some(value) = truth[*name].as_f64() {
                self.intervals[0] += 1;
                if *low <= value && value <= *high {
                    self.intervals[1] += 1;
                } else {
                    self.outside.push(format!("{name} {value:.4e} in {low:.4e} to {high:.4e}"));
                }
            }
        }
        let section = |value: &Value| Some([value["from_m"].as_f64()?, value["to_m"].as_f64()?]);
        if let (Some(a), Some(b)) = (section(&truth), section(&json)) {
            self.places.push(overlap(a, b));
        }
        if let (Hidden::DavisError(_), Effect::DavisError(davis)) = (hidden, &found.effect) {
            self.size_errors.extend(davis_error(&truth, davis));
        } else if let Some((name, neutral)) = candidates::of_effect(&found.effect).main_parameter(train.length_m)
            && let (Some(a), Some(b)) = (truth[name].as_f64(), json["parameters"][name].as_f64())
        {
            self.size_errors.push(((b - a) / (a - neutral)).abs());
        }
    }
}

fn told(set: &Set, answer: &Answer) -> Vec<(&'static str, f64, f64)> {
    let told = answer.found.nuisances.iter().filter(|nuisance| nuisance.told);
    let diagnosed = set.request.nuisance.and_then(|nuisance| {
        let kind = nuisance.diagnosed_as()?;
        let check = answer.input.check.as_ref()?;
        let of_runs = check.runs.iter().map(|run| &run.findings);
        let all = of_runs.chain(check.recorders.iter().map(|recorder| &recorder.findings)).flatten();
        let figures: Vec<Figure> = all.filter(|found| found.kind == kind).map(|found| found.figure).collect();
        let sd = (mean(figures.iter().map(|figure| figure.sd * figure.sd))? / figures.len() as f64).sqrt();
        Some((nuisance.reported_as()?, mean(figures.iter().map(|figure| figure.value))?, sd))
    });
    let lengths = answer.found.named.iter().filter_map(length_in_runs);
    told.map(|nuisance| (nuisance.kind.name(), nuisance.value, nuisance.sd)).chain(diagnosed).chain(lengths).collect()
}

/// The length of the train in some of the runs: a nuisance that has a name.
fn length_in_runs(named: &Named) -> Option<(&'static str, f64, f64)> {
    let Effect::TrainLengthError(length) = &named.effect else { return None };
    let sd = named.intervals.first().map_or(f64::NAN, |(_, low, high)| (high - low) / (2.0 * HALF_95));
    (!named.runs.is_empty()).then_some((LENGTH_IN_RUNS, length.true_length_m, sd))
}

fn key_name(effect: &Hidden) -> &'static str {
    match effect.unknown_coordinate() {
        Some(_) => "unknown",
        None => effect.name(),
    }
}

fn is_right(key: &[&str], named: &Named) -> bool {
    key.contains(&named.effect.name()) || key.iter().any(|key| is_rival(key, &named))
}

/// A name of the key stands among the few rivals of a found one.
fn is_rival(key: &str, named: &&Named) -> bool {
    named.ambiguous_with.len() <= MOST_RIVALS && named.ambiguous_with.iter().any(|kind| kind.name() == key)
}

/// A nuisance was told, and what the key names with it as what these data cannot tell from it.
fn is_reading(key: &str, nuisance: &Nuisance) -> bool {
    nuisance.told && nuisance.ambiguous_with.iter().any(|kind| kind.name() == key)
}

/// Each name of the key is found, or `fits` a found one that is no other of the key; each found one serves once.
pub(super) fn one_to_one<T>(
    key: &[&str],
    found: &[T],
    name: impl Fn(&T) -> &str,
    fits: impl Fn(&str, &&T) -> bool,
) -> bool {
    let mut left: Vec<&T> = found.iter().filter(|one| !key.contains(&name(one))).collect();
    let mut missing = key.iter().filter(|key| !found.iter().any(|one| name(one) == **key));
    missing.all(|key| match left.iter().position(|one| fits(key, one)) {
        Some(i) => {
            left.remove(i);
            true
        }
        None => false,
    })
}

fn parameters(hidden: &Hidden) -> Value {
    serde_json::to_value(hidden).unwrap_or(Value::Null)
}

/// Wrong coefficients hide in each other, their resistance does not: error of it between 60 and 140 km/h as a share of
/// what was hidden, root mean squares.
fn davis_error(truth: &Value, found: &DavisError) -> Option<f64> {
    let truth = DavisTruth { r0: truth["dr0"].as_f64()?, r1: truth["dr1"].as_f64()?, r2: truth["dr2"].as_f64()? };
    let found = DavisTruth { r0: found.dr0, r1: found.dr1, r2: found.dr2 };
    let speeds = (60..=140).step_by(10).map(|kmh| f64::from(kmh) / 3.6);
    let (error, hidden) = speeds.fold((0.0, 0.0), |(error, hidden), v| {
        let (a, b) = (truth.resistance_n_per_kg(v), found.resistance_n_per_kg(v));
        (error + (b - a).powi(2), hidden + a * a)
    });
    Some((error / hidden).sqrt())
}

/// Below the usual level.
pub(super) fn is_significant(p_value: f64) -> bool {
    p_value < 0.05
}

/// Intersection over union.
fn overlap(a: [f64; 2], b: [f64; 2]) -> f64 {
    let both = (a[1].min(b[1]) - a[0].max(b[0])).max(0.0);
    both / (a[1] - a[0] + b[1] - b[0] - both)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_that_do_not_meet_have_nothing_in_common() {
        assert_eq!(overlap([0.0, 10.0], [20.0, 30.0]), 0.0);
        assert_eq!(overlap([0.0, 10.0], [0.0, 10.0]), 1.0);
        assert!((overlap([0.0, 10.0], [5.0, 15.0]) - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn wrong_coefficients_are_judged_by_their_resistance() {
        let truth = serde_json::json!({ "dr0": 1e-3, "dr1": 0.0, "dr2": 0.0 });
        let found = DavisError { dr0: 1.1e-3, dr1: 0.0, dr2: 0.0 };
        assert!((davis_error(&truth, &found).unwrap() - 0.1).abs() < 1e-9);
    }
}
