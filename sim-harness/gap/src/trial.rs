//! Is it more than chance, and does it repeat? What a term of the resistance must stand before it has a name; else it is told as a candidate.
//!
//! The column of the term (see `trials.rs`), its shape and coefficients as found, is tried beside the other terms as the probes of the evidence are: by signs
//! of whole runs and habits of drivers. It was looked for, so it must exceed the largest that chance makes of it or of any probe. And it must say the same in
//! both halves of the runs: by their order, by the date, by direction, by unit.

use crate::config::GapConfig;
use crate::data::runs::Run;
use crate::fit::median;
use rundown::model::direction::Direction;
use rundown_check::agreement::Figure;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// How a term fared.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Probability that chance alone makes as much of this term, or of any probe.
    pub p_value: f64,
    /// Where the runs could be halved: the term in both halves, as a multiple of what all runs say.
    pub halves: Vec<Halves>,
}

/// A term in two halves of the runs, as a multiple of what all runs say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halves {
    /// What the halves are.
    pub by: By,
    /// In each of them.
    pub multiples: [Figure; 2],
    /// From how many runs more than needed their standard deviations are known.
    pub freedom: f64,
}

/// Into which halves runs are split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// Every second one.
    Turn,
    /// Earlier and later days.
    Date,
    /// Up and down.
    Direction,
    /// The unit with the most runs, and the others.
    Unit,
}

impl By {
    /// All of them.
    pub(crate) const ALL: [Self; 4] = [Self::Turn, Self::Date, Self::Direction, Self::Unit];

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Turn => "turn",
            Self::Date => "date",
            Self::Direction => "direction",
            Self::Unit => "unit",
        }
    }

    /// What the two halves are called.
    pub fn halves(self) -> [&'static str; 2] {
        match self {
            Self::Turn => ["every second run", "the others"],
            Self::Date => ["the earlier days", "the later ones"],
            Self::Direction => ["up", "down"],
            Self::Unit => ["the unit with the most runs", "the others"],
        }
    }

    /// In which half each run is: 0 or 1, none in neither.
    pub(crate) fn halves_of(self, runs: &[Run]) -> Vec<Option<usize>> {
        let half = |is_second: bool| Some(usize::from(is_second));
        match self {
            Self::Turn => {
                // Within each direction: trains often go there and back in turn.
                let mut turns = [0_usize; 2];
                let mut of_run = |run: &Run| {
                    let turn = &mut turns[usize::from(run.direction == Direction::Up)];
                    *turn += 1;
                    half(*turn % 2 == 0)
                };
                runs.iter().map(&mut of_run).collect()
            }
            Self::Direction => runs.iter().map(|run| half(run.direction == Direction::Down)).collect(),
            Self::Date => {
                let days = || runs.iter().filter_map(|run| run.day);
                let first = days().fold(f64::INFINITY, f64::min);
                // No run is before its first day.
                let middle = median(days()).filter(|middle| *middle > first);
                let middle = middle.or_else(|| days().filter(|day| *day > first).min_by(f64::total_cmp));
                runs.iter().map(|run| run.day.zip(middle).and_then(|(day, middle)| half(day >= middle))).collect()
            }
            Self::Unit => {
                let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
                runs.iter().for_each(|run| *counts.entry(&run.recorded.unit).or_default() += 1);
                let most = counts.into_iter().max_by_key(|(_, count)| *count).map(|(unit, _)| unit);
                runs.iter().map(|run| half(most != Some(&run.recorded.unit))).collect()
            }
        }
    }
}

impl Halves {
    /// The halves differ by more than chance, or one of them that could show it shows none.
    pub fn contradict(&self, config: &GapConfig) -> bool {
        let [a, b] = self.multiples;
        let telling = |half: &Figure| half.sd < config.certainty.telling_half;
        let sure = of_few(config.certainty.halves, self.freedom);
        (a.value - b.value).abs() > sure * a.sd.hypot(b.sd) + config.certainty.halves_apart
            || self.multiples.iter().any(|half| telling(half) && half.value <= 0.0)
    }
}

/// The quantile of Student's t beside this one of the normal distribution, by its series in 1/freedom. (Cornish and Fisher 1938.) Below two no difference is sure.
fn of_few(z: f64, freedom: f64) -> f64 {
    if freedom < 2.0 {
        return f64::INFINITY;
    }
    let square = z * z;
    let terms = [
        (square + 1.0) / 4.0,
        ((5.0 * square + 16.0) * square + 3.0) / 96.0,
        (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0,
    ];
    z * (1.0 + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / freedom))
}

