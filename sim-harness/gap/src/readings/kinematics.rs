//! Do speed and location agree? Scale, offset and lag, before any question about forces.
//!
//! Over each pair of samples, with σ the sign of the direction and v̄ the mean of the two speed readings:
//!
//! ```text
//! σ Δs - v̄ dt = ε v̄ dt + b dt - lag Δv        ε = 1/scale - 1,  b: half a quantum if the recorder truncates
//! ```
//!
//! Location noise is shared by neighbouring pairs with opposite sign; what the rounding of the speed leaves adds up. Fitted run by run, then over runs:
//! a run is the unit, and one bad run must not decide.

use crate::config::KinematicsConfig;
use crate::data::runs::{Readings, Run, usual_step_s};
use crate::fit::Base;
use nalgebra::{DMatrix, DVector};

/// What was found, each with its standard deviation from the spread between runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kinematics {
    /// Measured over true speed, less 1.
    pub scale: (f64, f64),
    /// Offset of the speed reading, true less read, m/s.
    pub offset_mps: (f64, f64),
    /// Age of the location reading less that of the speed, s.
    pub lag_s: (f64, f64),
    /// The step of the speed readings, m/s; 0 if there is none.
    pub quantum_mps: f64,
    /// Runs that have enough of both.
    pub runs: usize,
}

impl Kinematics {
    /// Measured over true speed, less 1, with its standard deviation, if it is beyond doubt and matters.
    pub fn scale_that_matters(&self, config: &KinematicsConfig) -> Option<(f64, f64)> {
        matters(self.scale, config.least_scale, config)
    }

    /// The same of the lag, s.
    pub fn lag_that_matters(&self, config: &KinematicsConfig) -> Option<(f64, f64)> {
        matters(self.lag_s, config.least_lag_s, config)
    }

    /// The recorder truncates its speeds.
    fn truncates(&self, config: &KinematicsConfig) -> bool {
        let half = 0.5 * self.quantum_mps;
        let (value, sd) = self.offset_mps;
        half > 0.0 && (value - half).abs() < config.truncated_share * half && value > config.truncated_sd * sd
    }

    /// What is corrected before any force is looked at.
    pub fn readings(&self, config: &KinematicsConfig) -> Readings {
        let (lag_s, lag_sd_s) = self.lag_s;
        Readings {
            speed_scale: self.scale_that_matters(config).map_or(1.0, |(value, _)| 1.0 + value),
            speed_offset_mps: if self.truncates(config) { 0.5 * self.quantum_mps } else { 0.0 },
            speed_quantum_mps: self.quantum_mps,
            // A lag too small to be named still moves the train on its gradients.
            location_lag_s: if lag_s.abs() > config.corrected_sd * lag_sd_s { lag_s } else { 0.0 },
            ..Readings::default()
        }
    }
}

fn matters((value, sd): (f64, f64), least: f64, config: &KinematicsConfig) -> Option<(f64, f64)> {
    (value.abs() > least && value.abs() > config.sure * sd).then_some((value, sd))
}

/// One run's normal equations.
struct OfRun {
    information: nalgebra::Matrix3<f64>,
    score: nalgebra::Vector3<f64>,
}

/// Finds scale, offset and lag over all runs.
pub fn kinematics(runs: &[Run], config: &KinematicsConfig) -> Kinematics {
    let quantum_mps = quantum_mps(runs, config);
    let of_runs: Vec<OfRun> = runs.iter().filter_map(|run| of_run(run, config)).collect();
    let with_offset = fitted(&of_runs, quantum_mps, &[0, 1, 2], config);
    // Without a quantum there is no truncation. An offset that is not put right must not hold a part of the scale either.
    let truncates = quantum_mps > 0.0 && with_offset.truncates(config);
    if truncates { with_offset } else { fitted(&of_runs, quantum_mps, &[0, 2], config) }
}

