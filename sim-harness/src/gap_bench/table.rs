//! Many scores in tables that a person reads: Markdown.

use crate::gap_bench::draw::{SIZES, SetRequest};
use crate::gap_bench::nuisance::Nuisance;
use crate::gap_bench::score::Score;
use rundown_check::figure::HALF_95;
use rundown_files::statistics::{mean, median};
use rundown_pages::numbers::counted;
use serde::Serialize;
use std::collections::BTreeMap;

/// A set that was investigated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Done {
    /// What it was to be.
    #[serde(rename = "ask")]
    pub request: SetRequest,
    /// The key's values, for people.
    pub hidden: String,
    /// Train, line, drivers, sampling, for people.
    pub data: String,
    /// What came of it.
    pub score: Score,
    /// Time of the investigation, s.
    pub seconds: f64,
}

/// All tables.
pub fn tables(done: &[Done]) -> String {
    let names: Vec<(f64, bool)> = done.iter().flat_map(|done| done.score.sure.clone()).collect();
    let confusion = [true, false].map(|effort| confusion(done, effort)).concat();
    [left_out(done), false_alarms(done), nuisances(done), sizes(done), confusion, reliability(&names)].concat()
}

/// Which sets were judged without some of their runs, in a sentence. Nothing where none was.
fn left_out(done: &[Done]) -> String {
    let lacking: Vec<&Done> = done.iter().filter(|done| done.score.left_out > 0).collect();
    if lacking.is_empty() {
        return String::new();
    }
    let runs: usize = lacking.iter().map(|done| done.score.left_out).sum();
    let seeds: Vec<String> = lacking.iter().map(|done| done.request.seed.to_string()).collect();
    format!(
        "Of {} of {} sets {} left out: seeds {}.\n\n",
        lacking.len(),
        done.len(),
        counted(runs, "run was", "runs were"),
        seeds.join(", ")
    )
}

/// From these confidences on names are counted together.
const BINS: [f64; 5] = [0.0, 0.5, 0.7, 0.9, 0.99];

/// A reliability diagram in words: of the names that were given with some confidence, how many are right.
pub fn reliability(names: &[(f64, bool)]) -> String {
    let mut text =
        String::from("### Confidence\n\n| confidence | names | mean of the confidence | right |\n|---|---|---|---|\n");
    for (i, from) in BINS.into_iter().enumerate() {
        let to = BINS.get(i + 1).copied().unwrap_or(1.0);
        let inside = |(confidence, _): &&(f64, bool)| *confidence >= from && (*confidence < to || to == 1.0);
        let those: Vec<&(f64, bool)> = names.iter().filter(inside).collect();
        let mean = mean(those.iter().map(|(confidence, _)| confidence));
        let right = those.iter().filter(|(_, right)| *right).count();
        let mean = mean.map_or_else(|| "-".to_owned(), |mean| format!("{mean:.2}"));
        text.push_str(&format!("| {from} to {to} | {} | {mean} | {} |\n", those.len(), share(right, those.len())));
    }
    text.push('\n');
    text
}

fn false_alarms(done: &[Done]) -> String {
    let mut text = String::from(
        "### Nothing hidden\n\n| effort column | sensors | sets | false alarms | nothing named but `candidate` | p-value below 0.05 | refused |\n|---|---|---|---|---|---|---|\n",
    );
    for effort in [true, false] {
        for dirty in [false, true] {
            let sets: Vec<&Done> = done
                .iter()
                .filter(|d| d.request.kinds.is_empty() && d.request.nuisance.is_none())
                .filter(|d| d.request.effort == effort && d.request.dirty == dirty)
                .collect();
            if sets.is_empty() {
                continue;
            }
            let alarms = sets.iter().filter(|d| !d.score.found.is_empty()).count();
            let low = sets.iter().filter(|d| d.score.is_significant()).count();
            let refused = sets.iter().filter(|d| d.score.refused.is_some()).count();
            let unnamed = sets.iter().filter(|d| d.score.is_candidate()).count();
            text.push_str(&format!(
                "| {} | {} | {} | {alarms} | {unnamed} | {low} | {refused} |\n",
                yes(effort),
                if dirty { "dirty" } else { "clean" },
                sets.len()
            ));
        }
    }
    text.push('\n');
    text
}

