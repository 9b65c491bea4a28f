//! The wind of a single run, from its own residuals.
//!
//! ```text
//! e = residual - effects = r2 (2 v w + w²)        w: headwind of the run, prior 0 with the spread between runs
//! ```

use crate::data::{believed::Believed, rows::Row};
use crate::noise::whitening::Noise;
use rundown::model::effects::Effects;

/// Headwind against travel and its standard deviation, m/s.
pub fn own_wind<'a>(
    rows: impl Iterator<Item = &'a Row> + Clone,
    believed: &Believed<'_>,
    effects: &Effects,
    noise: &Noise,
    spread_mps: f64,
) -> (f64, f64) {
    let r2 = believed.train().davis().r2;
    let mut wind = (0.0, spread_mps);
    // The square of the wind is small: a few rounds settle it.
    for _ in 0..3 {
        let (mut information, mut score) = (spread_mps.powi(-2), 0.0);
        for row in rows.clone() {
            let interval = &row.interval;
            let error = row.residual_n_per_kg - of_effects(row, believed, effects);
            let slope = r2 * (2.0 * interval.mean_speed_mps() + wind.0);
            let variance = 2.0 * (noise.reading_mps / interval.dt_s).powi(2) + noise.disturbance(interval);
            information += slope * slope / variance;
            score += slope * error / variance;
        }
        wind = (score / information, information.powf(-0.5));
    }
    wind
}

fn of_effects(row: &Row, believed: &Believed<'_>, effects: &Effects) -> f64 {
    let line = believed.line(row.direction);
    row.interval.mean(|point| effects.resistance_n_per_kg(line, &line.train.davis(), &row.moment(point)))
}
