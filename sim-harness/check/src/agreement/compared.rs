//! Distance by location less distance by speed, and what scale, offset and skew explain of it.
//!
//! In: rows of a run. Out: differences between rows some seconds apart, and their fit with the noise that is most
//! likely.

use nalgebra::{Matrix3, Vector3};
use std::ops::RangeInclusive;

/// A row with everything that is compared: time, s, location in the direction of travel, m, speed reading, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time_s: f64,
    /// Location, growing in the direction of travel, m; no number where there is none.
    pub location_m: f64,
    /// Speed reading, m/s.
    pub speed_mps: f64,
}

/// For how long a difference holds a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HeldTime {
    /// Number of the difference.
    pub(crate) at: usize,
    /// Reading, m/s.
    pub(crate) speed_mps: f64,
    /// Time, s.
    pub(crate) held_s: f64,
}

/// Which share of its time each row is one of a held speed: none where the speed passes as fast as it passes one of its
/// neighbours.
pub(crate) fn held_shares(rows: &[Row]) -> Vec<f64> {
    let stretches: Vec<&[Row]> = rows.chunk_by(|a, b| a.speed_mps == b.speed_mps).collect();
    let begin_s = |i: usize| stretches.get(i).map(|stretch| stretch[0].time_s);
    let lasts_s = |i: usize| begin_s(i + 1).map_or(f64::INFINITY, |next_s| next_s - stretches[i][0].time_s);
    let mut shares = Vec::with_capacity(rows.len());
    for (i, stretch) in stretches.iter().enumerate() {
        let beside = i.checked_sub(1).zip(stretches.get(i + 1));
        let passing_s = beside.map_or(0.0, |(before, after)| {
            let steps = [stretches[before], after].map(|other| other[0].speed_mps - stretch[0].speed_mps);
            let passes = steps[0] * steps[1] < 0.0;
            if passes { lasts_s(before).min(lasts_s(i + 1)) } else { 0.0 }
        });
        let share = if stretch.len() > 1 { (1.0 - passing_s / lasts_s(i)).max(0.0) } else { 0.0 };
        shares.extend(std::iter::repeat_n(share, stretch.len()));
    }
    shares
}

/// Fewer differences say nothing.
const LEAST_PAIRS: usize = 20;
/// Time between two rows that are compared, s: what rounding leaves is correlated over seconds.
pub(crate) const PAIR_S: f64 = 5.0;
/// Slower readings are left out: a standing train has no rounding, a creeping one reads zero, m/s.
pub(crate) const SLOWEST_MPS: f64 = 1.5;
/// A train that loses speed faster brakes, m/s².
pub(crate) const BRAKES_MPS2: f64 = -0.2;
/// Fewer that are not bent do not say what the noise is.
const LEAST_STRAIGHT: f64 = 6.0;
/// Fits until the noise beside doubtful bends is known.
const PASSES: usize = 6;
/// A change of its variance that changes nothing any more.
const SETTLED: f64 = 1e-3;
/// Variance of a bend where bends count less, over the usual one.
const LESS_OF_BENDS: f64 = 4.0;
/// Innovations beyond so many standard deviations are drawn in to it.
const OUTLIER: f64 = 4.0;

/// Differences between picked rows, and the regressors.
#[derive(Clone, Default)]
pub(crate) struct Differences {
    /// Distance by location less that by speed, m.
    pub(crate) y: Vec<f64>,
    /// Distance by speed, m.
    pub(crate) by_speed: Vec<f64>,
    /// Time between the two rows, s.
    pub(crate) dt: Vec<f64>,
    /// By how much the way may be bent between rows far apart, m.
    bent_m: Vec<f64>,
    /// By how much it is longer than if it were bent steadily, m.
    at_once_m: Vec<f64>,
    /// What that adds to a variance, in units of the location's white noise.
    doubt: Vec<f64>,
    dv: Vec<f64>,
    /// Change of the acceleration, m/s².
    pub(crate) turns_mps2: Vec<f64>,
    /// Time of the later row, s.
    pub(crate) end_s: Vec<f64>,
    /// The difference before shares a row with this one.
    linked: Vec<bool>,
    /// Speeds that are held in the differences.
    pub(crate) held: Vec<HeldTime>,
}

