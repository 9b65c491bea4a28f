//! What section 4 claims in numbers, and whether these runs say the same.
//!
//! Each claim has the criterion by which it counts as reproduced, set before looking: a shape where the paper describes
//! one, else a margin about the paper's number that 67 runs justify. The verdict is that on the paper's mode; the gated
//! mode and the truth stand beside it.
//!
//! What is a direction only counts from a size on that a reader of the paper could see: [`super::visible`].
//!
//! On simulated runs many claims could not fail, because the scenario was made so. Each claim says what it is worth:
//! [`ClaimKind`]. Into recorded runs nothing was put, and nobody knows what is true of them.

mod brake;
mod driving;
pub mod markdown;
mod power;
mod resistance;
mod sets;
pub mod summary;
mod trials;
mod unscented;

pub use super::verdict::Verdict;
pub use sets::{Sets, over_sets};

use super::tallies::{R0_BAND, Tallies};
use super::{gather::Gathered, moments::Moments, trials::Trials, visible::Size};
use rundown::model::train::Train;
use rundown_files::column::{Column, record};
use rundown_files::table::{Cell, Record};
use rundown_pages::numbers::{NOTHING, number};

/// What a claim that holds on simulated runs is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClaimKind {
    /// Put into the scenario, the description or the method: it could not fail, and says that they are the paper's.
    Input,
    /// Put into the scenario, and found again by the extractor with the error that is said.
    Recovered,
    /// Follows from the method on runs that were not made for it: it could have failed.
    Predicted,
    /// Of recorded runs: what the extractor reads in them, without a truth beside it.
    Observed,
}

impl ClaimKind {
    pub const ALL: [Self; 4] = [Self::Input, Self::Recovered, Self::Predicted, Self::Observed];

    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Recovered => "recovered",
            Self::Predicted => "predicted",
            Self::Observed => "observed",
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    pub kind: ClaimKind,
    /// Figure or section of the paper: `2` to `9`, `3.1`, `3.2`, `4.1`, `4.2`, `4.4`, or `conclusion`.
    pub place: &'static str,
    pub statement: &'static str,
    pub paper: String,
    pub gated: String,
    pub truth: String,
    /// Of the paper's mode against the truth: of a claim that is recovered, and of the two on shares, where it decides
    /// nothing.
    pub error: String,
    pub verdict: Verdict,
    pub why: String,
    /// It has numbers of the paper's own line, train or drivers.
    pub is_of_the_train: bool,
    /// An input that is in the runs, not in the description or the method.
    is_in_the_runs: bool,
    /// Of a claim of direction: the least change that counts, with its reason.
    pub least: Option<Size>,
    /// What each set of runs says; the words above are those of the first.
    pub sets: Sets,
}

/// The paper's line, m, and by how much of it a way that was recorded may differ.
const LINE_M: f64 = 32_103.0;
const OTHER_LINE: f64 = 0.01;
/// By how much the described r0 may lie beside the middle of the paper's band.
const OTHER_TRAIN: f64 = 0.05;

/// Whether line and train are the paper's. Without runs only the description can say so.
fn is_at_home(gathered: &Gathered, train: &Train) -> bool {
    let r0 = 0.5 * (R0_BAND.start() + R0_BAND.end());
    let is_line = near(gathered.travelled_m.mean(), LINE_M, OTHER_LINE * LINE_M);
    let is_train = near(Some(train.davis().r0), r0, OTHER_TRAIN * r0);
    is_line != Some(false) && is_train == Some(true)
}

/// What is judged of runs on another line or with another train: what the method does, not what the paper's line, train
/// and drivers put into its numbers.
fn judged_elsewhere(claim: Claim) -> Claim {
    match claim.is_of_the_train {
        true => Claim { verdict: Verdict::Elsewhere, ..claim },
        false => claim,
    }
}

fn is_recorded(gathered: &Gathered) -> bool {
    gathered.paper.runs > 0 && gathered.truth.runs == 0
}

/// Of recorded runs, into which nothing was put.
fn observed(claim: Claim) -> Claim {
    match claim.kind {
        ClaimKind::Recovered => Claim { kind: ClaimKind::Observed, ..claim },
        ClaimKind::Input if claim.is_in_the_runs => Claim { kind: ClaimKind::Observed, ..claim },
        ClaimKind::Input | ClaimKind::Predicted | ClaimKind::Observed => claim,
    }
}

