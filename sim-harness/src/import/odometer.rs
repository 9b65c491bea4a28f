//! Locations that count the way of a wheel: they rise whichever way the train goes, and may be beyond any line.

use super::staged::Staged;
use rundown_files::sample::MOST_LOCATION_M;
use std::collections::BTreeMap;

/// A wheel goes back by less: noise, and the last metres of a stop, m.
const BACK_M: f64 = 300.0;
/// Logs that must rise from one to the next: two may be the two halves of a line.
const LEAST_LOGS: usize = 3;

/// Why the locations of these runs are no chainage: they are beyond any line, or rise from run to run of a unit and
/// none comes back.
pub fn counts_on(runs: &[Staged]) -> Option<String> {
    if let Some(far) = runs.iter().find(|run| is_far(run.ends_m)) {
        return Some(format!("{} is at {:.0} km, beyond any line: an odometer", far.name, far.ends_m.1 / 1e3));
    }
    let rises = |run: &Staged| run.first_m - run.ends_m.0 < BACK_M && run.ends_m.1 - run.ends_m.0 > BACK_M;
    if !runs.iter().all(rises) {
        return None;
    }
    // Each unit has an odometer of its own.
    let mut units: BTreeMap<&str, Vec<&Staged>> = BTreeMap::new();
    runs.iter().for_each(|run| units.entry(&run.unit).or_default().push(run));
    let mut tell = units.values().filter(|of_unit| of_unit.iter().filter(|run| run.is_head).count() >= LEAST_LOGS);
    let apart = |of_unit: &Vec<&Staged>| {
        let mut ends: Vec<(f64, f64)> = of_unit.iter().map(|run| run.ends_m).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.windows(2).all(|pair| pair[1].0 > pair[0].1 - BACK_M)
    };
    let of = if units.len() > 1 { "of a unit " } else { "" };
    (tell.clone().next().is_some() && tell.all(apart))
        .then(|| format!("all locations rise and no two runs {of}overlap: an odometer"))
}

/// Beyond any line.
pub fn is_far((low_m, high_m): (f64, f64)) -> bool {
    low_m < -MOST_LOCATION_M || high_m > MOST_LOCATION_M
}