impl Differences {
    /// `parts`: rows without a gap or a shift of the location between them.
    pub(crate) fn of(parts: &[Vec<Row>]) -> Self {
        let mut all = Self::default();
        for part in parts {
            all.take(part);
        }
        all
    }

    /// Doubts the bends beside a location noise of this variance, m². Whether there are any.
    fn doubt_bends(&mut self, variance: f64) -> bool {
        self.doubt = self.bent_m.iter().map(|bent_m| bent_m * bent_m / variance).collect();
        self.doubt.iter().any(|doubt| *doubt > 0.0)
    }

    /// Which share of its variance each has from noise, not from bends that count `less` than usual.
    fn straight(&self, ratio: f64, less: f64) -> Vec<f64> {
        let share = |(dt, doubt): (&f64, &f64)| {
            let noise = 2.0 + ratio * dt;
            noise / (noise + less * doubt)
        };
        self.dt.iter().zip(&self.doubt).map(share).collect()
    }

    /// Acceleration of each, m/s²: of short ones with their neighbours, for the steps of the speeds make as much.
    pub(crate) fn mps2(&self) -> Vec<f64> {
        let follows = |i: usize| self.linked.get(i) == Some(&true) && self.dt[i - 1].max(self.dt[i]) < 2.0 * PAIR_S;
        let of = |i: usize| {
            let near = i - usize::from(follows(i))..=i + usize::from(follows(i + 1));
            let [dv, dt] = [&self.dv, &self.dt].map(|of| of[near.clone()].iter().sum::<f64>());
            dv / dt
        };
        (0..self.y.len()).map(of).collect()
    }

    /// The way by speed where the acceleration is such, m; 0 elsewhere.
    pub(crate) fn way_where(&self, is: impl Fn(f64) -> bool) -> Vec<f64> {
        self.by_speed.iter().zip(self.mps2()).map(|(m, mps2)| if is(mps2) { *m } else { 0.0 }).collect()
    }

    /// What this scale, offset and skew leave of each, m.
    pub(crate) fn left_m(&self, beta: &Vector3<f64>) -> Vec<f64> {
        let Self { y, by_speed, dt, dv, .. } = self;
        (0..y.len()).map(|i| y[i] - beta[0] * by_speed[i] - beta[1] * dt[i] - beta[2] * dv[i]).collect()
    }

    /// Fewer say nothing.
    pub(crate) fn are_enough(&self) -> bool {
        self.y.len() >= LEAST_PAIRS
    }

    fn take(&mut self, part: &[Row]) {
        let shares = held_shares(part);
        let mut held: Vec<HeldTime> = Vec::new();
        let mut from = None;
        let mut from_mps2 = 0.0;
        let mut way = Way::default();
        let mut linked = false;
        for (i, row) in part.iter().enumerate() {
            if row.speed_mps < SLOWEST_MPS {
                (from, linked) = (None, false);
                continue;
            }
            let is_located = row.location_m.is_finite();
            let Some((begin, more)) = from.zip(i.checked_sub(1).and_then(|_| Way::between(part, i))) else {
                (from, way, linked) = (is_located.then_some(*row), Way::default(), false);
                from_mps2 = slope_at(part, i);
                held.clear();
                continue;
            };
            way.add(more);
            let half_s = 0.5 * (row.time_s - part[i - 1].time_s);
            let of = |j: usize| HeldTime { at: self.y.len(), speed_mps: part[j].speed_mps, held_s: half_s * shares[j] };
            held.extend([i - 1, i].map(of).iter().filter(|one| one.held_s > 0.0));
            let dt = row.time_s - begin.time_s;
            if dt >= PAIR_S && is_located {
                self.y.push(row.location_m - begin.location_m - way.by_speed_m);
                self.by_speed.push(way.by_speed_m);
                self.dt.push(dt);
                self.bent_m.push(way.bent_m);
                self.at_once_m.push(way.at_once_m);
                self.doubt.push(0.0);
                self.dv.push(row.speed_mps - begin.speed_mps);
                let mps2 = slope_at(part, i);
                self.turns_mps2.push(mps2 - from_mps2);
                from_mps2 = mps2;
                self.end_s.push(row.time_s);
                self.linked.push(linked);
                self.held.append(&mut held);
                (from, way, linked) = (Some(*row), Way::default(), true);
            }
        }
    }
}

