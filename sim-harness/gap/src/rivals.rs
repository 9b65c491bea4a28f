//! Who else was tried: every other candidate in the place of each effect that was found, with what the fit would lose.
//!
//! ```text
//! worse = score with the effect - score with the rival in its place        score: log-likelihood less what the freedom of the terms costs
//! ```

use super::analysis::Surroundings;
use super::named::{Named, name};
use super::rows::Believed;
use super::select::Search;
use super::terms::Term;
use super::workflow::Investigation;
use super::worth::unnamed;
use rundown::model::effects::Effect;

/// A candidate in the place of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Rival {
    /// Its name.
    pub name: &'static str,
    /// Log-likelihood that is lost with it in the place of the effect, costs of freedom included. Below about 3 these data do not tell the two apart; at 7 the
    /// effect fits a thousand times more likely.
    pub worse: f64,
}

/// What the number of a rival means, for readers.
pub const MEANING: &str = "log-likelihood lost when the rival stands in the effect's place, the cost of each one's freedom included: the effect is exp(worse) times more likely; below 3 these data cannot tell the two apart";

/// The rivals of each effect, nearest first; in the order of `found.named`. Effects that the readings or the differences between runs tell have none.
pub fn rivals(found: &Investigation, believed: Believed<'_>, surroundings: &Surroundings) -> Vec<Vec<Rival>> {
    let findings = &found.findings;
    let context = findings.context(believed, surroundings);
    let model: Vec<Term> = findings.terms.iter().map(|f| f.term.clone()).collect();
    let search = (!model.is_empty()).then(|| {
        let (rows, calibrated) = (&findings.rows, &findings.calibrated);
        Search::new(&context, rows, calibrated, findings.measured)
    });
    let of = |one: &Named| -> Vec<Rival> {
        if is_limit(&one.effect) {
            return of_limit(found, one.effect.name());
        }
        match (&search, model.iter().position(|term| stands_for(term, one))) {
            (Some(search), Some(index)) => of_term(search, &model, index, one.effect.name()),
            _ => Vec::new(),
        }
    };
    found.named.iter().map(of).collect()
}

/// It bounds the traction, and leaves the motion under a known effort as it is.
pub fn is_limit(effect: &Effect) -> bool {
    matches!(effect, Effect::PowerLimitSection(_) | Effect::TractionScale(_) | Effect::LowAdhesion(_))
}

/// The effect came of this term. A tunnel and a wrong gradient may have changed names.
fn stands_for(term: &Term, one: &Named) -> bool {
    let named = one.effect.name();
    match (term, &one.effect) {
        (Term::Tunnel(section) | Term::Gradient(section), effect) => {
            let sections = effect.section_m();
            let overlaps = sections.is_some_and(|(from, to)| from < section[1] && section[0] < to);
            matches!(effect, Effect::TunnelDrag(_) | Effect::GradientError(_)) && overlaps
        }
        (Term::Bump(_), _) => one.coordinate == Some("location"),
        (Term::Cube, _) => one.coordinate == Some("speed"),
        _ => name(term) == named,
    }
}

fn of_term(search: &Search<'_>, model: &[Term], index: usize, named: &str) -> Vec<Rival> {
    let score = search.score(model);
    let mut others = model.to_vec();
    others.remove(index);
    let rival = |term: &Term| {
        let mut with = others.clone();
        with.insert(index, term.clone());
        Rival { name: name(term), worse: score - search.score(&with) - unnamed(term) }
    };
    let found = search.candidates(&others);
    nearest(found.iter().map(|found| rival(&found.term)), named)
}

fn of_limit(found: &Investigation, named: &str) -> Vec<Rival> {
    let all = &found.findings.limits;
    let best = all.first().map_or(0.0, |limit| limit.value);
    let rival = all.iter().map(|found| Rival { name: found.limit.name(), worse: best - found.value });
    nearest(rival, named)
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
