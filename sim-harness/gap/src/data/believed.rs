//! What is believed of train and line, and the conditions of the runs.

use crate::config::{GapConfig, PenaltyConfig};
use crate::data::interval::{Interval, Point};
use crate::data::runs::Run;
use rundown::model::{direction::Direction, line::Line, track::Track, train::Train};
use rundown_files::statistics::mean;

/// A train that starts, m/s: the described effort is the largest, and the power limits nothing yet.
const STARTING_MPS: f64 = 0.1;

/// The largest described effort, N/kg.
pub fn starting_effort_n_per_kg(train: &Train) -> f64 {
    train.max_effort_n_per_kg(STARTING_MPS)
}

/// The believed model, with a line for each direction.
#[derive(Clone, Copy, Debug)]
pub struct Believed<'a> {
    up: Line<'a>,
    down: Line<'a>,
}

impl<'a> Believed<'a> {
    pub fn new(train: &'a Train, track: &'a Track) -> Self {
        let line = |direction| Line { train, track, direction };
        Self { up: line(Direction::Up), down: line(Direction::Down) }
    }

    pub fn line(&self, direction: Direction) -> &Line<'a> {
        match direction {
            Direction::Up => &self.up,
            Direction::Down => &self.down,
        }
    }

    pub fn train(&self) -> &'a Train {
        self.up.train
    }

    pub fn track(&self) -> &'a Track {
        self.up.track
    }
}

/// What the believed model takes off at a point, r + g, N/kg.
pub fn load_at(line: &Line<'_>, point: &Point) -> f64 {
    let davis = line.train.davis();
    davis.resistance_n_per_kg(point.speed_mps) + line.gradient_n_per_kg(point.location_m)
}

/// The same along an interval, at the air speed where the wind is measured.
pub fn believed_load(line: &Line<'_>, interval: &Interval) -> f64 {
    let load = interval.mean(|p| load_at(line, p));
    interval.wind_mps.map_or(load, |wind_mps| load + interval.mean(|p| wind_n_per_kg(line, p.speed_mps, wind_mps)))
}

/// What a headwind adds to the air drag, r2 ((v + w)|v + w| - v²), N/kg.
pub fn wind_n_per_kg(line: &Line<'_>, speed_mps: f64, wind_mps: f64) -> f64 {
    let air_mps = speed_mps + wind_mps;
    line.train.davis().r2 * (air_mps * air_mps.abs() - speed_mps * speed_mps)
}

/// What may be known of a line beyond its gradients.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    pub length_m: f64,
    /// No gradient is described.
    pub is_level: bool,
    /// Curves: (from, to, Röckl's number), m, N/N.
    pub curves: Vec<(f64, f64, f64)>,
    /// Tunnels: (from, to), m.
    pub tunnels: Vec<(f64, f64)>,
    /// Feeding sections: (from, to), m.
    pub feeding: Vec<(f64, f64)>,
    pub stops: Vec<f64>,
}

/// Temperature and dates of runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conditions {
    /// Mean temperature, °C.
    pub temperature_c: f64,
    /// Day of the first run, since 1970-01-01.
    pub first_day: f64,
    /// Days from the first run to the last.
    pub period_days: f64,
    pub runs: usize,
    /// The largest step of the speed readings, m/s; 0: they have none.
    pub speed_step_mps: f64,
}

impl Conditions {
    pub fn of(runs: &[Run]) -> Self {
        let days = || runs.iter().filter_map(|run| run.day);
        let first_day = days().fold(f64::INFINITY, f64::min).min(1e6);
        let period_days = (days().fold(0.0, f64::max) - first_day).max(0.0);
        let temperatures = runs.iter().flat_map(|run| run.samples.iter().filter_map(|s| s.temperature_c));
        let temperature_c = mean(temperatures).unwrap_or_default();
        let speed_step_mps = runs.iter().map(|run| run.recorded.speed_step_mps).fold(0.0, f64::max);
        Self { temperature_c, first_day, period_days, runs: runs.len(), speed_step_mps }
    }
}

/// What runs are compared with: the belief, the conditions that its terms refer to, and the settings.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    pub believed: Believed<'a>,
    /// What else is known of the line.
    pub surroundings: &'a Surroundings,
    /// Temperature and dates of the runs that were analysed.
    pub conditions: Conditions,
    pub config: &'a GapConfig,
}

impl Context<'_> {
    pub fn penalty(&self) -> PenaltyConfig {
        self.config.penalty.of_runs(self.conditions.runs)
    }
}

/// A described section whose edges may be those of the one found, or nearly, takes its place.
pub fn described(section: [f64; 2], edges: [(f64, f64); 2], descriptions: &[(f64, f64)], near_m: f64) -> [f64; 2] {
    let within = |at: f64, (low, high): (f64, f64)| (low - near_m..high + near_m).contains(&at);
    let fits = |&&(from, to): &&(f64, f64)| within(from, edges[0]) && within(to, edges[1]);
    let found = descriptions.iter().find(fits);
    found.map_or(section, |(from, to)| [*from, *to])
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::data::rows::Row;
    use rundown::model::{track::Gradient, train::TrainDescription};

    /// The train of the case study on 60 km of level line, and so many runs of it, one a day.
    pub(crate) fn on_a_level_line<T>(runs: usize, then: impl FnOnce(&Context<'_>) -> T) -> T {
        on(&Track::try_new(60_000.0, [Gradient { from_m: 0.0, permille: 0.0 }]).unwrap(), runs, then)
    }

    /// The case study's train on 30 km, each of them with another gradient.
    pub(crate) fn on_a_hilly_line<T>(runs: usize, then: impl FnOnce(&Context<'_>) -> T) -> T {
        let gradient = |i: u32| Gradient { from_m: 1_000.0 * f64::from(i), permille: f64::from(i * 7 % 11) - 5.0 };
        on(&Track::try_new(30_000.0, (0..30).map(gradient)).unwrap(), runs, then)
    }

    fn on<T>(track: &Track, runs: usize, then: impl FnOnce(&Context<'_>) -> T) -> T {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        then(&Context {
            believed: Believed::new(&train, track),
            surroundings: &Surroundings::default(),
            conditions: Conditions {
                temperature_c: 10.0,
                first_day: 0.0,
                period_days: runs as f64,
                runs,
                speed_step_mps: 0.0,
            },
            config: &GapConfig::default(),
        })
    }

    #[test]
    fn a_measured_headwind_changes_the_load_by_the_air_speed_and_none_changes_nothing() {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let track = Track::try_new(9_000.0, [Gradient { from_m: 0.0, permille: 0.0 }]).unwrap();
        let believed = Believed::new(&train, &track);
        let line = believed.line(Direction::Up);
        let mut interval = Row::coasting(Direction::Up, 2_000.0, 30.0).interval;
        let (still, r2) = (believed_load(line, &interval), train.davis().r2);
        // A tail wind faster than the train pushes it.
        for (wind_mps, air) in [(0.0, 900.0), (5.0, 35.0 * 35.0), (-5.0, 25.0 * 25.0), (-40.0, -100.0)] {
            interval.wind_mps = Some(wind_mps);
            assert!((believed_load(line, &interval) - still - r2 * (air - 900.0)).abs() < 1e-12, "{wind_mps}");
        }
    }
}
