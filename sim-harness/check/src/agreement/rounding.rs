//! What the rounding of speeds that are held does to the comparison with the location.
//!
//! A speed that passes a step is above and below it alike. One that is held is off by the same all the time, by up to
//! half a step, and again where it is held again: 80.4 km/h read 80 for an hour are a wheel of 0.995 to whoever takes
//! their rounding for noise. So each held speed has an error of its own, of the size of the rounding, and alike in all
//! runs:
//!
//! ```text
//! Δx - ∫ v_r dt = (1/s - 1) ∫ v_r dt + (o/s) Δt + τ Δv_r - Σ e_l (time at l) + noise
//! ```
//!
//! Where much of a run is at one speed, scale and offset are left to the rest of it, and to other speeds.

use crate::agreement::compared::{Compared, HeldTime, PAIR_S, dot};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix2, Matrix3, Vector2, Vector3};
use std::collections::BTreeMap;
use std::ops::Range;

/// What a run says of scale, offset and skew beside the errors of its held speeds: normal equations of these, in this
/// order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Equations {
    /// Readings that are held, m/s.
    speeds: Vec<f64>,
    /// Information of what is asked, the rounding not known yet.
    matrix: DMatrix<f64>,
    score: DVector<f64>,
    /// Of a reading, standard deviation, m/s; 0 where it is not known.
    rounding_mps: f64,
}

/// A speed that is held for a shorter time is off by no more than noise, s: its readings are taken to be off
/// independently from difference to difference.
const LEAST_S: f64 = 2.0 * PAIR_S;

/// What is known of recorders beforehand: scale, and true less read speed, m/s, standard deviations. Wheels wear by 5
/// %, and steps of speeds are 1 or 2 km/h.
const SCALE_SD: f64 = 0.1;
const OFFSET_SD_MPS: f64 = 1.0;

/// Time at each held speed, difference by difference, of those in a range.
fn held(compared: &Compared, range: Range<usize>) -> Vec<(f64, Vec<f64>)> {
    let differences = &compared.differences;
    let mut times: Vec<&HeldTime> = differences.held.iter().filter(|one| range.contains(&one.at)).collect();
    times.sort_by(|a, b| a.speed_mps.total_cmp(&b.speed_mps));
    let of = |level: &[&HeldTime]| {
        let mut seconds = vec![0.0; differences.y.len()];
        level.iter().for_each(|one| seconds[one.at] += one.held_s);
        (level[0].speed_mps, seconds)
    };
    let is_long = |level: &&[&HeldTime]| level.iter().map(|one| one.held_s).sum::<f64>() >= LEAST_S;
    times.chunk_by(|a, b| a.speed_mps == b.speed_mps).filter(is_long).map(of).collect()
}

/// 1/s - 1, o/s and τ of a run with their information, and what the rounding of each speed does to the first two,
/// standard deviation.
pub(crate) struct Solved {
    pub(crate) values: Vector3<f64>,
    pub(crate) information: Matrix3<f64>,
    pub(crate) held: Vec<(u64, Vector2<f64>)>,
}

impl Equations {
    /// `kept`: what correlation of the noise leaves of the information.
    pub(crate) fn of(compared: &Compared, kept: f64) -> Self {
        let fit = &compared.fit;
        let all = held(compared, 0..compared.differences.y.len());
        let speeds = all.iter().map(|(speed_mps, _)| *speed_mps).collect();
        let columns: Vec<Vec<f64>> = all.iter().map(|(_, seconds)| compared.whitened(seconds)).collect();
        let columns: Vec<&[f64]> = fit.columns.iter().chain(&columns).map(Vec::as_slice).collect();
        let dot = |a: &[f64], b: &[f64]| kept / fit.variance * dot(a, b);
        let mut matrix = DMatrix::from_fn(columns.len(), columns.len(), |i, j| dot(columns[i], columns[j]));
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&(fit.information * kept));
        let left = DVector::from_fn(columns.len(), |i, _| if i < 3 { 0.0 } else { dot(columns[i], &fit.residuals) });
        let score = matrix.columns(0, 3) * fit.beta + left;
        Self { speeds, matrix, score, rounding_mps: 0.0 }
    }

    /// The rounding of a reading, standard deviation, m/s, and what it leaves of the information.
    pub(crate) fn set_rounding(&mut self, rounding_mps: f64, left: f64) {
        self.rounding_mps = rounding_mps;
        self.matrix *= left;
        self.score *= left;
        if rounding_mps == 0.0 {
            self.speeds.clear();
            self.matrix = self.matrix.view((0, 0), (3, 3)).into_owned();
            self.score = self.score.rows(0, 3).into_owned();
        }
    }

    /// What is known of the errors of the held speeds, their size included.
    fn own_errors(&self) -> Option<Cholesky<f64, Dyn>> {
        let levels = self.speeds.len();
        let mut own = self.matrix.view((3, 3), (levels, levels)).into_owned();
        (0..levels).for_each(|i| own[(i, i)] += self.rounding_mps.powi(-2));
        own.cholesky()
    }

    /// None: the run says nothing of them.
    pub(crate) fn solved(&self) -> Option<Solved> {
        let levels = self.speeds.len();
        let asked = self.matrix.fixed_view::<3, 3>(0, 0).into_owned();
        if levels == 0 {
            let values = asked.cholesky()?.solve(&self.score.fixed_rows::<3>(0).into_owned());
            return Some(Solved { values, information: asked, held: Vec::new() });
        }
        let by_level = self.own_errors()?.solve(&self.matrix.view((3, 0), (levels, 3)));
        let information = asked - self.matrix.view((0, 3), (3, levels)) * &by_level;
        let information = 0.5 * (information + information.transpose());
        let score = self.score.fixed_rows::<3>(0) - by_level.transpose() * self.score.rows(3, levels);
        let covariance = information.try_inverse()?;
        let effect = |i: usize| covariance * by_level.row(i).transpose() / self.rounding_mps;
        let held = self.speeds.iter().enumerate().map(|(i, speed)| (speed.to_bits(), effect(i).xy())).collect();
        Some(Solved { values: covariance * score, information, held })
    }

    /// The same once the speeds are divided by so much.
    pub(crate) fn rescale(&mut self, ratio: f64) {
        self.score = &self.score * ratio + self.matrix.column(0) * (ratio - 1.0);
    }

    /// What is left of them when errors of the held speeds that are of this run alone are eliminated. None: there is
    /// nothing to solve.
    fn without_own(&self) -> Option<Self> {
        let levels = self.speeds.len();
        let held = self.matrix.columns(3, levels);
        let root = self.own_errors()?;
        let matrix = &self.matrix - held * root.solve(&held.transpose());
        let score = &self.score - held * root.solve(&self.score.rows(3, levels));
        Some(Self { score, matrix, ..self.clone() })
    }

    /// What is left of them when the skew, which is another one in each run, is eliminated: matrix and score.
    fn without_skew(&self) -> (DMatrix<f64>, DVector<f64>) {
        let skew = self.matrix.column(2).into_owned();
        let matrix = &self.matrix - &skew * skew.transpose() / skew[2];
        (matrix, &self.score - &skew * (self.score[2] / skew[2]))
    }
}

