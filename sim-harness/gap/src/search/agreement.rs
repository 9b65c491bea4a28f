//! Do all rows agree on a term, and do those show it that nothing else could explain?
//!
//! An effect of the train or the line acts in all parts of the data. A part in which a term, with its coefficients from
//! all rows, makes the fit worse by more than chance would, contradicts it. And what acts by place must be shown by
//! rows that drivers cannot forge:
//!
//! | weak evidence | because |
//! |---|---|
//! | braking, effort measured | drivers brake at the same places in each run, and what readings of the effort miss between them is the same in each run, too |
//! | holding a speed, for the length | a driver or a regulator answers each change of the gradient some seconds late, and so looks like a train of another length |
//! | a load that is nearer to none than believed, effort not measured | a train that is powered lightly uphill, or braked lightly downhill, looks like one that coasts |

use crate::candidate::{Shape, Term};
use crate::config::SearchConfig;
use crate::data::{believed::load_at, rows::Row};
use crate::fit::Base;
use crate::search::fits::Search;
use nalgebra::DVector;
use rundown::model::{direction::Direction, line::Line};

/// One of two parts of the rows; the other is the rest.
type Part = fn(&Row, &SearchConfig) -> bool;

fn held(row: &Row, config: &SearchConfig) -> bool {
    row.interval.acceleration_mps2().abs() < config.held_mps2
}

fn up(row: &Row, _: &SearchConfig) -> bool {
    row.direction == Direction::Up
}

/// By what the rows are split.
fn splits(term: &Term) -> &'static [Part] {
    match term.shape {
        Shape::Section(_) => &[held, up],
        Shape::Runs(_) => &[held],
        _ if term.is_whole() => &[held, up],
        Shape::Law
        | Shape::Powers(_)
        | Shape::Number(_)
        | Shape::Numbers(..)
        | Shape::NumberInRuns(..)
        | Shape::Step(..)
        | Shape::Table(..) => &[],
    }
}

impl Search<'_> {
    /// No part of the rows contradicts a term with these coefficients, and what acts by place is shown by more than
    /// weak evidence.
    pub fn agrees(&self, base: &Base, term: &Term, beta: &[f64]) -> bool {
        let config = &self.context.config.search;
        let splits = splits(term);
        if splits.is_empty() && !term.by_place() {
            return true;
        }
        let explained = self.explained(base, term, beta);
        let gains = gains(base, &explained);
        let over = |of: &DVector<f64>, wanted: &dyn Fn(usize) -> bool| -> f64 {
            of.iter().enumerate().filter(|(i, _)| wanted(*i)).map(|(_, value)| value).sum()
        };
        let information = explained.component_mul(&explained);
        // The noise is not known so well that a part which hardly shows the term could deny it.
        let shows = config.least_part * information.sum();
        let against = |part: &Part, inside: bool| {
            let is_inside = |i: usize| part(&self.rows[i], config) == inside;
            over(&information, &is_inside) > shows && over(&gains, &is_inside) < config.against
        };
        if splits.iter().any(|p| against(p, true) || against(p, false)) {
            return false;
        }
        if !term.by_place() {
            return true;
        }
        let extra = term.extra(beta, self.context, self.rows);
        // Whitened rows also hold a little of their neighbours and of the whole run: those count in which the term
        // acts.
        let most = extra.iter().fold(0.0, |most, e| f64::max(most, e.abs()));
        let strong = |i: usize| {
            let row = &self.rows[i];
            let line = self.context.believed.line(row.direction);
            extra[i].abs() > config.acting * most && !is_weak(term, row, extra[i], line, config)
        };
        over(&gains, &strong) > config.enough
    }
}

impl Search<'_> {
    /// What a term with these coefficients explains of each row, beside a model.
    fn explained(&self, base: &Base, term: &Term, beta: &[f64]) -> DVector<f64> {
        let mut explained = DVector::zeros(base.residual.len());
        for (column, beta) in self.white(term).iter().zip(beta) {
            explained += base.beside(column) * *beta;
        }
        explained
    }

    /// Whether a term may be light brakes: without an effort column more resistance on a described descent is a driver
    /// who holds the speed there, unless the other rows show the term as well.
    pub fn may_be_brakes(&self, base: &Base, term: &Term, beta: &[f64]) -> bool {
        let config = &self.context.config.search;
        let extra = term.extra(beta, self.context, self.rows);
        let is_braked = |(row, extra): (&Row, f64)| {
            let line = self.context.believed.line(row.direction);
            let slope = row.interval.mean(|p| line.gradient_n_per_kg(p.location_m));
            row.interval.effort_n_per_kg.is_none() && extra > 0.0 && slope < -config.descends_n_per_kg
        };
        let most = extra.iter().fold(0.0, |most, e| f64::max(most, e.abs()));
        let acts = |i: &usize| extra[*i].abs() > config.acting * most;
        let (braked, others): (Vec<usize>, Vec<usize>) =
            (0..extra.len()).filter(acts).partition(|i| is_braked((&self.rows[*i], extra[*i])));
        let gains = gains(base, &self.explained(base, term, beta));
        !braked.is_empty() && others.into_iter().map(|i| gains[i]).sum::<f64>() < config.enough
    }
}

/// What each row gains by what a term explains of it.
fn gains(base: &Base, explained: &DVector<f64>) -> DVector<f64> {
    base.residual.component_mul(explained) - 0.5 * explained.component_mul(explained)
}

