//! Wheels that creep: the speed of a driven axle reads too much while it powers, and what the train runs is right.
//!
//! ```text
//! Δx - ∫ v_r dt = ... - c/2 (∫ v_r dt rising) + c/2 (∫ v_r dt falling) - h (∫ v_r dt steady) + b Δa + noise
//! ```
//!
//! A wheel that is not as described is off by the same factor at all times. So where the scale of a speed that rises is
//! another one than that of a speed that falls, c, neither is a wheel's. A steady speed may be held by power, or be
//! that of a coast on a descent: what it is off by itself, h, is left to it. So is what means over some seconds make of
//! speeds that turn, b Δa ([`crate::recorder::second_order`]), which goes with the rises as c does.
//!
//! On climbs a train powers while it gets slower. So c is asked twice: against all speeds that fall, and against those
//! that fall so fast that the train brakes, where slower falls are left to h. The second is preferred.

use crate::LEAST_SCALE;
use crate::agreement::compared::{Compared, Differences, dot};
use crate::agreement::{BENDS_SD, FEW_RUNS};
use crate::figure::Figure;
use nalgebra::{Matrix3, Vector3};

/// A train that gains or loses less speed than this may power, coast or brake, m/s².
pub(crate) const RISES_MPS2: f64 = 0.08;
pub(crate) const FALLS_MPS2: f64 = -0.03;
/// On hills a freight train powers while it gets slower: one that gets slower by more brakes, m/s². On 1.5 % it loses
/// as much.
const BRAKES_MPS2: f64 = -0.15;
/// Creep of wheels that power, as a share of the speed: adhesion is best at one to three per cent. Where so much does
/// not show nothing is said; and half of it a steady speed is off by beside the mean of both, standard deviation.
const SOME_CREEP: f64 = 0.02;
/// What speeds may have of the second order, standard deviation, s²: means over 15 s have 9.4.
const SECOND_ORDER_S2: f64 = 10.0;
/// So many standard deviations: nothing is put right by it, so less than what is sure suffices.
const CONTRADICTS: f64 = 3.0;

/// By how much more the speed reads while it rises than while it falls, and than while the train brakes, as a share of
/// it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Creep {
    beside_falls: Option<Contrast>,
    beside_brakes: Option<Contrast>,
}

/// The speeds that c is asked against: those that fall by more, m/s².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Falls(f64);

impl Falls {
    /// What c, h and b add to each difference of this run, m.
    pub(crate) fn creep_m(self, compared: &Compared) -> Option<Vec<f64>> {
        let columns = columns(&compared.differences, self.0);
        let (_, factors) = fitted(compared, &columns)?;
        let of = |at: usize| (0..3).map(|which| factors[which] * columns[which][at]).sum();
        Some((0..columns[0].len()).map(of).collect())
    }
}

/// c against one kind of falling speed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Contrast {
    figure: Figure,
    /// What it is more by than with other bends of the ways between the rows.
    by_bends: [f64; 2],
}

impl Creep {
    /// None: the run does not say.
    pub(crate) fn of(compared: &Compared, with_other_bends: Option<&[Compared; 2]>) -> Option<Self> {
        let beside = |falls_mps2: f64| {
            let columns = columns(&compared.differences, falls_mps2);
            let figure = fitted(compared, &columns)?.0;
            let more_than =
                |other: &Compared| fitted(other, &columns).map_or(0.0, |other| figure.value - other.0.value);
            let by_bends = with_other_bends.map_or([0.0; 2], |all| [more_than(&all[0]), more_than(&all[1])]);
            Some(Contrast { figure, by_bends })
        };
        let [beside_falls, beside_brakes] = [FALLS_MPS2, BRAKES_MPS2].map(beside);
        (beside_falls.is_some() || beside_brakes.is_some()).then_some(Self { beside_falls, beside_brakes })
    }

    /// What runs of one recorder say together, where it matters and they contradict one wheel, and of what c is asked:
    /// against braking, when surely nothing drives, or else against all falls.
    pub(crate) fn sure<'a>(runs: impl Iterator<Item = &'a Self> + Clone) -> Option<(Figure, Falls)> {
        let is_sure = |all: &Figure| {
            all.sd * CONTRADICTS < SOME_CREEP && all.value.abs() > LEAST_SCALE && all.away_from(0.0) > CONTRADICTS
        };
        let pooled = |falls: Falls, of: fn(&Self) -> Option<&Contrast>| {
            let figure = Contrast::pooled(runs.clone().filter_map(of)).filter(is_sure)?;
            Some((figure, falls))
        };
        pooled(Falls(BRAKES_MPS2), |run| run.beside_brakes.as_ref())
            .or_else(|| pooled(Falls(FALLS_MPS2), |run| run.beside_falls.as_ref()))
    }
}

impl Contrast {
    fn pooled<'a>(runs: impl Iterator<Item = &'a Self> + Clone) -> Option<Figure> {
        let figures: Vec<Figure> = runs.clone().map(|run| run.figure).collect();
        let n = figures.len() as f64;
        let mean = Figure::mean_of(&figures)?;
        let few = (1.0 + FEW_RUNS / (n * n)).sqrt();
        // Ways are bent alike in all runs of a line.
        let all: f64 = figures.iter().map(|one| one.sd.powi(-2)).sum();
        let bent = |which: usize| {
            let more: f64 = runs.clone().map(|run| run.figure.sd.powi(-2) * run.by_bends[which]).sum();
            BENDS_SD[which] * more / all
        };
        Some(Figure { sd: (few * mean.sd).hypot(bent(0)).hypot(bent(1)), ..mean })
    }
}

/// What c, h and b add to each difference, m.
fn columns(differences: &Differences, falls_mps2: f64) -> [Vec<f64>; 3] {
    let share = |mps2: &f64| match *mps2 {
        mps2 if mps2 > RISES_MPS2 => [-0.5, 0.0],
        mps2 if mps2 < falls_mps2 => [0.5, 0.0],
        _ => [0.0, -1.0],
    };
    let shares: Vec<[f64; 2]> = differences.mps2().iter().map(share).collect();
    let of = |which: usize| differences.by_speed.iter().zip(&shares).map(|(m, share)| share[which] * m).collect();
    [of(0), of(1), differences.turns_mps2.clone()]
}

/// c beside h, b, scale, offset and skew; and all three.
fn fitted(compared: &Compared, columns: &[Vec<f64>; 3]) -> Option<(Figure, Vector3<f64>)> {
    let fit = &compared.fit;
    let variance = fit.variance / compared.independent();
    let of = columns.each_ref().map(|metres| compared.taken_up(metres));
    let taken = |i: usize, j: usize| (0..3).map(|k| of[i].0[k] * dot(&fit.columns[k], &of[j].1)).sum::<f64>();
    let mut information = Matrix3::from_fn(|i, j| (dot(&of[i].1, &of[j].1) - taken(i, j)) / variance);
    information[(1, 1)] += (0.5 * SOME_CREEP).powi(-2);
    information[(2, 2)] += SECOND_ORDER_S2.powi(-2);
    let score = Vector3::from_fn(|i, _| dot(&of[i].1, &fit.residuals) / variance);
    let covariance = information.cholesky()?.inverse();
    let factors = covariance * score;
    Some((Figure { value: factors[0], sd: covariance[(0, 0)].sqrt() }, factors))
}