/// What all runs say together.
pub(crate) struct Joint {
    /// 1/s - 1 and o/s.
    pub(crate) values: Vector2<f64>,
    pub(crate) covariance: Matrix2<f64>,
}

/// 1/s - 1 and o/s of all runs. Each held speed has one error in all of them, for a cruise control holds the same in
/// each, and one of its own in each, for a driver does not: either may be as large as the rounding.
///
/// `are_far`: rows are far apart. Little is left where most is bent, and the recorder is taken for one of a train:
/// trams that all hold one speed had an offset of as much, and no scale.
pub(crate) fn joint(runs: &[&Equations], are_far: bool) -> Option<Joint> {
    let speeds = runs.iter().flat_map(|run| &run.speeds).map(|speed| speed.to_bits());
    let mut places: BTreeMap<u64, usize> = speeds.map(|speed| (speed, 0)).collect();
    places.values_mut().enumerate().for_each(|(i, place)| *place = 2 + i);
    let size = 2 + places.len();
    let (mut matrix, mut score) = (DMatrix::zeros(size, size), DVector::zeros(size));
    for run in runs {
        let alone = if runs.len() > 1 { run.without_own() } else { None };
        let (own, own_score) = alone.as_ref().unwrap_or(run).without_skew();
        let place =
            |i: usize| if i < 2 { Some(i) } else { places.get(&run.speeds.get(i.wrapping_sub(3))?.to_bits()).copied() };
        let at: Vec<(usize, usize)> = (0..own_score.len()).filter_map(|i| Some((i, place(i)?))).collect();
        for (i, to) in &at {
            score[*to] += own_score[*i];
            at.iter().for_each(|(j, other)| matrix[(*to, *other)] += own[(*i, *j)]);
        }
    }
    let rounding_mps = runs.iter().map(|run| run.rounding_mps).fold(0.0, f64::max);
    (2..size).for_each(|i| matrix[(i, i)] += rounding_mps.powi(-2));
    if are_far {
        matrix[(0, 0)] += SCALE_SD.powi(-2);
        matrix[(1, 1)] += OFFSET_SD_MPS.powi(-2);
    }
    let root = matrix.cholesky()?;
    let covariance = root.solve(&DMatrix::identity(size, 2)).fixed_view::<2, 2>(0, 0).into_owned();
    Some(Joint { values: root.solve(&score).fixed_rows::<2>(0).into_owned(), covariance })
}

/// What an error of 1 m/s in each held speed does to one more cause, in units of it: root of the sum of squares. The
/// same reading before and after a place may be two speeds.
pub(crate) fn beside(compared: &Compared, metres: &[f64], place: usize) -> f64 {
    let columns = &compared.fit.columns;
    let (taken, column) = compared.taken_up(metres);
    let left = |i: usize| column[i] - (0..3).map(|k| taken[k] * columns[k][i]).sum::<f64>();
    let left: Vec<f64> = (0..column.len()).map(left).collect();
    let square = dot(&left, &left).max(f64::MIN_POSITIVE);
    let sides = [0..place + 1, place + 1..column.len()];
    let held = sides.into_iter().flat_map(|side| held(compared, side));
    held.map(|(_, seconds)| (dot(&compared.taken_up(&seconds).1, &left) / square).powi(2)).sum::<f64>().sqrt()
}