impl Trial {
    /// Of a term that acts in too few runs to be told from chance.
    pub(crate) const IMPOSSIBLE: Self = Self { p_value: 1.0, halves: Vec::new() };

    /// It is no chance, and repeats.
    pub fn is_stood(&self, config: &GapConfig) -> bool {
        self.p_value <= config.certainty.chance && !self.halves.iter().any(|halves| halves.contradict(config))
    }

    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        let of = |half: &Figure| json!({ "multiple": half.value, "sd": half.sd });
        let halves = self.halves.iter().map(|halves| {
            let [first, second] = halves.by.halves();
            let [a, b] = &halves.multiples;
            json!({ "by": halves.by.name(), "halves": [first, second], "multiples": [of(a), of(b)] })
        });
        json!({ "p_value": self.p_value, "halves": halves.collect::<Vec<_>>() })
    }

    /// Why it has no name, in a clause.
    pub fn sentence(&self, config: &GapConfig) -> String {
        if let Some(halves) = self.halves.iter().find(|halves| halves.contradict(config)) {
            let of = |which: usize| {
                let Figure { value, sd } = halves.multiples[which];
                format!("{value:.1} \u{b1} {sd:.1} times as large in {}", halves.by.halves()[which])
            };
            return format!("it does not repeat: it is {} and {}", of(0), of(1));
        }
        if *self == Self::IMPOSSIBLE {
            return "it acts in too few runs, or together with too much else, to be told from chance".to_owned();
        }
        format!("chance alone makes as much of it in {:.0} % of draws", 100.0 * self.p_value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::runs::Recorded;

    fn run(direction: Direction, day: Option<f64>, unit: &str) -> Run {
        let recorded = Recorded { unit: unit.to_owned(), ..Recorded::default() };
        Run { name: String::new(), direction, day, samples: Vec::new(), recorded }
    }

    #[test]
    fn halves_of_few_runs_may_differ_by_more() {
        // Exact quantiles of Student's t at the tail of three normal standard deviations.
        for (freedom, exact) in [(4.0, 6.62), (10.0, 3.96), (1e6, 3.0)] {
            let found = of_few(3.0, freedom);
            assert!((found / exact - 1.0).abs() < 0.05, "{freedom}: {found} for {exact}");
        }
        let halves = |b: f64, freedom: f64| {
            let of = |value: f64| Figure { value, sd: 0.1 };
            Halves { by: By::Turn, multiples: [of(1.0), of(b)], freedom }.contradict(&GapConfig::default())
        };
        // A half of the effect, and what is left in standard deviations of the difference: 4.2, 1.4, 7.1.
        assert!(halves(2.1, 30.0) && !halves(2.1, 4.0) && !halves(1.7, 30.0));
        assert!(halves(2.5, 6.0) && !halves(2.5, 1.0));
        assert!(halves(-0.1, 1.0), "a half that could show it shows none");
    }

    #[test]
    fn every_second_run_is_so_within_each_direction() {
        let runs: Vec<Run> = (0..8).map(|i| run([Direction::Up, Direction::Down][i % 2], None, "")).collect();
        let halves = By::Turn.halves_of(&runs);
        assert_ne!(halves, By::Direction.halves_of(&runs));
        assert_eq!(halves, [0, 0, 1, 1, 0, 0, 1, 1].map(Some));
    }

    #[test]
    fn runs_without_a_day_are_in_neither_half_and_a_long_first_day_is_one() {
        let days = [Some(1.0), Some(1.0), Some(1.0), Some(2.0), None];
        let runs = days.map(|day| run(Direction::Up, day, ""));
        assert_eq!(By::Date.halves_of(&runs), [Some(0), Some(0), Some(0), Some(1), None]);
        assert_eq!(By::Date.halves_of(&runs[..3]), [None; 3], "one day has no halves");
    }

    #[test]
    fn the_unit_with_the_most_runs_is_one_half() {
        let runs = ["a", "b", "b", "c"].map(|unit| run(Direction::Up, None, unit));
        assert_eq!(By::Unit.halves_of(&runs), [1, 0, 0, 1].map(Some));
    }
}
