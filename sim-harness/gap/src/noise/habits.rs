//! What all drivers do alike between two readings of the effort: a brake is applied and released, a handle moves. No
//! reading shows it, and at the same place they do it in each run.
//!
//! A force while powering and one while braking, each of them everywhere and for parts of the line: random effects that
//! no candidate may be better than.

use crate::columns::{in_the_middle, knots};
use crate::config::{EvidenceConfig, GapConfig};
use crate::data::rows::Row;
use rundown::model::effects::Coordinate;

/// Power 1, coast 0, brake -1.
pub fn regime(row: &Row, config: &EvidenceConfig) -> i8 {
    let effort = row.effort_n_per_kg;
    i8::from(effort > config.coast_n_per_kg) - i8::from(effort < -config.coast_n_per_kg)
}

/// Powering and braking, as [`regime`] has them.
pub const DRIVEN: [i8; 2] = [1, -1];

/// Mean square of residuals by regime, (N/kg)².
pub struct Scatter {
    /// Of powering and of braking.
    pub driven: [f64; 2],
    /// Of coasting; where hardly anybody coasts, that of powering.
    pub calm: f64,
}

impl Scatter {
    /// `residuals`: of these rows, N/kg.
    pub fn of(rows: &[Row], residuals: &[f64], config: &EvidenceConfig) -> Self {
        // `None`: too few rows to tell.
        let scatter = |which: i8| {
            let those = rows.iter().zip(residuals).filter(|(row, _)| regime(row, config) == which);
            let squares = those.map(|(_, residual)| residual * residual);
            let count = squares.clone().count();
            (count >= config.least_rows).then(|| squares.sum::<f64>() / count as f64)
        };
        let calm = scatter(0).or_else(|| scatter(1)).unwrap_or(f64::INFINITY);
        Self { driven: DRIVEN.map(|which| scatter(which).unwrap_or(calm)), calm }
    }

    /// What powering and braking scatter beyond coasting, standard deviations, N/kg.
    pub fn beyond_n_per_kg(&self) -> [f64; 2] {
        self.driven.map(|driven| (driven - self.calm).max(0.0).sqrt())
    }

    /// So many times wider than coasting do powering and braking scatter.
    fn wider(&self) -> [f64; 2] {
        self.driven.map(|driven| if self.calm > 0.0 && driven > self.calm { (driven / self.calm).sqrt() } else { 1.0 })
    }
}

/// How many times wider than one of coasting each row scatters, by its regime.
pub fn wider(rows: &[Row], config: &EvidenceConfig) -> Vec<f64> {
    let residuals: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
    let wider = Scatter::of(rows, &residuals, config).wider();
    let of = |row: &Row| DRIVEN.iter().zip(wider).find(|(which, _)| **which == regime(row, config));
    rows.iter().map(|row| of(row).map_or(1.0, |(_, wider)| wider)).collect()
}

/// Sizes of the two habits where nothing but the scatter is known: what names are tried against. `beyond_n_per_kg`: as
/// [`Scatter::beyond_n_per_kg`] has it.
pub fn judged(beyond_n_per_kg: &[f64; 2], config: &EvidenceConfig) -> [f64; 2] {
    [config.powering_habit * beyond_n_per_kg[0], config.braking_habit * beyond_n_per_kg[1]]
}

/// Forces, and to which of the two habits each belongs: each habit everywhere and along the line, that of braking along
/// the speed, too, because a brake is applied at high speed and released at low.
pub fn forces(rows: &[Row], config: &EvidenceConfig) -> Vec<(Vec<f64>, usize)> {
    let mut all = Vec::new();
    for (habit, which) in DRIVEN.iter().enumerate() {
        let force = |row: &Row| f64::from(regime(row, config) == *which);
        all.push((rows.iter().map(force).collect(), habit));
        all.extend(along(Coordinate::Location, config.location_knots, rows, force).map(|column| (column, habit)));
        if *which < 0 {
            all.extend(along(Coordinate::Speed, config.knots, rows, force).map(|column| (column, habit)));
        }
    }
    all
}

/// What the sensor of the effort is off by along the speed, beside its gain; with standard deviations.
pub fn gains(rows: &[Row], config: &GapConfig) -> Vec<(Vec<f64>, f64)> {
    let evidence = &config.evidence;
    let of_regime = |which: &i8| -> Vec<_> {
        let effort = |row: &Row| if regime(row, evidence) == *which { row.effort_n_per_kg } else { 0.0 };
        along(Coordinate::Speed, evidence.knots, rows, effort).map(|column| (column, config.traction.sensor)).collect()
    };
    DRIVEN.iter().flat_map(of_regime).collect()
}

/// What acts, divided into parts along a coordinate that hold as many rows each.
fn along(which: Coordinate, count: usize, rows: &[Row], acts: impl Fn(&Row) -> f64) -> impl Iterator<Item = Vec<f64>> {
    let at = move |row: &Row| in_the_middle(which, row);
    let edges = knots(rows.iter().filter(|row| acts(row) != 0.0).filter_map(at), count);
    let last = edges.last().copied();
    let of_part = move |pair: [f64; 2]| {
        let here =
            |row: &Row| at(row).is_some_and(|at| pair[0] <= at && (at < pair[1] || last == Some(at) && at == pair[1]));
        rows.iter().map(|row| if here(row) { acts(row) } else { 0.0 }).collect()
    };
    let pairs: Vec<[f64; 2]> = edges.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    pairs.into_iter().map(of_part)
}
