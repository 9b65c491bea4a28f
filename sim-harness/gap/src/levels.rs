//! Which unit, driver or day differs from the others? What a fleet is asked; no effect, because no law is behind it.
//!
//! In: the coasting rows beside the model that was found. Each run says by which share of the believed r(v) it has more resistance (a probe, see `chance.rs`); the
//! runs of one unit are compared with those of the others, in standard deviations. It was looked for among all units, so it must exceed the largest
//! difference that labels exchanged between runs of the same direction make. (Permutation test; runs are the unit.) What units, drivers and days share, only runs
//! that cross them could tell apart: runs that are all of one driver and of one unit differ by both names.

use crate::candidate::Fitted;
use crate::chance::{Ground, OfRun, beyond_noise, probability};
use crate::config::GapConfig;
use crate::data::{believed::Context, rows::Row, runs::Run};
use crate::noise::{calibrate::Calibrated, habits::regime};
use crate::trials::column;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rundown::model::direction::Direction;
use rundown_check::agreement::Figure;
use rundown_files::effect_file::date_of;
use rundown_pages::numbers::counted;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// By what runs are grouped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// The unit that made them.
    Unit,
    /// Who drove.
    Driver,
    /// The day of departure.
    Day,
}

/// Runs that have more resistance than the others, or less.
#[derive(Clone, Debug, PartialEq)]
pub struct Standout {
    /// What the runs share.
    pub level: Level,
    /// Name of the unit or driver, or the date.
    pub of: String,
    /// How many runs it has.
    pub runs: usize,
    /// Resistance beyond that of the other runs, as a share of the believed.
    pub share: Figure,
    /// Probability of such a difference, or a larger one, somewhere among these levels, if none differs.
    pub p_value: f64,
}

impl Level {
    const ALL: [Self; 3] = [Self::Unit, Self::Driver, Self::Day];

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unit => "unit",
            Self::Driver => "driver",
            Self::Day => "day",
        }
    }

    /// Of a run; empty: not known.
    fn of(self, run: &Run) -> String {
        match self {
            Self::Unit => run.recorded.unit.clone(),
            Self::Driver => run.recorded.driver.clone(),
            Self::Day => run.day.and_then(date_of).unwrap_or_default(),
        }
    }
}

impl Standout {
    /// For a person.
    pub fn sentence(&self) -> String {
        let Self { level, of, share: Figure { value, sd }, .. } = self;
        let more = if *value < 0.0 { "less" } else { "more" };
        format!(
            "The {} of {} {of} have {:.1} \u{b1} {:.1} % {more} resistance in coasting than the others, beside the effects above (p-value {:.3}): no law of its own is known for that.",
            counted(self.runs, "run", "runs"),
            level.name(),
            100.0 * value.abs(),
            196.0 * sd,
            self.p_value
        )
    }

    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        json!({
            "by": self.level.name(),
            "of": self.of,
            "runs": self.runs,
            "share": self.share.value,
            "share_sd": self.share.sd,
            "p_value": self.p_value,
        })
    }
}

/// What a run says, and which way it went.
struct One<'a> {
    of_run: OfRun,
    run: &'a Run,
}

/// Groups that differ from the others by more than chance, the surest first.
pub fn standouts(
    context: &Context<'_>,
    rows: &[Row],
    calibrated: &Calibrated,
    model: &[Fitted],
    runs: &[Run],
) -> Vec<Standout> {
    let ground = Ground::of_terms(context, rows, calibrated);
    let columns: Vec<Vec<f64>> = model.iter().map(|fitted| column(context, rows, fitted)).collect();
    let evidence = &context.config.evidence;
    let davis = context.believed.train().davis();
    let believed = |row: &Row| row.interval.mean(|point| davis.resistance_n_per_kg(point.speed_mps));
    let coasting = |row: &Row| if regime(row, evidence) == 0 { believed(row) } else { 0.0 };
    let believed: Vec<f64> = rows.iter().map(coasting).collect();
    let Some(probe) = ground.beside(&columns).and_then(|base| ground.probe(&base, &believed)) else {
        return Vec::new();
    };
    let of_rows = rows.chunk_by(|a, b| a.interval.run == b.interval.run).map(|rows| &runs[rows[0].interval.run]);
    let all = probe.runs.iter().zip(of_rows).map(|(of_run, run)| One { of_run: *of_run, run });
    let all: Vec<One<'_>> = all.filter(|one| one.of_run.information > 0.0).collect();
    let tried: Vec<(Level, Vec<String>)> = Level::ALL
        .iter()
        .map(|level| (*level, all.iter().map(|one| level.of(one.run)).collect::<Vec<_>>()))
        .filter(|(_, labels)| groups(labels, evidence.least_runs).len() > 1)
        .collect();
    let mut found: Vec<Standout> =
        tried.iter().flat_map(|(level, labels)| of_level(*level, labels, &all, tried.len(), context.config)).collect();
    found.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
    found
}

/// Labels of enough runs, where the others are enough, too.
fn groups(labels: &[String], least: usize) -> BTreeSet<&str> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    labels.iter().filter(|label| !label.is_empty()).for_each(|label| *counts.entry(label).or_default() += 1);
    let enough = |count: usize| count >= least && labels.len() - count >= least;
    counts.into_iter().filter(|(_, count)| enough(*count)).map(|(label, _)| label).collect()
}