/// Acceleration around a row, m/s².
fn slope_at(rows: &[Row], i: usize) -> f64 {
    let (before, after) = (rows[i.saturating_sub(1)], rows[(i + 1).min(rows.len() - 1)]);
    let dt = after.time_s - before.time_s;
    if dt > 0.0 { (after.speed_mps - before.speed_mps) / dt } else { 0.0 }
}

/// Beside a start or a stop rows farther apart are not compared: a bend of 1 m/s² makes a third of a metre in 2 s, 8 m
/// in 10 s.
const STRAIGHT_S: f64 = 2.0;

/// A smaller change of the acceleration is no driver's hand but power that fades, m/s².
const TURN_MPS2: f64 = 0.32;

/// Distance by speed between two rows, and by how much it may be bent if they are far apart, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Way {
    by_speed_m: f64,
    bent_m: f64,
    /// Longer than if it were bent steadily, m.
    at_once_m: f64,
}

impl Way {
    fn add(&mut self, more: Self) {
        self.by_speed_m += more.by_speed_m;
        self.bent_m += more.bent_m;
        self.at_once_m += more.at_once_m;
    }

    /// From row `i - 1` to row `i`: trapezium, bent as the neighbouring accelerations say; straight ones of a second
    /// are too long by two parts in ten thousand of a tram's hop. Between rows far apart it is bent at once, where a
    /// driver turns to the brake, or steadily, as the power fades or the brake is built up: half of both. Beside a
    /// start or a stop straight, or none: the train moved for a part of the time only, and the change of speed there is
    /// no acceleration.
    fn between(rows: &[Row], i: usize) -> Option<Self> {
        let (a, b) = (rows[i - 1], rows[i]);
        let dt = b.time_s - a.time_s;
        let straight_m = 0.5 * dt * (a.speed_mps + b.speed_mps);
        let slope = |a: &Row, b: &Row| (b.speed_mps - a.speed_mps) / (b.time_s - a.time_s);
        let around = i.checked_sub(2).and_then(|before| Some((&rows[before], rows.get(i + 1)?)));
        let is_far = dt > STRAIGHT_S;
        match around {
            Some((before, after)) if before.speed_mps.min(after.speed_mps) >= SLOWEST_MPS => {
                let [earlier, now, later] = [slope(before, &a), slope(&a, &b), slope(&b, after)];
                let steady_m = dt * dt / 24.0 * (earlier - later);
                // One acceleration up to a moment, the other behind it: the moment is where both together make the
                // change of the speed.
                let share = (later - now) / (later - earlier);
                let at_once_m = dt * dt / 2.0 * (earlier - later) * share * (1.0 - share);
                let is_hand = is_far && (earlier - later).abs() > TURN_MPS2 && (0.0..=1.0).contains(&share);
                let half_m = if is_hand { 0.5 * (at_once_m - steady_m) } else { 0.0 };
                let bend_m = steady_m + half_m;
                let bent_m = if is_far { bend_m.abs() + steady_m.abs() } else { 0.0 };
                Some(Self { by_speed_m: straight_m + bend_m, bent_m, at_once_m: half_m })
            }
            Some(_) if is_far => None,
            _ => Some(Self { by_speed_m: straight_m, ..Self::default() }),
        }
    }
}

