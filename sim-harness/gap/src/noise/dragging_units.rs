//! Does the brake of one unit drag?
//!
//! All runs of the unit then do, so that choosing them costs no more than the choice of a unit: runs of which no one is
//! sure by itself are so together. Units may differ by other things (the gain of their effort sensors, r(v), wind),
//! each of which must explain these runs worse. A force from the start is no brake that dragged after its first
//! application, if the rows before it show that; where trains brake at once it is one and the same.

use crate::columns::braked;
use crate::data::{believed::Context, rows::Row};
use crate::fit::choices;
use crate::noise::calibrate::own_columns;
use nalgebra::DVector;
use std::collections::{BTreeMap, BTreeSet};

/// The runs of each unit, where there are several.
fn runs_of_units(rows: &[Row]) -> Vec<Vec<usize>> {
    let mut of: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for row in rows {
        if let Some(unit) = row.interval.unit {
            of.entry(unit).or_default().insert(row.interval.run);
        }
    }
    let all = of.into_values().map(|runs| runs.into_iter().collect());
    Some(all.collect()).filter(|all: &Vec<_>| all.len() > 1).unwrap_or_default()
}

/// What choosing these runs costs, log-likelihood: the runs of a unit are one of so many units.
pub fn choice(chosen: &[usize], rows: &[Row]) -> f64 {
    let units = runs_of_units(rows);
    if units.iter().any(|runs| runs == chosen) {
        return (units.len() as f64).ln();
    }
    choices(chosen.len(), rows.last().map_or(1, |row| row.interval.run + 1))
}

/// The runs of each unit, and by what units may differ, whatever the noise is.
pub struct Units<'a> {
    context: &'a Context<'a>,
    rows: &'a [Row],
    runs: Vec<Vec<usize>>,
    constant: Vec<f64>,
    others: [Vec<f64>; 3],
}

impl<'a> Units<'a> {
    pub fn of(context: &'a Context<'a>, rows: &'a [Row]) -> Self {
        let davis = context.believed.train().davis();
        let believed = rows.iter().map(|row| row.interval.mean(|point| davis.resistance_n_per_kg(point.speed_mps)));
        let [constant, wind, mass] = own_columns(context, rows);
        Self { context, rows, runs: runs_of_units(rows), constant, others: [wind, mass, believed.collect()] }
    }

    /// The runs of each unit of which a brake that drags explains more than anything else that units differ by.
    ///
    /// `white`: whitens a column, beside the model. `left`: what the model leaves, whitened.
    pub fn dragging(&self, white: impl Fn(&[f64]) -> DVector<f64>, left: &DVector<f64>) -> Vec<Vec<usize>> {
        let Self { context, rows, runs: units, constant, others } = self;
        let config = context.config;
        let all: usize = units.iter().map(Vec::len).sum();
        // Gain of log-likelihood by a column, with the sign of its coefficient.
        let gain = |column: &[f64]| {
            let column = white(column);
            let score = column.dot(left);
            score * score.abs() / (2.0 * column.norm_squared().max(1e-12))
        };
        // Of more runs than these it is the train.
        let most_runs = config.between_runs.most_dragging * all as f64;
        let drags = |runs: &&Vec<usize>| {
            let by_brake = gain(&braked(context, rows, runs));
            let in_unit = |column: &Vec<f64>| -> Vec<f64> {
                let of_row = |(row, value): (&Row, &f64)| if runs.contains(&row.interval.run) { *value } else { 0.0 };
                rows.iter().zip(column).map(of_row).collect()
            };
            runs.len() >= config.evidence.least_runs
                && runs.len() as f64 <= most_runs
                && by_brake > config.between_runs.drag_gain
                && by_brake > gain(&in_unit(constant)) - config.certainty.rival_within
                && others.iter().all(|other| by_brake > gain(&in_unit(other)).abs() + config.certainty.rival_within)
        };
        units.iter().filter(drags).cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::direction::Direction;

    /// Runs of three units in turn, each run with a constant of its own; unit 1 has `more` (N/kg) after its first brake
    /// application, or from the start.
    fn found(more: f64, from_the_start: bool, seed: u64) -> Vec<Vec<usize>> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut rows = Vec::new();
        for run in 0..30 {
            let own = 0.003 * normal();
            for i in 0..60 {
                let speed_mps = 15.0 + f64::from(i % 20);
                let mut row = Row::coasting([Direction::Up, Direction::Down][run % 2], 500.0 * f64::from(i), speed_mps);
                row.interval.run = run;
                row.interval.unit = Some(run % 3);
                row.interval.braked = i >= 20;
                let drags = run % 3 == 1 && (row.interval.braked || from_the_start);
                row.residual_n_per_kg = 0.01 * normal() + own + if drags { more } else { 0.0 };
                rows.push(row);
            }
        }
        on_a_level_line(30, |context| {
            let white = |column: &[f64]| DVector::from_iterator(column.len(), column.iter().map(|value| value / 0.012));
            let left: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
            Units::of(context, &rows).dragging(white, &white(&left))
        })
    }

    #[test]
    fn the_unit_whose_brake_drags_is_found_and_no_other() {
        for seed in 0..5 {
            assert_eq!(found(0.006, false, seed), [(1..30).step_by(3).collect::<Vec<_>>()]);
        }
    }

    #[test]
    fn a_unit_with_more_resistance_from_the_start_does_not_drag() {
        for seed in 0..5 {
            assert!(found(0.006, true, seed).is_empty());
            assert!(found(0.0, false, seed).is_empty());
        }
    }

    #[test]
    fn choosing_a_unit_is_cheaper_than_choosing_its_runs() {
        let mut rows = Vec::new();
        for run in 0..30 {
            let mut row = Row::coasting(Direction::Up, 0.0, 20.0);
            (row.interval.run, row.interval.unit) = (run, Some(run % 3));
            rows.push(row);
        }
        let of_unit: Vec<usize> = (1..30).step_by(3).collect();
        assert!((choice(&of_unit, &rows) - 3.0_f64.ln()).abs() < 1e-12);
        assert!(choice(&(0..10).collect::<Vec<_>>(), &rows) > 10.0);
    }
}
