//! Are the runs of a unit those of two trains?
//!
//! In: what each run of a unit teaches of the resistance by itself, and the vehicle after all of them. Out: a note
//! where the runs fall into two sorts, such as with all and with half of the coaches, in no order. Neither are a few
//! [unlike](super::unlike) the others, then, nor has the train [changed](super::changed) at once; what is learned lies
//! between both, and its interval says nothing of it.
//!
//! ```text
//! apart = (mean of the upper - mean of the lower) / scatter within, at the split that leaves the least scatter
//! ```

use super::taught::Taught;
use super::vehicle::named;
use rundown::filter::gaussian::Gaussian;
use rundown::model::direction::Direction;
use rundown_check::agreement::Figure;
use rundown_files::statistics::median;

/// Runs of each sort at least.
const LEAST_RUNS: usize = 4;
/// Nearer sorts are those of winds and loads, as a share of the resistance. Judgement.
const LEAST_APART: f64 = 0.08;
/// Both are so many times as far apart as they scatter: the best split of runs of one sort leaves 2.7 in the middle,
/// and more than this in one of 500 sets of 8 to 10 runs.
const SURE: f64 = 7.0;
/// So many are named.
const NAMED: usize = 12;
/// So much of the way from one to the other is empty.
const EMPTY: f64 = 0.35;

/// Where the runs fall into two sorts.
#[derive(Debug, PartialEq)]
struct Split {
    /// How many have less.
    lower: usize,
    /// Resistance of the upper over that of the lower, less 1.
    share: f64,
}

/// The note on a unit; `vehicle`: its coefficients after all runs.
pub(super) fn note(unit: &str, runs: &[Taught], vehicle: &Gaussian<3>) -> Option<String> {
    let of_unit = runs.iter().filter(|run| run.unit == unit);
    let mut of_unit: Vec<(&Taught, Figure)> = of_unit.filter_map(|run| Some((run, run.over(vehicle)?))).collect();
    let in_order: Vec<f64> = of_unit.iter().map(|(_, share)| share.value).collect();
    of_unit.sort_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let shares: Vec<Figure> = of_unit.iter().map(|(_, share)| *share).collect();
    let Split { lower, share } = split(&shares)?;
    let (less, more) = of_unit.split_at(lower);
    // One sort after the other: it changed.
    let sorts: Vec<bool> = in_order.iter().map(|share| *share < more[0].1.value).collect();
    if sorts.windows(2).filter(|pair| pair[0] != pair[1]).count() == 1 {
        return None;
    }
    let speed_mps = median(of_unit.iter().map(|(run, _)| run.speed_mps))?;
    let goes = |part: &[(&Taught, Figure)], direction| part.iter().all(|(run, _)| run.direction == direction);
    let by_direction = [(Direction::Up, Direction::Down), (Direction::Down, Direction::Up)];
    let by_direction = by_direction.into_iter().any(|(one, other)| goes(less, one) && goes(more, other));
    let cause = if by_direction {
        "one for each direction: a steady wind, or gradients that are off?"
    } else {
        "coaches, a load, another train?"
    };
    let (sort, word) = if more.len() > less.len() { (less, "less") } else { (more, "more") };
    let percent = 100.0 * (if word == "more" { share } else { share / (1.0 + share) });
    let mut names: Vec<&str> = sort.iter().map(|(run, _)| run.name.as_str()).collect();
    names.sort_unstable();
    let named_runs = names[..names.len().min(NAMED)].join(", ");
    let rest = names.len().saturating_sub(NAMED);
    let rest = if rest > 0 { format!(" and {rest} more") } else { String::new() };
    Some(format!(
        "{}: its runs are of two sorts: {} of {} that teach enough by themselves have {percent:.0} % {word} resistance than \
         the others (at about {:.0} km/h), {named_runs}{rest}: {cause} What was learned lies between both, whatever its \
         interval; replay each sort by itself",
        named(unit),
        names.len(),
        of_unit.len(),
        3.6 * speed_mps,
    ))
}

/// Where shares in rising order fall apart.
fn split(shares: &[Figure]) -> Option<Split> {
    let mean = |part: &[Figure]| part.iter().map(|share| share.value).sum::<f64>() / part.len() as f64;
    let squares = |part: &[Figure]| part.iter().map(|share| (share.value - mean(part)).powi(2)).sum::<f64>();
    let within = |lower: usize| squares(&shares[..lower]) + squares(&shares[lower..]);
    let last = shares.len().checked_sub(LEAST_RUNS)?;
    let lower = (LEAST_RUNS..=last).min_by(|a, b| within(*a).total_cmp(&within(*b)))?;
    let (less, more) = shares.split_at(lower);
    let own_sd = median(shares.iter().map(|share| share.sd))?;
    let scatter = (within(lower) / (shares.len() - 2) as f64).sqrt().max(own_sd);
    let apart = mean(more) - mean(less);
    let gap = more.first()?.value - less.last()?.value;
    let are_two = apart > LEAST_APART && apart > SURE * scatter && gap > EMPTY * apart;
    are_two.then(|| Split { lower, share: (1.0 + mean(more)) / (1.0 + mean(less)) - 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn sorted(values: impl Iterator<Item = f64>) -> Vec<Figure> {
        let mut shares: Vec<Figure> = values.map(|value| Figure { value, sd: 0.01 }).collect();
        shares.sort_by(|a, b| a.value.total_cmp(&b.value));
        shares
    }

    #[test]
    fn runs_of_two_trains_in_no_order_are_two_sorts() {
        let scattered = |i: u32| 0.02 * (7.0 * f64::from(i)).sin();
        let runs = sorted((0..14).map(|i| scattered(i) + if i % 3 == 0 { 0.1 } else { -0.08 }));
        let found = split(&runs).unwrap();
        assert!(found.lower == 9 && (found.share - 0.19).abs() < 0.04, "{found:?}");
        assert_eq!(split(&sorted((0..14).map(|i| scattered(i) + if i < 3 { 0.1 } else { -0.08 }))), None, "three runs");
        assert_eq!(split(&sorted((0..14).map(|i| scattered(i) + 0.06 * f64::from(i % 2)))), None, "6 %");
    }

    #[test]
    fn runs_of_one_sort_are_hardly_ever_two() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let is_two = |_: &u32| {
            let count = rng.random_range(8..40);
            // Of winds: as far on both sides of a calm day.
            let mut wind = || (0..4).map(|_| rng.random_range(-0.1..0.1)).sum::<f64>();
            split(&sorted((0..count).map(|_| wind()))).is_some()
        };
        // Of 8 to 10 runs one set in 500, of 20 none in 20 000.
        let two = (0..2000).filter(is_two).count();
        assert!(two <= 4, "{two}");
    }
}