/// Whitened residuals and regressors of one ratio of the two noises.
pub(crate) struct Fit {
    pub(crate) beta: Vector3<f64>,
    /// Variance of the walk, m² a second, over that of the location's white noise, m².
    pub(crate) ratio: f64,
    whitening: Whitening,
    pub(crate) information: Matrix3<f64>,
    /// Variance of the location's white noise, m².
    pub(crate) variance: f64,
    pub(crate) log_likelihood: f64,
    /// Whitened distance by speed, time, and change of speed.
    pub(crate) columns: [Vec<f64>; 3],
    pub(crate) residuals: Vec<f64>,
}

/// The filter that makes the differences' noise white: location noise of 1 m², walk of `ratio` m² a second.
#[derive(Clone, Debug)]
struct Whitening {
    /// What each difference has of the innovation before it.
    gains: Vec<f64>,
    /// Standard deviations of the innovations, m.
    deviations: Vec<f64>,
    /// Logarithm of the determinant of their covariance.
    log_determinant: f64,
}

impl Whitening {
    fn of(differences: &Differences, ratio: f64) -> Self {
        let count = differences.y.len();
        let (mut gains, mut deviations) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let (mut variance, mut log_determinant) = (1.0_f64, 0.0);
        for i in 0..count {
            let gain = if differences.linked[i] { -1.0 / variance } else { 0.0 };
            variance = 2.0 + ratio * differences.dt[i] + differences.doubt[i] + gain;
            gains.push(gain);
            deviations.push(variance.sqrt());
            log_determinant += variance.ln();
        }
        Self { gains, deviations, log_determinant }
    }

    fn apply(&self, column: &[f64]) -> Vec<f64> {
        let mut before = 0.0;
        let rows = column.iter().zip(&self.gains).zip(&self.deviations);
        rows.map(|((value, gain), deviation)| {
            before = value - gain * before;
            before / deviation
        })
        .collect()
    }
}

/// Sum of the products.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn fit(differences: &Differences, ratio: f64) -> Option<Fit> {
    let whitening = Whitening::of(differences, ratio);
    let columns = [&differences.by_speed, &differences.dt, &differences.dv].map(|column| whitening.apply(column));
    let mut y = whitening.apply(&differences.y);
    let normal = Matrix3::from_fn(|i, j| dot(&columns[i], &columns[j]));
    // A run at one speed has no skew; what it cannot say stays at zero instead of failing.
    let normal = normal + Matrix3::from_diagonal(&(normal.diagonal() * 1e-9).add_scalar(1e-12));
    let factored = normal.cholesky()?;
    let solve = |y: &[f64]| {
        let score = Vector3::from_fn(|i, _| dot(&columns[i], y));
        let beta = factored.solve(&score);
        let residuals: Vec<f64> = (0..y.len())
            .map(|i| y[i] - columns[0][i] * beta[0] - columns[1][i] * beta[1] - columns[2][i] * beta[2])
            .collect();
        (beta, residuals)
    };
    let (mut beta, mut residuals) = solve(&y);
    for _ in 0..3 {
        let most = OUTLIER * mean_spread(&residuals);
        if residuals.iter().all(|left| left.abs() <= most) {
            break;
        }
        for (value, left) in y.iter_mut().zip(&residuals) {
            *value -= left - left.max(-most).min(most);
        }
        (beta, residuals) = solve(&y);
    }
    let n = y.len() as f64;
    // The noise is that of ways that are not bent: a bend is mostly known better than within its own size.
    let straight = differences.straight(ratio, 1.0);
    let squares: f64 = residuals.iter().zip(&straight).map(|(residual, straight)| straight * residual * residual).sum();
    let variance = (squares / (straight.iter().sum::<f64>() - 3.0).max(1.0)).max(1e-8);
    let log_likelihood = -0.5 * (n * variance.ln() + whitening.log_determinant);
    let information = normal / variance;
    Some(Fit { beta, ratio, whitening, information, variance, log_likelihood, columns, residuals })
}

