//! Speed against location: scale, offset and skew of a run, jointly, with their covariance.
//!
//! The speed reading at time t is v_r(t) = s v(t - τ) - o: s a wheel that is not as believed, o what truncation takes away, τ by how much the speed is older than
//! the location. So between two rows, to first order in s - 1 and in τ,
//!
//! ```text
//! Δx - ∫ v_r dt = (1/s - 1) ∫ v_r dt + (o/s) Δt + τ Δv_r + noise
//! ```
//!
//! The noise is white noise of the location, shared by neighbouring differences with opposite sign, and a walk that the errors of the speed add up to. Their ratio is
//! fitted by maximum likelihood, so that an odometer in whole metres and a satellite receiver are each believed as far as they deserve. One slow run cannot tell
//! scale and offset apart: the covariance says so, and [`pooled`] weighs with it.

use crate::rounding::{self, Equations, HeldTime};
use nalgebra::{Matrix2, Matrix3, SymmetricEigen, Vector2, Vector3};
use rundown_files::units::median;

/// A row with everything that is compared: time, s, location in the direction of travel, m, speed reading, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time_s: f64,
    /// Location, growing in the direction of travel, m.
    pub location_m: f64,
    /// Speed reading, m/s.
    pub speed_mps: f64,
}

/// Half a 95 % interval in standard deviations: the 97.5 % point of the normal distribution. All intervals have this width.
pub const HALF_95: f64 = 1.96;

/// A value and its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Figure {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub sd: f64,
}

impl Figure {
    /// Bounds of the 95 % interval.
    pub fn interval(&self) -> [f64; 2] {
        [self.value - HALF_95 * self.sd, self.value + HALF_95 * self.sd]
    }

    /// With its 95 % interval, in so many decimals.
    pub(crate) fn with_interval(&self, decimals: usize) -> String {
        let [low, high] = self.interval();
        format!("{:.decimals$} [{low:.decimals$}, {high:.decimals$}]", self.value)
    }

    /// So many standard deviations from this value.
    pub fn away_from(&self, value: f64) -> f64 {
        (self.value - value).abs() / self.sd
    }

    /// The value of one of many, drawn to the usual one by what is known of both. `spread`: standard deviation of many such figures.
    pub fn drawn(&self, usual: f64, spread: f64) -> f64 {
        let between = (spread * spread - self.sd * self.sd).max(0.0);
        usual + (self.value - usual) * between / (between + self.sd * self.sd).max(f64::MIN_POSITIVE)
    }
}

/// What one run says.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// 1/s - 1, o/s in m/s, τ in s.
    pub values: Vector3<f64>,
    /// Inverse of their covariance.
    pub information: Matrix3<f64>,
    /// White noise of the location, standard deviation, m.
    pub location_noise_m: f64,
    /// Growth of the difference between distance by speed and by location, m per square root of a second.
    pub walk_m: f64,
    /// Correlation of neighbouring innovations, 0 where the noise is as assumed.
    pub correlation: f64,
    /// Differences that were compared.
    pub pairs: usize,
    /// The rounding of each held speed, by its reading, and what it does to 1/s - 1 and o/s, standard deviation.
    pub(crate) held: Vec<(u64, Vector2<f64>)>,
    pub(crate) equations: Equations,
}

/// Fewer differences say nothing.
const LEAST_PAIRS: usize = 20;
/// Time between two rows that are compared, s: what rounding leaves is correlated over seconds.
pub(crate) const PAIR_S: f64 = 5.0;
/// Slower readings are left out: a standing train has no rounding, a creeping one reads zero, m/s.
const SLOWEST_MPS: f64 = 1.5;
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
    dv: Vec<f64>,
    /// Time of the later row, s.
    pub(crate) end_s: Vec<f64>,
    /// The difference before shares a row with this one.
    linked: Vec<bool>,
    /// Speeds that are held in the differences.
    pub(crate) held: Vec<HeldTime>,
}

