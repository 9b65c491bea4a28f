//! Is it more than chance, and does it repeat? What a term of the resistance must stand before it has a name; else it
//! is chance, or a candidate.
//!
//! The column of the term (see `trials.rs`), its shape and coefficients as found, is tried beside the other terms as
//! the probes of the evidence are: by a sign-flip test over runs and habits of drivers. It was looked for, so it must
//! exceed the largest that chance makes of it or of any probe. And it must say the same in both halves of the runs: by
//! their order, by the date, by direction, by unit.

use crate::config::{CertaintyConfig, GapConfig};
use crate::data::runs::Run;
use rundown::model::direction::Direction;
use rundown_check::figure::Figure;
use rundown_files::statistics::median;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// How a term fared.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Probability that chance alone makes as much of this term, or of any probe; none: it shows in limits or readings,
    /// and is tried in halves alone.
    pub p_value: Option<f64>,
    /// The same if the gradients are as described, where they may be off.
    pub as_described: Option<f64>,
    /// Where the runs could be halved: the term in both halves, as a multiple of what all runs say.
    pub halves: Vec<Halves>,
    /// It acts in too few runs, or together with too much else, to be tried.
    is_impossible: bool,
}

/// A term in two halves of the runs, as a multiple of what all runs say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halves {
    /// What the halves are.
    pub by: By,
    /// In each of them.
    pub multiples: [Figure; 2],
    /// Degrees of freedom of their standard deviations.
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
        let telling = |half: &Figure| half.sd < config.certainty.telling_half;
        self.apart(config) > config.certainty.halves
            || self.multiples.iter().any(|half| telling(half) && half.value <= 0.0)
    }

    /// By how many standard deviations they differ beyond what halves may, as if these were known from many runs.
    fn apart(&self, config: &GapConfig) -> f64 {
        let [a, b] = self.multiples;
        let CertaintyConfig { halves, halves_apart, .. } = config.certainty;
        let beyond = ((a.value - b.value).abs() - halves_apart).max(0.0) / a.sd.hypot(b.sd);
        beyond * halves / student_quantile(halves, self.freedom)
    }
}

/// The least that a p-value leaves of the odds of its null hypothesis, whatever the alternative: -e p ln p, which is 1
/// from 1/e on. (Sellke, Bayarri and Berger 2001, calibration of p-values.) A p-value of 0.05 leaves 0.41, one of 0.001
/// leaves 0.019.
fn left_of_null(p_value: f64) -> f64 {
    // Nothing is left of it at 0, the least that a tail has in floating point.
    let p_value = p_value.max(f64::MIN_POSITIVE);
    if p_value < (-1.0_f64).exp() { -core::f64::consts::E * p_value * p_value.ln() } else { 1.0 }
}

