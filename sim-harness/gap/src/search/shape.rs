//! Terms whose shape is a number: a time constant, the speed at which a fade begins, a length. The search tries a few; here the best is made finer, and its limits are found.

use crate::candidate::{Dial, Shape, ShapeLimits, Side, Term};
use crate::candidates::unknown::STEEP;
use crate::fit::{ANYWHERE, Base, Climb, Gain, LOSS_AT_LIMIT};
use crate::search::fits::Search;
use rundown::model::effects::Coordinate;

/// Where a shape stands on its dial.
struct Turned {
    dial: Dial,
    value: f64,
}

impl Turned {
    fn of(term: &Term) -> Option<Self> {
        let (Shape::Number(shape) | Shape::NumberInRuns(shape, _), Some(dial)) =
            (&term.shape, term.of.dial(&term.shape))
        else {
            return None;
        };
        Some(Self { dial, value: if dial.exponential { shape.ln() } else { *shape } })
    }

    fn clamped(&self, value: f64) -> f64 {
        value.clamp(self.dial.range.0, self.dial.range.1)
    }

    fn shape(&self, value: f64) -> f64 {
        if self.dial.exponential { value.exp() } else { value }
    }

    fn term(&self, term: &Term, value: f64) -> Term {
        term.with(term.shape.with_number(self.shape(value)))
    }
}

fn gain(search: &Search<'_>, base: &Base, term: &Term) -> f64 {
    search.gain(base, term).map_or(f64::NEG_INFINITY, |gain| gain.naive_gain)
}

/// The same term with its shape made finer.
pub fn refined(search: &Search<'_>, base: &Base, term: Term) -> Term {
    if let Shape::Step(which, ends, side) = term.shape {
        return term.with(Shape::Step(which, ramp(search, base, &term, (which, ends, side)), side));
    }
    let Some(turned) = Turned::of(&term) else {
        return term;
    };
    let Dial { step, range, .. } = turned.dial;
    let climb = Climb {
        steps: [step],
        shrink: 0.5,
        rounds: 0,
        least: 0.04 * step,
        better: 0.0,
        first: -1.0,
        both: true,
        range,
    };
    let ([best], _) = climb.from([turned.value], |[value]| Some(gain(search, base, &turned.term(&term, value))));
    turned.term(&term, best)
}

/// A step that is not steep: both ends moved as long as it fits better.
fn ramp(search: &Search<'_>, base: &Base, term: &Term, (which, ends, side): (Coordinate, [f64; 2], Side)) -> [f64; 2] {
    /// Longest move, of days or degrees, and the shortest.
    const MOVES: (f64, f64) = (8.0, 0.1);
    let climb = Climb {
        steps: [MOVES.0; 2],
        shrink: 0.5,
        rounds: 0,
        least: MOVES.1,
        better: 1e-9,
        first: -1.0,
        both: false,
        range: ANYWHERE,
    };
    let at = |ends: [f64; 2]| {
        let steep = ends[1] - ends[0] < 2.0 * STEEP - 1e-9;
        (!steep).then(|| gain(search, base, &term.with(Shape::Step(which, ends, side))))
    };
    climb.from(ends, at).0
}

/// Limits of a term's shape beside the others of its model: the profile of the log-likelihood. `half`: how far the limits of its coefficient are from it where the shape stays.
pub fn limits(base: &Base, search: &Search<'_>, term: &Term, half: f64) -> Option<ShapeLimits> {
    let turned = Turned::of(term)?;
    let least = 0.01 * turned.dial.step;
    let at = |value: f64| search.gain(base, &turned.term(term, value));
    let of = |gain: &Gain| (gain.gain, gain.beta.iter().next().copied().unwrap_or(1.0));
    let (most, beta) = of(&at(turned.value)?);
    let shape = turned.shape(turned.value);
    let mut limits = ShapeLimits { shape: (shape, shape), beta: (beta - half, beta + half) };
    for direction in [-1.0, 1.0] {
        // Ever larger steps out, then halves of the last one back in.
        let (mut value, mut step, mut outside) = (turned.value, least, false);
        while step >= least {
            let next = turned.clamped(value + direction * step);
            let loss = |gain: f64| (most - gain).max(0.0);
            let found = at(next).as_ref().map(of);
            match found.filter(|(gain, _)| loss(*gain) <= LOSS_AT_LIMIT) {
                Some((gain, beta)) => {
                    let half = half * (1.0 - loss(gain) / LOSS_AT_LIMIT).sqrt();
                    limits.beta.0 = limits.beta.0.min(beta - half);
                    limits.beta.1 = limits.beta.1.max(beta + half);
                    limits.shape.0 = limits.shape.0.min(turned.shape(next));
                    limits.shape.1 = limits.shape.1.max(turned.shape(next));
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
