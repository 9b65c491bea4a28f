//! The noise of a data set, found from the data.
//!
//! Maximum likelihood over reading error, disturbance, share of effort changes, and per-run random effects, beside a
//! model flexible enough to take up any effect. Outliers are given a wider spread instead of being dropped.

use crate::candidate::{Shape, Term};
use crate::candidates::sensors::LOCATION_OFFSET;
use crate::columns::{self, both_directions, hats, in_the_middle, knots};
use crate::config::NoiseConfig;
use crate::data::{believed::Context, interval::Interval, rows::Row};
use crate::fit::{Base, explained};
use crate::noise::alike::Alike;
use crate::noise::gradients::{self, Errors};
use crate::noise::habits::{self, DRIVEN, Scatter, regime};
use crate::noise::whitening::{Noise, Whitening};
use nalgebra::{DMatrix, DVector};
use rundown::model::effects::Coordinate;

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

#[derive(Clone, Debug, Default)]
pub struct Calibrated {
    /// Of rows.
    pub noise: Noise,
    /// Of runs.
    pub own: Own,
    /// Factor on the standard deviation of each row.
    pub spread: Vec<f64>,
    /// What rows of powering and of braking scatter beyond those of coasting, standard deviations, N/kg.
    pub driven_n_per_kg: [f64; 2],
    /// What the described gradients are off by at most places.
    pub gradients: Errors,
}

impl Calibrated {
    /// One noise for that many rows, and no nuisance.
    #[cfg(test)]
    pub(crate) fn even(noise: Noise, rows: usize) -> Self {
        Self { noise, spread: vec![1.0; rows], ..Self::default() }
    }

    /// With the nuisances among which effects are looked for.
    pub fn whitening(&self, context: &Context<'_>, rows: &[Row]) -> Whitening {
        self.without_nuisances(context, rows).with_common(&self.common(context, rows))
    }

    /// With all that sensors of the effort do: that of the brake has a gain of its own, and each one by the speed.
    pub fn for_probes(&self, context: &Context<'_>, rows: &[Row]) -> Whitening {
        self.without_nuisances(context, rows).with_common(&self.of_sensors(context, rows))
    }

    /// With all that names are tried against: what drivers do between two readings, too.
    pub fn for_trials(&self, context: &Context<'_>, rows: &[Row]) -> Whitening {
        let mut common = self.of_sensors(context, rows);
        if has_efforts(rows) {
            let evidence = &context.config.evidence;
            let sizes = habits::judged(&self.driven_n_per_kg, evidence);
            common.extend(habits::forces(rows, evidence).into_iter().map(|(force, habit)| (force, sizes[habit])));
        }
        self.without_nuisances(context, rows).with_common(&common)
    }

    /// The same where a flexible model has gain and offset as well.
    pub fn without_nuisances(&self, context: &Context<'_>, rows: &[Row]) -> Whitening {
        let deviations = Deviations { noise: self.noise, own: self.own };
        whitening(&deviations, &self.spread, rows, &own_columns(context, rows))
    }

    /// Variance of the acceleration over the interval of a row, without the error of its readings, (m/s²)².
    pub fn disturbance(&self, context: &Context<'_>, row: &Row) -> f64 {
        let regime = regime(row, &context.config.evidence);
        let driven = DRIVEN.iter().zip(self.driven_n_per_kg).find(|(which, _)| **which == regime);
        self.noise.disturbance(&row.interval) + driven.map_or(0.0, |(_, sd)| sd * sd)
    }

    /// Gain of the effort column, if there is one, offset of the locations, and errors of the gradients, with the
    /// standard deviations of their priors.
    fn common(&self, context: &Context<'_>, rows: &[Row]) -> Vec<(Vec<f64>, f64)> {
        let config = &context.config.nuisance;
        let gain = has_efforts(rows).then(|| (effort(rows), config.effort_gain_sd));
        let offset = LOCATION_OFFSET.columns(&Shape::Law, context, rows).remove(0);
        let one_each = gain.into_iter().chain([(offset, config.location_offset_sd_m)]);
        let mut all: Vec<_> = one_each.chain(starting_gains(context, rows)).collect();
        if self.gradients.sd_permille > 0.0 {
            all.extend(
                gradients::columns(context, rows).into_iter().map(|column| (column, self.gradients.sd_permille)),
            );
        }
        all
    }