/// Ratios of the two noises that are tried: powers of two. All of them are too many for each run of thousands, and the
/// likelihood has one top: first each [`STRIDE`]th, then those beside the best.
const EXPONENTS: RangeInclusive<i32> = -16..=8;
const STRIDE: i32 = 4;

/// The fit with the most likely ratio of the two noises, and its exponent. None: too few differences.
fn best_fit(differences: &Differences) -> Option<(Fit, i32)> {
    if !differences.are_enough() {
        return None;
    }
    let tried = EXPONENTS.step_by(STRIDE as usize).filter_map(|exponent| fit_at(differences, exponent));
    climbed(differences, tried.reduce(likelier)?, STRIDE / 2)
}

/// The likeliest from a fit on, in strides that are halved where both neighbours are less likely.
fn climbed(differences: &Differences, mut best: (Fit, i32), mut stride: i32) -> Option<(Fit, i32)> {
    while stride > 0 {
        let at = best.1;
        let beside = [at - stride, at + stride].into_iter().filter(|exponent| EXPONENTS.contains(exponent));
        best = beside.filter_map(|exponent| fit_at(differences, exponent)).fold(best, likelier);
        if best.1 == at {
            stride /= 2;
        }
    }
    Some(best)
}

fn fit_at(differences: &Differences, exponent: i32) -> Option<(Fit, i32)> {
    Some((fit(differences, f64::from(exponent).exp2())?, exponent))
}

fn likelier(a: (Fit, i32), b: (Fit, i32)) -> (Fit, i32) {
    if b.0.log_likelihood > a.0.log_likelihood { b } else { a }
}

/// Standard deviation from the mean of the sizes: the median is zero where an odometer counts whole metres at one
/// speed. Outliers are drawn in step by step.
fn mean_spread(values: &[f64]) -> f64 {
    let sizes: f64 = values.iter().map(|value| value.abs()).sum();
    1.2533 * sizes / values.len().max(1) as f64
}

/// A run as further causes see it: its differences, and what scale, offset and skew leave of them.
pub(crate) struct Compared {
    pub(crate) differences: Differences,
    pub(crate) fit: Fit,
    pub(crate) inverse: Matrix3<f64>,
}

impl Compared {
    /// None: too little of the run moves with both readings.
    pub(crate) fn fitted(mut differences: Differences) -> Option<Self> {
        let (mut fit, mut exponent) = best_fit(&differences)?;
        // A bend between rows far apart is known within its own size. The noise beside it is what is left where there
        // is none.
        for _ in 0..PASSES {
            if !differences.doubt_bends(fit.variance) {
                break;
            }
            let before = fit.variance;
            (fit, exponent) = climbed(&differences, fit_at(&differences, exponent)?, 1)?;
            if (fit.variance / before - 1.0).abs() < SETTLED {
                break;
            }
        }
        let straight: f64 = differences.straight(fit.ratio, LESS_OF_BENDS).iter().sum();
        if straight < LEAST_STRAIGHT { None } else { Self::of(differences, fit) }
    }

    /// With noises of which none is fitted.
    pub(crate) fn roughly(differences: Differences) -> Option<Self> {
        if !differences.are_enough() {
            return None;
        }
        let fit = fit(&differences, 1.0)?;
        Self::of(differences, fit)
    }

    /// The same where ways that are bent count less, and where all are bent steadily: what that changes is a doubt.
    /// None: none is bent.
    pub(crate) fn with_other_bends(&self) -> Option<[Self; 2]> {
        let (mut less, mut steady) = (self.differences.clone(), self.differences.clone());
        less.doubt.iter_mut().for_each(|doubt| *doubt *= LESS_OF_BENDS);
        if less.doubt == self.differences.doubt {
            return None;
        }
        steady.y.iter_mut().zip(&self.differences.at_once_m).for_each(|(y, at_once_m)| *y += at_once_m);
        let fitted = |differences: Differences| {
            let fit = fit(&differences, self.fit.ratio)?;
            Self::of(differences, fit)
        };
        Some([fitted(less)?, fitted(steady)?])
    }

