//! Locations that count the way of a wheel: they rise whichever way the train goes, and may be beyond any line.

use super::chainage::Placing;
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

/// Moves runs by whole turns of an odometer that began again at zero in some of them: where it was joined on the way
/// back, the same places are a turn lower. Only onto a run that passes most of the same places then.
pub fn unturned(runs: &[Staged], places: &mut [Placing]) {
    // The highest: no location is below zero there.
    let wrapped = runs.iter().filter_map(|run| Some((run, run.turn_m?)));
    let Some((onto, turn_m)) = wrapped.max_by(|a, b| a.0.ends_m.0.total_cmp(&b.0.ends_m.0)) else { return };
    for (run, place) in runs.iter().zip(places) {
        let [middle_m, onto_m] = [run, onto].map(|run| 0.5 * (run.ends_m.0 + run.ends_m.1));
        let turns = ((onto_m - middle_m) / turn_m).round();
        let offset_m = turns * turn_m;
        let (low_m, high_m) = (run.ends_m.0 + offset_m, run.ends_m.1 + offset_m);
        let both_m = high_m.min(onto.ends_m.1) - low_m.max(onto.ends_m.0);
        if turns != 0.0 && run.unit == onto.unit && both_m > 0.5 * (high_m - low_m) {
            let how = format!(
                "an odometer that begins again at zero after {turn_m:.0} m: by {turns:+} turns, onto {}",
                onto.name
            );
            *place = Placing::Shift { factor: 1.0, offset_m, how };
        }
    }
}

/// Beyond any line.
pub fn is_far((low_m, high_m): (f64, f64)) -> bool {
    low_m < -MOST_LOCATION_M || high_m > MOST_LOCATION_M
}
