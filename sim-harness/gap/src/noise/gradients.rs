//! Small errors of the described gradients: a random effect of place, which all runs share and which turns with the
//! direction of travel.
//!
//! ```text
//! y_i = ... + ±g/γ e(s_i)        cov(e(s), e(s')) = τ² exp(-|s - s'| / L)
//! ```
//!
//! with s the middle of the train. [`super::gradient_errors`] has τ.

use crate::data::{believed::Context, rows::Row};
use rundown_files::statistics::extremes;

/// Errors of the described gradients, as far as the places of a line show them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Standard deviation of those that are surely there, permille; 0: none.
    pub sd_permille: f64,
    /// Probability that there are typical ones, where none are sure.
    pub may_be: f64,
}

/// The middle of the train at the middle of an interval, m along the line, and the force of a permille there, N/kg.
pub fn at(context: &Context<'_>, row: &Row) -> (f64, f64) {
    let (train, sign) = (context.believed.train(), row.direction.sign());
    let middle_m = row.interval.middle().location_m - 0.5 * sign * train.length_m();
    (middle_m, 1e-3 * sign * train.gravity_n_per_kg())
}

/// Columns of independent errors of a permille, from which those of the line are made.
pub fn columns(context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
    let config = &context.config.gradients;
    let places: Vec<(f64, f64)> = rows.iter().map(|row| at(context, row)).collect();
    let (from_m, to_m) = extremes(places.iter().map(|(at_m, _)| at_m));
    let step_m = config.step_m.max((to_m - from_m) / config.most_steps as f64);
    let count = ((to_m - from_m) / step_m).ceil().max(1.0) as usize + 1;
    let alike = (-step_m / config.alike_m).exp();
    let mut all = vec![vec![0.0; rows.len()]; count];
    for (row, (at_m, force)) in places.into_iter().enumerate() {
        let before = ((at_m - from_m) / step_m).floor().clamp(0.0, (count - 2) as f64) as usize;
        let beyond = (at_m - from_m) / step_m - before as f64;
        // What is new at each knot lives on behind it, a little less at each.
        for (knot, column) in all.iter_mut().enumerate().take(before + 2) {
            let new = if knot == 0 { 1.0 } else { (1.0 - alike * alike).sqrt() };
            let at = |which: usize| if which < knot { 0.0 } else { new * alike.powi((which - knot) as i32) };
            column[row] = force * ((1.0 - beyond) * at(before) + beyond * at(before + 1));
        }
    }
    all
}
