//! How the coasts of each unit were foreseen, by what had been learned before them and by the description.

use super::vehicle::named;
use rundown_files::replay::ReplayedRun;
use rundown_pages::numbers::counted;
use std::collections::BTreeMap;

/// With fewer coasts nothing is said against what was learned.
const LEAST_COASTS: f64 = 8.0;
/// What was learned is worse than the description from so many times its error on.
const WORSE: f64 = 1.5;
/// A smaller difference is none that is worth a word, km/h: less than most recorders show.
const LEAST_KMH: f64 = 0.25;

/// By unit: coasts, squares of the errors by what had been learned and by the description.
#[derive(Debug, Default)]
pub(crate) struct Foreseen(BTreeMap<String, [f64; 3]>);

impl Foreseen {
    pub(crate) fn add(&mut self, runs: &[ReplayedRun]) {
        for run in runs {
            let foresight = &run.summary.foresight;
            let of_run = [foresight.trust.coasts, foresight.learned_mps, foresight.described_mps];
            let sums = self.0.entry(run.unit.clone()).or_default();
            sums.iter_mut().zip(of_run).for_each(|(sum, more)| *sum += more);
        }
    }

    /// A line for each of the first units; nothing where nobody coasted.
    pub(crate) fn lines(&self, most: usize) -> String {
        let line = |(unit, sums): (&String, &[f64; 3])| {
            let [learned, described] = rms_kmh(sums)?;
            Some(format!(
                "{}: {}, the speed at {} end predicted within {learned:.1} km/h (rms) by what had been learned, {described:.1} by the description\n",
                named(unit),
                counted(sums[0] as usize, "coast", "coasts"),
                if sums[0] > 1.0 { "their" } else { "its" },
            ))
        };
        self.0.iter().take(most).filter_map(line).collect()
    }

    /// The units of which the description foresees better than what was learned.
    pub(super) fn notes(&self) -> impl Iterator<Item = String> {
        self.0.iter().filter_map(|(unit, sums)| {
            let [learned, described] = rms_kmh(sums)?;
            (sums[0] >= LEAST_COASTS && learned > WORSE * described && learned - described > LEAST_KMH).then(|| {
                format!(
                    "{}: coasts were predicted within {learned:.1} km/h (rms) by what had been learned, but within {described:.1} by \
                     the description: what is learned here is worse than it, whatever its interval; a tunnel, a slope or a \
                     brake that the description lacks looks so",
                    named(unit)
                )
            })
        })
    }
}

/// Of what was learned and of the description; none without a coast.
fn rms_kmh([coasts, learned, described]: &[f64; 3]) -> Option<[f64; 2]> {
    (*coasts > 0.0).then(|| [learned, described].map(|squares_mps| 3.6 * (squares_mps / coasts).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_foresees_worse_than_the_description_is_said() {
        let notes = |sums| Foreseen(BTreeMap::from([("7".to_owned(), sums)])).notes().collect::<Vec<_>>();
        let said = notes([9.0, 9.0 * 4.0, 9.0]);
        assert!(said[0].starts_with(
            "unit 7: coasts were predicted within 7.2 km/h (rms) by what had been learned, but within 3.6"
        ));
        assert!(notes([9.0, 9.0 * 2.0, 9.0]).is_empty() && notes([3.0, 30.0, 3.0]).is_empty());
        // 0.3 in place of 0.1 km/h.
        assert!(notes([9.0, 9.0 * 0.0069, 9.0 * 0.00077]).is_empty());
    }
}
