//! Speed against location: scale, offset and skew of a run, jointly, with their covariance.
//!
//! The speed reading at time t is v_r(t) = s v(t - τ) - o: s a wheel that is not as believed, o what truncation takes
//! away, τ by how much the speed is older than the location. So between two rows, to first order in s - 1 and in τ,
//!
//! ```text
//! Δx - ∫ v_r dt = (1/s - 1) ∫ v_r dt + (o/s) Δt + τ Δv_r + noise
//! ```
//!
//! The noise is white noise of the location, shared by neighbouring differences with opposite sign, and a walk that the
//! errors of the speed add up to. Their ratio is fitted by maximum likelihood, so that an odometer in whole metres and
//! a satellite receiver are each believed as far as they deserve. One slow run cannot tell scale and offset apart: the
//! covariance says so, and [`pooled`] weighs with it.
//!
//! | question | module |
//! |---|---|
//! | which rows are compared? | `parts` |
//! | how far is the distance by location from that by speed? | `compared` |
//! | is the speed late by whole rows? | `late_rows` |
//! | what does the rounding of held speeds do? | `rounding` |
//! | which scale do most runs have? | `of_most` |

pub(crate) mod compared;
pub(crate) mod late_rows;
pub(crate) mod of_most;
pub(crate) mod parts;
pub(crate) mod rounding;

use crate::figure::Figure;
use compared::{Compared, PAIR_S, dot};
use nalgebra::{Matrix2, Matrix3, SymmetricEigen, Vector2, Vector3};
use rounding::{Equations, Joint};

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
    /// The same with other bends of the ways between the rows, see [`Compared::with_other_bends`]. None: none is bent.
    with_other_bends: Option<[Equations; 2]>,
    /// What bends usually make of the runs beside it, of 1/s - 1 and o/s in m/s: in a single one that may vanish by
    /// chance.
    usual_bends: Matrix2<f64>,
    /// By how much the speeds were moved before they were compared, s: the skew is what is left of it.
    moved_s: f64,
    /// What an error that all runs of a recorder share makes of 1/s - 1 and o/s, standard deviation.
    shared: Vector2<f64>,
}

impl Compared {
    /// One more cause, which adds so many metres per unit of it to each difference: what the data say of it beside the
    /// others, and the nats by which it beats none; the noise as without it. None where the others explain it.
    pub(crate) fn beside(&self, metres: &[f64]) -> Option<(Figure, f64)> {
        let fit = &self.fit;
        let column = self.whitened(metres);
        let cross = Vector3::from_fn(|i, _| dot(&fit.columns[i], &column));
        let left = dot(&column, &column) - cross.dot(&(self.inverse * cross));
        if left <= 1e-9 {
            return None;
        }
        let score = dot(&fit.residuals, &column);
        let figure = Figure { value: score / left, sd: (fit.variance / left).sqrt() };
        Some((figure, 0.5 * score * score.max(0.0) / (left * fit.variance)))
    }

    /// By how much the speed is older than the location, s, with scale and offset as they come out beside it.
    pub(crate) fn skew_s(&self) -> Figure {
        Figure { value: self.fit.beta[2], sd: (self.inverse[(2, 2)] * self.fit.variance).sqrt() }
    }

    /// Speed and location of the run. `with_other_bends`: what [`Compared::with_other_bends`] is.
    pub(crate) fn agreement(&self, with_other_bends: Option<&[Self; 2]>) -> Agreement {
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
            usual_bends: Matrix2::zeros(),
            moved_s: 0.0,
            shared: Vector2::zeros(),
            with_other_bends: with_other_bends
                .map(|all| all.each_ref().map(|other| Equations::of(other, self.independent()))),
        }
    }
}

