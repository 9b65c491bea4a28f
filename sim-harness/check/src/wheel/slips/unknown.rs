//! Which part of a bump of the speed the locations do not know.
//!
//! ```text
//! x - ∫ v_r dt = offset + drift t + scale ∫ v dt + τ v - k ∫ (v_r - v) dt + noise          v: as if nothing had slipped
//! ```
//!
//! k is 1 of a slip, 0 of a train that ran so. A wheel or an age of the speed goes on beside it. The noise is that of
//! the locations, white and a walk.

use super::Chord;
use crate::agreement::compared::{Compared, Differences, Row};
use crate::figure::Figure;
use nalgebra::{SMatrix, SVector};
use rundown_files::statistics::{median, spread};
use std::ops::Range;

/// Time before and behind a slip in which the locations show what it made of the way, s.
const AROUND_S: f64 = 16.0;
/// What is believed of drift, m/s, scale, age of the speed, s, and share of the bump: standard deviations.
const BELIEVED: [f64; 4] = [0.3, 0.02, 2.0, 3.0];
/// No locations are known better, m.
const LEAST_NOISE_M: f64 = 0.3;
/// Of a slip each of its seconds makes a part.
const MOST_OF_LEAP: f64 = 0.97;

/// What the locations of a run are off by.
pub(super) struct Noise {
    /// White, variance, m².
    white_m2: f64,
    /// Growth of the variance of a walk, m²/s.
    walk_m2: f64,
}

impl Noise {
    /// By the medians of what scale, offset and age of the speed leave: slips do not decide it.
    pub(super) fn of(parts: &[Vec<Row>]) -> Option<Self> {
        let compared = Compared::roughly(Differences::of(parts))?;
        let left_m = compared.left_m();
        let dt_s = median(&compared.differences.dt)?;
        let two_m = left_m.windows(2).map(|two| two[0] + two[1]);
        let bends_m =
            parts.iter().flat_map(|part| part.windows(3).map(|rows| apart_m(&rows[1..]) - apart_m(&rows[..2])));
        let white_m2 = (spread(bends_m).powi(2) / 6.0).max(LEAST_NOISE_M.powi(2));
        let walk_m2 = ((spread(two_m).powi(2) - 2.0 * white_m2) / (2.0 * dt_s)).max(0.0);
        Some(Self { white_m2, walk_m2 })
    }
}

/// Way by location less that by speed, between two rows, m.
fn apart_m(rows: &[Row]) -> f64 {
    let dt = rows[1].time_s - rows[0].time_s;
    rows[1].location_m - rows[0].location_m - 0.5 * dt * (rows[0].speed_mps + rows[1].speed_mps)
}

/// Two neighbours make most of what speed and location are apart by: a clock that loses a second, or a location that
/// leaps.
pub(super) fn is_leap(rows: &[Row]) -> bool {
    let apart_m: Vec<f64> = rows.windows(2).map(apart_m).collect();
    let most_m = apart_m.iter().fold(0.0, |most: f64, apart_m| most.max(apart_m.abs()));
    most_m >= MOST_OF_LEAP * apart_m.iter().sum::<f64>().abs()
}

/// Which part of a bump the locations do not know.
pub(super) fn share(part: &[Row], rows: &Range<usize>, noise: &Noise) -> Option<Figure> {
    let line = Chord::through(part[rows.start], part[rows.end]);
    let before = part[..rows.start].iter().rev().take_while(|row| row.time_s >= line.from.time_s - AROUND_S).count();
    let behind = part[rows.end..].iter().take_while(|row| row.time_s <= line.to.time_s + AROUND_S).count();
    let mut normal = SMatrix::<f64, 4, 4>::from_diagonal(&SVector::from(BELIEVED.map(|sd| sd.powi(-2))));
    let mut score = SVector::<f64, 4>::zeros();
    // The differences of neighbouring rows, made white.
    let (mut last, mut variance) = ((SVector::<f64, 4>::zeros(), 0.0), f64::INFINITY);
    for two in part[rows.start - before..rows.end + behind].windows(2) {
        let dt = two[1].time_s - two[0].time_s;
        let mps = [&two[0], &two[1]].map(|row| line.of(row));
        let way_m = 0.5 * dt * (mps[0] + mps[1]);
        let bump_m = way_m - 0.5 * dt * (two[0].speed_mps + two[1].speed_mps);
        let gain = -noise.white_m2 / variance;
        let x = SVector::from([dt, way_m, mps[1] - mps[0], bump_m]) - last.0 * gain;
        let y = apart_m(two) - last.1 * gain;
        variance = 2.0 * noise.white_m2 + noise.walk_m2 * dt + gain * noise.white_m2;
        normal += x * x.transpose() / variance;
        score += x * (y / variance);
        last = (x, y);
    }
    let inverse = normal.cholesky()?.inverse();
    Some(Figure { value: (inverse * score)[3], sd: inverse[(3, 3)].sqrt() })
}
