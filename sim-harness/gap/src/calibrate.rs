//! The noise of a data set, found from the data.
//!
//! Maximum likelihood over reading error, disturbance, share of effort changes, and what each run has for itself, beside a model flexible enough to
//! take up any effect. Outliers are given a wider spread instead of being dropped.

use super::fit::Base;
use super::rows::Row;
use super::runs::Interval;
use super::terms::{Context, Coordinate, Term, both_directions};
use super::whitening::{Noise, Whitening};
use nalgebra::{DMatrix, DVector};

/// What differs from run to run, standard deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Own {
    /// A constant resistance, N/kg.
    pub constant_n_per_kg: f64,
    /// Wind along the line, m/s.
    pub wind_mps: f64,
    /// Mass, or gain of the measured effort: a share of u - r2 v².
    pub mass: f64,
}

/// The noise of a data set.
#[derive(Clone, Debug, Default)]
pub struct Calibrated {
    /// Of rows.
    pub noise: Noise,
    /// Of runs.
    pub own: Own,
    /// Factor on the standard deviation of each row.
    pub spread: Vec<f64>,
}

/// Beyond this many standard deviations a row is an outlier.
const OUTLIER: f64 = 3.5;
/// Where the flexible model takes so much of the rows, its freedom hides what differs between runs: then the restricted likelihood is worth its time.
const FEW: f64 = 1.05;
/// Knots of the flexible model along the location, and rows for each.
const KNOTS: (usize, usize) = (5, 30);
const ROWS_A_KNOT: usize = 20;

impl Calibrated {
    /// The whitening of these rows.
    pub fn whitening(&self, context: &Context<'_>, rows: &[Row]) -> Whitening {
        whitening(&self.noise, &self.own, &self.spread, rows, &own_columns(context, rows))
    }
}

/// Columns of what each run has for itself: constant, wind, mass.
pub fn own_columns(context: &Context<'_>, rows: &[Row]) -> [Vec<f64>; 3] {
    let one = |term: Term| term.columns(context, rows).swap_remove(0);
    let (wind, mass) = (one(Term::Wind(0.0)), one(Term::Mass));
    [vec![1.0; rows.len()], wind, mass]
}

/// The whitening under a noise, by what each run has for itself.
pub fn whitening(noise: &Noise, own: &Own, spread: &[f64], rows: &[Row], columns: &[Vec<f64>; 3]) -> Whitening {
    let intervals: Vec<&Interval> = rows.iter().map(|row| &row.interval).collect();
    let [constant, wind, mass] = columns;
    Whitening::new(&intervals, noise, spread).with_own(&[
        (constant, own.constant_n_per_kg),
        (wind, own.wind_mps),
        (mass, own.mass),
    ])
}

/// Knots between the smallest and the largest value, equally filled.
pub fn knots(values: impl Iterator<Item = f64>, count: usize) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.is_empty() {
        return Vec::new();
    }
    let mut knots: Vec<f64> = (0..count).map(|i| sorted[i * (sorted.len() - 1) / (count - 1).max(1)]).collect();
    knots.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    knots
}