impl Differences {
    /// `parts`: rows without a gap or a shift of the location between them.
    pub(crate) fn of(parts: &[&[Row]]) -> Self {
        let mut all = Self::default();
        for part in parts {
            all.take(part);
        }
        all
    }

    /// Fewer say nothing.
    pub(crate) fn are_enough(&self) -> bool {
        self.y.len() >= LEAST_PAIRS
    }

    fn take(&mut self, part: &[Row]) {
        let shares = rounding::held_shares(part);
        let mut held: Vec<HeldTime> = Vec::new();
        let mut from = None;
        let mut by_speed = 0.0;
        let mut linked = false;
        for (i, row) in part.iter().enumerate() {
            if row.speed_mps < SLOWEST_MPS {
                (from, linked) = (None, false);
                continue;
            }
            let Some((begin, more_m)) = from.zip(i.checked_sub(1).and_then(|_| distance(part, i))) else {
                (from, by_speed, linked) = (Some(*row), 0.0, false);
                held.clear();
                continue;
            };
            by_speed += more_m;
            let half_s = 0.5 * (row.time_s - part[i - 1].time_s);
            let of = |j: usize| HeldTime { at: self.y.len(), speed_mps: part[j].speed_mps, held_s: half_s * shares[j] };
            held.extend([i - 1, i].map(of).iter().filter(|one| one.held_s > 0.0));
            let dt = row.time_s - begin.time_s;
            if dt >= PAIR_S {
                self.y.push(row.location_m - begin.location_m - by_speed);
                self.by_speed.push(by_speed);
                self.dt.push(dt);
                self.dv.push(row.speed_mps - begin.speed_mps);
                self.end_s.push(row.time_s);
                self.linked.push(linked);
                self.held.append(&mut held);
                (from, by_speed, linked) = (Some(*row), 0.0, true);
            }
        }
    }
}

/// Rows farther apart are bent between: a bend of 1 m/s² makes a third of a metre in 2 s, 8 m in 10 s.
const STRAIGHT_S: f64 = 2.0;

/// Distance by speed from row `i - 1` to row `i`: trapezium, bent as the neighbouring accelerations say. None beside a start or a stop: the train moved for a
/// part of the time only, and the change of speed there is no acceleration.
fn distance(rows: &[Row], i: usize) -> Option<f64> {
    let (a, b) = (rows[i - 1], rows[i]);
    let dt = b.time_s - a.time_s;
    let straight = 0.5 * dt * (a.speed_mps + b.speed_mps);
    let slope = |a: &Row, b: &Row| (b.speed_mps - a.speed_mps) / (b.time_s - a.time_s);
    let around = i.checked_sub(2).and_then(|before| Some((&rows[before], rows.get(i + 1)?)));
    match around {
        Some((before, after)) if dt > STRAIGHT_S => {
            let moves = before.speed_mps.min(after.speed_mps) >= SLOWEST_MPS;
            moves.then(|| straight - dt * dt / 12.0 * (slope(&b, after) - slope(before, &a)) / 2.0)
        }
        _ => Some(straight),
    }
}

/// Whitened residuals and regressors of one ratio of the two noises.
pub(crate) struct Fit {
    pub(crate) beta: Vector3<f64>,
    /// Variance of the walk, m² a second, over that of the location's white noise, m².
    pub(crate) ratio: f64,
    pub(crate) information: Matrix3<f64>,
    /// Variance of the location's white noise, m².
    pub(crate) variance: f64,
    pub(crate) log_likelihood: f64,
    /// Whitened distance by speed, time, and change of speed.
    pub(crate) columns: [Vec<f64>; 3],
    pub(crate) residuals: Vec<f64>,
}

