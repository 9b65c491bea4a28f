//! Locations that count the way of a wheel: they rise whichever way the train goes, and may be beyond any line.

use super::staged::Staged;
use rundown_files::sample::MOST_LOCATION_M;

/// A wheel goes back by less: noise, and the last metres of a stop, m.
const BACK_M: f64 = 300.0;
/// Logs that must rise from one to the next: two may be the two halves of a line.
const LEAST_LOGS: usize = 3;

/// Why the locations of these runs are no chainage: they are beyond any line, or rise from run to run and none comes back.
pub fn counts_on(runs: &[Staged]) -> Option<String> {
    if let Some(far) = runs.iter().find(|run| is_far(run.ends_m)) {
        return Some(format!("{} is at {:.0} km, beyond any line: an odometer", far.name, far.ends_m.1 / 1e3));
    }
    let heads = runs.iter().filter(|run| run.is_head).count();
    let rises = |run: &Staged| run.first_m - run.ends_m.0 < BACK_M && run.ends_m.1 - run.ends_m.0 > BACK_M;
    if heads < LEAST_LOGS || !runs.iter().all(rises) {
        return None;
    }
    let mut ends: Vec<(f64, f64)> = runs.iter().map(|run| run.ends_m).collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let apart = ends.windows(2).all(|pair| pair[1].0 > pair[0].1 - BACK_M);
    apart.then(|| "all locations rise and no two runs overlap: an odometer".to_owned())
}

/// Beyond any line.
pub fn is_far((low_m, high_m): (f64, f64)) -> bool {
    low_m < -MOST_LOCATION_M || high_m > MOST_LOCATION_M
}
