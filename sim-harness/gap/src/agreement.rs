//! Do all rows tell the same of a term, and do those tell it that nothing else could?
//!
//! An effect of the train or the line acts in all parts of the data. A part in which a term, with its coefficients from all rows, makes the fit worse by more than chance would, contradicts
//! it. And what acts by place must be told by rows that drivers cannot forge:
//!
//! | weak witness | because |
//! |---|---|
//! | braking, effort measured | drivers brake at the same places in each run, and what readings of the effort miss between them is the same in each run, too |
//! | holding a speed, for the length | a driver or a regulator answers each change of the gradient some seconds late, and so looks like a train of another length |
//! | a load that is nearer to none than believed, effort not measured | a train that is pulled lightly uphill, or braked lightly downhill, looks like one that coasts |

use super::fit::Base;
use super::rows::{Row, load_at};
use super::select::{ENOUGH, Search};
use super::terms::Term;
use super::worth::is_section;
use nalgebra::DVector;
use rundown::model::direction::Direction;
use rundown::model::line::Line;

/// Gain of log-likelihood below which a part contradicts a term: with a true effect, about one part in a hundred falls below.
const AGAINST: f64 = -3.0;
/// An effort below this is a brake application, N/kg.
const BRAKING_N_PER_KG: f64 = -0.02;
/// A term acts where it adds more than this share of the most that it adds.
const ACTING: f64 = 0.1;
/// A speed that changes by less is held, m/s².
const HELD_MPS2: f64 = 0.02;

/// One of two parts of the rows; the other is the rest.
type Part = fn(&Row) -> bool;

fn held(row: &Row) -> bool {
    row.interval.acceleration_mps2().abs() < HELD_MPS2
}

fn up(row: &Row) -> bool {
    row.direction == Direction::Up
}

/// It acts by place.
pub(super) fn by_place(term: &Term) -> bool {
    is_section(term) || matches!(term, Term::Length(_) | Term::Curve)
}

/// By what the rows are split.
fn splits(term: &Term) -> &'static [Part] {
    match term {
        _ if is_section(term) || matches!(term, Term::Length(_)) => &[held, up],
        Term::DraggingBrake(_) => &[held],
        _ => &[],
    }
}

impl Search<'_> {
    /// No part of the rows contradicts a term with these coefficients, and what acts by place is told by more than weak witnesses.
    pub(super) fn agrees(&self, base: &Base, term: &Term, beta: &[f64]) -> bool {
        let splits = splits(term);
        if splits.is_empty() && !by_place(term) {
            return true;
        }
        let mut explained = DVector::zeros(base.residual.len());
        for (column, beta) in self.white(term).iter().zip(beta) {
            explained += base.beside(column) * *beta;
        }
        let gains = base.residual.component_mul(&explained) - 0.5 * explained.component_mul(&explained);
        let sum = |wanted: &dyn Fn(usize) -> bool| -> f64 {
            let gains = gains.iter().enumerate();
            gains.filter(|(i, _)| wanted(*i)).map(|(_, g)| g).sum()
        };
        let against = |part: &Part, inside: bool| sum(&|i| part(&self.rows[i]) == inside) < AGAINST;
        if splits.iter().any(|p| against(p, true) || against(p, false)) {
            return false;
        }
        if !by_place(term) {
            return true;
        }
        let extra = term.extra(beta, self.context, self.rows);
        // Whitened rows also tell a little of their neighbours and of the whole run: those count in which the term acts.
        let most = extra.iter().fold(0.0, |most, e| f64::max(most, e.abs()));
        let strong = |i: usize| {
            let row = &self.rows[i];
            let line = self.context.believed.line(row.direction);
            extra[i].abs() > ACTING * most && !is_weak(term, row, extra[i], line)
        };
        sum(&strong) > ENOUGH
    }
}

/// A driver could have forged what this row tells. `extra`: the resistance that the term adds in it, N/kg.
fn is_weak(term: &Term, row: &Row, extra: f64, line: &Line<'_>) -> bool {
    let Some(effort) = row.interval.effort_n_per_kg else {
        let mut loads = row.interval.path.iter().map(|p| load_at(line, p));
        return loads.any(|load| extra * load < 0.0);
    };
    let answers = matches!(term, Term::Length(_)) && effort > 0.0 && held(row);
    effort < BRAKING_N_PER_KG || answers
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::track::{Gradient, Track};
    use rundown::model::train::{Train, TrainDescription};

    /// Level, then 20 permille up.
    fn track() -> Track {
        let gradient = |from_m: f64, permille: f64| Gradient { from_m, permille };
        Track::try_new(9_000.0, [gradient(0.0, 0.0), gradient(5_000.0, 20.0)]).unwrap()
    }

    #[test]
    fn without_an_effort_a_load_that_seems_nearer_to_none_may_be_a_held_speed() {
        let (train, track) = (Train::try_new(TrainDescription::CASE_STUDY).unwrap(), track());
        let weak = |direction, location_m, extra| {
            let line = Line { train: &train, track: &track, direction };
            let row = Row::coasting(direction, location_m, 30.0);
            is_weak(&Term::Bump([0.0, 9_000.0]), &row, extra, &line)
        };
        // Level, uphill: less resistance is light power. Downhill: more is a light brake.
        assert!(weak(Direction::Up, 2_000.0, -0.02) && !weak(Direction::Up, 2_000.0, 0.02));
        assert!(weak(Direction::Up, 7_000.0, -0.02) && !weak(Direction::Up, 7_000.0, 0.02));
        assert!(weak(Direction::Down, 7_000.0, 0.02) && !weak(Direction::Down, 7_000.0, -0.02));
    }

    #[test]
    fn with_an_effort_braking_is_weak_and_for_a_length_a_held_speed_too() {
        let (train, track) = (Train::try_new(TrainDescription::CASE_STUDY).unwrap(), track());
        let line = Line { train: &train, track: &track, direction: Direction::Up };
        let weak = |term: &Term, effort: f64, gained_mps: f64| {
            let mut row = Row::coasting(Direction::Up, 2_000.0, 30.0);
            row.effort_n_per_kg = effort;
            row.interval.effort_n_per_kg = Some(effort);
            row.interval.speed_mps[1] += gained_mps;
            is_weak(term, &row, 0.02, &line)
        };
        let (tunnel, length) = (Term::Tunnel([0.0, 9_000.0]), Term::Length(200.0));
        assert!(weak(&tunnel, -0.3, -3.0) && weak(&length, -0.3, -3.0));
        assert!(!weak(&tunnel, 0.05, 0.0) && weak(&length, 0.05, 0.0));
        assert!(!weak(&length, 0.2, 1.5) && !weak(&length, 0.0, 0.0));
    }
}