/// `free`: which of scale, offset and lag are looked for.
fn fitted(of_runs: &[OfRun], quantum_mps: f64, free: &[usize], config: &KinematicsConfig) -> Kinematics {
    let mut kept: Vec<&OfRun> = of_runs.iter().collect();
    let mut found = Kinematics { quantum_mps, runs: of_runs.len(), ..Kinematics::default() };
    for _ in 0..3 {
        let Some((beta, sd, outside)) = over_runs(&kept, free, config) else {
            return found;
        };
        found.scale = (1.0 / (1.0 + beta[0]) - 1.0, sd[0]);
        found.offset_mps = (beta[1], sd[1]);
        found.lag_s = (beta[2], sd[2]);
        if outside.is_empty() {
            break;
        }
        kept = kept.into_iter().enumerate().filter(|(index, _)| !outside.contains(index)).map(|(_, run)| run).collect();
    }
    found
}

/// Values, deviations from the spread of runs, and runs that are far from all others.
fn over_runs(runs: &[&OfRun], free: &[usize], config: &KinematicsConfig) -> Option<([f64; 3], [f64; 3], Vec<usize>)> {
    let count = free.len();
    let pick = |run: &OfRun| {
        (
            DMatrix::from_fn(count, count, |i, j| run.information[(free[i], free[j])]),
            DVector::from_fn(count, |i, _| run.score[free[i]]),
        )
    };
    let mut information = DMatrix::zeros(count, count);
    let mut score = DVector::zeros(count);
    for run in runs {
        let (i, s) = pick(run);
        information += i;
        score += s;
    }
    let inverse = information.clone().cholesky()?.inverse();
    let beta = &inverse * score;
    let mut meat = DMatrix::zeros(count, count);
    let mut sizes = Vec::new();
    for run in runs {
        let (i, s) = pick(run);
        let left = s - i * &beta;
        let moved = &inverse * &left;
        sizes.push(moved[0].abs());
        meat += &left * left.transpose();
    }
    let n = runs.len() as f64;
    let robust = &inverse * meat * &inverse * (n / (n - count as f64).max(1.0));
    let (mut value, mut sd) = ([0.0; 3], [0.0; 3]);
    for (place, which) in free.iter().enumerate() {
        value[*which] = beta[place];
        // Never surer than the noise model with its few assumptions, halved.
        sd[*which] = robust[(place, place)].sqrt().max(config.least_sd_share * inverse[(place, place)].sqrt());
    }
    let mut sorted = sizes.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let outside = if runs.len() < config.least_runs {
        Vec::new()
    } else {
        (0..sizes.len()).filter(|i| sizes[*i] > config.outlying_run * median).collect()
    };
    Some((value, sd, outside))
}

/// One run's measured over true speed with its standard deviation. An offset is left out: it is the recorder's, and in a single run it is confounded with the wheel.
pub fn scale_of_run(run: &Run, config: &KinematicsConfig) -> Option<(f64, f64)> {
    let of_run = of_run(run, config)?;
    let (beta, sd, _) = over_runs(&[&of_run], &[0, 2], config)?;
    Some((1.0 / (1.0 + beta[0]), sd[0]))
}

/// What a change of the acceleration adds to the distance from reading `i` - 1 to reading `i`, m: -dt² Δa/12 (Hermite). Ten seconds beside the end of a strong acceleration are a metre, always
/// of the same sign.
fn bent(read: &[(f64, f64, f64)], i: usize, longest_s: f64) -> f64 {
    let (Some(before), Some(after)) = (i.checked_sub(2).map(|j| read[j]), read.get(i + 1)) else {
        return 0.0;
    };
    let (from, to) = (read[i - 1], read[i]);
    let moving = before.2.min(from.2).min(to.2).min(after.2) > 0.0;
    if !moving || from.0 - before.0 > longest_s || after.0 - to.0 > longest_s {
        return 0.0;
    }
    let slope = |a: (f64, f64, f64), b: (f64, f64, f64)| (b.2 - a.2) / (b.0 - a.0);
    -(to.0 - from.0).powi(2) / 12.0 * (slope(from, *after) - slope(before, to))
}

/// Differences of location and speed over pairs of readings, with their covariance, row by row: that of neighbours is the location that they share.
#[derive(Default)]
struct Pairs {
    /// Distance by location less that by speed.
    y: Vec<f64>,
    /// Of scale, offset and lag.
    columns: [Vec<f64>; 3],
    diagonal: Vec<f64>,
    below: Vec<f64>,
}