/// Finds the noise of these rows. `measured`: the effort is measured, so its gain may differ from run to run.
/// `wind` allows a wind of its own to each run. Also the log-likelihood reached.
pub fn calibrate(context: &Context<'_>, rows: &[Row], measured: bool, wind: bool, model: &[Term]) -> (Calibrated, f64) {
    let columns = own_columns(context, rows);
    let flexible = flexible(context, rows, model);
    let y: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
    let mut found = Calibrated {
        noise: Noise { reading_mps: 0.08, acceleration_mps2: 0.003, change_share: if measured { 0.3 } else { 0.0 } },
        own: Own::default(),
        spread: vec![1.0; rows.len()],
    };
    // The flexible model is taken out once a round, under the noise found so far; what is left, widened for what it took, is judged.
    let left = |found: &Calibrated| {
        left_of(&y, &flexible, &whitening(&found.noise, &found.own, &found.spread, rows, &columns))
    };
    let freedom = freedom(rows, &flexible);
    let few = freedom > FEW;
    let likelihood = |noise: &Noise, own: &Own, spread: &[f64], residual: &[f64]| {
        let whitening = whitening(noise, own, spread, rows, &columns);
        if few {
            return restricted(&y, &flexible, &whitening);
        }
        -whitening.log_determinant() - 0.5 * freedom * whitening.whiten(residual).norm_squared()
    };
    // In coasting a wind looks like a constant and a mass together, larger ones than runs of one train have. With an effort column they are its zero and gain, too.
    let most_own = if measured { [0.05, 0.2] } else { [1e-3, 0.04] };
    let mut reached = f64::NEG_INFINITY;
    for round in 0..3 {
        let Some((residual, _)) = left(&found) else {
            return (found, reached);
        };
        let mut best = likelihood(&found.noise, &found.own, &found.spread, &residual);
        let mut factor: f64 = if round == 0 { 2.0 } else { 1.4 };
        let mut own_zero = [false; 3];
        while factor > 1.07 {
            let mut moved = false;
            for which in 0..6 {
                if which == 2 && !measured || which == 4 && !wind || which >= 3 && round == 0 {
                    continue;
                }
                for step in [factor, 1.0 / factor] {
                    let (mut noise, mut own) = (found.noise, found.own);
                    let (value, start, most) = match which {
                        0 => (&mut noise.reading_mps, 0.08, 1.0),
                        1 => (&mut noise.acceleration_mps2, 0.003, 0.2),
                        2 => (&mut noise.change_share, 0.3, 2.0),
                        3 => (&mut own.constant_n_per_kg, 5e-4, most_own[0]),
                        4 => (&mut own.wind_mps, 0.5, 20.0),
                        _ => (&mut own.mass, 5e-3, most_own[1]),
                    };
                    if which >= 3 && *value == 0.0 {
                        if own_zero[which - 3] || step < 1.0 {
                            continue;
                        }
                        *value = start;
                    } else {
                        *value = (*value * step).min(most);
                        if which >= 3 && *value < 0.1 * start {
                            *value = 0.0;
                        }
                    }
                    let now = likelihood(&noise, &own, &found.spread, &residual);
                    if now > best + 1e-3 {
                        best = now;
                        (found.noise, found.own) = (noise, own);
                        moved = true;
                        break;
                    } else if which >= 3 {
                        own_zero[which - 3] |= match which {
                            3 => found.own.constant_n_per_kg == 0.0,
                            4 => found.own.wind_mps == 0.0,
                            _ => found.own.mass == 0.0,
                        };
                    }
                }
            }
            if !moved {
                factor = factor.sqrt();
                own_zero = [false; 3];
            }
        }
        reached = best;
        if round < 2
            && let Some((_, residual)) = left(&found)
        {
            for (spread, e) in found.spread.iter_mut().zip(residual.iter()) {
                *spread = (*spread * e.abs() / OUTLIER).max(1.0);
            }
        }
    }
    (found, reached)
}

/// Restricted log-likelihood: of what is beyond the flexible model, whichever its coefficients are.
fn restricted(y: &[f64], flexible: &[Vec<f64>], whitening: &Whitening) -> f64 {
    let white: Vec<_> = flexible.iter().map(|c| whitening.whiten(c)).collect();
    let x = DMatrix::from_columns(&white);
    let y = whitening.whiten(y);
    let mut gram = x.transpose() * &x;
    for i in 0..gram.nrows() {
        gram[(i, i)] *= 1.0 + 1e-10;
    }
    let Some(cholesky) = gram.cholesky() else {
        return f64::NEG_INFINITY;
    };
    let with = x.transpose() * &y;
    let explained = with.dot(&cholesky.solve(&with));
    let log_root: f64 = cholesky.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
    -whitening.log_determinant() - log_root - 0.5 * (y.norm_squared() - explained)
}

/// What a flexible model leaves: as it is, and whitened.
fn left_of(y: &[f64], flexible: &[Vec<f64>], whitening: &Whitening) -> Option<(Vec<f64>, DVector<f64>)> {
    let white: Vec<_> = flexible.iter().map(|c| whitening.whiten(c)).collect();
    let base = Base::new(&whitening.whiten(y), &white, whitening.runs())?;
    let mut left = y.to_vec();
    for (column, beta) in flexible.iter().zip(base.beta.iter()) {
        left.iter_mut().zip(column).for_each(|(e, c)| *e -= beta * c);
    }
    Some((left, base.residual))
}

/// What is left is smaller by what the flexible model took: the factor on its squares.
fn freedom(rows: &[Row], flexible: &[Vec<f64>]) -> f64 {
    rows.len() as f64 / (rows.len() as f64 - flexible.len() as f64).max(1.0)
}

/// What a model flexible enough for any effect leaves of the residuals, and the factor on its squares.
pub fn left(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated, model: &[Term]) -> Option<(Vec<f64>, f64)> {
    let flexible = flexible(context, rows, model);
    let y: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
    let (left, _) = left_of(&y, &flexible, &calibrated.whitening(context, rows))?;
    Some((left, freedom(rows, &flexible)))
}