/// In the paper's order.
pub fn claims(gathered: &Gathered, train: &Train, trials: &Trials) -> Vec<Claim> {
    let mut claims = Vec::from(driving::setting(train));
    claims.push(unscented::third_moment());
    claims.push(driving::runs(gathered));
    claims.extend(driving::profiles(gathered));
    claims.extend(resistance::one_run(gathered, train));
    claims.extend(resistance::all_runs(gathered, train));
    claims.extend(resistance::terms(gathered, train));
    claims.push(resistance::initial(&trials.sensitivity));
    claims.extend(trials::trials(trials));
    claims.extend(driving::regimes(gathered, train));
    claims.extend(driving::style(gathered));
    claims.extend(brake::brake(gathered));
    claims.push(power::transition(train));
    claims.extend(power::power(gathered, train));
    claims.push(resistance::estimated(gathered));
    claims.push(trials::recognised(trials.thinned.as_ref()));
    if is_recorded(gathered) {
        claims = claims.into_iter().map(observed).collect();
    }
    if !is_at_home(gathered, train) {
        claims = claims.into_iter().map(judged_elsewhere).collect();
    }
    over_sets(claims, &[])
}

/// The columns of `claims.csv`.
pub fn columns() -> Vec<Column<Claim>> {
    let count = |name, meaning, of: fn(&Sets) -> usize| {
        Column::count(name, meaning, move |claim: &Claim| Cell::from(of(&claim.sets)))
    };
    let verdict = "over all sets: `reproduced`, `not reproduced`, `not visible` (not reproduced: the change is smaller than a \
        reader of the paper could see), `no data` or `not judged` (it has numbers of the paper's own line, train or drivers, and these runs are others)";
    let least = "the least change that counts, with its reason";
    let place = "figure of the paper, `2` to `9`, its section, `3.1`, `3.2`, `4.1`, `4.2`, `4.4`, or its `conclusion`";
    let kind = "`input`: put into scenario, description or method; `recovered`: put in and found again; `predicted`: could have failed; `observed`: in recorded runs, whose truth is not known";
    let error = "of the paper's mode against the truth, of a claim that is `recovered`, and of the two on shares (of one run, of runs above 140 km/h)";
    vec![
        Column::text("place", place, |claim: &Claim| claim.place),
        Column::text("kind", kind, |claim: &Claim| claim.kind.as_str()),
        Column::text("statement", "what the paper says", |claim: &Claim| claim.statement),
        Column::text("paper_mode", "what the paper's mode says", |claim: &Claim| claim.paper.clone()),
        Column::text("gated_mode", "what the gated mode says", |claim: &Claim| claim.gated.clone()),
        Column::text("truth", "what was true", |claim: &Claim| claim.truth.clone()),
        Column::text("error", error, |claim: &Claim| claim.error.clone()),
        Column::text("verdict", verdict, |claim: &Claim| claim.verdict.as_str()),
        Column::text("why", "by which criterion", |claim: &Claim| claim.why.clone()),
        Column::text("least", least, |claim: &Claim| claim.least.map_or("", |least| least.reason))
            .empty_when("the claim has a number of its own"),
        count("sets", "sets of runs; values are those of the first", |sets| sets.all),
        count("sets_judged", "those that have data on it", |sets| sets.judged),
        count("sets_reproduced", "those in which it is reproduced", |sets| sets.held),
        count("sets_not_visible", "those in which the change is too small to be seen", |sets| sets.not_visible),
    ]
}

pub fn records(claims: &[Claim]) -> Vec<Record> {
    let columns = columns();
    claims.iter().map(|claim| record(&columns, claim)).collect()
}

/// What the paper's mode says of a claim, the gated mode, and the truth; a dash where there is nothing.
type ClaimColumns = [Option<String>; 3];

/// A claim of which nothing is known yet.
fn claim(place: &'static str, statement: &'static str) -> Claim {
    let nothing = || NOTHING.to_owned();
    let [paper, gated, truth, error] = std::array::from_fn(|_| nothing());
    let (verdict, why) = (Verdict::NoData, String::new());
    Claim {
        kind: ClaimKind::Predicted,
        place,
        statement,
        paper,
        gated,
        truth,
        error,
        verdict,
        why,
        is_of_the_train: false,
        is_in_the_runs: false,
        least: None,
        sets: Sets::default(),
    }
}

impl Claim {
    fn columns(self, columns: ClaimColumns) -> Self {
        let [paper, gated, truth] = columns.map(|text| text.unwrap_or_else(|| NOTHING.to_owned()));
        Self { paper, gated, truth, ..self }
    }

