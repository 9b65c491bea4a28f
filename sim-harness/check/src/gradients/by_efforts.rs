//! Do measured efforts vouch for the described gradients?
//!
//! ```text
//! dv/dt = q u - k g(s) - b0 - b1 v - b2 v²          k: 1 described rightly, -1 with the sign turned, 0 of another line
//! ```
//!
//! Speeds that are held by a fine hand fall and rise with the slopes, run after run at the same places, as coasts on
//! other slopes would. Beside the efforts they are no riddle. How surely k is known is what places say of it.

use crate::effort::{self, least_squares};
use nalgebra::SVector;
use rundown::model::direction::Direction;
use rundown::model::line::Line;
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown_files::sample::Sample;
use std::collections::BTreeMap;

/// Length of a window, s.
const WINDOW_S: f64 = 10.0;
/// Slower trains creep, m/s; and an effort that changes by more has no mean that is known, N/kg.
const SLOWEST_MPS: f64 = 5.0;
const MOST_CHANGE_N_PER_KG: f64 = 0.05;
/// Fewer windows say nothing.
const LEAST_WINDOWS: usize = 200;
/// k of described gradients is within this of 1 ...
const NEAR: f64 = 0.15;
/// ... by so many standard deviations less.
const SURE: f64 = 2.0;
/// Length of a place, m.
const PLACE_M: f64 = 1000.0;

/// What a train did in some seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Driven {
    ends_m: [f64; 2],
    direction: Direction,
    speed_mps: f64,
    acceleration_mps2: f64,
    effort_n_per_kg: f64,
}

/// The windows of a run in which the effort hardly changes; none without an effort column.
pub(super) fn windows(rows: &[Sample], direction: Direction) -> Vec<Driven> {
    effort::stretches(rows, WINDOW_S).into_iter().filter_map(|rows| window(rows, direction)).collect()
}

fn window(rows: &[Sample], direction: Direction) -> Option<Driven> {
    let ([from, to], (acceleration_mps2, effort_n_per_kg)) = ([rows.first()?, rows.last()?], effort::window(rows)?);
    let speeds_mps = [from.speed_mps?, to.speed_mps?];
    let efforts = || rows.iter().filter_map(|row| row.effort_n_per_kg);
    let change = efforts().fold(f64::NEG_INFINITY, f64::max) - efforts().fold(f64::INFINITY, f64::min);
    let is_usable = speeds_mps[0].min(speeds_mps[1]) > SLOWEST_MPS && change < MOST_CHANGE_N_PER_KG;
    is_usable.then_some(Driven {
        ends_m: [from.location_m?, to.location_m?],
        direction,
        speed_mps: 0.5 * (speeds_mps[0] + speeds_mps[1]),
        acceleration_mps2,
        effort_n_per_kg,
    })
}

/// The described gradients are those that the efforts need.
pub(super) fn vouch(windows: &[Driven], train: &Train, track: &Track) -> bool {
    let row = |window: &Driven| {
        let line = Line { train, track, direction: window.direction };
        let gradient = 0.5 * window.ends_m.iter().map(|at_m| line.gradient_n_per_kg(*at_m)).sum::<f64>();
        let v = window.speed_mps;
        (SVector::from([-gradient, window.effort_n_per_kg, 1.0, v, v * v]), window.acceleration_mps2)
    };
    let rows: Vec<(SVector<f64, 5>, f64)> = windows.iter().map(row).collect();
    if rows.len() < LEAST_WINDOWS {
        return false;
    }
    let Some((beta, inverse)) = least_squares(&rows) else { return false };
    let mut places: BTreeMap<i64, f64> = BTreeMap::new();
    for (window, (x, acceleration)) in windows.iter().zip(&rows) {
        let place = (window.ends_m[0] / PLACE_M).floor() as i64;
        *places.entry(place).or_default() += (inverse.row(0) * x)[0] * (acceleration - x.dot(&beta));
    }
    let sd = places.values().map(|score| score * score).sum::<f64>().sqrt();
    (beta[0] - 1.0).abs() + SURE * sd < NEAR
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rundown::model::track::Gradient;
    use rundown::model::train::TrainDescription;

    /// 40 km of slopes, so many times as steep.
    fn track(steep: f64) -> Track {
        let gradient =
            |i: u32| Gradient { from_m: 1000.0 * f64::from(i), permille: steep * (f64::from(i * 7 % 11) - 5.0) };
        Track::try_new(40_000.0, (0..40).map(gradient)).unwrap()
    }

    /// What a driver who holds the speed roughly does on these slopes, seconds late.
    fn driven(track: &Track, train: &Train) -> Vec<Driven> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let line = Line { train, track, direction: Direction::Up };
        let window = |i: u32| {
            let at_m = f64::from(i * 150 % 39_000) + 400.0;
            let effort_n_per_kg = 0.02 + line.gradient_n_per_kg(at_m - 300.0) + rng.random_range(-0.02..0.02);
            let resistance = 0.01 + 2e-5 * 900.0 + line.gradient_n_per_kg(at_m);
            Driven {
                ends_m: [at_m; 2],
                direction: Direction::Up,
                speed_mps: 30.0 + rng.random_range(-5.0..5.0),
                acceleration_mps2: 1.03 * effort_n_per_kg - resistance + rng.random_range(-0.01..0.01),
                effort_n_per_kg,
            }
        };
        (0..1500).map(window).collect()
    }

    #[test]
    fn efforts_vouch_for_the_slopes_that_they_go_over_and_for_no_others() {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let windows = driven(&track(1.0), &train);
        assert!(vouch(&windows, &train, &track(1.0)));
        for steep in [-1.0, 0.1, 0.5, 2.0] {
            assert!(!vouch(&windows, &train, &track(steep)), "{steep}");
        }
        assert!(!vouch(&windows[..LEAST_WINDOWS - 1], &train, &track(1.0)), "too few");
    }
}
