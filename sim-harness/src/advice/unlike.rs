//! Is a run among these one of another train?
//!
//! In: what each run teaches of the resistance by itself, and the vehicle after all of them. Out: a note on the runs
//! that are far from all others. A log of another train, a forgotten load or a gale teach the vehicle as the others do,
//! and nothing else asks whether they belong to it.
//!
//! ```text
//! away = run / vehicle - 1, by its median over the runs, in units of 1.4826 x the median distance from it
//! ```

use super::first_of;
use super::taught::Taught;
use rundown::filter::gaussian::Gaussian;
use rundown_check::figure::Figure;
use rundown_files::statistics::{median, spread};

/// From fewer runs it is not known how runs scatter.
const LEAST_RUNS: usize = 8;
/// So many times as far from the others as they are from each other ...
const FAR: f64 = 6.0;
/// ... by so large a share of the resistance (judgement: winds of single days do less) ...
const LEAST_SHARE: f64 = 0.12;
/// ... and by so many of its own standard deviations (measured: one misjudged coast is worth several) is worth a word.
const SURE: f64 = 12.0;
/// So many are named.
const NAMED: usize = 3;

/// Runs far from all others, the farthest first. `vehicle`: the coefficients of a unit after all runs.
pub(super) fn note(runs: &[Taught], vehicle: impl Fn(&str) -> Option<Gaussian<3>>) -> Option<String> {
    let shares: Vec<(Figure, &Taught)> = runs
        .iter()
        .filter(|run| run.teaches_much())
        .filter_map(|run| Some((run.over(&vehicle(&run.unit)?)?, run)))
        .collect();
    if shares.len() < LEAST_RUNS {
        return None;
    }
    let middle = median(shares.iter().map(|(share, _)| share.value))?;
    let scatter = spread(shares.iter().map(|(share, _)| share.value - middle));
    let is_far = |share: &Figure| {
        let away = (share.value - middle).abs();
        away > LEAST_SHARE && away > FAR * scatter && away > SURE * share.sd
    };
    let far = shares.into_iter().filter(|(share, _)| is_far(share));
    let mut far: Vec<(f64, &Taught)> = far.map(|(share, run)| (share.value - middle, run)).collect();
    if far.is_empty() {
        return None;
    }
    far.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let of_run = |(share, run): &(f64, &Taught)| {
        let than = if *share > 0.0 { "more" } else { "less" };
        format!("{} {:.0} % {than} (at {:.0} km/h)", run.name, 100.0 * share.abs(), 3.6 * run.speed_mps)
    };
    Some(format!(
        "unlike the others in their resistance, which scatter by {:.1} %: {}; another train, a load, a brake that drags \
         or a gale? They taught the vehicle as the others did: leave them out if they are none of it",
        100.0 * scatter,
        first_of(far.iter().map(of_run), NAMED)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::resistance::Resistance;
    use rundown::model::direction::Direction;

    /// The note on runs with so much of the vehicle's resistance each.
    fn said(factors: &[f64]) -> Option<String> {
        let davis = Gaussian::independent([0.01, 1e-4, 3e-5], [1e-4, 1e-6, 1e-7]);
        let vehicle = Resistance::at(&davis, 25.0).unwrap().mean_n_per_kg;
        let run = |(i, factor): (usize, &f64)| Taught {
            name: format!("run{i}"),
            unit: String::new(),
            direction: Direction::Up,
            share: 1.0,
            speed_mps: 25.0,
            r_n_per_kg: Figure { value: factor * vehicle, sd: 1e-4 },
        };
        let runs: Vec<Taught> = factors.iter().enumerate().map(run).collect();
        note(&runs, |_| Some(davis))
    }

    const ALIKE: [f64; 9] = [1.0, 1.02, 0.98, 1.01, 0.99, 1.03, 0.97, 1.0, 1.01];

    #[test]
    fn a_run_of_another_train_is_named_with_its_share() {
        let mut factors = ALIKE.to_vec();
        factors[3] = 0.75;
        let note = said(&factors).unwrap();
        assert!(note.starts_with("unlike the others"), "{note}");
        assert!(note.contains("run3 25 % less (at 90 km/h);"), "{note}");
    }

    #[test]
    fn runs_that_scatter_are_none() {
        assert_eq!(said(&ALIKE), None);
        // In strong winds all of them do.
        assert_eq!(said(&[1.0, 1.2, 0.8, 1.1, 0.9, 1.3, 0.7, 1.0, 1.05]), None);
        // Of few it is not known how they scatter.
        assert_eq!(said(&[1.0, 1.0, 1.0, 1.3]), None);
    }
}
