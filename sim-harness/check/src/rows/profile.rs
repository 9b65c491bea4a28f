//! One run over its way: speed by location, and where it stood.

use rundown_files::sample::Sample;
use std::ops::Range;

/// Length of a cell, m.
pub const CELL_M: f64 = 50.0;
/// A way of more cells is none that a train went in one run.
const MOST_CELLS: f64 = 60_000.0;
/// Below this a train stands, m/s.
const STANDING_MPS: f64 = 0.3;
/// Standing for less is not seen by every recorder, s.
const LEAST_STAND_S: f64 = 8.0;
/// A gap of rows in which the train moved on slower than this was a stand, m/s.
const CRAWL_MPS: f64 = 0.5;
/// A gap is one beyond this, s.
const LEAST_GAP_S: f64 = 15.0;

/// A standstill on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Where, along the direction of travel, m.
    pub at_m: f64,
    /// How long, s.
    pub duration_s: f64,
}

/// Speed over location. Locations are those of the track, with the sign of the direction: they grow.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Where the run begins and ends, m.
    pub ends_m: [f64; 2],
    /// Number of the first cell.
    pub first_cell: i64,
    /// Lowest speed in each cell, m/s; not a number where it is not known.
    pub speeds_mps: Vec<f32>,
    /// Standstills between the ends, in order.
    pub stands: Vec<Stand>,
}

/// A row with all that is needed.
#[derive(Clone, Copy)]
struct Point {
    time_s: f64,
    at_m: f64,
    mps: f64,
}

/// Number of the cell of a location.
pub fn cell(at_m: f64) -> i64 {
    (at_m / CELL_M).floor() as i64
}

impl Profile {
    /// None where the run does not move by a few cells.
    pub fn of(rows: &[Sample], sign: f64) -> Option<Self> {
        let points = points(rows, sign);
        let (first, last) = (points.first()?, points.last()?);
        let length = (last.at_m - first.at_m) / CELL_M;
        if !(4.0..MOST_CELLS).contains(&length) {
            return None;
        }
        let first_cell = cell(first.at_m);
        let mut speeds_mps = vec![f32::NAN; (cell(last.at_m) - first_cell + 1) as usize];
        let mut lower = |cell: i64, mps: f64| {
            let slot = usize::try_from(cell - first_cell).ok().and_then(|at| speeds_mps.get_mut(at));
            if let Some(slot) = slot {
                *slot = slot.min(mps as f32);
            }
        };
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            lower(cell(a.at_m), a.mps);
            lower(cell(b.at_m), b.mps);
            for between in cell(a.at_m) + 1..cell(b.at_m) {
                // With a constant acceleration the square of the speed is linear in the location.
                let share = ((between as f64 + 0.5) * CELL_M - a.at_m) / (b.at_m - a.at_m);
                lower(between, (a.mps * a.mps * (1.0 - share) + b.mps * b.mps * share).max(0.0).sqrt());
            }
        }
        Some(Self { ends_m: [first.at_m, last.at_m], first_cell, speeds_mps, stands: stands(&points) })
    }

    pub fn speed_mps(&self, cell: i64) -> Option<f32> {
        get(&self.speeds_mps, cell - self.first_cell)
    }

    /// The run passes a place, neither beginning nor ending within `near_m` of it.
    pub fn passes(&self, at_m: f64, near_m: f64) -> bool {
        (self.ends_m[0] + near_m..self.ends_m[1] - near_m).contains(&at_m)
    }

    /// The run stands, begins or ends within `near_m` of a place.
    pub fn calls_at(&self, at_m: f64, near_m: f64) -> bool {
        let stands_m = self.stands.iter().map(|stand| stand.at_m);
        stands_m.chain(self.ends_m).any(|stand_m| (stand_m - at_m).abs() <= near_m)
    }

    /// Where the run stands, its ends among them where it begins or ends at a stand, m.
    pub fn calls_m(&self) -> Vec<f64> {
        let stands_at = |at_m: f64| self.speed_mps(cell(at_m)).is_some_and(|mps| f64::from(mps) < STANDING_MPS);
        let [first_m, last_m] = self.ends_m;
        let within = self.stands.iter().map(|stand| stand.at_m);
        let ends = [first_m, last_m].map(|at_m| Some(at_m).filter(|at_m| stands_at(*at_m)));
        ends[0].into_iter().chain(within).chain(ends[1]).collect()
    }

    /// For each cell the lowest speed within so many metres: others brake a little earlier or later.
    pub fn lows(&self, near_m: f64) -> Vec<f32> {
        let reach = (near_m / CELL_M).round() as usize;
        let lowest = |at: usize| {
            let from = at.saturating_sub(reach);
            let to = (at + reach + 1).min(self.speeds_mps.len());
            self.speeds_mps[from..to].iter().copied().fold(f32::NAN, f32::min)
        };
        (0..self.speeds_mps.len()).map(lowest).collect()
    }
}

