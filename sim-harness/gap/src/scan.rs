//! The best section of the line for a term.
//!
//! A section's column is the difference of two cumulative columns (all of the line before `to` minus all before `from`), so one Gram matrix of
//! cumulative columns scores every section.

use super::fit::Base;
use super::rows::Row;
use super::terms::{Context, Term};
use super::whitening::Whitening;
use nalgebra::{DMatrix, DVector};

/// What acts within a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Drag with v².
    Tunnel,
    /// A gradient.
    Gradient,
    /// A constant resistance.
    Bump,
}

impl Kind {
    /// The term of a section.
    pub fn term(self, section: [f64; 2]) -> Term {
        match self {
            Self::Tunnel => Term::Tunnel(section),
            Self::Gradient => Term::Gradient(section),
            Self::Bump => Term::Bump(section),
        }
    }
}

/// Spacing of the edges that are tried, m.
const EDGE_M: f64 = 100.0;
/// Most edges.
const MOST_EDGES: f64 = 400.0;
/// Shortest section, m.
const SHORTEST_M: f64 = 300.0;
/// Longest section, as a share of the line: more is no matter of place.
const LONGEST_SHARE: f64 = 0.4;

/// A section with a smaller share of its information beside the model is the model's own.
const LEAST_INFORMATION: f64 = 1e-6;
/// A section that gains by less is the same.
const LEAST_GAIN: f64 = 1e-6;

/// Cumulative columns of one kind, whitened.
#[derive(Clone, Debug)]
pub struct Scan {
    kind: Kind,
    edges_m: Vec<f64>,
    columns: DMatrix<f64>,
    gram: DMatrix<f64>,
}

impl Scan {
    /// What acts.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Prepares the scan over the part of the line that was travelled.
    pub fn new(kind: Kind, context: &Context<'_>, rows: &[Row], whitening: &Whitening) -> Self {
        let length_m = context.believed.train().length_m();
        let at = rows.iter().flat_map(|row| row.interval.path.iter().map(|p| p.location_m));
        let (low, high) = at.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), m| (l.min(m), h.max(m)));
        let low = ((low - length_m) / EDGE_M).floor() * EDGE_M;
        let high = high + length_m;
        let step_m = (((high - low) / MOST_EDGES / EDGE_M).ceil() * EDGE_M).max(EDGE_M);
        let edges_m: Vec<f64> = (0..).map(|i| low + f64::from(i) * step_m).take_while(|e| *e < high + step_m).collect();
        let columns: Vec<DVector<f64>> = edges_m
            .iter()
            .map(|edge| {
                let column = kind.term([low - 1.0, *edge]).columns(context, rows);
                whitening.whiten(&column[0])
            })
            .collect();
        let columns = DMatrix::from_columns(&columns);
        let gram = columns.transpose() * &columns;
        Self { kind, edges_m, columns, gram }
    }

    /// The best section beside the current model, edges on the grid, with its naive gain.
    pub fn best(&self, base: &Base) -> Option<([f64; 2], f64)> {
        let with_residual = self.columns.transpose() * &base.residual;
        let gram = base.project(&self.columns, &self.gram);
        let mut best = None;
        let longest_m = LONGEST_SHARE * (self.edges_m[self.edges_m.len() - 1] - self.edges_m[0]);
        for a in 0..self.edges_m.len() {
            for b in a + 1..self.edges_m.len() {
                let length_m = self.edges_m[b] - self.edges_m[a];
                if !(SHORTEST_M..=longest_m).contains(&length_m) {
                    continue;
                }
                let information = gram[(a, a)] + gram[(b, b)] - 2.0 * gram[(a, b)];
                let score = with_residual[b] - with_residual[a];
                if information <= LEAST_INFORMATION * (self.gram[(b, b)] + self.gram[(a, a)]) {
                    continue;
                }
                let gain = 0.5 * score * score / information;
                if best.is_none_or(|(_, most)| gain > most) {
                    best = Some(([self.edges_m[a], self.edges_m[b]], gain));
                }
            }
        }
        best
    }

    /// Sections on the grid that lose less than `loss` of a gain of log-likelihood, with their coefficients and what they lose.
    pub fn within(&self, base: &Base, gain: f64, loss: f64) -> Vec<([f64; 2], f64, f64)> {
        let with_residual = self.columns.transpose() * &base.residual;
        let gram = base.project(&self.columns, &self.gram);
        let mut within = Vec::new();
        for a in 0..self.edges_m.len() {
            for b in a + 1..self.edges_m.len() {
                let information = gram[(a, a)] + gram[(b, b)] - 2.0 * gram[(a, b)];
                let beta = (with_residual[b] - with_residual[a]) / information;
                let lost = gain - 0.5 * beta * beta * information;
                if information > 0.0 && lost < loss {
                    within.push(([self.edges_m[a], self.edges_m[b]], beta, lost.max(0.0)));
                }
            }
        }
        within
    }

    /// The same with edges refined below the grid: a cumulative column between two edges is, within a train's length, the straight line between theirs.
    pub fn refined(&self, base: &Base) -> Option<[f64; 2]> {
        let with_residual = self.columns.transpose() * &base.residual;
        let gram = base.project(&self.columns, &self.gram);
        let (mut section, _) = self.best(base)?;
        let last = self.edges_m.len() - 2;
        let weights = |edge_m: f64| {
            let i = self.edges_m.partition_point(|e| *e <= edge_m).saturating_sub(1).min(last);
            let t = (edge_m - self.edges_m[i]) / (self.edges_m[i + 1] - self.edges_m[i]);
            [(i, 1.0 - t), (i + 1, t)]
        };
        let gain = |section: [f64; 2]| {
            let (from, to) = (weights(section[0]), weights(section[1]));
            let terms = [(from[0].0, -from[0].1), (from[1].0, -from[1].1), to[0], to[1]];
            let score: f64 = terms.iter().map(|(i, w)| w * with_residual[*i]).sum();
            let squared = |gram: &DMatrix<f64>| -> f64 {
                terms
                    .iter()
                    .flat_map(|(i, a)| terms.iter().map(move |(j, b)| (i, j, a * b)))
                    .map(|(i, j, w)| w * gram[(*i, *j)])
                    .sum()
            };
            let information = squared(&gram);
            // Nearly nothing beside the model: what it brings is rounding.
            if information > LEAST_INFORMATION * squared(&self.gram) { 0.5 * score * score / information } else { 0.0 }
        };
        let mut most = gain(section);
        let mut step_m = 0.5 * (self.edges_m[1] - self.edges_m[0]);
        while step_m > 5.0 {
            let mut moved = false;
            for edge in 0..2 {
                for by in [step_m, -step_m] {
                    let mut other = section;
                    other[edge] += by;
                    let on_grid = self.edges_m[0]..=self.edges_m[last + 1];
                    if other[1] - other[0] < SHORTEST_M || !on_grid.contains(&other[edge]) {
                        continue;
                    }
                    let now = gain(other);
                    if now > most + LEAST_GAIN {
                        (section, most, moved) = (other, now, true);
                    }
                }
            }
            if !moved {
                step_m *= 0.5;
            }
        }
        Some(section)
    }
}
