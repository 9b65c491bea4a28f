//! Terms whose shape is a number: a time constant, the speed at which a fade begins, a length. The search tries a few;
//! here the best is made finer, and its limits are found.

use crate::candidate::{Dial, Shape, ShapeLimits, Side, Term};
use crate::candidates::unknown::STEEP;
use crate::columns::in_the_middle;
use crate::fit::{ANYWHERE, Base, Climb, Gain, LOSS_AT_LIMIT};
use crate::search::fits::Search;
use rundown::model::effects::Coordinate;
use rundown_files::statistics::extremes;

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

/// A step that is not steep: both ends moved as long as it fits better, among the days or degrees that the runs have.
/// An end that none of them has seen is only another size, and a line over all of them fits ever better on its way out.
fn ramp(search: &Search<'_>, base: &Base, term: &Term, (which, ends, side): (Coordinate, [f64; 2], Side)) -> [f64; 2] {
    /// Longest move, of days or degrees, and the shortest.
    const MOVES: (f64, f64) = (8.0, 0.1);
    let range = extremes(search.rows.iter().filter_map(|row| in_the_middle(which, row)));
    if range.0 > range.1 {
        return ends;
    }
    let climb = Climb {
        steps: [MOVES.0; 2],
        shrink: 0.5,
        rounds: 0,
        least: MOVES.1,
        better: 1e-9,
        first: -1.0,
        both: false,
        range,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidates;
    use crate::data::{believed::tests::on_a_level_line, rows::Row};
    use crate::noise::{calibrate::Calibrated, whitening::Noise};
    use rundown::model::direction::Direction;
    use rundown::model::effects::EffectKind;

    /// Where the ends of a step over days come to rest, of 60 runs, one a day, with this much on each day.
    fn ends(n_per_kg: impl Fn(f64) -> f64) -> [f64; 2] {
        on_a_level_line(60, |context| {
            let row = |i: usize| {
                let mut row = Row::coasting(Direction::Up, 900.0 * (i % 20) as f64, 30.0);
                row.interval.run = i / 20;
                row.interval.begin_s = 20.0 * (i % 20) as f64;
                let day = (i / 20) as f64;
                row.interval.day = Some(day);
                // Two sizes in turn are the noise.
                row.residual_n_per_kg = n_per_kg(day) + if i.is_multiple_of(2) { 0.002 } else { -0.002 };
                row
            };
            let rows: Vec<Row> = (0..60 * 20).map(row).collect();
            let noise = Noise { acceleration_mps2: 0.002, ..Noise::default() };
            let calibrated = Calibrated::even(noise, rows.len());
            let search = Search::new(context, &rows, &calibrated, false);
            let base = search.base(&[]).unwrap();
            let shape = Shape::Step(Coordinate::Day, [30.0 - STEEP, 30.0 + STEEP], Side::Above);
            let term = Term { of: candidates::of(EffectKind::Unknown), shape };
            let Shape::Step(_, ends, _) = refined(&search, &base, term).shape else { unreachable!() };
            ends
        })
    }

    #[test]
    fn the_ends_of_a_step_stay_among_the_days_of_the_runs() {
        // What grows on all days, from something on the first one, is fitted best by ends far outside.
        let [from, to] = ends(|day| 0.01 + 1e-4 * day);
        assert!((0.0..=59.0).contains(&from) && (0.0..=59.0).contains(&to), "{from} {to}");
        // What grows for some days is found as it is.
        let [from, to] = ends(|day| 0.01 * ((day - 20.0) / 20.0).clamp(0.0, 1.0));
        assert!((from - 20.0).abs() < 1.0 && (to - 40.0).abs() < 1.0, "{from} {to}");
    }
}
