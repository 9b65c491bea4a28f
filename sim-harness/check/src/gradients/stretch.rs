//! Stretches of 20 s, one each 10 s: how the kinetic energy changed, and what the described resistance took.

use crate::effort::driven::climb_n_per_kg;
use crate::rows::steps;
use rundown::model::direction::Direction;
use rundown::model::resistance::Davis;
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown_files::sample::Sample;

/// Long enough that speeds in whole km/h leave an error of half a permille, and short enough for the coasts of a
/// suburban train, s.
const LENGTH_S: f64 = 20.0;
/// A stretch begins so long after the one before, s: a coast holds whole ones wherever it begins.
const BEGIN_EACH_S: f64 = 10.0;
/// Of so many stretches that overlap only one is independent.
pub const OVERLAP: f64 = LENGTH_S / BEGIN_EACH_S;
/// A longer gap ends a stretch, s.
const LONGEST_STEP_S: f64 = 12.0;
/// Slower trains do not coast long, m/s.
const SLOWEST_MPS: f64 = 6.0;
/// Beyond, trains power or brake on any gradient, m/s².
const MOST_RATE_MPS2: f64 = 0.35;
/// Location and speed may differ by this share of the way and these metres.
const AGREES: (f64, f64) = (0.1, 60.0);

/// What one stretch says, but for the gradients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Gain of kinetic energy over the way, N/kg.
    pub gain_n_per_kg: f64,
    /// Described resistance, mean over the way, N/kg.
    pub resistance_n_per_kg: f64,
    /// Mean over the way of the speed, m/s, and of its square, m²/s².
    pub mean_powers: [f64; 2],
    /// What the step of the speeds makes of the gain, standard deviation, N/kg.
    pub rounded_n_per_kg: f64,
    /// Front of the train where it begins and where it ends, m.
    pub fronts_m: [f64; 2],
    /// The way between, m.
    pub way_m: f64,
    /// Direction of travel.
    pub direction: Direction,
    /// Which run, counted from 0.
    pub run: usize,
}

impl Stretch {
    /// Which half of the runs: 0 or 1.
    pub fn half(&self) -> usize {
        self.run % 2
    }

    /// Force of the described climb, N/kg, on a train of such a length.
    pub fn climb_n_per_kg(&self, length_m: f64, train: &Train, track: &Track) -> f64 {
        climb_n_per_kg(self.fronts_m, self.way_m, self.direction, length_m, (train, track))
    }

    /// The same of a train with another resistance.
    pub fn with(self, davis: &Davis) -> Self {
        let [mps, squared] = self.mean_powers;
        Self { resistance_n_per_kg: davis.r0 + davis.r1 * mps + davis.r2 * squared, ..self }
    }
}

pub fn of(rows: &[Sample], direction: Direction, run: usize, train: &Train) -> Vec<Stretch> {
    let read = |row: &&Sample| row.location_m.is_some() && row.speed_mps.is_some();
    let rows: Vec<&Sample> = rows.iter().filter(read).collect();
    let rounding_mps = steps::of_speed_kmh(rows.iter().copied()).map_or(0.0, steps::rounding_mps);
    let mut stretches = Vec::new();
    let mut from = 0;
    for to in 1..rows.len() {
        let dt = rows[to].time_s - rows[to - 1].time_s;
        if !(0.0..=LONGEST_STEP_S).contains(&dt) {
            from = to;
        } else if rows[to].time_s - rows[from].time_s >= LENGTH_S - 1e-6 {
            stretches.extend(stretch(&rows[from..=to], direction, run, train, rounding_mps));
            let next_s = rows[from].time_s + BEGIN_EACH_S - 1e-6;
            from = (from..to).find(|row| rows[*row].time_s >= next_s).unwrap_or(to);
        }
    }
    stretches
}

fn stretch(rows: &[&Sample], direction: Direction, run: usize, train: &Train, rounding_mps: f64) -> Option<Stretch> {
    let speeds = || rows.iter().filter_map(|row| row.speed_mps);
    let fronts_m = [rows.first()?.location_m?, rows.last()?.location_m?];
    let (first, last) = (speeds().next()?, speeds().next_back()?);
    let (mut way_m, mut sums) = (0.0, [0.0; 2]);
    for pair in rows.windows(2) {
        let mps = 0.5 * (pair[0].speed_mps? + pair[1].speed_mps?);
        let step_m = mps * (pair[1].time_s - pair[0].time_s);
        way_m += step_m;
        sums = [sums[0] + mps * step_m, sums[1] + mps * mps * step_m];
    }
    let time_s = rows.last()?.time_s - rows.first()?.time_s;
    let rate_mps2 = (last - first) / time_s;
    let moved_m = direction.sign() * (fronts_m[1] - fronts_m[0]);
    let agrees = (moved_m - way_m).abs() < AGREES.0 * way_m + AGREES.1;
    let is_one = speeds().all(|mps| mps > SLOWEST_MPS) && rate_mps2.abs() < MOST_RATE_MPS2 && agrees;
    let stretch = || Stretch {
        gain_n_per_kg: (last * last - first * first) / (2.0 * way_m),
        rounded_n_per_kg: 0.5_f64.sqrt() * (first + last) * rounding_mps / way_m,
        resistance_n_per_kg: 0.0,
        mean_powers: sums.map(|sum| sum / way_m),
        fronts_m,
        way_m,
        direction,
        run,
    };
    is_one.then(|| stretch().with(&train.davis()))
}