/// A value of a table that may be outside of it, or not known.
pub fn get(values: &[f32], at: i64) -> Option<f32> {
    usize::try_from(at).ok().and_then(|at| values.get(at)).copied().filter(|value| !value.is_nan())
}

/// The median speed of several runs in each cell.
pub struct Medians {
    first_cell: i64,
    medians_mps: Vec<f32>,
}

impl Medians {
    /// Of the speeds of each run, m/s, from its first cell on.
    pub fn of<'a>(runs: impl Iterator<Item = (i64, &'a [f32])> + Clone) -> Self {
        let first_cell = runs.clone().map(|(first_cell, _)| first_cell).min().unwrap_or(0);
        let end = runs.clone().map(|(first_cell, speeds)| first_cell + speeds.len() as i64).max();
        let median = |cell: i64| {
            let known = runs.clone().filter_map(|(first_cell, speeds)| get(speeds, cell - first_cell));
            let mut speeds: Vec<f32> = known.collect();
            let middle = speeds.len() / 2;
            if speeds.is_empty() { f32::NAN } else { *speeds.select_nth_unstable_by(middle, f32::total_cmp).1 }
        };
        Self { first_cell, medians_mps: (first_cell..end.unwrap_or(first_cell)).map(median).collect() }
    }

    /// That of a cell, m/s; none where nothing is known.
    pub fn mps(&self, cell: i64) -> Option<f32> {
        get(&self.medians_mps, cell - self.first_cell)
    }

    /// From the first to the last cell.
    pub fn cells(&self) -> Range<i64> {
        self.first_cell..self.first_cell + self.medians_mps.len() as i64
    }
}

/// Rows with a location that grows and a speed; where noise lets the location fall, it stays.
fn points(rows: &[Sample], sign: f64) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::with_capacity(rows.len());
    for row in rows {
        let (Some(location_m), Some(mps)) = (row.location_m, row.speed_mps) else {
            continue;
        };
        let last = points.last().copied();
        let at_m = last.map_or(sign * location_m, |last| last.at_m.max(sign * location_m));
        if last.is_none_or(|last| last.time_s < row.time_s) {
            points.push(Point { time_s: row.time_s, at_m, mps });
        }
    }
    points
}

/// Standstills between the first and the last movement, those without rows included.
fn stands(points: &[Point]) -> Vec<Stand> {
    let moves = |point: &Point| point.mps > STANDING_MPS;
    let (Some(first), Some(last)) = (points.iter().position(moves), points.iter().rposition(moves)) else {
        return Vec::new();
    };
    let mut stands: Vec<Stand> = Vec::new();
    let mut i = first;
    while i < last {
        let mut j = i + 1;
        while j < last && !moves(&points[j]) {
            j += 1;
        }
        let (from, to) = (points[i], points[j]);
        let (time_s, way_m) = (to.time_s - from.time_s, to.at_m - from.at_m);
        let silent = j == i + 1 && time_s > LEAST_GAP_S && way_m < CRAWL_MPS * time_s;
        // From the middle of the step before to that after.
        let steps_s =
            if j > i + 1 { 0.5 * (points[i + 1].time_s - from.time_s + to.time_s - points[j - 1].time_s) } else { 0.0 };
        if (j > i + 1 || silent) && time_s - steps_s >= LEAST_STAND_S {
            let at_m = if j > i + 1 { points[i + 1].at_m } else { from.at_m };
            stands.push(Stand { at_m, duration_s: time_s - steps_s });
        }
        i = j;
    }
    stands
}
