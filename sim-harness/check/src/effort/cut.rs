//! An effort column that is cut off at a maximum: what is larger is written as that.
//!
//! In: rows of all runs of a unit, put right, and the line with the train as described. Out: the most, where the train
//! needs more than that for its motion.
//!
//! ```text
//! Δv/Δt + g = q e - k r                of smaller efforts; r as described
//! times = (Δv/Δt + g + k r) / (q e)    of those at the most; 1 where nothing is cut off
//! ```
//!
//! Trains that start with a constant effort have a most of their own, too, and it moves them as their other efforts do.

use crate::SURE;
use crate::effort::demanded::{Powered, powered};
use crate::effort::least_squares;
use crate::figure::Figure;
use nalgebra::Vector2;
use rundown::model::line::Line;
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, sd_of_median, spread};

/// Efforts within this share of the most are at it: the digits of the column.
const AT_MOST: f64 = 2e-3;
/// Smaller ones that are compared with it have this share of it at least, and this at most: a mean over a row is at the
/// most in part.
const SMALLER: [f64; 2] = [0.3, 0.9];
/// So many windows of either.
const LEAST_WINDOWS: usize = 20;
/// A smaller multiple is what readings leave. Judgement: columns that are not cut off have 0.99 to 1.00.
const LEAST_TIMES: f64 = 1.04;

/// The most, N/kg, and how many times as much the trains need in the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cut {
    pub(crate) most_n_per_kg: f64,
    pub(crate) times: Figure,
}

/// None: the efforts end nowhere, or where the trains' do.
pub(crate) fn of<'a>(runs: impl Iterator<Item = (&'a [Sample], Line<'a>)>) -> Option<Cut> {
    let windows: Vec<Powered> = runs.flat_map(|(rows, line)| powered(rows, &line)).collect();
    let most = windows.iter().map(|window| window.effort).fold(0.0, f64::max);
    let (mut at_most, mut smaller) = (Vec::new(), Vec::new());
    for window in windows {
        if is_at(window.effort, most) {
            at_most.push(window);
        } else if (SMALLER[0] * most..SMALLER[1] * most).contains(&window.effort) {
            smaller.push(window);
        }
    }
    if at_most.len().min(smaller.len()) < LEAST_WINDOWS {
        return None;
    }
    let row = |window: &Powered| (Vector2::new(window.effort, -window.resistance), window.gained);
    let rows: Vec<(Vector2<f64>, f64)> = smaller.iter().map(row).collect();
    let (fitted, inverse, left) = least_squares(&rows)?;
    let [q, k] = [fitted[0], fitted[1]];
    let noise = left / rows.len() as f64;
    let of = |window: &Powered| (window.gained + k * window.resistance) / (q * window.effort);
    let times = median(at_most.iter().map(of))?;
    let resistance = median(at_most.iter().map(|window| window.resistance))?;
    let by = Vector2::new(-times / q, resistance / (q * most));
    let of_fit = (noise * (by.transpose() * inverse * by)[0]).sqrt();
    let of_median = sd_of_median(spread(at_most.iter().map(|window| of(window) - times)), at_most.len());
    let times = Figure { value: times, sd: of_fit.hypot(of_median) };
    let is_cut = q > 0.0 && times.value - SURE * times.sd > LEAST_TIMES;
    is_cut.then_some(Cut { most_n_per_kg: most, times })
}

fn is_at(effort: f64, most: f64) -> bool {
    effort >= (1.0 - AT_MOST) * most
}

/// Leaves out what was cut off, and the rows beside it, whose means were in part. Out: how many were cut off.
pub(crate) fn leave_out(rows: &mut [Sample], cut: &Cut) -> usize {
    let at: Vec<usize> = (0..rows.len())
        .filter(|i| rows[*i].effort_n_per_kg.is_some_and(|effort| is_at(effort, cut.most_n_per_kg)))
        .collect();
    for i in &at {
        let beside = i.saturating_sub(1)..rows.len().min(i + 2);
        rows[beside].iter_mut().for_each(|row| row.effort_n_per_kg = None);
    }
    at.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::direction::Direction;
    use rundown::model::track::Track;
    use rundown::model::train::{Train, TrainDescription};

    /// Rows of a train that powers with 0.4 N/kg up to 12 m/s and then with 4.8 W/kg, written up to `most`, ten times.
    fn found(most: f64, times_r: f64) -> (Option<Cut>, Vec<Sample>) {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let track = Track::try_new(40_000.0, []).unwrap();
        let line = Line { train: &train, track: &track, direction: Direction::Up };
        let mut rows = Vec::new();
        let mut speed_mps = 0.0_f64;
        for i in 0..2400 {
            let effort = (4.8 / speed_mps.max(1.0)).min(0.4);
            rows.push(Sample {
                time_s: f64::from(i),
                location_m: Some(1000.0),
                speed_mps: Some(speed_mps),
                effort_n_per_kg: Some(effort.min(most)),
                ..Sample::default()
            });
            speed_mps += effort - times_r * train.davis().resistance_n_per_kg(speed_mps);
            if i % 240 == 239 {
                speed_mps = 0.0;
            }
        }
        (of(std::iter::once((rows.as_slice(), line))), rows)
    }

    #[test]
    fn a_column_that_ends_below_what_moves_the_train_is_cut_off_and_an_effort_of_the_start_is_not() {
        let (cut, mut rows) = found(0.2, 1.0);
        let cut = cut.unwrap();
        assert!((cut.most_n_per_kg - 0.2).abs() < 1e-12 && (1.1..2.0).contains(&cut.times.value), "{cut:?}");
        let count = leave_out(&mut rows, &cut);
        let kept: Vec<f64> = rows.iter().filter_map(|row| row.effort_n_per_kg).collect();
        assert!(count > 100 && kept.len() > 1000 && kept.iter().all(|effort| *effort < 0.2), "{count}");
        for times_r in [0.7, 1.0, 1.4] {
            assert_eq!(found(0.4, times_r).0, None, "{times_r}");
        }
    }
}