/// A driver could have forged what this row shows. `extra`: the resistance that the term adds in it, N/kg.
fn is_weak(term: &Term, row: &Row, extra: f64, line: &Line<'_>, config: &SearchConfig) -> bool {
    let Some(effort) = row.interval.effort_n_per_kg else {
        let mut loads = row.interval.path.iter().map(|p| load_at(line, p));
        return loads.any(|load| extra * load < 0.0);
    };
    let answers = term.is_whole() && effort > 0.0 && held(row, config);
    effort < config.braking_n_per_kg || answers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidates;
    use crate::data::believed::tests::on_a_hilly_line;
    use crate::noise::{calibrate::Calibrated, whitening::Noise};
    use rundown::model::effects::EffectKind;
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
        let bump = Term { of: candidates::of(EffectKind::Unknown), shape: Shape::Section([0.0, 9_000.0]) };
        let weak = |direction, location_m, extra| {
            let line = Line { train: &train, track: &track, direction };
            let row = Row::coasting(direction, location_m, 30.0);
            is_weak(&bump, &row, extra, &line, &SearchConfig::default())
        };
        // Level, uphill: less resistance is light power. Downhill: more is a light brake.
        assert!(weak(Direction::Up, 2_000.0, -0.02) && !weak(Direction::Up, 2_000.0, 0.02));
        assert!(weak(Direction::Up, 7_000.0, -0.02) && !weak(Direction::Up, 7_000.0, 0.02));
        assert!(weak(Direction::Down, 7_000.0, 0.02) && !weak(Direction::Down, 7_000.0, -0.02));
    }

    #[test]
    fn a_gradient_that_only_descending_coasts_show_may_be_light_brakes() {
        on_a_hilly_line(30, |context| {
            let may_be_brakes = |climbing_n_per_kg: f64, effort_n_per_kg: Option<f64>| {
                let row = |i: usize| {
                    let direction = [Direction::Up, Direction::Down][i / 20 % 2];
                    let mut row = Row::coasting(direction, 500.0 + 1_000.0 * (i % 20) as f64, 30.0);
                    row.interval.run = i / 20;
                    row.interval.begin_s = 20.0 * i as f64;
                    row.interval.effort_n_per_kg = effort_n_per_kg;
                    // Up the line km 5 falls by 3 permille.
                    if i % 20 == 5 {
                        row.residual_n_per_kg = if direction == Direction::Up { 0.02 } else { climbing_n_per_kg };
                    }
                    row
                };
                let rows: Vec<Row> = (0..30 * 20).map(row).collect();
                let noise = Noise { acceleration_mps2: 0.004, ..Noise::default() };
                let calibrated = Calibrated::even(noise, rows.len());
                let search = Search::new(context, &rows, &calibrated, effort_n_per_kg.is_some());
                let shape = Shape::Section([5_000.0, 6_000.0]);
                let term = Term { of: candidates::of(EffectKind::GradientError), shape };
                let base = search.base(&[]).unwrap();
                let beta = search.gain(&base, &term).unwrap().beta[0];
                search.may_be_brakes(&base, &term, &[beta])
            };
            assert!(may_be_brakes(0.0, None));
            // Trains that climb there show the same slope, or a column shows that nobody brakes.
            assert!(!may_be_brakes(-0.02, None) && !may_be_brakes(0.0, Some(0.0)));
        });
    }

    #[test]
    fn few_rows_that_hardly_show_a_drag_do_not_deny_it_and_many_do() {
        on_a_hilly_line(30, |context| {
            let agrees = |held_each: usize| {
                let row = |i: usize| {
                    let is_held = i.is_multiple_of(held_each);
                    let mut row = Row::coasting(Direction::Up, 500.0 + 1_000.0 * (i % 60) as f64, 30.0);
                    row.interval.run = i / 60;
                    row.interval.begin_s = 20.0 * (i % 60) as f64;
                    row.interval.braked = true;
                    row.interval.effort_n_per_kg = Some(0.0);
                    row.interval.speed_mps[1] += if is_held { 0.0 } else { -1.0 };
                    // Every third run drags, but for rows that hold the speed, which say the opposite.
                    let drags = if (i / 60).is_multiple_of(3) { 0.01 } else { 0.0 };
                    row.residual_n_per_kg = if is_held { -drags } else { drags };
                    row
                };
                let rows: Vec<Row> = (0..30 * 60).map(row).collect();
                let noise = Noise { acceleration_mps2: 0.004, ..Noise::default() };
                let calibrated = Calibrated::even(noise, rows.len());
                let search = Search::new(context, &rows, &calibrated, true);
                let shape = Shape::Runs((0..30).step_by(3).collect());
                let term = Term { of: candidates::of(EffectKind::DraggingBrake), shape };
                search.agrees(&search.base(&[]).unwrap(), &term, &[0.01])
            };
            assert!(agrees(60) && !agrees(6));
        });
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
            is_weak(term, &row, 0.02, &line, &SearchConfig::default())
        };
        let tunnel = Term { of: candidates::of(EffectKind::TunnelDrag), shape: Shape::Section([0.0, 9_000.0]) };
        let length = Term { of: candidates::of(EffectKind::TrainLengthError), shape: Shape::Number(200.0) };
        assert!(weak(&tunnel, -0.3, -3.0) && weak(&length, -0.3, -3.0));
        assert!(!weak(&tunnel, 0.05, 0.0) && weak(&length, 0.05, 0.0));
        assert!(!weak(&length, 0.2, 1.5) && !weak(&length, 0.0, 0.0));
    }
}
