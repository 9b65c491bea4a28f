//! Who else was tried: every other candidate in the place of each effect that was found, with what the fit would lose.
//!
//! ```text
//! worse = score with the effect - score with the rival in its place        score: log-likelihood less the penalty of the freedom of the terms
//! ```

use crate::candidate::{ShowsIn, Term};
use crate::candidates;
use crate::data::believed::Context;
use crate::findings::Findings;
use crate::named::Named;
use crate::search::fits::Search;

/// A candidate in the place of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Rival {
    /// Its name.
    pub name: &'static str,
    /// Log-likelihood that is lost with it in the place of the effect, penalties of freedom included. Below about 3
    /// these data do not separate the two; at 7 the effect fits a thousand times more likely.
    pub worse: f64,
}

/// What the number of a rival means, for readers.
pub const MEANING: &str = "log-likelihood lost when the rival stands in the effect's place, the penalty of each one's freedom included: the effect is exp(worse) times more likely; below 3 these data do not separate the two";

/// The rivals of each effect, nearest first; in the order of `named`. Effects that the readings or the differences
/// between runs show have none. `context`: that of the findings.
pub fn rivals(named: &[Named], findings: &Findings, context: &Context<'_>) -> Vec<Vec<Rival>> {
    let model: Vec<Term> = findings.terms.iter().map(|f| f.term.clone()).collect();
    let search =
        (!model.is_empty()).then(|| Search::new(context, &findings.rows, &findings.calibrated, findings.measured));
    let of = |one: &Named| match (&search, one.term) {
        _ if candidates::of_effect(&one.effect).facts().nature.shows_in == ShowsIn::FullPower => {
            of_limit(findings, one.effect.name())
        }
        (Some(search), Some(index)) => of_term(search, &model, index, one.effect.name()),
        _ => Vec::new(),
    };
    named.iter().map(of).collect()
}

fn of_term(search: &Search<'_>, model: &[Term], index: usize, named: &str) -> Vec<Rival> {
    let score = search.score(model);
    let mut others = model.to_vec();
    others.remove(index);
    let rival = |term: &Term| {
        let mut with = others.clone();
        with.insert(index, term.clone());
        let worse = score - search.score(&with) - term.unnamed_penalty(search.context);
        Rival { name: term.of.name(), worse }
    };
    let found = search.in_place(&others);
    nearest(found.iter().map(|found| rival(&found.term)), named)
}

fn of_limit(findings: &Findings, named: &str) -> Vec<Rival> {
    let best = findings.limits.first().map_or(0.0, |limit| limit.value);
    let rivals = findings.limits.iter();
    nearest(rivals.map(|found| Rival { name: found.effect.name(), worse: best - found.value }), named)
}

/// One of each name, the nearest; not the effect itself.
fn nearest(rivals: impl Iterator<Item = Rival>, named: &str) -> Vec<Rival> {
    let mut all: Vec<Rival> = rivals.filter(|r| r.name != named && r.worse.is_finite()).collect();
    all.sort_by(|a, b| a.worse.total_cmp(&b.worse));
    let mut nearest: Vec<Rival> = Vec::new();
    for rival in all {
        if nearest.iter().all(|other| other.name != rival.name) {
            nearest.push(rival);
        }
    }
    nearest
}
