//! Distances by location over those by speed, stretch by stretch of a moving train.
//!
//! In: rows that have time, place and speed, by file. Out: a ratio a stretch. Rows need not be evenly spaced, and a
//! place may be held for many of them.

use super::super::columns::Columns;
use super::super::geo;
use super::super::meaning::Meaning;
use rundown_files::statistics::{median, upper_quantile};

/// A step is no gap up to so many usual ones, or so many of those that this share of the steps do not exceed.
/// Judgement: of rows in bursts of ten one step in ten is long, and between two rows of a moving train that far apart
/// it hardly stops.
const MOST_STEPS: f64 = 10.0;
const LONG_STEP: f64 = 0.9;
const MOST_LONG_STEPS: f64 = 2.0;
/// A train moves above this share of the speed that is hardly ever exceeded.
pub const MOVES: f64 = 0.25;

/// A row of a moving train: time in s where it is no number; location, or latitude and longitude.
#[derive(Clone, Copy)]
pub struct Passing {
    pub time: f64,
    pub place: (f64, f64),
    pub speed: f64,
}

fn steps_of(pieces: &[Vec<Passing>]) -> impl Iterator<Item = f64> {
    let steps = pieces.iter().flat_map(|rows| rows.windows(2).map(|pair| pair[1].time - pair[0].time));
    steps.filter(|step| *step > 0.0)
}

/// The speed that is hardly ever exceeded, and the usual step of the clock.
pub fn usual(pieces: &[Vec<Passing>]) -> Option<(f64, f64)> {
    let fastest = upper_quantile(pieces.iter().flatten().map(|row| row.speed), 0.99)?;
    Some((fastest, median(steps_of(pieces))?))
}

/// The longest step that is no gap: rows that come in bursts have short ones in them and long ones between them.
pub fn longest(pieces: &[Vec<Passing>], step: f64) -> f64 {
    let long = upper_quantile(steps_of(pieces), LONG_STEP).unwrap_or(step);
    (MOST_STEPS * step).max(MOST_LONG_STEPS * long)
}

/// Of stretches of a moving train with so many steps, of the place or of the rows: a place that a recorder holds for a
/// while moves none, and a stretch goes from change to change.
pub fn ratios(
    pieces: &[Vec<Passing>],
    columns: &Columns,
    [fastest, longest]: [f64; 2],
    (steps, of_place): (usize, bool),
) -> Vec<f64> {
    let located = columns.has(Meaning::Location);
    let goes_on = |a: &Passing, b: &Passing| {
        a.speed.min(b.speed) > MOVES * fastest && b.time > a.time && b.time - a.time < longest
    };
    let mut ratios = Vec::new();
    for rows in pieces {
        // Distances, and steps; none before the place has changed for the first time.
        let mut stretch: Option<(f64, f64, usize)> = None;
        for pair in rows.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            let moved = !of_place || a.place != b.place;
            if !goes_on(a, b) {
                stretch = None;
                continue;
            }
            let Some((by_speed, by_place, count)) = &mut stretch else {
                stretch = moved.then_some((0.0, 0.0, 0));
                continue;
            };
            *by_speed += 0.5 * (a.speed + b.speed) * (b.time - a.time);
            *by_place += if located { b.place.0 - a.place.0 } else { geo::distance_m(a.place, b.place) };
            *count += usize::from(moved);
            if *count == steps {
                ratios.push(by_place.abs() / *by_speed);
                stretch = Some((0.0, 0.0, 0));
            }
        }
    }
    ratios
}
