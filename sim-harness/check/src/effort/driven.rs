//! What trains did in windows of some seconds in which the effort hardly changes.

use crate::effort;
use rundown::model::direction::Direction;
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown_files::sample::Sample;
use rundown_files::statistics::span;

/// Length of a window, s.
const WINDOW_S: f64 = 10.0;
/// Slower trains creep, m/s; and an effort that changes by more has no mean that is known, N/kg.
const SLOWEST_MPS: f64 = 5.0;
const MOST_CHANGE_N_PER_KG: f64 = 0.05;
/// Brakes are left out, N/kg: many columns have a gain of their own for them, or none of some brakes.
const LEAST_EFFORT_N_PER_KG: f64 = -0.02;

/// What a train did in some seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Driven {
    pub(crate) fronts_m: [f64; 2],
    pub(crate) way_m: f64,
    pub(crate) direction: Direction,
    pub(crate) run: usize,
    pub(crate) speed_mps: f64,
    pub(crate) acceleration_mps2: f64,
    /// Its mean, where each row has that since the row before, and where each has that of its moment, N/kg.
    pub(crate) efforts_n_per_kg: [f64; 2],
}

impl Driven {
    /// Force of the described climb, N/kg.
    pub(crate) fn climb_n_per_kg(&self, train: &Train, track: &Track) -> f64 {
        self.climb_of(train.length_m(), train, track)
    }

    /// The same somewhere else along the line.
    pub(crate) fn moved(self, by_m: f64) -> Self {
        Self { fronts_m: self.fronts_m.map(|front_m| front_m + by_m), ..self }
    }

    /// The same on a train of such a length.
    pub(crate) fn climb_of(&self, length_m: f64, train: &Train, track: &Track) -> f64 {
        climb_n_per_kg(self.fronts_m, self.way_m, self.direction, length_m, (train, track))
    }
}

/// Force of the described climb over a way, N/kg, on a train of such a length.
pub(crate) fn climb_n_per_kg(
    fronts_m: [f64; 2],
    way_m: f64,
    direction: Direction,
    length_m: f64,
    (train, track): (&Train, &Track),
) -> f64 {
    let [from_m, to_m] = fronts_m.map(|front_m| track.height_integral_m2(front_m, length_m, direction) / length_m);
    train.gravity_n_per_kg() * (to_m - from_m) / way_m
}

/// The windows of a run in which the effort hardly changes; none without an effort column.
pub(crate) fn windows(rows: &[Sample], direction: Direction, run: usize) -> Vec<Driven> {
    effort::stretches(rows, WINDOW_S).into_iter().filter_map(|rows| window(rows, direction, run)).collect()
}

fn window(rows: &[Sample], direction: Direction, run: usize) -> Option<Driven> {
    let ([from, to], (acceleration_mps2, effort_n_per_kg)) = ([rows.first()?, rows.last()?], effort::window(rows)?);
    let speeds_mps = [from.speed_mps?, to.speed_mps?];
    let speed_mps = 0.5 * (speeds_mps[0] + speeds_mps[1]);
    let way_m = speed_mps * (to.time_s - from.time_s);
    let middle_m = 0.5 * (from.location_m? + to.location_m?);
    let momentary_n_per_kg = {
        let pairs = || rows.windows(2).map(|pair| (pair, pair[1].time_s - pair[0].time_s));
        let of = |pair: &[Sample], s: f64| Some(0.5 * s * (pair[0].effort_n_per_kg? + pair[1].effort_n_per_kg?));
        pairs().filter_map(|(pair, s)| of(pair, s)).sum::<f64>() / pairs().map(|(_, s)| s).sum::<f64>()
    };
    let change = span(rows.iter().filter_map(|row| row.effort_n_per_kg));
    let is_slow = speeds_mps[0].min(speeds_mps[1]) <= SLOWEST_MPS;
    let is_usable = !is_slow && change < MOST_CHANGE_N_PER_KG && effort_n_per_kg > LEAST_EFFORT_N_PER_KG;
    is_usable.then_some(Driven {
        fronts_m: [-0.5, 0.5].map(|share| middle_m + direction.sign() * share * way_m),
        way_m,
        direction,
        run,
        speed_mps,
        acceleration_mps2,
        efforts_n_per_kg: [effort_n_per_kg, momentary_n_per_kg],
    })
}