/// The filter that makes the differences' noise white: location noise of 1 m², walk of `ratio` m² a second.
pub(crate) fn whitened(differences: &Differences, ratio: f64, column: &[f64], variances: &mut Vec<f64>) -> Vec<f64> {
    let mut white = Vec::with_capacity(column.len());
    variances.clear();
    let (mut before, mut variance_before) = (0.0, 1.0);
    for (i, value) in column.iter().enumerate() {
        let diagonal = 2.0 + ratio * differences.dt[i];
        let gain = if differences.linked[i] { -1.0 / variance_before } else { 0.0 };
        let variance = diagonal + if differences.linked[i] { gain } else { 0.0 };
        let innovation = value - gain * before;
        white.push(innovation / variance.sqrt());
        variances.push(variance);
        (before, variance_before) = (innovation, variance);
    }
    white
}

fn fit(differences: &Differences, ratio: f64) -> Option<Fit> {
    let mut variances = Vec::new();
    let columns = [&differences.by_speed, &differences.dt, &differences.dv]
        .map(|column| whitened(differences, ratio, column, &mut variances));
    let mut y = whitened(differences, ratio, &differences.y, &mut variances);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let normal = Matrix3::from_fn(|i, j| dot(&columns[i], &columns[j]));
    // A run at one speed has no skew; what it cannot say stays at zero instead of failing.
    let normal = normal + Matrix3::from_diagonal(&(normal.diagonal() * 1e-9).add_scalar(1e-12));
    let solve = |y: &[f64]| {
        let score = Vector3::from_fn(|i, _| dot(&columns[i], y));
        let beta = normal.cholesky()?.solve(&score);
        let residuals: Vec<f64> = (0..y.len())
            .map(|i| y[i] - columns[0][i] * beta[0] - columns[1][i] * beta[1] - columns[2][i] * beta[2])
            .collect();
        Some((beta, residuals))
    };
    let (mut beta, mut residuals) = solve(&y)?;
    for _ in 0..3 {
        let most = OUTLIER * mean_spread(&residuals);
        for (value, left) in y.iter_mut().zip(&residuals) {
            *value -= left - left.max(-most).min(most);
        }
        (beta, residuals) = solve(&y)?;
    }
    let n = y.len() as f64;
    let variance = (dot(&residuals, &residuals) / (n - 3.0)).max(1e-8);
    let log_likelihood = -0.5 * (n * variance.ln() + variances.iter().map(|v| v.ln()).sum::<f64>());
    Some(Fit { beta, ratio, information: normal / variance, variance, log_likelihood, columns, residuals })
}

/// The fit with the most likely ratio of the two noises. None: too few differences.
pub(crate) fn best_fit(differences: &Differences) -> Option<Fit> {
    if !differences.are_enough() {
        return None;
    }
    let ratios = (-16..=8).map(|exponent| f64::from(exponent).exp2());
    let fits = ratios.filter_map(|ratio| fit(differences, ratio));
    fits.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood))
}

/// Standard deviation from the median of the sizes.
pub(crate) fn spread(values: &[f64]) -> f64 {
    let sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    if sizes.is_empty() { 0.0 } else { 1.4826 * median(&sizes) }
}

/// Standard deviation from the mean of the sizes: the median is zero where an odometer counts whole metres at one speed. Outliers are drawn in step by step.
fn mean_spread(values: &[f64]) -> f64 {
    let sizes: f64 = values.iter().map(|value| value.abs()).sum();
    1.2533 * sizes / values.len().max(1) as f64
}

/// A run as further causes see it: its differences, and what scale, offset and skew leave of them.
pub(crate) struct Compared {
    pub(crate) differences: Differences,
    pub(crate) fit: Fit,
    inverse: Matrix3<f64>,
}

impl Compared {
    /// None: too little of the run moves with both readings.
    pub(crate) fn fitted(differences: Differences) -> Option<Self> {
        let fit = best_fit(&differences)?;
        Self::of(differences, fit)
    }

    /// With the noise of another fit.
    pub(crate) fn in_noise_of(&self, other: &Self) -> Option<Self> {
        Self::of(self.differences.clone(), fit(&self.differences, other.fit.ratio)?)
    }

    fn of(differences: Differences, fit: Fit) -> Option<Self> {
        let inverse = (fit.information * fit.variance).try_inverse()?;
        Some(Self { differences, fit, inverse })
    }