    /// The same with what the sensor of the effort is off by otherwise.
    fn of_sensors(&self, context: &Context<'_>, rows: &[Row]) -> Vec<(Vec<f64>, f64)> {
        let mut all = self.common(context, rows);
        if has_efforts(rows) {
            let braking = rows.iter().map(|row| row.effort_n_per_kg.min(0.0)).collect();
            all.push((braking, context.config.nuisance.brake_gain_sd));
            all.extend(habits::gains(rows, context.config));
        }
        all
    }
}

/// What the effort column is off by beside its gain in the first seconds after a start, at all speeds and rising with
/// the speed: how late it is there, and how a handle moves, is known to so much only, and the efforts are the largest
/// of all.
fn starting_gains(context: &Context<'_>, rows: &[Row]) -> Vec<(Vec<f64>, f64)> {
    let config = &context.config.interval;
    let starts = |row: &Row| if row.interval.dt_s < 1.5 * config.start_length_s { row.effort_n_per_kg } else { 0.0 };
    let by_speed = |row: &Row| starts(row) * (row.interval.mean_speed_mps() / config.start_mps - 1.0);
    let columns: [Vec<f64>; 2] = [rows.iter().map(starts).collect(), rows.iter().map(by_speed).collect()];
    columns.map(|column| (column, context.config.nuisance.starting_gain_sd)).into()
}

fn has_efforts(rows: &[Row]) -> bool {
    rows.iter().any(|row| row.interval.effort_n_per_kg.is_some())
}

/// What the gain of the effort column is a factor of: none without the column.
pub fn effort(rows: &[Row]) -> Vec<f64> {
    rows.iter().map(|row| row.effort_n_per_kg).collect()
}

/// Columns of the per-run random effects: constant, wind, mass.
pub fn own_columns(context: &Context<'_>, rows: &[Row]) -> [Vec<f64>; 3] {
    [vec![1.0; rows.len()], columns::wind(context, rows, 0.0), columns::mass(context, rows)]
}

#[derive(Clone, Copy, Debug)]
pub struct Deviations {
    /// Of rows.
    pub noise: Noise,
    /// Of runs.
    pub own: Own,
}

/// The whitening under a noise, by per-run random effects.
pub fn whitening(deviations: &Deviations, spread: &[f64], rows: &[Row], columns: &[Vec<f64>; 3]) -> Whitening {
    let intervals: Vec<&Interval> = rows.iter().map(|row| &row.interval).collect();
    let ([constant, wind, mass], own) = (columns, &deviations.own);
    Whitening::new(&intervals, &deviations.noise, spread).with_own(&[
        (constant, own.constant_n_per_kg),
        (wind, own.wind_mps),
        (mass, own.mass),
    ])
}

/// A standard deviation that is looked for.
struct Sought {
    start: f64,
    most: f64,
    /// It differs between runs, and may be none.
    between_runs: bool,
    of: fn(&mut Deviations) -> &mut f64,
}

impl Sought {
    /// `measured`: with an effort column, so its gain may differ from run to run. `wind`: a wind of its own to each
    /// run.
    fn all(config: &NoiseConfig, measured: bool, wind: bool) -> Vec<Self> {
        let of_rows = |start, most, of| Self { start, most, between_runs: false, of };
        let of_runs = |start, most, of| Self { start, most, between_runs: true, of };
        let (most_constant_n_per_kg, most_mass) = match measured {
            true => (config.most_constant_n_per_kg, config.most_mass),
            false => (config.most_coasting_constant_n_per_kg, config.most_coasting_mass),
        };
        let mut all = vec![
            of_rows(config.reading_mps, config.most_reading_mps, |at| &mut at.noise.reading_mps),
            of_rows(config.acceleration_mps2, config.most_acceleration_mps2, |at| &mut at.noise.acceleration_mps2),
        ];
        if measured {
            all.push(of_rows(config.change_share, config.most_change_share, |at| &mut at.noise.change_share));
        }
        all.push(of_runs(config.constant_n_per_kg, most_constant_n_per_kg, |at| &mut at.own.constant_n_per_kg));
        if wind {
            all.push(of_runs(config.wind_mps, config.most_wind_mps, |at| &mut at.own.wind_mps));
        }
        all.push(of_runs(config.mass, most_mass, |at| &mut at.own.mass));
        all
    }

    /// Moved by a factor. `None`: what is none becomes no smaller, nor does one that has been tried become any more.
    fn moved(&self, at: &Deviations, step: f64, is_zero: bool, least_share: f64) -> Option<Deviations> {
        let mut moved = *at;
        let value = (self.of)(&mut moved);
        if self.between_runs && *value == 0.0 {
            if is_zero || step < 1.0 {
                return None;
            }
            *value = self.start;
        } else {
            *value = (*value * step).min(self.most);
            if self.between_runs && *value < least_share * self.start {
                *value = 0.0;
            }
        }
        Some(moved)
    }
}

