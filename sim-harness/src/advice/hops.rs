//! Was the resistance learned on short hops, where its interval is too narrow?
//!
//! In: the runs as replayed. Out: a note for each unit that was taught there.
//!
//! A coast of 10 to 40 s that begins or ends with a second of something else is off by several per cent, all of a driver's by the same, and their scatter does not say
//! so. The board has no figure for that; these are measured on trains of other simulators (docs/limits.md).

use super::vehicle::{After, named};
use rundown::tick::estimate::Estimate;
use rundown::tick::short_hops::{Hops, ShortHopConfig};
use rundown_files::replay::ReplayedRun;
use rundown_wire::{Learned, Regime};
use std::collections::BTreeMap;

/// From this share of what taught on, the interval is that of short hops.
const LEAST_SHARE: f64 = 0.5;

/// By unit: ticks that taught on short hops, and all that did.
#[derive(Debug, Default)]
pub(super) struct OnHops(BTreeMap<String, [usize; 2]>);

impl OnHops {
    pub(super) fn add(&mut self, config: &ShortHopConfig, run: &ReplayedRun) {
        let [short, all] = taught(config, &run.estimates);
        let sums = self.0.entry(run.unit.clone()).or_default();
        *sums = [sums[0] + short, sums[1] + all];
    }

    /// For the units whose resistance is published as learned.
    pub(super) fn notes(&self, vehicles: &BTreeMap<String, After>) -> impl Iterator<Item = String> {
        let is_learned = |unit: &str| vehicles.get(unit).is_some_and(|after| after.learned == Learned::Learned);
        let is_on_hops = |[short, all]: [usize; 2]| all > 0 && short as f64 >= LEAST_SHARE * all as f64;
        let units = self.0.iter().filter(move |(unit, sums)| is_on_hops(**sums) && is_learned(unit));
        units.map(|(unit, _)| {
            format!(
                "{}: learned on short hops, from coasts of 10 to 40 s: of 19 trams and suburban trains of another simulator 9 had \
                 an r(v) outside of the interval that is given, by 5 to 12 %; count on ± 10 %, whatever it says",
                named(unit)
            )
        })
    }
}

/// Ticks that taught on short hops, and all that did.
fn taught(config: &ShortHopConfig, estimates: &[Estimate]) -> [usize; 2] {
    let mut hops = Hops::default();
    let mut taught = [0, 0];
    for estimate in estimates {
        hops.observe(config, estimate.time_s, estimate.regime == Regime::Standstill);
        let is_short = hops.are_short(config, estimate.time_s);
        taught[0] += usize::from(estimate.learning && is_short);
        taught[1] += usize::from(estimate.learning);
    }
    taught
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replaying::Request;
    use std::path::{Path, PathBuf};

    #[test]
    fn what_teaches_between_stops_that_are_near_is_of_short_hops() {
        let reference = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/reference").join(name);
        let [run, train, track]: [PathBuf; 3] = ["run01.csv", "train.toml", "track.toml"].map(reference);
        let mut run = Request::new(vec![run], train, track).open().unwrap().replay(|| ()).unwrap().runs.remove(0);
        let config = ShortHopConfig::default();
        let [short, all] = taught(&config, &run.estimates);
        assert!(short == 0 && all > 10, "{short} of {all} on an intercity");
        let mut vehicle = After::of(&run);
        vehicle.learned = Learned::Learned;
        let vehicles = BTreeMap::from([(run.unit.clone(), vehicle)]);
        let said = |run: &ReplayedRun| {
            let mut on_hops = OnHops::default();
            on_hops.add(&config, run);
            on_hops.notes(&vehicles).count()
        };
        assert_eq!(said(&run), 0);
        // It stops every 150 s, and what it does between is learned from.
        for estimate in &mut run.estimates {
            let stands = estimate.time_s % 150.0 < 20.0;
            estimate.regime = if stands { Regime::Standstill } else { Regime::Coast };
            estimate.learning = !stands;
        }
        let [short, all] = taught(&config, &run.estimates);
        assert!(5 * short > 4 * all, "{short} of {all}: the first hop is not known to be one");
        assert_eq!(said(&run), 1);
    }
}
