//! Locations that count the way of a wheel: they wrap, they rise whichever way the train goes, they are beyond any line.

use super::account::Account;
use super::chainage::Place;
use super::cut::Stretch;
use super::staged::Staged;
use rundown_check::finding::Finding;
use rundown_check::places;
use rundown_files::sample::MOST_LOCATION_M;

/// No train turns its wheels further in its life, m.
pub const MOST_ODOMETER_M: f64 = 1e11;
/// A train that stood in a gap is no further on, m.
const STOOD_M: f64 = 300.0;
/// Logs that must rise from one to the next: two may be the two halves of a line.
const LEAST_LOGS: usize = 3;

/// By how much the odometer of a file had wrapped when a stretch ended, and where that was.
#[derive(Clone, Copy, Debug, Default)]
pub struct Odometer {
    shift_m: f64,
    end_m: f64,
}

impl Odometer {
    /// Joins wraps; those before a gap too, where the train stood in the gap.
    pub fn join(&mut self, stretch: &mut Stretch, findings: &mut Vec<Finding>, account: &mut Account) {
        let read_m = |stretch: &Stretch| stretch.rows.iter().rev().find_map(|row| row.location_m);
        let (first_m, last_m) = (stretch.rows.iter().find_map(|row| row.location_m), read_m(stretch));
        let stood = first_m.is_some_and(|first| (first + self.shift_m - self.end_m).abs() < STOOD_M);
        if self.shift_m != 0.0 && stood && !stretch.is_head {
            account.count("odometers that wrapped before a gap, joined over it", 1);
            stretch.rows.iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| m + self.shift_m));
        }
        places::join(&mut stretch.rows, findings);
        if let Some((last_m, end_m)) = last_m.zip(read_m(stretch)) {
            *self = Self { shift_m: end_m - last_m, end_m };
        }
    }
}

/// Why the locations of these runs are no chainage: they are beyond any line, or rise from run to run and none comes back.
pub fn counts_on(runs: &[Staged]) -> Option<String> {
    if let Some(far) = runs.iter().find(|run| is_far(run.ends_m)) {
        return Some(format!("{} is at {:.0} km, beyond any line: an odometer", far.name, far.ends_m.1 / 1e3));
    }
    let heads = runs.iter().filter(|run| run.is_head).count();
    let rises = |run: &Staged| run.first_m - run.ends_m.0 < STOOD_M && run.ends_m.1 - run.ends_m.0 > STOOD_M;
    if heads < LEAST_LOGS || !runs.iter().all(rises) {
        return None;
    }
    let mut ends: Vec<(f64, f64)> = runs.iter().map(|run| run.ends_m).collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let apart = ends.windows(2).all(|pair| pair[1].0 > pair[0].1 - STOOD_M);
    apart.then(|| "all locations rise and no two runs overlap: an odometer".to_owned())
}

/// Brings runs that stay as they are into the range of a chainage: by one shift, or each to begin at 0.
pub fn within_range(runs: &[Staged], places: &mut [Place]) {
    if !runs.iter().any(|run| is_far(run.ends_m)) {
        return;
    }
    let least_m = runs.iter().map(|run| run.ends_m.0).fold(f64::INFINITY, f64::min);
    let most_m = runs.iter().map(|run| run.ends_m.1).fold(f64::NEG_INFINITY, f64::max);
    for (run, place) in runs.iter().zip(places) {
        let (from_m, how) = if most_m - least_m < MOST_LOCATION_M {
            (least_m, "an odometer beyond any line: all runs by the same distance, so that the first begins at 0")
        } else {
            (run.ends_m.0, "odometers beyond any line and far apart: each run begins at 0")
        };
        *place = Place::Shift { sign: 1.0, offset_m: -from_m, how: how.to_owned() };
    }
}

fn is_far((low_m, high_m): (f64, f64)) -> bool {
    low_m < -MOST_LOCATION_M || high_m > MOST_LOCATION_M
}