/// The likeliest deviations near these, moved by factors that become smaller.
fn climbed(
    sought: &[Sought],
    mut at: Deviations,
    mut factor: f64,
    least_share: f64,
    likelihood: impl Fn(&Deviations) -> f64,
) -> (Deviations, f64) {
    let mut best = likelihood(&at);
    let mut is_zero = vec![false; sought.len()];
    while factor > 1.07 {
        let mut moved = false;
        for (one, is_zero) in sought.iter().zip(&mut is_zero) {
            for step in [factor, 1.0 / factor] {
                let Some(tried) = one.moved(&at, step, *is_zero, least_share) else {
                    continue;
                };
                let now = likelihood(&tried);
                if now > best + 1e-3 {
                    (at, best, moved) = (tried, now, true);
                    break;
                }
                *is_zero |= one.between_runs && *(one.of)(&mut at) == 0.0;
            }
        }
        if !moved {
            factor = factor.sqrt();
            is_zero.fill(false);
        }
    }
    (at, best)
}

/// Finds the noise of these rows. `measured`: the effort is measured, so its gain may differ from run to run.
/// `wind` allows a wind of its own to each run. Also the log-likelihood reached.
pub fn calibrate(context: &Context<'_>, rows: &[Row], measured: bool, wind: bool, model: &[Term]) -> (Calibrated, f64) {
    let beside = flexible(context, rows, model);
    let (mut found, reached) = calibrate_beside(context, (rows, vec![1.0; rows.len()]), measured, wind, beside);
    if let Some(alike) = Alike::of(context, rows) {
        let wider = alike.wider(&found.noise);
        found.spread.iter_mut().zip(wider).for_each(|(spread, wider)| *spread *= wider);
    }
    (found, reached)
}

/// The same beside a flexible model with what else is known to differ. `spread`: how many times wider each row
/// scatters, as far as it is known.
pub fn calibrate_beside(
    context: &Context<'_>,
    (rows, mut spread): (&[Row], Vec<f64>),
    measured: bool,
    wind: bool,
    flexible: Vec<Vec<f64>>,
) -> (Calibrated, f64) {
    let config = &context.config.noise;
    let columns = own_columns(context, rows);
    let y: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
    let noise = Noise {
        reading_mps: config.reading_mps,
        acceleration_mps2: config.acceleration_mps2,
        change_share: if measured { config.change_share } else { 0.0 },
    };
    let mut at = Deviations { noise, own: Own::default() };
    let known = spread.clone();
    let freedom = freedom(rows, &flexible);
    let is_restricted = freedom > config.restricted_from;
    let mut reached = f64::NEG_INFINITY;
    let sought = Sought::all(config, measured, wind);
    for round in 0..3 {
        // The flexible model is taken out once a round, under the noise found so far; what is left, widened for what it
        // took, is evaluated.
        let Some((residual, _)) = left_of(&y, &flexible, &whitening(&at, &spread, rows, &columns)) else {
            break;
        };
        let likelihood = |tried: &Deviations| {
            let whitening = whitening(tried, &spread, rows, &columns);
            if is_restricted {
                return restricted(&y, &flexible, &whitening);
            }
            -whitening.log_determinant() - 0.5 * freedom * whitening.whiten(&residual).norm_squared()
        };
        let now = if round == 0 { sought.iter().filter(|one| !one.between_runs).count() } else { sought.len() };
        let rows_first = sought.split_at(now).0;
        (at, reached) = climbed(rows_first, at, if round == 0 { 2.0 } else { 1.4 }, config.least_share, likelihood);
        if round < 2
            && let Some((_, residual)) = left_of(&y, &flexible, &whitening(&at, &spread, rows, &columns))
        {
            for ((spread, known), e) in spread.iter_mut().zip(&known).zip(residual.iter()) {
                *spread = (*spread * e.abs() / config.outlier).max(*known);
            }
        }
    }
    let driven_n_per_kg = match left_of(&y, &flexible, &whitening(&at, &spread, rows, &columns)) {
        Some((left, _)) if measured => Scatter::of(rows, &left, &context.config.evidence).beyond_n_per_kg(),
        _ => [0.0; 2],
    };
    (Calibrated { noise: at.noise, own: at.own, spread, driven_n_per_kg, gradients: Errors::default() }, reached)
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
    let Some((log_root, explained)) = explained(gram, &(x.transpose() * &y)) else {
        return f64::NEG_INFINITY;
    };
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
    let (left, _) = left_of(&y, &flexible, &calibrated.without_nuisances(context, rows))?;
    Some((left, freedom(rows, &flexible)))
}