/// Columns that take up any effect: Davis, location, time, the known model, and effects of the effort.
fn flexible(context: &Context<'_>, rows: &[Row], model: &[Term]) -> Vec<Vec<f64>> {
    let of = |which| move |row: &Row| super::terms::coordinate(which, row, row.interval.middle());
    let count = (rows.len() / ROWS_A_KNOT).clamp(KNOTS.0, KNOTS.1);
    let location = knots(rows.iter().filter_map(of(Coordinate::Location)), count);
    let time = knots(rows.iter().filter_map(of(Coordinate::Time)), 6);
    let speed = knots(rows.iter().filter_map(of(Coordinate::Speed)), 6);
    let mut columns = Term::Smooth(Coordinate::Location, location).columns(context, rows);
    // One knot left out: the sum of all is the constant, which the location has.
    columns.extend(Term::Smooth(Coordinate::Time, time).columns(context, rows).into_iter().skip(1));
    columns.extend(Term::Smooth(Coordinate::Speed, speed).columns(context, rows).into_iter().skip(1));
    columns.extend(Term::Mass.columns(context, rows));
    if both_directions(rows) {
        let signed: Vec<Vec<f64>> =
            columns.iter().map(|c| c.iter().zip(rows).map(|(v, row)| v * row.direction.sign()).collect()).collect();
        columns.extend(signed);
    }
    for which in [Coordinate::Temperature, Coordinate::Day] {
        let at = knots(rows.iter().filter_map(of(which)), 4);
        columns.extend(Term::Smooth(which, at).columns(context, rows).into_iter().skip(1));
    }
    for term in model {
        columns.extend(term.columns(context, rows));
    }
    columns.retain(|c| c.iter().any(|v| *v != 0.0));
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::Believed;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};
    use rundown::model::direction::Direction;
    use rundown::model::track::{Gradient, Track};
    use rundown::model::train::{Train, TrainDescription};

    /// Noise of a reading, m/s.
    const READING_MPS: f64 = 0.08;

    /// What is found in 40 runs of which each coasts for six intervals, at any place and speed, in a wind of its own.
    fn found(wind_sd_mps: f64, seed: u64) -> Calibrated {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let level = Gradient { from_m: 0.0, permille: 0.0 };
        let track = Track::try_new(60_000.0, [level]).unwrap();
        let context = Context {
            believed: Believed::new(&train, &track),
            curves: &[],
            temperature_c: 10.0,
            first_day: 0.0,
            period_days: 40.0,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let unit = Normal::new(0.0, 1.0).unwrap();
        let mut rows = Vec::new();
        let mut winds = Vec::new();
        for run in 0..40 {
            let wind = wind_sd_mps * unit.sample(&mut rng);
            let directions = [Direction::Up, Direction::Down];
            let temperature_c = rng.random_range(0.0..20.0);
            for _ in 0..6 {
                let location_m = rng.random_range(0.0..60_000.0);
                let mut row = Row::coasting(directions[run % 2], location_m, rng.random_range(15.0..40.0));
                row.interval.run = run;
                row.interval.day = Some(run as f64);
                row.interval.temperature_c = Some(temperature_c);
                let slope = READING_MPS / row.interval.dt_s;
                row.residual_n_per_kg = slope * (unit.sample(&mut rng) - unit.sample(&mut rng));
                rows.push(row);
                winds.push(wind);
            }
        }
        let [_, against_wind, _] = own_columns(&context, &rows);
        for ((row, wind), column) in rows.iter_mut().zip(winds).zip(against_wind) {
            row.residual_n_per_kg += wind * column;
        }
        calibrate(&context, &rows, false, true, &[]).0
    }

    #[test]
    fn a_flexible_model_does_not_hide_the_winds_of_few_rows() {
        let found: Vec<Calibrated> = (0..6).map(|seed| found(1.5, seed)).collect();
        let mean = found.iter().map(|found| found.own.wind_mps).sum::<f64>() / 6.0;
        assert!((mean - 1.5).abs() < 0.3, "{mean}");
        let reading = found.iter().map(|found| found.noise.reading_mps).sum::<f64>() / 6.0;
        assert!((reading / READING_MPS - 1.0).abs() < 0.2, "{reading}");
    }

    #[test]
    fn no_wind_is_found_where_none_blows() {
        let winds: Vec<f64> = (0..12).map(|seed| found(0.0, seed).own.wind_mps).collect();
        let mean = winds.iter().sum::<f64>() / 12.0;
        assert!(mean < 0.5, "{winds:?}");
    }
}
