//! The best section of the line for a term.
//!
//! A section's column is the difference of two cumulative columns (all of the line before `to` minus all before
//! `from`), so one Gram matrix of cumulative columns scores every section.

use crate::candidate::{Shape, Term};
use crate::config::SearchConfig;
use crate::data::{believed::Context, rows::Row};
use crate::fit::{ANYWHERE, Base, Climb};
use crate::noise::whitening::Whitening;
use nalgebra::{DMatrix, DVector};
use rundown_files::statistics::sorted;

/// A section with a smaller share of its information beside the model is the model's own.
const LEAST_INFORMATION: f64 = 1e-6;
/// A section that gains by less is the same.
const LEAST_GAIN: f64 = 1e-6;

/// Cumulative columns of one kind, whitened.
#[derive(Clone, Debug)]
pub struct Scan {
    pub term: Term,
    config: SearchConfig,
    edges_m: Vec<f64>,
    /// Where the rows lie, in order.
    middles_m: Vec<f64>,
    columns: DMatrix<f64>,
    gram: DMatrix<f64>,
}

/// No part of the line: any is wider.
const NOWHERE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// A term on all of the line before an edge, row by row. Only rows whose train stands across the edge are computed for
/// each.
struct Cumulative<'a> {
    term: &'a Term,
    context: &'a Context<'a>,
    rows: &'a [Row],
    from_m: f64,
    /// What the term is on the whole line.
    whole: Vec<f64>,
    /// Between which locations the train is in each row, at most.
    reach_m: Vec<(f64, f64)>,
}

impl Cumulative<'_> {
    fn before(&self, edge_m: f64) -> Vec<f64> {
        let term = self.term.with(Shape::Section([self.from_m, edge_m]));
        let across = |(low, high): &(f64, f64)| *low < edge_m && edge_m < *high;
        let mut column = Vec::with_capacity(self.rows.len());
        for near in self.reach_m.chunk_by(|a, b| across(a) == across(b)) {
            let rows = column.len()..column.len() + near.len();
            if across(&near[0]) {
                column.extend_from_slice(&term.columns(self.context, &self.rows[rows])[0]);
            } else {
                let behind =
                    |(row, (_, high)): (usize, &(f64, f64))| if *high <= edge_m { self.whole[row] } else { 0.0 };
                column.extend(rows.zip(near).map(behind));
            }
        }
        column
    }
}

impl Scan {
    /// Prepares the scan over the part of the line that was travelled.
    pub fn new(term: Term, context: &Context<'_>, rows: &[Row], whitening: &Whitening) -> Self {
        let config = context.config.search.clone();
        let edge_m = config.edge_m;
        let length_m = context.believed.train().length_m();
        let wider = |(low, high): (f64, f64), (from, to): (f64, f64)| (low.min(from), high.max(to));
        let reach = |row: &Row| {
            let at = row.interval.path.iter().map(|p| (p.location_m - length_m, p.location_m + length_m));
            at.fold(NOWHERE, wider)
        };
        let reach_m: Vec<(f64, f64)> = rows.iter().map(reach).collect();
        let (low, high) = reach_m.iter().copied().fold(NOWHERE, wider);
        let low = (low / edge_m).floor() * edge_m;
        let step_m = (((high - low) / config.most_edges / edge_m).ceil() * edge_m).max(edge_m);
        let edges_m: Vec<f64> = (0..).map(|i| low + f64::from(i) * step_m).take_while(|e| *e < high + step_m).collect();
        let (from_m, to_m) = (low - 1.0, edges_m[edges_m.len() - 1] + step_m);
        let whole = term.with(Shape::Section([from_m, to_m])).columns(context, rows).remove(0);
        let cumulative = Cumulative { term: &term, context, rows, from_m, whole, reach_m };
        let columns: Vec<DVector<f64>> =
            edges_m.iter().map(|edge| whitening.whiten(&cumulative.before(*edge))).collect();
        let columns = DMatrix::from_columns(&columns);
        let gram = columns.transpose() * &columns;
        let middles_m = sorted(rows.iter().map(|row| row.interval.middle().location_m));
        Self { term, config, edges_m, middles_m, columns, gram }
    }

    /// Rows lie in it: the ends of trains that coast beside a section say little of it, and it may explain any of them.
    fn is_seen(&self, [from_m, to_m]: [f64; 2]) -> bool {
        let before = |edge_m: f64| self.middles_m.partition_point(|middle_m| *middle_m < edge_m);
        before(to_m) - before(from_m) >= self.config.least_in_section
    }

    /// The columns times the residual, and their Gram matrix, beside the current model.
    fn beside(&self, base: &Base) -> (DVector<f64>, DMatrix<f64>) {
        (self.columns.tr_mul(&base.residual), base.project(&self.columns, &self.gram))
    }

    /// The best section beside the current model, edges on the grid, with its naive gain.
    fn best(&self, (with_residual, gram): &(DVector<f64>, DMatrix<f64>)) -> Option<([f64; 2], f64)> {
        let mut best = None;
        let longest_m = self.config.longest_share * (self.edges_m[self.edges_m.len() - 1] - self.edges_m[0]);
        for a in 0..self.edges_m.len() {
            for b in a + 1..self.edges_m.len() {
                let length_m = self.edges_m[b] - self.edges_m[a];
                let section = [self.edges_m[a], self.edges_m[b]];
                if !(self.config.shortest_m..=longest_m).contains(&length_m) || !self.is_seen(section) {
                    continue;
                }
                let information = gram[(a, a)] + gram[(b, b)] - 2.0 * gram[(a, b)];
                let score = with_residual[b] - with_residual[a];
                if information <= LEAST_INFORMATION * (self.gram[(b, b)] + self.gram[(a, a)]) {
                    continue;
                }
                let gain = 0.5 * score * score / information;
                if best.is_none_or(|(_, most)| gain > most) {
                    best = Some((section, gain));
                }
            }
        }
        best
    }

    /// Sections on the grid that lose less than `loss` of a gain of log-likelihood, with their coefficients and what
    /// they lose.
    pub fn within(&self, base: &Base, gain: f64, loss: f64) -> Vec<([f64; 2], f64, f64)> {
        let (with_residual, gram) = self.beside(base);
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

    /// The same with edges refined below the grid: a cumulative column between two edges is, within a train's length,
    /// the straight line between theirs.
    pub fn refined(&self, base: &Base) -> Option<[f64; 2]> {
        let beside = self.beside(base);
        let (section, _) = self.best(&beside)?;
        let (with_residual, gram) = &beside;
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
            let information = squared(gram);
            // Nearly nothing beside the model: what it brings is rounding.
            if information > LEAST_INFORMATION * squared(&self.gram) { 0.5 * score * score / information } else { 0.0 }
        };
        let on_grid = self.edges_m[0]..=self.edges_m[last + 1];
        let step_m = 0.5 * (self.edges_m[1] - self.edges_m[0]);
        let climb = Climb {
            steps: [step_m; 2],
            shrink: 0.5,
            rounds: 0,
            least: 5.0,
            better: LEAST_GAIN,
            first: 1.0,
            both: false,
            range: ANYWHERE,
        };
        let allowed = |section: &[f64; 2]| {
            let is_long = section[1] - section[0] >= self.config.shortest_m;
            is_long && section.iter().all(|edge| on_grid.contains(edge)) && self.is_seen(*section)
        };
        let at = |section: [f64; 2]| allowed(&section).then(|| gain(section));
        Some(climb.from(section, at).0)
    }
}
