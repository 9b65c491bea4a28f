//! Is the train of the last runs that of the first?
//!
//! In: what each run of a unit teaches of the resistance by itself, in order, and the vehicle after all of them. Out: a
//! note where it changed at once. The estimator takes a vehicle to change slowly: after a brake that begins to drag, a
//! repair or another load what it has learned lies between both for many runs, and its interval says nothing of it.
//!
//! ```text
//! change = median of the runs since - median of those before, at the split that leaves the least distances
//! ```

use super::taught::{self, Taught};
use super::vehicle::named;
use rundown::filter::gaussian::Gaussian;
use rundown_check::figure::Figure;
use rundown_files::statistics::{median, sd_of_median, spread};

/// Runs on each side at least.
const LEAST_RUNS: usize = 4;
/// Smaller changes are those of winds and loads, as a share of the resistance. Judgement.
const LEAST_CHANGE: f64 = 0.08;
/// So many of its standard deviations make a change: the split was sought among all runs.
const SURE: f64 = 6.0;
/// The runs next to the split show so much of it, or it is a drift.
const AT_ONCE: f64 = 0.7;

/// A change between two runs.
#[derive(Debug, PartialEq)]
struct ChangedAt {
    /// Index of the first run after it.
    since: usize,
    /// Resistance since, over that before, less 1.
    share: f64,
}

/// The note on a unit; `vehicle`: its coefficients after all runs.
pub(super) fn note(unit: &str, runs: &[Taught], vehicle: &Gaussian<3>) -> Option<String> {
    let of_unit = taught::last_of(unit, runs, vehicle, Taught::teaches_much);
    let shares: Vec<Figure> = of_unit.iter().map(|(_, share)| *share).collect();
    let ChangedAt { since, share } = change(&shares)?;
    let (first, _) = of_unit.get(since)?;
    let speed_mps = median(of_unit.iter().map(|(run, _)| run.speed_mps))?;
    Some(format!(
        "{}: from {} on it has {:.0} % {} resistance (at about {:.0} km/h, by {since} runs before and {} since \
         that teach enough by themselves): a brake that drags, a repair, another load or train? What is carried over it \
         lies between both, whatever its interval; replay the runs since by themselves",
        named(unit),
        first.name,
        100.0 * share.abs(),
        if share > 0.0 { "more" } else { "less" },
        3.6 * speed_mps,
        shares.len() - since
    ))
}

/// Where the shares change at once, and by how much.
fn change(shares: &[Figure]) -> Option<ChangedAt> {
    let middle = |part: &[Figure]| median(part.iter().map(|share| share.value));
    // Distances from the medians of both sides.
    let rest = |since: usize| {
        let (before, after) = shares.split_at(since);
        let of = |part: &[Figure]| -> Option<Vec<f64>> {
            let middle = middle(part)?;
            Some(part.iter().map(|share| share.value - middle).collect())
        };
        Some([of(before)?, of(after)?].concat())
    };
    let sum = |since: &usize| rest(*since).map_or(f64::INFINITY, |rest| rest.iter().map(|off| off.abs()).sum());
    let last = shares.len().checked_sub(LEAST_RUNS)?;
    let since = (LEAST_RUNS..=last).min_by(|a, b| sum(a).total_cmp(&sum(b)))?;
    let (before, after) = shares.split_at(since);
    let own_sd = median(shares.iter().map(|share| share.sd))?;
    let scatter = spread(rest(since)?).max(own_sd);
    let sd = sd_of_median(scatter, before.len()).hypot(sd_of_median(scatter, after.len()));
    let next = middle(&after[..LEAST_RUNS])? - middle(&before[before.len() - LEAST_RUNS..])?;
    let (before, after) = (middle(before)?, middle(after)?);
    let (change, share) = (after - before, (1.0 + after) / (1.0 + before) - 1.0);
    let is_sure = share.abs() > LEAST_CHANGE && change.abs() > SURE * sd;
    (is_sure && next / change > AT_ONCE).then_some(ChangedAt { since, share })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares of runs that scatter by some percent about these.
    fn shares(about: impl IntoIterator<Item = f64>) -> Vec<Figure> {
        let scattered = |(i, about): (usize, f64)| about + 0.02 * (7.0 * i as f64).sin();
        about.into_iter().enumerate().map(scattered).map(|value| Figure { value, sd: 0.01 }).collect()
    }

    #[test]
    fn a_resistance_that_changes_at_once_is_found_with_its_run_and_share() {
        let before_and_since = |before: f64, since: f64| shares([before; 13].into_iter().chain([since; 9]));
        let found = change(&before_and_since(-0.1, 0.15)).unwrap();
        assert!(found.since == 13 && (found.share - 0.28).abs() < 0.04, "{found:?}");
        let found = change(&before_and_since(0.1, -0.1)).unwrap();
        assert!(found.since == 13 && (found.share + 0.18).abs() < 0.04, "{found:?}");
    }

    #[test]
    fn runs_that_scatter_or_drift_or_are_few_have_not_changed() {
        assert_eq!(change(&shares([0.0; 30])), None);
        assert_eq!(change(&shares([0.0, 0.3, -0.3, 0.2, -0.2, 0.25, -0.25, 0.1, 0.3, -0.1, 0.3, -0.3])), None, "winds");
        assert_eq!(change(&shares([-0.1, -0.1, -0.1, 0.15, 0.15, 0.15])), None, "three runs on each side");
        assert_eq!(change(&shares([0.0; 9].into_iter().chain([0.05; 9]))), None, "a small change");
        for runs in [30_u32, 60, 200] {
            let drift = (0..runs).map(|i| 0.2 * f64::from(i) / f64::from(runs - 1));
            assert_eq!(change(&shares(drift)), None, "a drift over {runs} runs");
            let season = (0..2 * runs).map(|i| 0.1 * (std::f64::consts::PI * f64::from(i) / f64::from(runs)).sin());
            assert_eq!(change(&shares(season)), None, "a season of twice as many");
        }
    }
}
