//! An effort column whose small efforts have another gain than its large ones.
//!
//! In: rows of all runs of a unit, put right, with the line as described. Out: how many times as large the gain of
//! small efforts is, where it is surely another one.
//!
//! ```text
//! dv/dt = q u - k g - b0 - b1 v - b2 v²          q: one for small and one for large u; b0: of each run
//! ```
//!
//! Speeds that are held ask for small efforts, starts for large ones. The same force at a speed comes from r and from
//! slopes, so where slopes differ the gain of the small ones is apart from r, and coasts, which see the slopes without
//! efforts, tell it from a wrong steepness.

use crate::effort::driven::{self, Driven};
use crate::figure::Figure;
use nalgebra::{SMatrix, SVector};
use rundown::model::line::Line;
use rundown_files::sample::Sample;
use rundown_files::statistics::{mean_of, squares_about, upper_quantile};
use std::collections::BTreeMap;

/// Efforts below such a share of the largest are small; that is the one that a tenth of those of powering exceed.
const SHARES: [f64; 4] = [0.2, 0.35, 0.55, 0.8];
const LARGEST: f64 = 0.9;
/// A smaller effort is none, N/kg.
const LEAST_N_PER_KG: f64 = 0.01;
/// So many windows of small and of large efforts say something.
const LEAST_SMALL: usize = 40;
const LEAST_LARGE: usize = 20;
/// The gain is another one by so many standard deviations, and by at least as much beyond so many of them.
const SURE: f64 = 4.0;
const LEAST_OFF: f64 = 0.02;
const SURELY: f64 = 2.5;
/// Runs, or places of this length, m, are left out by turns; of places at most so many groups.
const PLACE_M: f64 = 1000.0;
const PLACES: i64 = 20;

/// What small efforts have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Small {
    /// Gain of the small ones over that of the large ones.
    pub(crate) times: Figure,
    /// Efforts below this are small, N/kg.
    pub(crate) below_n_per_kg: f64,
}

/// Of the runs of a unit, each with its line.
pub(crate) fn of<'a>(runs: impl Iterator<Item = (&'a [Sample], Line<'a>)>) -> Option<Small> {
    let windows = runs.enumerate().flat_map(|(run, (rows, line))| {
        let climbs = driven::windows(rows, line.direction, run).into_iter();
        climbs.map(move |window| (window, window.climb_n_per_kg(line.train, line.track)))
    });
    let windows: Vec<(Driven, f64)> = windows.collect();
    let powered = |(window, _): &&(Driven, f64)| window.efforts_n_per_kg[0] > LEAST_N_PER_KG;
    let largest =
        upper_quantile(windows.iter().filter(powered).map(|(window, _)| window.efforts_n_per_kg[0]), LARGEST)?;
    // Means or momentary efforts: what explains more.
    let fits = SHARES.into_iter().filter_map(|share| {
        let fits = [0, 1].into_iter().filter_map(|which| TwoGains::new(&windows, which, share * largest));
        fits.min_by(|a, b| a.left.total_cmp(&b.left))
    });
    let sure = |fit: &TwoGains| {
        let off = (fit.small.times.value - 1.0).abs();
        off > SURE * fit.small.times.sd && off - SURELY * fit.small.times.sd > LEAST_OFF
    };
    let z = |fit: &TwoGains| fit.small.times.away_from(1.0);
    fits.filter(sure).max_by(|a, b| z(a).total_cmp(&z(b))).map(|fit| fit.small)
}

/// Gains of small and of large efforts, gradient, r1 and r2.
type Regressors = SVector<f64, 5>;

/// Sums of a linear fit.
#[derive(Clone, Copy, Default)]
struct Sums {
    normal: SMatrix<f64, 5, 5>,
    score: Regressors,
}

impl Sums {
    fn add(&mut self, x: &Regressors, y: f64) {
        self.normal += x * x.transpose();
        self.score += x * y;
    }

    fn beta(&self) -> Option<Regressors> {
        self.normal.cholesky().map(|normal| normal.solve(&self.score))
    }

    /// Gain of the small efforts over that of the large ones, without these.
    fn times_without(&self, left_out: &Self) -> Option<f64> {
        let rest = Self { normal: self.normal - left_out.normal, score: self.score - left_out.score };
        rest.beta().map(|beta| beta[0] / beta[1])
    }
}

struct TwoGains {
    small: Small,
    /// Sum of the squares that are left.
    left: f64,
}

impl TwoGains {
    fn new(windows: &[(Driven, f64)], which: usize, below_n_per_kg: f64) -> Option<Self> {
        let row = |(window, climb): &(Driven, f64)| {
            let (u, v) = (window.efforts_n_per_kg[which], window.speed_mps);
            let (small, large) = if u < below_n_per_kg { (u, 0.0) } else { (0.0, u) };
            (Regressors::from([small, large, -climb, v, v * v]), window.acceleration_mps2)
        };
        let mut rows: Vec<(Regressors, f64)> = windows.iter().map(row).collect();
        let small = rows.iter().filter(|(x, _)| x[0] > LEAST_N_PER_KG).count();
        let large = rows.iter().filter(|(x, _)| x[1] > 0.0).count();
        if small < LEAST_SMALL || large < LEAST_LARGE {
            return None;
        }
        // A brake that drags in one run, and a wind, ask for efforts to which nothing answers: each run has its own r0.
        let mut of_run = BTreeMap::<usize, (f64, Regressors, f64)>::new();
        for ((window, _), (x, y)) in windows.iter().zip(&rows) {
            let (count, sum_x, sum_y) = of_run.entry(window.run).or_default();
            (*count, *sum_x, *sum_y) = (*count + 1.0, *sum_x + x, *sum_y + y);
        }
        for ((window, _), (x, y)) in windows.iter().zip(&mut rows) {
            let (count, sum_x, sum_y) = &of_run[&window.run];
            (*x, *y) = (*x - sum_x / *count, *y - sum_y / *count);
        }
        let mut all = Sums::default();
        let (mut runs, mut places) = (BTreeMap::<usize, Sums>::new(), BTreeMap::<i64, Sums>::new());
        for ((window, _), (x, y)) in windows.iter().zip(&rows) {
            let place = ((window.fronts_m[0] / PLACE_M).floor() as i64).rem_euclid(PLACES);
            let parts = [runs.entry(window.run).or_default(), places.entry(place).or_default()];
            parts.into_iter().chain([&mut all]).for_each(|sums| sums.add(x, *y));
        }
        let beta = all.beta()?;
        let sd = jackknife(&all, runs.values())?.hypot(jackknife(&all, places.values())?);
        let left = rows.iter().map(|(x, y)| (y - x.dot(&beta)).powi(2)).sum();
        Some(Self { small: Small { times: Figure { value: beta[0] / beta[1], sd }, below_n_per_kg }, left })
    }
}

/// Standard deviation of the ratio of the gains, from each part left out by turns.
fn jackknife<'a>(all: &Sums, parts: impl Iterator<Item = &'a Sums>) -> Option<f64> {
    let without: Vec<f64> = parts.map(|part| all.times_without(part)).collect::<Option<_>>()?;
    let count = without.len() as f64;
    let squares = squares_about(mean_of(&without), &without);
    (without.len() > 1).then(|| ((count - 1.0) / count * squares).sqrt())
}
