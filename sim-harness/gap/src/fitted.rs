//! The terms of a model with their coefficients, limits and rivals.

use super::fit::TWO_SIDED;
use super::limits::SectionLimits;
use super::select::{Found, Search};
use super::shape;
use super::terms::Term;
use super::worth::unnamed;

/// A term with its coefficients.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The term.
    pub term: Term,
    /// Its coefficients.
    pub beta: Vec<f64>,
    /// Their standard deviations: the larger of noise model and spread between runs, and what sensors may do in all runs alike.
    pub sd: Vec<f64>,
    /// Log-likelihood that would be lost without it.
    pub gain: f64,
    /// Limits of a section.
    pub section: Option<SectionLimits>,
    /// Limits of a shape that is a number.
    pub shape: Option<shape::Limits>,
    /// Others that would do nearly as well in its place, with how much worse they are.
    pub rivals: Vec<(Term, f64)>,
}

/// A law is as good as this share of its coefficient, whatever the noise: means over 10 s, the path between readings.
const LAW: f64 = 0.01;
/// A rival within this of a term cannot be told apart from it.
pub const NEAR: f64 = 3.0;
/// A rival that is worse by more has no odds.
const FAR: f64 = 10.0;

/// Each term of the model with its coefficients, what it brings beside the others, and who would do as well.
pub fn fitted(search: &Search<'_>, model: &[Term]) -> Vec<Fitted> {
    let Some(base) = search.base(model) else {
        return Vec::new();
    };
    let score = search.score(model);
    let (naive, robust) = (base.naive(), base.robust());
    let mut place = 0;
    let mut fitted = Vec::new();
    for (index, term) in model.iter().enumerate() {
        let count = if matches!(term, Term::Length(_)) { 0 } else { term.count() };
        let range = place..place + count;
        place += count;
        let mut others = model.to_vec();
        others.remove(index);
        let (same, rivals): (Vec<Found>, Vec<Found>) = search
            .candidates(&others)
            .into_iter()
            .partition(|found| core::mem::discriminant(&found.term) == core::mem::discriminant(term));
        let gain = same.first().map_or(0.0, |found| found.gain.gain);
        let rivals = rivals
            .into_iter()
            .filter_map(|found| {
                let mut with = others.clone();
                with.insert(index, found.term.clone());
                let worse = score - search.score(&with) - unnamed(&found.term);
                (worse < FAR).then_some((found.term, worse))
            })
            .collect();
        let sd: Vec<f64> = range
            .clone()
            .zip(search.systematic(model, index))
            .map(|(i, systematic)| naive[(i, i)].max(robust[(i, i)]).sqrt().hypot(systematic))
            .zip(range.clone())
            .map(|(sd, i)| sd.hypot(LAW * base.beta[i]))
            .collect();
        let half = TWO_SIDED * sd.first().copied().unwrap_or(0.0);
        let beside = search.base(&others);
        let shape = beside.and_then(|beside| shape::limits(&beside, search, term, half));
        let section = search.section(&others, term, half);
        fitted.push(Fitted {
            term: term.clone(),
            beta: range.map(|i| base.beta[i]).collect(),
            sd,
            shape,
            gain,
            section,
            rivals,
        });
    }
    fitted
}
