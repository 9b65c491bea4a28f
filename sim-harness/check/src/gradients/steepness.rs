//! How many times as steep as described the gradients are, by the coasts.
//!
//! ```text
//! a = -k g(s) - δ0 - (1 + δ1) r          a: gain of kinetic energy over the way; each stretch as surely as it is coasted
//! ```
//!
//! A rotating mass that is off, or a survey in another unit of height, makes k another number than 1. It follows the
//! slopes, so no number of runs averages it out, and no place stands out by it.

use super::mixture::MixtureFit;
use super::stretch::Stretch;
use crate::effort::least_squares;
use crate::figure::Figure;
use nalgebra::{SMatrix, SVector};
use std::collections::BTreeMap;

/// Length of a place, m.
const PLACE_M: f64 = 1000.0;
/// Fewer places do not show how surely k is known; a single one would leave no doubt at all.
const LEAST_PLACES: usize = 10;
/// So many coasted stretches must say it.
pub(super) const LEAST_COASTED: f64 = 200.0;
/// They are taken to scatter by no more than whole km/h make them, N/kg: where trains hold speeds or power a little as
/// well, a wider distribution has stretches in it that follow the slopes.
pub(super) const MOST_SD_N_PER_KG: f64 = 0.006;
/// It is another number than 1 by so many standard deviations, and by so much.
const SURELY_NOT: f64 = 3.0;
const LEAST_STEEPER: f64 = 0.02;
/// Drivers who power a little on climbs make right slopes look less steep: by up to 0.05 on trams, 0.025 elsewhere.
const LEAST_FLATTER: f64 = 0.03;

/// k with its standard deviation over the places, where it surely is another number than 1.
pub(super) fn by_coasts(stretches: &[Stretch], climbs_n_per_kg: &[f64]) -> Option<Figure> {
    let fit = MixtureFit::of(stretches, climbs_n_per_kg, MOST_SD_N_PER_KG)?;
    let steep = fitted(stretches, &fit.shares, climbs_n_per_kg).filter(|_| fit.coasted() >= LEAST_COASTED)?;
    let (off, sure) = (steep.value - 1.0, SURELY_NOT * steep.sd);
    let is_off = off > LEAST_STEEPER.max(sure) || -off > LEAST_FLATTER + sure;
    is_off.then_some(steep)
}

/// Of stretches that are coasted as surely as `shares` say; none from too few places.
fn fitted(stretches: &[Stretch], shares: &[f64], climbs_n_per_kg: &[f64]) -> Option<Figure> {
    let row = |((stretch, climb), share): ((&Stretch, &f64), &f64)| {
        let (weight, r) = (share.sqrt(), stretch.resistance_n_per_kg);
        (SVector::from([-climb, 1.0, r]) * weight, weight * (stretch.gain_n_per_kg + r))
    };
    let rows: Vec<(SVector<f64, 3>, f64)> = stretches.iter().zip(climbs_n_per_kg).zip(shares).map(row).collect();
    let (beta, inverse, _) = least_squares(&rows)?;
    first_over_places(&rows, stretches.iter().map(|stretch| stretch.fronts_m), (&beta, &inverse))
}

/// The first coefficient of a fit with its standard deviation over the places at which its rows begin; none from too
/// few.
pub(super) fn first_over_places<const N: usize>(
    rows: &[(SVector<f64, N>, f64)],
    fronts_m: impl Iterator<Item = [f64; 2]>,
    fit: (&SVector<f64, N>, &SMatrix<f64, N, N>),
) -> Option<Figure> {
    let place = |[from_m, _]: [f64; 2]| (from_m / PLACE_M).floor() as i64;
    first_over(rows, fronts_m.map(place), fit, LEAST_PLACES)
}

/// The same over any groups of the rows; none from fewer than `least`.
pub(super) fn first_over<const N: usize, G: Ord>(
    rows: &[(SVector<f64, N>, f64)],
    groups: impl Iterator<Item = G>,
    (beta, inverse): (&SVector<f64, N>, &SMatrix<f64, N, N>),
    least: usize,
) -> Option<Figure> {
    let mut scores: BTreeMap<G, f64> = BTreeMap::new();
    for (group, (x, y)) in groups.zip(rows) {
        *scores.entry(group).or_default() += (inverse.row(0) * x)[0] * (y - x.dot(beta));
    }
    if scores.len() < least {
        return None;
    }
    // The scores have no sum: one group less is free.
    let groups = scores.len() as f64;
    let sd = (scores.values().map(|score| score * score).sum::<f64>() * groups / (groups - 1.0)).sqrt();
    Some(Figure { value: beta[0], sd })
}
