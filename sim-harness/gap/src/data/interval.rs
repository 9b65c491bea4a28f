//! An interval of a run: from one reading of the speed to the next, with the path travelled in it.

/// Points along the path of an interval at which laws are evaluated.
pub const POINTS: usize = 10;

/// Times that are nearer are the same: sums of lengths and differences of time stamps round, s.
pub const SAME_TIME_S: f64 = 1e-6;

/// A point on the path of an interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Location of the front, m.
    pub location_m: f64,
    pub speed_mps: f64,
    /// Time since the train first moved, s.
    pub since_departure_s: f64,
}

/// From one reading of the speed to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Interval {
    pub run: usize,
    /// Which unit made the run, by its place among their names; `None`: not known.
    pub unit: Option<usize>,
    pub begin_s: f64,
    pub dt_s: f64,
    /// Speed at both ends, m/s.
    pub speed_mps: [f64; 2],
    /// Mean effort over the interval, N/kg.
    pub effort_n_per_kg: Option<f64>,
    /// How much the effort changes within it beyond what is understood, N/kg, not negative.
    pub effort_change_n_per_kg: f64,
    /// Effort at the end less effort at the beginning, N/kg, each around it as the speed is read; of means, half a row
    /// later at both.
    pub effort_step_n_per_kg: f64,
    /// Change of the effort from one momentary reading to the next at the end, less that at the beginning, N/kg:
    /// straight lines between readings miss a twelfth of it, times the time between two over `dt_s` (Euler-Maclaurin).
    pub effort_bend_n_per_kg: f64,
    pub temperature_c: Option<f64>,
    /// Measured mean headwind, m/s.
    pub wind_mps: Option<f64>,
    /// Day, since 1970-01-01 UTC.
    pub day: Option<f64>,
    /// How long the train stood before its last start, s; `None`: since before the run.
    pub stood_s: Option<f64>,
    /// The brake has been applied since the departure.
    pub braked: bool,
    /// Shares its first reading with the interval before it.
    pub follows: bool,
    pub path: [Point; POINTS],
}

impl Interval {
    /// Change of speed over time, m/s².
    pub fn acceleration_mps2(&self) -> f64 {
        (self.speed_mps[1] - self.speed_mps[0]) / self.dt_s
    }

    pub fn mean_speed_mps(&self) -> f64 {
        0.5 * (self.speed_mps[0] + self.speed_mps[1])
    }

    /// The mean of a law along the path.
    pub fn mean(&self, law: impl Fn(&Point) -> f64) -> f64 {
        self.path.iter().map(law).sum::<f64>() / POINTS as f64
    }

    pub fn middle(&self) -> &Point {
        &self.path[POINTS / 2]
    }
}
