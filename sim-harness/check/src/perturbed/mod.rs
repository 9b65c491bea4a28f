//! Runs that something outside the train disturbed: a red signal, a restriction, a slower train ahead. The paper
//! removes them first (section 4).
//!
//! In: runs whose readings are put right, and the described stops. Out: for each run what held it up, where, and what
//! the other runs do there.
//!
//! ```text
//! readings -> profile: lowest speed in each cell of 50 m, standstills -> stops that few others make (stops)
//!                                                                     -> speeds far below the others' (slow)
//! ```
//!
//! Only runs in the same direction are compared. Nothing is claimed where too few others pass, nor where more than a
//! third of the runs would be perturbed: then they have no timetable in common.

mod slow;
mod stops;

pub(crate) use stops::near_m;

use crate::rows::profile::{Medians, Profile};
use rundown::model::direction::Direction;
use rundown_files::recording::Recording;
use serde::Serialize;
use std::fmt;

/// So many others must pass a place before a run is compared with them.
const LEAST_OTHERS: usize = 5;
/// Where a larger share of the runs would be perturbed, they have no timetable in common.
const MOST_PERTURBED: f64 = 1.0 / 3.0;

/// What held a run up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// A standstill where no station is.
    UnscheduledStop,
    /// A speed far below that of the other runs.
    HeldBack,
}

/// One place where a run was held up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Perturbation {
    /// What.
    pub cause: Cause,
    /// Lowest location of the place, m.
    pub from_m: f64,
    /// Highest, m.
    pub to_m: f64,
    /// Time at a stand, or time lost against the other runs, s.
    pub duration_s: f64,
    /// Lowest speed there, km/h.
    pub speed_kmh: f64,
    /// What three quarters of the others exceed there, km/h.
    pub others_kmh: Option<f64>,
    /// Others that stop there, too.
    pub others_stopping: usize,
    /// Others that pass.
    pub others: usize,
}

impl fmt::Display for Perturbation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from_m, to_m, duration_s, speed_kmh, others, others_stopping, .. } = self;
        let [from_km, to_km] = [from_m / 1000.0, to_m / 1000.0];
        match (self.cause, self.others_kmh) {
            (Cause::UnscheduledStop, _) => {
                write!(
                    f,
                    "stopped {duration_s:.0} s at km {from_km:.1}, where {others_stopping} of {others} other runs stop"
                )
            }
            (Cause::HeldBack, Some(others_kmh)) => write!(
                f,
                "held at {speed_kmh:.0} km/h between km {from_km:.1} and {to_km:.1}, where most of {others} other runs exceed {others_kmh:.0} km/h; {duration_s:.0} s lost"
            ),
            (Cause::HeldBack, None) => {
                write!(f, "held at {speed_kmh:.0} km/h between km {from_km:.1} and {to_km:.1}; {duration_s:.0} s lost")
            }
        }
    }
}

/// What came of the comparison.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// What held each run up, in the order of the runs.
    pub runs: Vec<Vec<Perturbation>>,
    /// Runs that were compared with no others: too few pass, or they differ too much.
    pub not_compared: usize,
}

/// Compares runs with one another. `is_usable`: by run; one that is not takes no part. `stops_m`: described stops, as
/// the track has them.
pub fn find(recordings: &[Recording], is_usable: &[bool], stops_m: &[f64]) -> Found {
    let mut found = Found { runs: vec![Vec::new(); recordings.len()], not_compared: 0 };
    for direction in [Direction::Up, Direction::Down] {
        let of_direction = (0..recordings.len()).filter(|i| is_usable[*i] && recordings[*i].direction == direction);
        let sign = direction.sign();
        let (indices, profiles): (Vec<usize>, Vec<Profile>) =
            of_direction.filter_map(|i| Some((i, Profile::of(&recordings[i].rows, sign)?))).unzip();
        let stops_m: Vec<f64> = stops_m.iter().map(|at_m| sign * at_m).collect();
        let compared = compare(&profiles, &stops_m);
        let perturbed = compared.iter().flatten().filter(|list| !list.is_empty()).count();
        let no_timetable = perturbed as f64 > MOST_PERTURBED * profiles.len() as f64;
        for (i, list) in indices.into_iter().zip(compared) {
            match list {
                Some(list) if !no_timetable => found.runs[i] = list.into_iter().map(|one| one.along(sign)).collect(),
                _ => found.not_compared += 1,
            }
        }
    }
    found
}

/// For each run of one direction what held it up, none where it cannot be compared.
fn compare(profiles: &[Profile], stops_m: &[f64]) -> Vec<Option<Vec<Perturbation>>> {
    let near_m = stops::near_m(profiles);
    let stations = stops::Stations { described_m: stops_m, near_m };
    let lows: Vec<Vec<f32>> = profiles.iter().map(|profile| profile.lows(near_m)).collect();
    let first_cells = profiles.iter().map(|profile| profile.first_cell);
    let typical = Medians::of(first_cells.zip(lows.iter().map(Vec::as_slice)));
    let of_run = |run: usize| {
        let stopped = stations.unscheduled(profiles, run)?;
        let held = slow::held_back(profiles, &lows, &typical, run, near_m);
        // A stop includes the way down to it and up again.
        let apart = |held: &Perturbation| {
            !stopped.iter().any(|stop| (held.from_m - near_m..held.to_m + near_m).contains(&stop.from_m))
        };
        Some(stopped.iter().cloned().chain(held.into_iter().filter(apart)).collect())
    };
    (0..profiles.len()).map(of_run).collect()
}

impl Perturbation {
    /// From the distance along the direction of travel to the locations of the track.
    fn along(self, sign: f64) -> Self {
        let (a, b) = (sign * self.from_m, sign * self.to_m);
        Self { from_m: a.min(b), to_m: a.max(b), ..self }
    }
}