    /// With the noise of another fit.
    pub(crate) fn in_noise_of(&self, other: &Self) -> Option<Self> {
        Self::of(self.differences.clone(), fit(&self.differences, other.fit.ratio)?)
    }

    fn of(differences: Differences, fit: Fit) -> Option<Self> {
        let inverse = (fit.information * fit.variance).try_inverse()?;
        Some(Self { differences, fit, inverse })
    }

    /// A cause that adds so many metres to each difference, whitened as they are.
    pub(crate) fn whitened(&self, metres: &[f64]) -> Vec<f64> {
        self.fit.whitening.apply(metres)
    }

    /// What scale, offset and skew take up of a cause that adds so many metres to each difference, and its whitened
    /// column.
    pub(crate) fn taken_up(&self, metres: &[f64]) -> (Vector3<f64>, Vec<f64>) {
        let column = self.whitened(metres);
        let cross = Vector3::from_fn(|i, _| self.fit.columns[i].iter().zip(&column).map(|(a, b)| a * b).sum());
        (self.inverse * cross, column)
    }

    /// What scale, offset and skew leave of each difference, m.
    pub(crate) fn left_m(&self) -> Vec<f64> {
        self.differences.left_m(&self.fit.beta)
    }

    /// The same once so many metres are taken off each difference, its noise fitted again.
    pub(crate) fn without(&self, metres: &[f64]) -> Option<Self> {
        let mut differences = self.differences.clone();
        for (value, metres) in differences.y.iter_mut().zip(metres) {
            *value -= metres;
        }
        Self::fitted(differences)
    }

    /// Correlation of neighbouring innovations.
    pub(crate) fn correlation(&self) -> f64 {
        let products = self.fit.residuals.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
        let squares = self.fit.residuals.iter().map(|residual| residual * residual).sum::<f64>();
        products / squares.max(1e-12)
    }

    /// Noise that is correlated beyond the model says less: what is left of the information.
    pub(crate) fn independent(&self) -> f64 {
        let kept = self.correlation().clamp(0.0, 0.95);
        (1.0 - kept) / (1.0 + kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shares(kmh: &[f64]) -> Vec<f64> {
        let row = |(i, kmh): (usize, &f64)| Row { time_s: i as f64, location_m: 0.0, speed_mps: kmh / 3.6 };
        held_shares(&kmh.iter().enumerate().map(row).collect::<Vec<Row>>())
    }

    #[test]
    fn a_speed_that_is_held_counts_and_one_that_passes_does_not() {
        let rises: Vec<f64> = (0..300).map(|i| f64::from(i / 3 + 1)).collect();
        assert!(shares(&rises)[3..297].iter().all(|share| *share == 0.0));
        // Held before it goes on to rise, and before it falls.
        for after in [91.0, 89.0] {
            let held = shares(&[vec![88.0, 88.0, 89.0, 89.0], vec![90.0; 100], vec![after; 2], vec![80.0; 2]].concat());
            assert!(held[4..104].iter().all(|share| *share > 0.97), "{held:?}");
        }
    }

    #[test]
    fn the_way_between_rows_is_bent_as_the_speed_is() {
        let row = |time_s: f64| {
            let after_top_s = time_s - 20.0;
            let location_m = 20.0 * time_s - 0.04 * after_top_s.powi(3) / 3.0;
            Row { time_s, location_m, speed_mps: 20.0 - 0.04 * after_top_s.powi(2) }
        };
        let rows = |step_s: f64| -> Vec<Row> { (0..16).map(|i| row(12.0 + step_s * f64::from(i))).collect() };
        for step_s in [0.5, 1.0] {
            let rows = rows(step_s);
            for i in 2..rows.len() - 1 {
                let way = Way::between(&rows, i).unwrap();
                assert!((way.by_speed_m - rows[i].location_m + rows[i - 1].location_m).abs() < 1e-9, "{step_s} {i}");
            }
        }
    }
}