impl Agreement {
    /// The same with what the rounding of the speeds does, which may not show in the residuals: each reading is off by
    /// as much as a part of the step, and where a speed is held, all of them by the same.
    ///
    /// `rounding_mps`: of a reading, standard deviation; `step_s`: time between readings.
    pub fn with_rounding(mut self, rounding_mps: f64, step_s: f64) -> Self {
        let pair_s = PAIR_S.max(step_s);
        let seen = 2.0 * self.location_noise_m * self.location_noise_m + self.walk_m * self.walk_m * pair_s;
        let least = rounding_mps * rounding_mps * pair_s * step_s.min(pair_s);
        let left = if least > seen { seen / least } else { 1.0 };
        self.all_equations().for_each(|equations| equations.set_rounding(rounding_mps, left));
        if let Some(solved) = self.equations.solved() {
            (self.values, self.information, self.held) = (solved.values, solved.information, solved.held);
        }
        self
    }

    /// The speeds were moved by so much, s, before they were compared.
    pub(crate) fn after_moving(self, moved_s: f64) -> Self {
        Self { moved_s, ..self }
    }

    /// By so much, s.
    pub(crate) fn moved_s(&self) -> f64 {
        self.moved_s
    }

    /// By how much the speed is older than the location, s.
    pub(crate) fn age_s(&self) -> f64 {
        self.moved_s + self.values[2]
    }

    /// An error that all runs of the recorder share makes so much of 1/s - 1 and o/s, standard deviation.
    pub(crate) fn doubted(self, shared: Vector2<f64>) -> Self {
        Self { shared, ..self }
    }

    /// What it is once the speeds are divided by so much.
    pub(crate) fn rescaled(mut self, ratio: f64) -> Self {
        self.values[0] = (1.0 + self.values[0]) * ratio - 1.0;
        self.values[1] *= ratio;
        self.all_equations().for_each(|equations| equations.rescale(ratio));
        self
    }

    fn all_equations(&mut self) -> impl Iterator<Item = &mut Equations> {
        std::iter::once(&mut self.equations).chain(self.with_other_bends.iter_mut().flatten())
    }

    /// Information on 1/s - 1 and o/s when the skew is unknown.
    fn without_skew(&self) -> Matrix2<f64> {
        let cross = Vector2::new(self.information[(0, 2)], self.information[(1, 2)]);
        self.information.fixed_view::<2, 2>(0, 0) - cross * cross.transpose() / self.information[(2, 2)]
    }

    /// By how much the speed is older than the location, s, with 1/s - 1 and o/s of its recorder, and the covariance of
    /// these.
    pub fn skew_s(&self, scale_and_offset: Vector2<f64>, covariance: &Matrix2<f64>) -> Figure {
        let information = self.information[(2, 2)];
        let cross = Vector2::new(self.information[(0, 2)], self.information[(1, 2)]) / information;
        let off = scale_and_offset - self.values.xy();
        let variance = information.recip() + cross.dot(&(covariance * cross));
        Figure { value: self.moved_s + self.values[2] - cross.dot(&off), sd: variance.sqrt() }
    }
}

/// What several runs of one recorder say together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pooled {
    /// 1/s - 1 and o/s in m/s.
    pub values: Vector2<f64>,
    /// Their covariance: the larger of what the noise and what the scatter between runs says.
    pub covariance: Matrix2<f64>,
    /// What they are more by than with other bends of the ways between the rows, a column each: a doubt, for the bends
    /// are alike in all runs of a line.
    pub by_bends: Matrix2<f64>,
    /// Runs that took part.
    pub runs: usize,
}

impl Pooled {
    /// s: measured over true speed.
    pub fn scale(&self) -> Figure {
        let value = 1.0 / (1.0 + self.values[0]);
        Figure { value, sd: value * value * doubted(self.covariance[(0, 0)], self.by_bends.row(0).transpose()) }
    }

    /// o: true less read, km/h.
    pub fn offset_kmh(&self) -> Figure {
        Figure {
            value: 3.6 * self.values[1],
            sd: 3.6 * doubted(self.covariance[(1, 1)], self.by_bends.row(1).transpose()),
        }
    }

    /// The scale when the offset is known, m/s.
    pub fn scale_at(&self, offset_mps: f64) -> Figure {
        let [[a, b], [_, d]] = self.covariance.data.0;
        let value = 1.0 / (1.0 + self.values[0] + b / d * (offset_mps - self.values[1]));
        let by_bends = (self.by_bends.row(0) - self.by_bends.row(1) * (b / d)).transpose();
        Figure { value, sd: value * value * doubted((a - b * b / d).max(0.0), by_bends) }
    }

