//! The terms of a model with their coefficients, limits and rivals.

use crate::candidate::{Fitted, Term};
use crate::search::{fits::Search, selection::Found, shape};
use rundown_check::agreement::HALF_95;

/// Each term of the model with its coefficients, what it brings beside the others, and who would do as well.
pub fn fitted(search: &Search<'_>, model: &[Term]) -> Vec<Fitted> {
    let Some(base) = search.base(model) else {
        return Vec::new();
    };
    let certainty = &search.context.config.certainty;
    let score = search.score(model);
    let (naive, robust) = (base.naive(), base.robust());
    let dispersion = base.dispersion();
    let mut place = 0;
    let of_term = |(index, term): (usize, &Term)| {
        let count = if term.is_whole() { 0 } else { term.count() };
        let range = place..place + count;
        place += count;
        let mut others = model.to_vec();
        others.remove(index);
        let (same, rivals): (Vec<Found>, Vec<Found>) =
            search.candidates(&others).into_iter().partition(|found| found.term.is_like(term));
        // Runs that differ in the effect say so beside the noise of all rows.
        let differ = same.first().map_or(1.0, |found| found.gain.naive_gain / found.gain.gain.max(1e-9));
        let dispersion = dispersion.max(differ);
        let rival = |found: Found| {
            let mut with = others.clone();
            with.insert(index, found.term.clone());
            let worse = score - search.score(&with) - found.term.unnamed_penalty(search.context);
            (worse < certainty.far * dispersion).then_some((found.term, worse))
        };
        let sd = range.clone().zip(search.systematic(model, index)).map(|(i, systematic)| {
            let sd = naive[(i, i)].max(robust[(i, i)]).sqrt().hypot(systematic);
            sd.hypot(certainty.law * base.beta[i])
        });
        let sd: Vec<f64> = sd.collect();
        let half = HALF_95 * sd.first().copied().unwrap_or(0.0);
        let beta: Vec<f64> = range.map(|i| base.beta[i]).collect();
        Fitted {
            term: term.clone(),
            sd,
            gain: same.first().map_or(0.0, |found| found.gain.gain),
            dispersion,
            shape: search.base(&others).and_then(|beside| shape::limits(&beside, search, term, half)),
            section: search.section(&others, term, half, beta.first().copied().unwrap_or(1.0)),
            rivals: rivals.into_iter().filter_map(rival).collect(),
            beta,
        }
    };
    model.iter().enumerate().map(of_term).collect()
}