    /// One more cause, which adds so many metres per unit of it to each difference: what the data say of it beside the others, and the nats by which it beats
    /// none; the noise as without it. None where the others explain it.
    pub(crate) fn beside(&self, metres: &[f64]) -> Option<(Figure, f64)> {
        let fit = &self.fit;
        let column = whitened(&self.differences, fit.ratio, metres, &mut Vec::new());
        let dot = |a: &[f64]| a.iter().zip(&column).map(|(a, b)| a * b).sum::<f64>();
        let cross = Vector3::from_fn(|i, _| dot(&fit.columns[i]));
        let left = dot(&column) - cross.dot(&(self.inverse * cross));
        if left <= 1e-9 {
            return None;
        }
        let score = dot(&fit.residuals);
        let figure = Figure { value: score / left, sd: (fit.variance / left).sqrt() };
        Some((figure, 0.5 * score * score.max(0.0) / (left * fit.variance)))
    }

    /// A cause that adds so many metres to each difference, whitened as they are.
    pub(crate) fn whitened(&self, metres: &[f64]) -> Vec<f64> {
        whitened(&self.differences, self.fit.ratio, metres, &mut Vec::new())
    }

    /// What scale, offset and skew take up of a cause that adds so many metres to each difference, and its whitened column.
    pub(crate) fn taken_up(&self, metres: &[f64]) -> (Vector3<f64>, Vec<f64>) {
        let column = self.whitened(metres);
        let cross = Vector3::from_fn(|i, _| self.fit.columns[i].iter().zip(&column).map(|(a, b)| a * b).sum());
        (self.inverse * cross, column)
    }

    /// What scale, offset and skew leave of each difference, m.
    pub(crate) fn left_m(&self) -> Vec<f64> {
        let Differences { y, by_speed, dt, dv, .. } = &self.differences;
        let beta = self.fit.beta;
        (0..y.len()).map(|i| y[i] - beta[0] * by_speed[i] - beta[1] * dt[i] - beta[2] * dv[i]).collect()
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
    fn correlation(&self) -> f64 {
        let products = self.fit.residuals.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
        let squares = self.fit.residuals.iter().map(|residual| residual * residual).sum::<f64>();
        products / squares.max(1e-12)
    }

    /// Noise that is correlated beyond the model says less: what is left of the information.
    pub(crate) fn independent(&self) -> f64 {
        let kept = self.correlation().clamp(0.0, 0.95);
        (1.0 - kept) / (1.0 + kept)
    }

    /// Speed and location of the run.
    pub(crate) fn agreement(&self) -> Agreement {
        let fit = &self.fit;
        Agreement {
            values: fit.beta,
            information: fit.information * self.independent(),
            location_noise_m: fit.variance.sqrt(),
            walk_m: (fit.ratio * fit.variance).sqrt(),
            correlation: self.correlation(),
            pairs: self.differences.y.len(),
            held: Vec::new(),
            equations: Equations::of(self, self.independent()),
        }
    }
}

impl Agreement {
    /// The same with what the rounding of the speeds does, which may not show in the residuals: each reading is off by as much as a part of the step, and where a speed is
    /// held, all of them by the same.
    ///
    /// `rounding_mps`: of a reading, standard deviation; `step_s`: time between readings.
    pub fn with_rounding(mut self, rounding_mps: f64, step_s: f64) -> Self {
        let pair_s = PAIR_S.max(step_s);
        let seen = 2.0 * self.location_noise_m * self.location_noise_m + self.walk_m * self.walk_m * pair_s;
        let least = rounding_mps * rounding_mps * pair_s * step_s.min(pair_s);
        self.equations.set_rounding(rounding_mps, if least > seen { seen / least } else { 1.0 });
        if let Some(solved) = self.equations.solved() {
            (self.values, self.information, self.held) = (solved.values, solved.information, solved.held);
        }
        self
    }

