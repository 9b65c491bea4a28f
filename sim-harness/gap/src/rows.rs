//! Interval residuals: what the believed model leaves unexplained.
//!
//! ```text
//! y = u - dv/dt - mean(r(v) + g(s))        N/kg, positive: more resistance than believed
//! ```
//!
//! With an effort column every moving interval gives one; without, only established coasting does (u = 0).

use super::runs::{Interval, Point};
use rundown::model::direction::Direction;
use rundown::model::line::Line;
use rundown::model::train::Train;

/// Below this an interval says nothing: readings of zero, creeping, the last metres, m/s.
pub const SLOWEST_MPS: f64 = 2.0;

/// An effort that changes by more within an interval has no mean that is known well enough, N/kg: a switch of the regime, a brake being applied.
const MOST_CHANGE_N_PER_KG: f64 = 0.03;

/// The believed model, with a line for each direction.
#[derive(Clone, Copy, Debug)]
pub struct Believed<'a> {
    up: Line<'a>,
    down: Line<'a>,
}

impl<'a> Believed<'a> {
    /// Of a train on a track.
    pub fn new(train: &'a Train, track: &'a rundown::model::track::Track) -> Self {
        let line = |direction| Line { train, track, direction };
        Self { up: line(Direction::Up), down: line(Direction::Down) }
    }

    /// The line in a direction.
    pub fn line(&self, direction: Direction) -> &Line<'a> {
        match direction {
            Direction::Up => &self.up,
            Direction::Down => &self.down,
        }
    }

    /// The train.
    pub fn train(&self) -> &'a Train {
        self.up.train
    }
}

/// What the believed model takes off at a point, r + g, N/kg.
pub fn load_at(line: &Line<'_>, point: &Point) -> f64 {
    let davis = line.train.davis();
    davis.resistance_n_per_kg(point.speed_mps) + line.gradient_n_per_kg(point.location_m)
}

/// The same along an interval.
pub fn believed_load(line: &Line<'_>, interval: &Interval) -> f64 {
    interval.mean(|p| load_at(line, p))
}

/// An interval that counts, with its residual.
#[derive(Clone, Debug)]
pub struct Row {
    /// The interval.
    pub interval: Interval,
    /// Direction of its run.
    pub direction: Direction,
    /// The effort over it: measured, or known to be zero, N/kg.
    pub effort_n_per_kg: f64,
    /// The residual, N/kg.
    pub residual_n_per_kg: f64,
}

impl Row {
    /// `None` if the interval says nothing.
    pub fn new(line: &Line<'_>, interval: &Interval, effort_n_per_kg: Option<f64>) -> Option<Self> {
        let slowest = interval.speed_mps[0].min(interval.speed_mps[1]);
        let effort_n_per_kg = effort_n_per_kg?;
        (slowest >= SLOWEST_MPS && interval.effort_change_n_per_kg <= MOST_CHANGE_N_PER_KG).then(|| Self {
            interval: interval.clone(),
            direction: line.direction,
            effort_n_per_kg,
            residual_n_per_kg: effort_n_per_kg - interval.acceleration_mps2() - believed_load(line, interval),
        })
    }
}

#[cfg(test)]
impl Row {
    /// A row of a train at one place and speed, its effort not measured.
    pub(super) fn coasting(direction: Direction, location_m: f64, speed_mps: f64) -> Self {
        use super::runs::POINTS;
        let point = Point { location_m, speed_mps, since_departure_s: 60.0 };
        let interval = Interval {
            run: 0,
            begin_s: 60.0,
            dt_s: 10.0,
            speed_mps: [speed_mps; 2],
            effort_n_per_kg: None,
            effort_change_n_per_kg: 0.0,
            effort_step_n_per_kg: 0.0,
            temperature_c: None,
            day: None,
            braked: false,
            follows: false,
            path: [point; POINTS],
        };
        Self { interval, direction, effort_n_per_kg: 0.0, residual_n_per_kg: 0.0 }
    }
}
