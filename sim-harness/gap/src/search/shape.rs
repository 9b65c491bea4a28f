//! Terms whose shape is a number: a time constant, the speed at which a fade begins, a length. The search tries a few;
//! here the best is made finer, and its limits are found.

use crate::candidate::{Dial, Shape, ShapeLimits, Side, Term};
use crate::candidates::unknown::STEEP;
use crate::fit::{ANYWHERE, Base, Climb, Gain, LOSS_AT_LIMIT};
use crate::search::fits::Search;
use rundown::model::effects::Coordinate;

/// First step of the logarithm of a second number.
const SECOND_STEP: f64 = 0.5;

/// Where a shape stands on its dial.
struct Turned {
    dial: Dial,
    value: f64,
    /// Logarithm of its second number.
    second: Option<f64>,
}

impl Turned {
    fn of(term: &Term) -> Option<Self> {
        let (Shape::Number(shape) | Shape::Numbers(shape, _) | Shape::NumberInRuns(shape, _), Some(dial)) =
            (&term.shape, term.of.dial(&term.shape))
        else {
            return None;
        };
        let second = term.shape.second_number();
        let value = if dial.exponential { shape.ln() } else { *shape };
        Some(Self { dial, value, second: second.is_finite().then(|| second.ln()) })
    }

    fn shape(&self, value: f64) -> f64 {
        if self.dial.exponential { value.exp() } else { value }
    }

    /// The term with its numbers elsewhere, both within their ranges.
    fn term(&self, term: &Term, value: f64, second: Option<f64>) -> Term {
        let within = |value: f64, range: (f64, f64)| value.clamp(range.0, range.1);
        let number = self.shape(within(value, self.dial.range));
        term.with(match second {
            Some(second) => Shape::Numbers(number, within(second, self.dial.second_range).exp()),
            None => term.shape.with_number(number),
        })
    }

    /// How numbers are turned, by these steps at first.
    fn climb<const N: usize>(steps: [f64; N]) -> Climb<N> {
        Climb {
            steps,
            shrink: 0.5,
            rounds: 0,
            least: 0.04 * steps[0],
            better: 0.0,
            first: -1.0,
            both: true,
            range: ANYWHERE,
        }
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
    let at = |value: f64, second: Option<f64>| turned.term(&term, value, second);
    let gain = |value: f64, second: Option<f64>| Some(gain(search, base, &at(value, second)));
    let step = turned.dial.step;
    if let Some(second) = turned.second {
        let climb = Turned::climb([step, SECOND_STEP]);
        let ([value, second], _) = climb.from([turned.value, second], |[value, second]| gain(value, Some(second)));
        return at(value, Some(second));
    }
    let ([value], _) = Turned::climb([step]).from([turned.value], |[value]| gain(value, None));
    at(value, None)
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

/// How far a number may be turned, with the coefficient there.
struct Profile {
    value: (f64, f64),
    beta: (f64, f64),
}

impl Profile {
    /// From `start` on, where the gain is `most`, as far as the log-likelihood loses no more than a limit allows.
    /// `half`: how far the limits of the coefficient are from it where the number stays.
    fn of(start: (f64, &Gain), half: f64, least: f64, range: (f64, f64), at: impl Fn(f64) -> Option<Gain>) -> Self {
        let beta_of = |gain: &Gain| gain.beta.iter().next().copied().unwrap_or(1.0);
        let (most, beta) = (start.1.gain, beta_of(start.1));
        let mut profile = Self { value: (start.0, start.0), beta: (beta - half, beta + half) };
        for direction in [-1.0, 1.0] {
            // Ever larger steps out, then halves of the last one back in.
            let (mut value, mut step, mut outside) = (start.0, least, false);
            while step >= least {
                let next = (value + direction * step).clamp(range.0, range.1);
                let loss = |gain: &Gain| (most - gain.gain).max(0.0);
                match at(next).filter(|gain| loss(gain) <= LOSS_AT_LIMIT) {
                    Some(found) => {
                        let half = half * (1.0 - loss(&found) / LOSS_AT_LIMIT).sqrt();
                        let beta = beta_of(&found);
                        profile.beta = (profile.beta.0.min(beta - half), profile.beta.1.max(beta + half));
                        profile.value = (profile.value.0.min(next), profile.value.1.max(next));
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
        profile
    }
}

/// Limits of a term's shape beside the others of its model: the profile of the log-likelihood, each number with the
/// other where it fits best. `half`: how far the limits of its coefficient are from it where the shape stays.
pub fn limits(base: &Base, search: &Search<'_>, term: &Term, half: f64) -> Option<ShapeLimits> {
    let turned = Turned::of(term)?;
    let Dial { step, range, second_range, .. } = turned.dial;
    let at = |value: f64, second: Option<f64>| search.gain(base, &turned.term(term, value, second));
    let of = |value: f64, second: Option<f64>| at(value, second).map(|gain| gain.gain);
    let start = at(turned.value, turned.second)?;
    let number = Profile::of((turned.value, &start), half, 0.01 * step, range, |value| {
        let second =
            turned.second.map(|second| Turned::climb([SECOND_STEP]).from([second], |[at]| of(value, Some(at))).0[0]);
        at(value, second)
    });
    let second = turned.second.map(|second| {
        Profile::of((second, &start), half, 0.01 * SECOND_STEP, second_range, |second| {
            let ([value], _) = Turned::climb([step]).from([turned.value], |[at]| of(at, Some(second)));
            at(value, Some(second))
        })
    });
    let mut beta = number.beta;
    if let Some(second) = &second {
        beta = (beta.0.min(second.beta.0), beta.1.max(second.beta.1));
    }
    let shape = (turned.shape(number.value.0), turned.shape(number.value.1));
    Some(ShapeLimits { shape, beta, second: second.map(|Profile { value: (low, high), .. }| (low.exp(), high.exp())) })
}