    /// Whether the criterion is met; none where there are no data.
    fn holds(self, holds: Option<bool>) -> Self {
        Self { verdict: holds.map_or(Verdict::NoData, Verdict::from), ..self }
    }

    /// Judged by changes against what could be seen of them.
    fn seen(self, verdict: Option<Verdict>, least: Size) -> Self {
        Self { verdict: verdict.unwrap_or(Verdict::NoData), ..self }.least(least)
    }

    /// By which criterion.
    fn by(self, why: impl Into<String>) -> Self {
        Self { why: why.into(), ..self }
    }

    fn of_the_train(self) -> Self {
        Self { is_of_the_train: true, ..self }
    }

    /// What the paper's mode is off against the truth, where that decides nothing.
    fn off_by(self, error: Option<String>) -> Self {
        Self { error: error.unwrap_or(self.error), ..self }
    }

    fn of_any_train(self) -> Self {
        Self { is_of_the_train: false, ..self }
    }

    /// Description or method are so.
    fn input(self) -> Self {
        Self { kind: ClaimKind::Input, ..self }.of_the_train()
    }

    /// The scenario was made so.
    fn input_of_runs(self) -> Self {
        Self { is_in_the_runs: true, ..self.input() }
    }

    /// The scenario was made so, and the extractor must find it: what it found meets the criterion, and so does the
    /// truth. Without a truth the former alone decides.
    fn recovered(self, [found, was]: [Option<Verdict>; 2]) -> Self {
        let verdict = match (found.unwrap_or(Verdict::NoData), was) {
            (Verdict::Reproduced, Some(Verdict::NoData)) => Verdict::NoData,
            (Verdict::Reproduced, Some(Verdict::Not | Verdict::NotVisible)) => Verdict::Not,
            (found, _) => found,
        };
        let in_truth = was.map_or("", |_| "; asked of the truth, too");
        Self { kind: ClaimKind::Recovered, verdict, why: self.why + in_truth, ..self }.of_the_train()
    }

    /// What the paper's mode found and what was true differ by no more than the margin. Comes after the criterion.
    fn within(self, found: Option<f64>, truth: Option<f64>, margin: f64, words: impl Fn(f64) -> String) -> Self {
        let Some((found, truth)) = found.zip(truth) else {
            return self;
        };
        let error = found - truth;
        let misses = self.verdict == Verdict::Reproduced && error.abs() > margin;
        Self {
            verdict: if misses { Verdict::Not } else { self.verdict },
            error: words(error),
            why: format!("{}; found within {} of the truth", self.why, words(margin)),
            ..self
        }
    }

    /// By what could be seen.
    fn least(self, least: Size) -> Self {
        Self { least: Some(least), ..self }
    }
}

/// The columns of a claim on the description, or on the paper's mode alone.
fn alone(text: Option<String>) -> ClaimColumns {
    [text, None, None]
}

/// What the criterion says of what the paper's mode found, and of what was true; none where no truth is known.
fn both<V: Into<Verdict>>(gathered: &Gathered, of: impl Fn(&Tallies) -> Option<V>) -> [Option<Verdict>; 2] {
    let [found, was] = [&gathered.paper, &gathered.truth].map(|tallies| of(tallies).map(Into::into));
    [found, was.or((gathered.truth.runs > 0).then_some(Verdict::NoData))]
}

/// The columns of one quantity.
fn three(gathered: &Gathered, of: impl Fn(&Tallies) -> Option<String>) -> ClaimColumns {
    let truth = (gathered.truth.runs > 0).then(|| of(&gathered.truth));
    [of(&gathered.paper), of(&gathered.gated), truth.flatten()]
}

fn near(found: Option<f64>, wanted: f64, margin: f64) -> Option<bool> {
    found.map(|found| (found - wanted).abs() <= margin)
}

/// A difference of shares.
fn points(difference: f64) -> String {
    format!("{} points", number(100.0 * difference, 1))
}

fn percent(share: Option<f64>) -> Option<String> {
    share.map(|share| format!("{}\u{a0}%", number(100.0 * share, 1)))
}

fn mean(moments: &Moments, decimals: usize) -> Option<String> {
    moments.mean().map(|mean| number(mean, decimals))
}

fn from_to(moments: &Moments, per_unit: f64, decimals: usize) -> Option<String> {
    (moments.count > 0).then(|| {
        let end = |value: f64| number(value / per_unit, decimals);
        format!("{} to {}", end(moments.least), end(moments.largest))
    })
}

#[cfg(test)]
mod tests;