    /// What it is once the speeds are divided by so much.
    pub(crate) fn rescaled(mut self, ratio: f64) -> Self {
        self.values[0] = (1.0 + self.values[0]) * ratio - 1.0;
        self.values[1] *= ratio;
        self.equations.rescale(ratio);
        self
    }

    /// Information on 1/s - 1 and o/s when the skew is unknown.
    fn without_skew(&self) -> Matrix2<f64> {
        let cross = Vector2::new(self.information[(0, 2)], self.information[(1, 2)]);
        self.information.fixed_view::<2, 2>(0, 0) - cross * cross.transpose() / self.information[(2, 2)]
    }

    /// By how much the speed is older than the location, s, with 1/s - 1 and o/s of its recorder, and the covariance of these.
    pub fn skew_s(&self, scale_and_offset: Vector2<f64>, covariance: &Matrix2<f64>) -> Figure {
        let information = self.information[(2, 2)];
        let cross = Vector2::new(self.information[(0, 2)], self.information[(1, 2)]) / information;
        let off = scale_and_offset - self.values.xy();
        let variance = information.recip() + cross.dot(&(covariance * cross));
        Figure { value: self.values[2] - cross.dot(&off), sd: variance.sqrt() }
    }
}

/// What several runs of one recorder say together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pooled {
    /// 1/s - 1 and o/s in m/s.
    pub values: Vector2<f64>,
    /// Their covariance: the larger of what the noise and what the scatter between runs says.
    pub covariance: Matrix2<f64>,
    /// Runs that took part.
    pub runs: usize,
}

impl Pooled {
    /// s: measured over true speed.
    pub fn scale(&self) -> Figure {
        let value = 1.0 / (1.0 + self.values[0]);
        Figure { value, sd: value * value * self.covariance[(0, 0)].sqrt() }
    }

    /// o: true less read, km/h.
    pub fn offset_kmh(&self) -> Figure {
        Figure { value: 3.6 * self.values[1], sd: 3.6 * self.covariance[(1, 1)].sqrt() }
    }

    /// The scale when the offset is known, m/s.
    pub fn scale_at(&self, offset_mps: f64) -> Figure {
        let [[a, b], [_, d]] = self.covariance.data.0;
        let value = 1.0 / (1.0 + self.values[0] + b / d * (offset_mps - self.values[1]));
        Figure { value, sd: value * value * (a - b * b / d).max(0.0).sqrt() }
    }
}

/// What a driver's style does to the comparison is the same all through a run, and shows in the scatter between runs only: one run alone has twice the
/// standard deviation that its noise says, four have a tenth more.
const FEW_RUNS: f64 = 3.0;

/// Pools runs, each weighed by what it can tell apart.
pub fn pooled(runs: &[Agreement]) -> Option<Pooled> {
    let (values, covariance) = rounding::joint(&runs.iter().map(|run| &run.equations).collect::<Vec<_>>())?;
    let mut all = Matrix2::zeros();
    let mut scatter = Matrix2::zeros();
    for run in runs {
        let information = run.without_skew();
        let score = information * (run.values.xy() - values);
        scatter += score * score.transpose();
        all += information;
    }
    let n = runs.len() as f64;
    let own = all.cholesky()?.inverse();
    let by_scatter = own * scatter * own * (n / (n - 1.0).max(1.0));
    let few = 1.0 + FEW_RUNS / (n * n);
    Some(Pooled { values, covariance: larger(covariance, by_scatter) * few, runs: runs.len() })
}

/// In each direction the larger of two covariances.
fn larger(a: Matrix2<f64>, b: Matrix2<f64>) -> Matrix2<f64> {
    let Some(root) = a.cholesky() else {
        return b;
    };
    let l = root.l();
    let Some(inverse) = l.try_inverse() else {
        return a;
    };
    let relative = SymmetricEigen::new(inverse * b * inverse.transpose());
    let grown = relative.eigenvalues.map(|value| value.max(1.0));
    l * relative.eigenvectors * Matrix2::from_diagonal(&grown) * relative.eigenvectors.transpose() * l.transpose()
}