/// `tried`: so many levels were looked at.
fn of_level(level: Level, labels: &[String], all: &[One<'_>], tried: usize, config: &GapConfig) -> Vec<Standout> {
    let groups = groups(labels, config.evidence.least_runs);
    // As all runs scatter: labels that are exchanged change nothing of it.
    let [excess, growth] = beyond_noise(all.iter().map(|one| one.of_run), None);
    let between = (excess / growth).max(0.0);
    let sizes = |labels: &[&str]| -> Vec<f64> {
        let size = |group: &&str| difference(labels, group, all, between);
        groups.iter().map(size).map(|figure| figure.away_from(0.0)).collect()
    };
    let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
    let observed = sizes(&labels);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let largest = |sizes: Vec<f64>| sizes.into_iter().fold(0.0, f64::max);
    let draws: Vec<f64> =
        (0..config.evidence.flips).map(|_| largest(sizes(&exchanged(&labels, all, &mut rng)))).collect();
    let of_group = |(group, size): (&&str, &f64)| {
        let reached = draws.iter().filter(|draw| *draw >= size).count();
        let p_value = (tried as f64 * probability(reached, draws.len())).min(1.0);
        // As runs scatter within the two groups.
        let is_in = |inside: bool| {
            let those = all.iter().zip(&labels).filter(move |(_, label)| (*label == group) == inside);
            beyond_noise(those.map(|(one, _)| one.of_run), None)
        };
        let [[a, of_a], [b, of_b]] = [is_in(true), is_in(false)];
        Standout {
            level,
            of: (*group).to_owned(),
            runs: labels.iter().filter(|label| *label == group).count(),
            share: difference(&labels, group, all, ((a + b) / (of_a + of_b)).max(0.0)),
            p_value,
        }
    };
    groups.iter().zip(&observed).map(of_group).filter(|one| one.p_value <= config.certainty.chance).collect()
}

/// The mean of a group less that of the others, where runs differ by this variance beside their noise.
fn difference(labels: &[&str], group: &str, all: &[One<'_>], between: f64) -> Figure {
    let mut sums = [[0.0; 2]; 2];
    for (one, label) in all.iter().zip(labels) {
        let weight = one.of_run.weight_beside(between);
        let [score, information] = &mut sums[usize::from(*label == group)];
        *score += weight * one.of_run.score;
        *information += weight * one.of_run.information;
    }
    let [[others, of_others], [score, information]] = sums;
    Figure { value: score / information - others / of_others, sd: (1.0 / information + 1.0 / of_others).sqrt() }
}

/// Labels exchanged between runs of the same direction.
fn exchanged<'a>(labels: &[&'a str], all: &[One<'_>], rng: &mut ChaCha8Rng) -> Vec<&'a str> {
    let mut labels = labels.to_vec();
    for direction in [Direction::Up, Direction::Down] {
        let places: Vec<usize> = (0..all.len()).filter(|i| all[*i].run.direction == direction).collect();
        let mut those: Vec<&str> = places.iter().map(|i| labels[*i]).collect();
        those.shuffle(rng);
        places.iter().zip(those).for_each(|(place, label)| labels[*place] = label);
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use crate::data::runs::Recorded;
    use crate::noise::whitening::Noise;
    use rand_distr::{Distribution, StandardNormal};

    const RUNS: usize = 40;
    const ROWS: usize = 40;

    /// Of five units on eight days, driven by two in turn, each run with so much of r(v) more, and a scatter between runs of 3 %.
    fn found(seed: u64, more: fn(usize) -> f64) -> Vec<Standout> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let run = |run: usize| Run {
            name: run.to_string(),
            direction: [Direction::Up, Direction::Down][run % 2],
            day: Some((run / 5) as f64 + 0.3),
            samples: Vec::new(),
            recorded: Recorded {
                unit: format!("u{}", run % 5),
                driver: ["Ada", "Bo"][run / 2 % 2].to_owned(),
                ..Recorded::default()
            },
        };
        let runs: Vec<Run> = (0..RUNS).map(run).collect();
        let noise = Noise { acceleration_mps2: 0.003, ..Noise::default() };
        on_a_level_line(RUNS, |context| {
            let davis = context.believed.train().davis();
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let mut rows = Vec::new();
            for (index, run) in runs.iter().enumerate() {
                let share = more(index) + 0.03 * normal();
                for i in 0..ROWS {
                    let speed_mps = 40.0 - 0.5 * i as f64;
                    let mut row = Row::coasting(run.direction, 1000.0 * i as f64, speed_mps);
                    row.interval.run = index;
                    row.residual_n_per_kg = 0.003 * normal() + share * davis.resistance_n_per_kg(speed_mps);
                    rows.push(row);
                }
            }
            let calibrated = Calibrated { noise, spread: vec![1.0; rows.len()], ..Calibrated::default() };
            standouts(context, &rows, &calibrated, &[], &runs)
        })
    }

    #[test]
    fn the_unit_that_drags_is_found_with_its_share() {
        for seed in 0..5 {
            let found = found(seed, |run| if run % 5 == 3 { 0.12 } else { 0.0 });
            assert_eq!((found[0].level, found[0].of.as_str(), found[0].runs), (Level::Unit, "u3", 8), "{found:?}");
            assert!(found[0].share.away_from(0.12) < 3.5 && found[0].share.sd < 0.03, "{found:?}");
            assert!(found[0].sentence().starts_with("The 8 runs of unit u3 have 1"), "{}", found[0].sentence());
        }
    }

    #[test]
    fn a_windy_day_is_one() {
        let found = found(7, |run| if run / 5 == 4 { 0.15 } else { 0.0 });
        assert_eq!((found[0].level, found[0].of.as_str()), (Level::Day, "1970-01-05"), "{found:?}");
    }

    #[test]
    fn where_none_differs_hardly_any_is_found() {
        let sets = (0..60).filter(|seed| !found(100 + seed, |_| 0.0).is_empty()).count();
        // Binomial, 60 of at most 0.05: more than 8 in one of 300 tries.
        assert!(sets <= 8, "{sets} of 60");
    }
}