impl Pairs {
    fn whiten(&self, column: &[f64]) -> DVector<f64> {
        let mut white: Vec<f64> = Vec::with_capacity(column.len());
        for (i, value) in column.iter().enumerate() {
            let before = if i == 0 { 0.0 } else { white[i - 1] };
            white.push((value - self.below[i] * before) / self.diagonal[i]);
        }
        DVector::from_vec(white)
    }
}

fn pairs(run: &Run, config: &KinematicsConfig) -> Pairs {
    let sign = run.direction.sign();
    let longest_s = 3.0 * usual_step_s(run).max(5.0);
    // Fast logs: pairs about 10 s apart, or the distance between two samples drowns in the noise of the location.
    let read: Vec<(f64, f64, f64)> =
        run.samples.iter().filter_map(|s| Some((s.time_s, s.location_m?, s.speed_mps?))).collect();
    let mut distance_m = vec![0.0; read.len()];
    for i in 1..read.len() {
        distance_m[i] = distance_m[i - 1]
            + 0.5 * (read[i].0 - read[i - 1].0) * (read[i].2 + read[i - 1].2)
            + bent(&read, i, longest_s);
    }
    let mut picked: Vec<usize> = Vec::new();
    for (i, r) in read.iter().enumerate() {
        if picked.last().is_none_or(|last| r.0 - read[*last].0 > config.pair_s) {
            picked.push(i);
        }
    }
    let mut pairs = Pairs::default();
    let KinematicsConfig { location_sd_m, distance_sd_m, .. } = *config;
    let mut last_end = None;
    for pair in picked.windows(2) {
        let (a, b) = (read[pair[0]], read[pair[1]]);
        let dt = b.0 - a.0;
        // A standing train has no rounding and no truncation.
        if dt > longest_s.max(config.longest_s) || a.2.min(b.2) < config.slowest_mps {
            last_end = None;
            continue;
        }
        let by_speed = distance_m[pair[1]] - distance_m[pair[0]];
        pairs.y.push(sign * (b.1 - a.1) - by_speed);
        pairs.columns.iter_mut().zip([by_speed, dt, -(b.2 - a.2)]).for_each(|(column, value)| column.push(value));
        let variance = 2.0 * location_sd_m * location_sd_m + distance_sd_m * distance_sd_m * dt;
        let shared = last_end == Some(pair[0]);
        let off: f64 =
            if shared { -location_sd_m * location_sd_m / pairs.diagonal.last().copied().unwrap_or(1.0) } else { 0.0 };
        pairs.diagonal.push((variance - off * off).sqrt());
        pairs.below.push(off);
        last_end = Some(pair[1]);
    }
    pairs
}

fn of_run(run: &Run, config: &KinematicsConfig) -> Option<OfRun> {
    let pairs = pairs(run, config);
    if pairs.y.len() < config.least_pairs {
        return None;
    }
    let columns = pairs.columns.each_ref().map(|column| pairs.whiten(column));
    // Outliers of the location: winsorised around a first fit.
    let mut white_y = pairs.whiten(&pairs.y);
    let all = 0..white_y.len();
    let base = Base::new(&white_y, &columns, core::slice::from_ref(&all))?;
    for (value, left) in white_y.iter_mut().zip(base.residual.iter()) {
        *value -= left - left.clamp(-config.outlier, config.outlier);
    }
    let information = nalgebra::Matrix3::from_fn(|i, j| columns[i].dot(&columns[j]));
    let score = nalgebra::Vector3::from_fn(|i, _| columns[i].dot(&white_y));
    Some(OfRun { information, score })
}

/// The step of the speed readings if nearly all are whole multiples of 1, 0.5 or 0.1 km/h and not of less.
fn quantum_mps(runs: &[Run], config: &KinematicsConfig) -> f64 {
    let speeds: Vec<f64> = runs
        .iter()
        .flat_map(|run| run.samples.iter().filter_map(|s| s.speed_mps))
        .filter(|v| *v > 0.0)
        .map(|v| 3.6 * v)
        .collect();
    for quantum_kmh in [1.0, 0.5] {
        let whole = speeds.iter().filter(|v| ((*v / quantum_kmh).round() * quantum_kmh - *v).abs() < 1e-3).count();
        if whole as f64 > config.whole_share * speeds.len() as f64 && !speeds.is_empty() {
            return quantum_kmh / 3.6;
        }
    }
    0.0
}
