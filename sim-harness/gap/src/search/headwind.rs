//! The headwind column as a reference for the wind: how much of the residuals it explains, and whether they fit just as
//! much of it.
//!
//! ```text
//! residual + wind = s wind + effects + noise        wind: r2 ((v + w)|v + w| - v²), w measured
//! ```
//!
//! The forward model has taken the wind off with s = 1. What is left is fitted beside the effects: s = 1 where sensor,
//! sign and r2 are right.

use crate::candidate::Term;
use crate::data::believed::{Context, wind_n_per_kg};
use crate::data::rows::Row;
use crate::search::fits::Search;
use rundown_check::figure::HALF_95;
use rundown_files::statistics::rms;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headwind {
    /// Intervals with a measured wind.
    pub rows: usize,
    /// Root mean square of their residuals in still air, N/kg.
    pub before_n_per_kg: f64,
    /// The same at the air speed.
    pub after_n_per_kg: f64,
    /// Share of the measured wind that the residuals fit, and its 95 % interval.
    pub scale: (f64, [f64; 2]),
}

impl Headwind {
    pub fn agrees(&self) -> bool {
        let (_, [low, high]) = self.scale;
        (low..=high).contains(&1.0)
    }
}

/// What the measured wind adds to the resistance in each row, N/kg; 0 where it is not measured.
fn column(context: &Context<'_>, rows: &[Row]) -> Vec<f64> {
    let of_row = |row: &Row| {
        let line = context.believed.line(row.direction);
        let wind = |wind_mps| row.interval.mean(|p| wind_n_per_kg(line, p.speed_mps, wind_mps));
        row.interval.wind_mps.map_or(0.0, wind)
    };
    rows.iter().map(of_row).collect()
}

/// `None`: no wind is measured, or no other than none. `model`: the effects that were found.
pub fn headwind(search: &Search<'_>, model: &[Term]) -> Option<Headwind> {
    let column = column(search.context, search.rows);
    let gain = search.base(model)?.gain(&[search.whitening.whiten(&column)])?;
    let scale = 1.0 + gain.beta.iter().next()?;
    let sd = gain.naive[(0, 0)].max(gain.robust[(0, 0)]).sqrt().hypot(search.context.config.certainty.law * scale);
    let measured = search.rows.iter().zip(&column).filter(|(row, _)| row.interval.wind_mps.is_some());
    let measured: Vec<(f64, f64)> = measured.map(|(row, wind)| (row.residual_n_per_kg, *wind)).collect();
    column.iter().any(|wind| *wind != 0.0).then(|| Headwind {
        rows: measured.len(),
        before_n_per_kg: rms(measured.iter().map(|(left, wind)| left + wind)),
        after_n_per_kg: rms(measured.iter().map(|(left, _)| left)),
        scale: (scale, [scale - HALF_95 * sd, scale + HALF_95 * sd]),
    })
}
