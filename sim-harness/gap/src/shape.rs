//! Terms whose shape is a number: a time constant, the speed at which a fade begins, a length. The search tries a few; here the best is made finer, and its limits are found.

use super::families::STEEP;
use super::fit::{Base, Gain, LOSS_AT_LIMIT};
use super::select::Search;
use super::terms::{Coordinate, Side, Term};

/// A shape, how far each step goes at first, and the range in which it makes sense.
struct Dial {
    value: f64,
    step: f64,
    least: f64,
    most: f64,
    /// The shape is the exponential of the value.
    exponential: bool,
}

impl Dial {
    fn of(term: &Term) -> Option<Self> {
        let dial = |value: f64, step, least, most, exponential| Some(Self { value, step, least, most, exponential });
        match term {
            // 20 s to 40 min.
            Term::WarmUp(tau_s) => dial(tau_s.ln(), 0.25, 3.0, 7.8, true),
            Term::BrakeFade(from_mps) => dial(*from_mps, 2.5, 0.0, 32.0, false),
            Term::Length(true_m) => dial(true_m.ln(), 0.03, true_m.ln() - 0.3, true_m.ln() + 0.3, true),
            _ => None,
        }
    }

    fn shape(&self, value: f64) -> f64 {
        if self.exponential { value.exp() } else { value }
    }
}

fn with_shape(term: &Term, shape: f64) -> Term {
    match term {
        Term::WarmUp(_) => Term::WarmUp(shape),
        Term::BrakeFade(_) => Term::BrakeFade(shape),
        Term::Length(_) => Term::Length(shape),
        other => other.clone(),
    }
}

/// 95 % limits of a shape, and of the coefficient that goes with it: where the shape moves, the coefficient follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Of the shape.
    pub shape: (f64, f64),
    /// Of the coefficient.
    pub beta: (f64, f64),
}

/// The same term with its shape made finer.
pub fn refined(search: &Search<'_>, base: &Base, term: Term) -> Term {
    if let Term::Step(which, ends, side) = term {
        return Term::Step(which, ramp(search, base, which, ends, side), side);
    }
    let Some(dial) = Dial::of(&term) else {
        return term;
    };
    let gain = |value: f64| {
        let gain = search.gain(base, &with_shape(&term, dial.shape(value)));
        gain.map_or(f64::NEG_INFINITY, |gain| gain.naive_gain)
    };
    let (mut best, mut step) = (dial.value, dial.step);
    let mut most = gain(best);
    while step > 0.04 * dial.step {
        let mut moved = false;
        for value in [best - step, best + step] {
            let now = gain(value.clamp(dial.least, dial.most));
            if now > most {
                (best, most, moved) = (value.clamp(dial.least, dial.most), now, true);
            }
        }
        if !moved {
            step *= 0.5;
        }
    }
    with_shape(&term, dial.shape(best))
}

/// A step that is not steep: both ends moved as long as it fits better.
fn ramp(search: &Search<'_>, base: &Base, which: Coordinate, mut ends: [f64; 2], side: Side) -> [f64; 2] {
    /// Longest move, of days or degrees, and the shortest.
    const MOVES: (f64, f64) = (8.0, 0.1);
    let gain = |ends: [f64; 2]| {
        let gain = search.gain(base, &Term::Step(which, ends, side));
        gain.map_or(f64::NEG_INFINITY, |gain| gain.naive_gain)
    };
    let (mut most, mut step) = (gain(ends), MOVES.0);
    while step > MOVES.1 {
        let mut moved = false;
        for (end, by) in [(0, -step), (0, step), (1, -step), (1, step)] {
            let mut other = ends;
            other[end] += by;
            if other[1] - other[0] < 2.0 * STEEP - 1e-9 {
                continue;
            }
            let now = gain(other);
            if now > most + 1e-9 {
                (ends, most, moved) = (other, now, true);
            }
        }
        if !moved {
            step *= 0.5;
        }
    }
    ends
}

/// Limits of a term's shape beside the others of its model: the profile of the log-likelihood. `half`: how far the limits of its coefficient are from it where the shape stays.
pub fn limits(base: &Base, search: &Search<'_>, term: &Term, half: f64) -> Option<Limits> {
    let dial = Dial::of(term)?;
    let at = |value: f64| search.gain(base, &with_shape(term, dial.shape(value)));
    let of = |gain: &Gain| (gain.gain, gain.beta.iter().next().copied().unwrap_or(1.0));
    let (most, beta) = of(&at(dial.value)?);
    let mut limits =
        Limits { shape: (dial.shape(dial.value), dial.shape(dial.value)), beta: (beta - half, beta + half) };
    for direction in [-1.0, 1.0] {
        // Ever larger steps out, then halves of the last one back in.
        let (mut value, mut step, mut outside) = (dial.value, 0.01 * dial.step, false);
        while step >= 0.01 * dial.step {
            let next = (value + direction * step).clamp(dial.least, dial.most);
            let loss = |gain: f64| (most - gain).max(0.0);
            let found = at(next).as_ref().map(of);
            match found.filter(|(gain, _)| loss(*gain) <= LOSS_AT_LIMIT) {
                Some((gain, beta)) => {
                    let half = half * (1.0 - loss(gain) / LOSS_AT_LIMIT).sqrt();
                    limits.beta.0 = limits.beta.0.min(beta - half);
                    limits.beta.1 = limits.beta.1.max(beta + half);
                    limits.shape.0 = limits.shape.0.min(dial.shape(next));
                    limits.shape.1 = limits.shape.1.max(dial.shape(next));
                    if next == value {
                        break;
                    }
                    value = next;
                }
                None => outside = true,
            }
            step *= if outside { 0.5 } else { 2.0 };
        }
    }
    Some(limits)
}
