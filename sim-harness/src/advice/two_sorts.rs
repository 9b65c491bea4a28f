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

use super::first_of;
use super::taught::{self, Taught};
use super::vehicle::named;
use rundown::filter::gaussian::Gaussian;
use rundown::model::direction::Direction;
use rundown_check::figure::Figure;
use rundown_files::statistics::{mean_of, median, squares_about};

/// Runs of each sort at least. Judgement: three are some that are unlike the others.
const LEAST_RUNS: usize = 4;
/// Nearer sorts are those of winds and loads, as a share of the resistance. Judgement.
const LEAST_APART: f64 = 0.08;
/// They are so many times as far apart as each scatters: the best split of runs of one sort leaves 2.7 in the middle,
/// and more than this in one of 500 sets of 8 to 10 runs.
const SURE: f64 = 7.0;
/// One sort after the other turns once, and with a stray run three times.
const CHANGE_TURNS: usize = 3;
/// So many are named.
const NAMED: usize = 12;
/// So much of the way from one to the other is empty. Judgement.
const EMPTY: f64 = 0.35;

/// Where the runs fall into two sorts.
#[derive(Debug, PartialEq)]
struct Split {
    /// How many have less.
    lower: usize,
    /// Resistance of the upper over that of the lower, less 1.
    share: f64,
}

/// What is said of a unit.
pub(super) struct Note {
    pub(super) text: String,
    /// One sort comes after the other, but for a run: the train may have changed.
    pub(super) may_be_a_change: bool,
    /// What was learned is the resistance of neither sort.
    pub(super) is_of_neither: bool,
}

/// The note on a unit; `vehicle`: its coefficients after all runs.
pub(super) fn note(unit: &str, runs: &[Taught], vehicle: &Gaussian<3>) -> Option<Note> {
    let in_order = taught::last_of(unit, runs, vehicle, |_| true);
    let mut shares: Vec<Figure> = in_order.iter().map(|(_, share)| *share).collect();
    shares.sort_by(|a, b| a.value.total_cmp(&b.value));
    let Split { lower, share } = split(&shares)?;
    let is_less = |of_run: &Figure| of_run.value < shares[lower].value;
    let (less, more): (Vec<_>, Vec<_>) = in_order.iter().partition(|(_, share)| is_less(share));
    let turns = in_order.windows(2).filter(|pair| is_less(&pair[0].1) != is_less(&pair[1].1)).count();
    let speed_mps = median(in_order.iter().map(|(run, _)| run.speed_mps))?;
    let goes = |part: &[(&Taught, Figure)], direction| part.iter().all(|(run, _)| run.direction == direction);
    let by_direction = [(Direction::Up, Direction::Down), (Direction::Down, Direction::Up)];
    let by_direction = by_direction.into_iter().any(|(one, other)| goes(&less, one) && goes(&more, other));
    let cause = if by_direction {
        "one for each direction: a steady wind, or gradients that are off? One direction alone teaches them, too"
    } else {
        "coaches, a load, another train, another chainage? What was learned lies between both, whatever its interval, and \
         is not published; replay each sort by itself"
    };
    let (sort, word, percent) = if more.len() > less.len() {
        (less, "less", 100.0 * share / (1.0 + share))
    } else {
        (more, "more", 100.0 * share)
    };
    let text = format!(
        "{}: its runs are of two sorts: {} of {} that teach enough by themselves have {percent:.0} % {word} resistance than \
         the others (at about {:.0} km/h), {}: {cause}",
        named(unit),
        sort.len(),
        in_order.len(),
        3.6 * speed_mps,
        first_of(sort.iter().map(|(run, _)| run.name.clone()), NAMED),
    );
    Some(Note { text, may_be_a_change: turns <= CHANGE_TURNS, is_of_neither: !by_direction })
}

/// Where shares in rising order fall apart.
fn split(shares: &[Figure]) -> Option<Split> {
    let mean = |part: &[Figure]| mean_of(part.iter().map(|share| share.value));
    let squares = |part: &[Figure]| squares_about(mean(part), part.iter().map(|share| share.value));
    let within = |lower: usize| squares(&shares[..lower]) + squares(&shares[lower..]);
    let last = shares.len().checked_sub(LEAST_RUNS)?;
    let lower = (LEAST_RUNS..=last).min_by(|a, b| within(*a).total_cmp(&within(*b)))?;
    let (less, more) = shares.split_at(lower);
    let own_sd = median(shares.iter().map(|share| share.sd))?;
    let scatter = (within(lower) / (shares.len() - 2) as f64).sqrt().max(own_sd);
    let apart = mean(more) - mean(less);
    let gap = more.first()?.value - less.last()?.value;
    let are_two = mean(less) > -1.0 && apart > LEAST_APART && apart > SURE * scatter && gap > EMPTY * apart;
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
            let count = rng.random_range(8..=10);
            // Of winds: as far on both sides of a calm day.
            let mut wind = || (0..4).map(|_| rng.random_range(-0.1..0.1)).sum::<f64>();
            split(&sorted((0..count).map(|_| wind()))).is_some()
        };
        let two = (0..5000).filter(is_two).count();
        assert!(two <= 20, "{two}");
    }
}