/// The quantile of Student's t beside this one of the normal distribution, by its series in 1/freedom. (Cornish and
/// Fisher 1938.) Below two no difference is sure.
fn student_quantile(z: f64, freedom: f64) -> f64 {
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
    /// Of a term that acts in too few runs to be distinguished from chance.
    pub(crate) const IMPOSSIBLE: Self =
        Self { p_value: Some(1.0), as_described: None, halves: Vec::new(), is_impossible: true };

    /// Of a term that chance makes as much of with this probability.
    pub(crate) fn of(p_value: f64, halves: Vec<Halves>) -> Self {
        Self { p_value: Some(p_value), as_described: None, halves, is_impossible: false }
    }

    /// Takes the mean of this p-value and of that `beside` errors of the gradients, which are there with the
    /// probability `may_be`; never less than without them.
    pub(crate) fn beside_errors(&mut self, may_be: f64, beside: &Self) {
        if let (Some(alone), Some(beside)) = (self.p_value, beside.p_value) {
            self.as_described = Some(alone);
            self.p_value = Some(alone.max(alone + may_be * (beside - alone)));
        }
    }

    /// Of what leaves no mean residual; none where the runs cannot be halved.
    pub(crate) fn by_halves(halves: Vec<Halves>) -> Option<Self> {
        (!halves.is_empty()).then_some(Self { p_value: None, as_described: None, halves, is_impossible: false })
    }

    /// It is no chance, and repeats.
    pub fn is_stood(&self, config: &GapConfig) -> bool {
        self.p_value.is_none_or(|p| p <= config.certainty.chance)
            && !self.halves.iter().any(|halves| halves.contradict(config))
    }

    /// Something may be there, with a name or without: what acts in few runs is not known to be chance.
    pub(crate) fn is_beyond_chance(&self, config: &GapConfig) -> bool {
        self.is_impossible || self.as_described.or(self.p_value).is_none_or(|p| p <= config.certainty.chance)
    }

    /// It is no chance if the gradients are as described, and may be theirs if they are not.
    pub(crate) fn is_of_errors(&self, config: &GapConfig) -> bool {
        let chance = config.certainty.chance;
        self.as_described.is_some_and(|p| p <= chance) && self.p_value.is_some_and(|p| p > chance)
    }

    /// Odds of chance against the name.
    pub(crate) fn odds_of_chance(&self) -> f64 {
        self.p_value.map_or(0.0, left_of_null)
    }

    /// What the halves leave of the odds that it is the same in all runs; 1 where they agree. The worst of several
    /// halvings counts, each as often as it is tried.
    pub(crate) fn odds_of_repeating(&self, config: &GapConfig) -> f64 {
        let apart = self.halves.iter().map(|halves| halves.apart(config)).fold(0.0, f64::max);
        let by_chance = libm::erfc(apart / core::f64::consts::SQRT_2) * self.halves.len() as f64;
        if self.halves.is_empty() { 1.0 } else { left_of_null(by_chance) }
    }

    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        let of = |half: &Figure| json!({ "multiple": half.value, "sd": half.sd });
        let halves = self.halves.iter().map(|halves| {
            let [first, second] = halves.by.halves();
            let [a, b] = &halves.multiples;
            json!({ "by": halves.by.name(), "halves": [first, second], "multiples": [of(a), of(b)] })
        });
        let halves: Vec<_> = halves.collect();
        json!({ "p_value": self.p_value, "p_value_as_described": self.as_described, "halves": halves })
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
        if self.is_of_errors(config) {
            return "it may be small errors of the described gradients: the places of the line do not show whether there \
                    are any"
                .to_owned();
        }
        "it acts in too few runs, or together with too much else, to be distinguished from chance".to_owned()
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
            let found = student_quantile(3.0, freedom);
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
    fn confidence_falls_with_chance_and_with_halves_that_differ() {
        // -e p ln p, by hand: e * 0.05 * 2.996 and e * 0.001 * 6.908.
        for (p_value, left) in [(0.05, 0.407), (0.001, 0.0188), (0.5, 1.0), (0.0, 0.0)] {
            assert!((left_of_null(p_value) - left).abs() < 1e-3, "{p_value}");
        }
        let config = GapConfig::default();
        let confidence = |p_value: f64, second: f64| {
            let of = |value: f64| Figure { value, sd: 0.1 };
            let halves = Halves { by: By::Turn, multiples: [of(1.0), of(second)], freedom: 1e6 };
            let trial = Trial::of(p_value, vec![halves]);
            let effect = rundown::model::effects::MassError { relative: 0.1 }.into();
            let mut named = crate::named::Named::plain(effect, Vec::new(), 60.0, 60.0);
            named.tried(Some(trial), &config);
            named.confidence
        };
        // Halves may differ by a half of the effect; at 0.3 beyond that, 2.1 standard deviations, the odds of 53 to 1
        // are 16 to 1.
        assert!((confidence(0.001, 1.0) - 0.982).abs() < 1e-3 && (confidence(0.001, 1.4) - 0.982).abs() < 1e-3);
        assert!((confidence(0.001, 1.8) - 0.941).abs() < 3e-3, "{}", confidence(0.001, 1.8));
        assert!((confidence(0.03, 1.0) - 0.778).abs() < 1e-3);
    }

    #[test]
    fn what_chance_makes_often_is_no_candidate_and_what_acts_in_few_runs_is_one() {
        let config = GapConfig::default();
        let trial = |p_value: f64| Trial::of(p_value, Vec::new());
        assert!(trial(0.03).is_stood(&config));
        assert!(!trial(0.04).is_stood(&config) && !trial(0.04).is_beyond_chance(&config));
        assert!(!Trial::IMPOSSIBLE.is_stood(&config) && Trial::IMPOSSIBLE.is_beyond_chance(&config));
        let of = |value: f64| Figure { value, sd: 0.1 };
        let halves = vec![Halves { by: By::Turn, multiples: [of(2.0), of(0.0)], freedom: 1e6 }];
        let twice = Trial::of(0.001, halves);
        assert!(!twice.is_stood(&config) && twice.is_beyond_chance(&config));
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