/// Columns that take up any effect: Davis, location, time, the known model, and effects of the effort.
pub fn flexible(context: &Context<'_>, rows: &[Row], model: &[Term]) -> Vec<Vec<f64>> {
    let config = &context.config.noise;
    let along =
        |which, count| hats(which, &knots(rows.iter().filter_map(|row| in_the_middle(which, row)), count), rows);
    let count = (rows.len() / config.rows_a_knot).clamp(config.least_knots, config.most_knots);
    let mut columns = along(Coordinate::Location, count);
    // One knot left out: the sum of all is the constant, which the location has.
    columns.extend(along(Coordinate::Time, config.knots).into_iter().skip(1));
    columns.extend(along(Coordinate::Speed, config.knots).into_iter().skip(1));
    columns.push(columns::mass(context, rows));
    if both_directions(rows) {
        let signed: Vec<Vec<f64>> =
            columns.iter().map(|c| c.iter().zip(rows).map(|(v, row)| v * row.direction.sign()).collect()).collect();
        columns.extend(signed);
    }
    for which in [Coordinate::Temperature, Coordinate::Day] {
        columns.extend(along(which, config.run_knots).into_iter().skip(1));
    }
    columns.extend(braking(rows, config.knots));
    for term in model {
        columns.extend(term.columns(context, rows));
    }
    columns.retain(|c| c.iter().any(|v| *v != 0.0));
    columns
}

/// The effort of the brake, as a multiple for each range of the speeds at which trains brake: that of one that fades is
/// another at each.
fn braking(rows: &[Row], count: usize) -> Vec<Vec<f64>> {
    let speed = |row: &Row| in_the_middle(Coordinate::Speed, row);
    let braked = rows.iter().filter(|row| row.effort_n_per_kg < 0.0);
    let knots = knots(braked.filter_map(speed), count);
    if knots.is_empty() {
        return Vec::new();
    }
    let mut columns = hats(Coordinate::Speed, &knots, rows);
    for (effort, row) in columns.iter_mut().flat_map(|column| column.iter_mut().zip(rows)) {
        *effort *= row.effort_n_per_kg.min(0.0);
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};
    use rundown::model::direction::Direction;

    /// Noise of a reading, m/s.
    const READING_MPS: f64 = 0.08;

    /// What is found in 40 runs of which each coasts for six intervals, at any place and speed, in a wind of its own.
    fn found(wind_sd_mps: f64, seed: u64) -> Calibrated {
        on_a_level_line(40, |context| found_beside(context, wind_sd_mps, seed))
    }

    fn found_beside(context: &Context<'_>, wind_sd_mps: f64, seed: u64) -> Calibrated {
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
        let [_, against_wind, _] = own_columns(context, &rows);
        for ((row, wind), column) in rows.iter_mut().zip(winds).zip(against_wind) {
            row.residual_n_per_kg += wind * column;
        }
        calibrate(context, &rows, false, true, &[]).0
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

    #[test]
    fn a_brake_that_fades_is_neither_noise_nor_an_outlier() {
        on_a_level_line(30, |context| {
            let mut rng = ChaCha8Rng::seed_from_u64(9);
            let unit = Normal::new(0.0, 1.0).unwrap();
            let row = |i: usize| {
                let speed_mps = rng.random_range(8.0..38.0);
                let mut row = Row::coasting(Direction::Up, 900.0 * (i % 60) as f64, speed_mps);
                row.interval.run = i / 60;
                row.effort_n_per_kg = [0.0, 0.1, -0.5, 0.0, 0.05][i % 5];
                row.interval.effort_n_per_kg = Some(row.effort_n_per_kg);
                let fade = 0.35 * (speed_mps - 14.0).max(0.0) / 25.0;
                row.residual_n_per_kg = fade * row.effort_n_per_kg.min(0.0) + 0.002 * unit.sample(&mut rng);
                row
            };
            let rows: Vec<Row> = (0..30 * 60).map(row).collect();
            let (found, _) = calibrate(context, &rows, true, true, &[]);
            let wide = found.spread.iter().filter(|spread| **spread > 2.0).count();
            assert!(wide < 9 && found.driven_n_per_kg[1] < 0.01, "{wide} rows, {:?}", found.driven_n_per_kg);
        });
    }
}