    /// Beside other runs of the line, whose ways are bent alike.
    pub(crate) fn beside_others(&self) -> Self {
        Self { by_bends: Matrix2::zeros(), ..*self }
    }
}

/// Bends that count less still count: of trams, metros and suburban trains 5 to 12 s apart what was measured was off by
/// up to three times of what they made of it. Which way they bend makes half the difference between both, and the
/// formulas for both miss as much.
pub(crate) const BENDS_SD: [f64; 2] = [1.5, 1.25];

/// Standard deviation with a doubt of the bends.
fn doubted(variance: f64, by_bends: Vector2<f64>) -> f64 {
    variance.sqrt().hypot(by_bends.component_mul(&Vector2::from(BENDS_SD)).norm())
}

/// What a driver's style does to the comparison is the same all through a run, and shows in the scatter between runs
/// only: one run alone has twice the standard deviation that its noise says, four have a tenth more.
pub(crate) const FEW_RUNS: f64 = 3.0;

/// In one run alone the same few bends count again and again: its scale was off by up to three times of what they
/// usually make.
pub(crate) const ALONE: f64 = 2.0;

/// Tells each run of a recorder what bends between the rows usually make of one alone: root of the mean square.
pub(crate) fn share_bends(runs: &mut [Option<Agreement>]) {
    let alone = |run: &Agreement| {
        let alone = std::slice::from_ref(run);
        by_bends(alone, &joint(alone)?.values)
    };
    let squares: Vec<Matrix2<f64>> =
        runs.iter().flatten().filter_map(alone).map(|one| one.component_mul(&one)).collect();
    let usual =
        (squares.iter().sum::<Matrix2<f64>>() / squares.len().max(1) as f64).map(|square| ALONE * square.sqrt());
    runs.iter_mut().flatten().for_each(|run| run.usual_bends = usual);
}

/// A row of one of the runs is far from the next.
fn are_far(runs: &[Agreement]) -> bool {
    runs.iter().any(|run| run.with_other_bends.is_some())
}

/// What the runs say together, the ways bent as they are taken to be.
fn joint(runs: &[Agreement]) -> Option<Joint> {
    rounding::joint(&runs.iter().map(|run| &run.equations).collect::<Vec<_>>(), are_far(runs))
}

/// What these values of 1/s - 1 and o/s are more by than with other bends.
fn by_bends(runs: &[Agreement], values: &Vector2<f64>) -> Option<Matrix2<f64>> {
    if !are_far(runs) {
        return Some(Matrix2::zeros());
    }
    let more_than = |which: usize| {
        let others = runs.iter().map(|run| run.with_other_bends.as_ref().map_or(&run.equations, |all| &all[which]));
        Some(values - rounding::joint(&others.collect::<Vec<_>>(), true)?.values)
    };
    Some(Matrix2::from_columns(&[more_than(0)?, more_than(1)?]))
}

/// Pools runs, each weighed by what it can tell apart.
pub fn pooled(runs: &[Agreement]) -> Option<Pooled> {
    let Joint { values, covariance } = joint(runs)?;
    let mut by_bends = by_bends(runs, &values)?;
    if let [one] = runs {
        by_bends = by_bends.zip_map(&one.usual_bends, |own: f64, usual: f64| own.abs().max(usual).copysign(own));
    }
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
    let shared = runs.iter().map(|run| run.shared).sum::<Vector2<f64>>() / n;
    let covariance = larger(covariance, by_scatter) * few + shared * shared.transpose();
    Some(Pooled { values, covariance, by_bends, runs: runs.len() })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_one_is_that_one_whatever_rounding_does() {
        for i in 0..1000 {
            let one = Figure { value: 0.9 + 1e-4 * f64::from(i) / 3.0, sd: 1e-5 * f64::from(i + 1) / 7.0 };
            let mean = Figure::mean_of(&[one]).unwrap();
            assert!(
                (mean.sd / one.sd - 1.0).abs() < 1e-9 && (mean.value - one.value).abs() < 1e-12,
                "{one:?} {mean:?}"
            );
        }
    }
}