/// What was said of recorders and descriptions that are wrong, one row for each nuisance and kind of log.
fn nuisances(done: &[Done]) -> String {
    let mut kinds: Vec<Option<Nuisance>> = Vec::new();
    for one in done {
        if !kinds.contains(&one.request.nuisance) {
            kinds.push(one.request.nuisance);
        }
    }
    if kinds.iter().all(Option::is_none) {
        return String::new();
    }
    let mut text = String::from(
        "### Nuisances\n\n\
        Wrong names: sets with a name that the key has not. Reported: the nuisance of the set. Error: of the figure reported, median of its size. \
        Reported besides: other nuisances.\n\n\
        | nuisance | effort column | sets | wrong names | p-value below 0.05 | reported | error | 95 % intervals that hold | reported besides | refused |\n\
        |---|---|---|---|---|---|---|---|---|---|\n",
    );
    for kind in kinds {
        for effort in [true, false] {
            let of_kind = |d: &&Done| d.request.nuisance == kind && d.request.effort == effort;
            let sets: Vec<&Score> = done.iter().filter(of_kind).map(|d| &d.score).collect();
            if sets.is_empty() {
                continue;
            }
            let wrong = sets.iter().filter(|s| s.found.iter().any(|name| !s.key.contains(name))).count();
            let low = sets.iter().filter(|s| s.is_significant()).count();
            let refused = sets.iter().filter(|s| s.refused.is_some()).count();
            let told = |s: &&Score| {
                let (name, truth) = s.nuisance?;
                let (_, value, sd) = s.told.iter().find(|(told, ..)| *told == name)?;
                Some((value - truth, *sd))
            };
            let errors: Vec<(f64, f64)> = sets.iter().filter_map(told).collect();
            let hold = errors.iter().filter(|(error, sd)| error.abs() < HALF_95 * sd).count();
            let is_other = |s: &Score, name: &str| s.nuisance.is_none_or(|(own, _)| own != name);
            let besides = sets.iter().filter(|s| s.told.iter().any(|(name, ..)| is_other(s, name))).count();
            text.push_str(&format!(
                "| {} | {} | {} | {wrong} | {low} | {} | {} | {} | {besides} | {refused} |\n",
                kind.map_or("none", Nuisance::name),
                yes(effort),
                sets.len(),
                share(errors.len(), sets.iter().filter(|s| s.nuisance.is_some()).count()),
                median(errors.iter().map(|(error, _)| error.abs())).map_or_else(nothing, |x| format!("{x:.4}")),
                share(hold, errors.len()),
            ));
        }
    }
    text.push('\n');
    text
}

/// One row for each size, number of effects and kind of log.
fn sizes(done: &[Done]) -> String {
    let mut text = String::from(
        "### Something hidden\n\n\
        Named: all effects of the set and no other; something outside the catalogue as `unknown`. Shared: the same, or named beside at most two rivals. \
        Errors and shares are medians. Removed: share of the removable gap on hold-out runs.\n\n\
        | effects | effort column | size | sets | named | named or shared | size error | place (IoU) | removed | intervals that hold | right coordinate of unknowns | refused |\n\
        |---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (count, effort) in [(1, true), (1, false), (2, true), (2, false)] {
        for size in SIZES {
            let sets: Vec<&Score> = done
                .iter()
                .filter(|d| d.request.kinds.len() == count && d.request.effort == effort && d.request.size == size)
                .map(|d| &d.score)
                .collect();
            if sets.is_empty() {
                continue;
            }
            let all = |of: &dyn Fn(&Score) -> Vec<f64>| median(sets.iter().flat_map(|s| of(s)));
            let [intervals, hold] = sets.iter().fold([0, 0], |[a, b], s| [a + s.intervals[0], b + s.intervals[1]]);
            let unknown: Vec<bool> = sets.iter().filter_map(|s| s.coordinate).collect();
            text.push_str(&format!(
                "| {count} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
                yes(effort),
                format!("{size:?}").to_lowercase(),
                sets.len(),
                share(sets.iter().filter(|s| s.exact).count(), sets.len()),
                share(sets.iter().filter(|s| s.exact || s.shared).count(), sets.len()),
                percent(all(&|s| s.size_errors.clone())),
                all(&|s| s.places.clone()).map_or_else(nothing, |x| format!("{x:.2}")),
                percent(all(&|s| s.removed.into_iter().collect())),
                share(hold, intervals),
                share(unknown.iter().filter(|right| **right).count(), unknown.len()),
                sets.iter().filter(|s| s.refused.is_some()).count(),
            ));
        }
    }
    text.push('\n');
    text
}

/// What was found where one kind was hidden, by size.
fn confusion(done: &[Done], effort: bool) -> String {
    let mut rows: BTreeMap<&str, [Vec<String>; 3]> = BTreeMap::new();
    for one in done {
        if let [kind] = one.request.kinds[..]
            && one.request.effort == effort
        {
            let cell = &mut rows.entry(kind).or_default()[one.request.size as usize];
            let score = &one.score;
            cell.push(if score.exact {
                "✓".to_owned()
            } else {
                let nothing = if score.refused.is_some() { "refused" } else { "nothing" };
                let mut text = if score.found.is_empty() { nothing.to_owned() } else { score.found.join(" + ") };
                if score.shared {
                    text.push_str(" (shared)");
                }
                text
            });
        }
    }
    if rows.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "### What was named, {} effort column\n\n| hidden | clear | medium | faint |\n|---|---|---|---|\n",
        if effort { "with" } else { "without" }
    );
    for (kind, cells) in rows {
        text.push_str(&format!("| {kind} |"));
        for mut cell in cells {
            cell.sort();
            text.push_str(&format!(" {} |", cell.join(", ")));
        }
        text.push('\n');
    }
    text.push('\n');
    text
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(nothing, |x| format!("{:.1} %", 100.0 * x))
}

pub(super) fn share(count: usize, of: usize) -> String {
    if of == 0 { nothing() } else { format!("{:.2} ({count}/{of})", count as f64 / of as f64) }
}

fn nothing() -> String {
    "-".to_owned()
}

pub(super) fn yes(effort: bool) -> &'static str {
    if effort { "yes" } else { "no" }
}
