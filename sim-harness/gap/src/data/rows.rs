//! Interval residuals: what the believed model leaves unexplained.
//!
//! ```text
//! y = u - dv/dt - mean(r(v) + g(s))        N/kg, positive: more resistance than believed
//! ```
//!
//! Where a log has a headwind column, r is taken at the air speed: a measured wind is not searched for.
//! With an effort column every moving interval gives one; without, only established coasting does (u = 0).

use crate::config::IntervalConfig;
use crate::data::believed::believed_load;
use crate::data::interval::{Interval, Point};
use rundown::model::{direction::Direction, effects::Moment, line::Line};

/// An interval that counts, with its residual.
#[derive(Clone, Debug)]
pub struct Row {
    pub interval: Interval,
    pub direction: Direction,
    /// The effort over it: measured, or known to be zero, N/kg.
    pub effort_n_per_kg: f64,
    pub residual_n_per_kg: f64,
}

impl Row {
    /// `None` if the interval says nothing.
    pub fn new(
        line: &Line<'_>,
        interval: &Interval,
        effort_n_per_kg: Option<f64>,
        config: &IntervalConfig,
    ) -> Option<Self> {
        let slowest = interval.speed_mps[0].min(interval.speed_mps[1]);
        let effort_n_per_kg = effort_n_per_kg?;
        (slowest >= config.slowest_mps && interval.effort_change_n_per_kg <= config.most_change_n_per_kg).then(|| {
            Self {
                interval: interval.clone(),
                direction: line.direction,
                effort_n_per_kg,
                residual_n_per_kg: effort_n_per_kg - interval.acceleration_mps2() - believed_load(line, interval),
            }
        })
    }

    /// The row with an effort put right that reads too high by `gain`.
    pub fn without_gain(mut self, gain: f64) -> Self {
        self.residual_n_per_kg -= self.effort_n_per_kg * (1.0 - 1.0 / (1.0 + gain));
        let Interval { effort_step_n_per_kg, effort_bend_n_per_kg, .. } = &mut self.interval;
        for effort in [&mut self.effort_n_per_kg, effort_step_n_per_kg, effort_bend_n_per_kg] {
            *effort /= 1.0 + gain;
        }
        self.interval.effort_n_per_kg = self.interval.effort_n_per_kg.map(|effort| effort / (1.0 + gain));
        self.interval.effort_change_n_per_kg /= 1.0 + gain;
        self
    }

    /// A train at a point, driven as it was in this row.
    pub fn moment(&self, point: &Point) -> Moment {
        Moment {
            location_m: point.location_m,
            speed_mps: point.speed_mps,
            effort_n_per_kg: self.effort_n_per_kg,
            since_departure_s: point.since_departure_s,
            stood_s: self.interval.stood_s,
            braked: self.interval.braked,
            temperature_c: self.interval.temperature_c,
            day: self.interval.day,
        }
    }
}

#[cfg(test)]
impl Row {
    /// A row of a train at one place and speed, its effort not measured.
    pub(crate) fn coasting(direction: Direction, location_m: f64, speed_mps: f64) -> Self {
        use crate::data::interval::POINTS;
        let point = Point { location_m, speed_mps, since_departure_s: 60.0 };
        let interval = Interval {
            run: 0,
            unit: None,
            begin_s: 60.0,
            dt_s: 10.0,
            speed_mps: [speed_mps; 2],
            effort_n_per_kg: None,
            effort_change_n_per_kg: 0.0,
            effort_step_n_per_kg: 0.0,
            effort_bend_n_per_kg: 0.0,
            temperature_c: None,
            wind_mps: None,
            day: None,
            stood_s: None,
            braked: false,
            follows: false,
            path: [point; POINTS],
        };
        Self { interval, direction, effort_n_per_kg: 0.0, residual_n_per_kg: 0.0 }
    }
}
