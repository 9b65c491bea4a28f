//! Which unit, driver or day differs from the others? What a fleet is asked; no effect, because no law is behind it.
//!
//! In: the coasting rows beside the model that was found. Each run says by which share of the believed r(v) it has more
//! resistance (a probe, see `chance.rs`); the runs of one unit are compared with those of the others, in standard
//! deviations. It was looked for among all units, so it must exceed the largest difference of its kind that exchanged
//! labels make (`exchange.rs`; permutation test). Runs that are all of one driver and of one unit differ by both names.

mod exchange;
mod loads;
mod standout;

pub use standout::{Level, More, NotCompared, Standout};

use crate::candidate::Fitted;
use crate::chance::{Ground, OfRun, beyond_noise, probability};
use crate::columns::mass;
use crate::config::{EvidenceConfig, GapConfig};
use crate::data::{believed::Context, rows::Row, runs::Run};
use crate::noise::{calibrate::Calibrated, habits::regime};
use crate::trials::column;
use exchange::Exchange;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rundown::model::direction::Direction;
use rundown_check::figure::Figure;
use std::collections::{BTreeMap, BTreeSet};

/// What a run says: in comparison with the others, and with the description.
struct One<'a> {
    of_run: OfRun,
    described: OfRun,
    run: &'a Run,
}

/// The runs of the rows, in their order.
fn runs_of<'a>(rows: &[Row], runs: &'a [Run]) -> Vec<&'a Run> {
    rows.chunk_by(|a, b| a.interval.run == b.interval.run).map(|rows| &runs[rows[0].interval.run]).collect()
}

/// The labels that runs have at a level.
fn labels(level: Level, runs: &[&Run]) -> Vec<String> {
    runs.iter().map(|run| level.of(run)).filter(|label| !label.is_empty()).collect()
}

/// The coasting rows, with their noise.
fn coasting(rows: &[Row], calibrated: &Calibrated, config: &EvidenceConfig) -> (Vec<Row>, Calibrated) {
    let coasts = |(row, _): &(&Row, &f64)| regime(row, config) == 0;
    let (rows, spread) = rows.iter().zip(&calibrated.spread).filter(coasts).map(|(row, s)| (row.clone(), *s)).unzip();
    (rows, Calibrated { spread, ..calibrated.clone() })
}

/// The believed resistance of a row, N/kg.
fn believed(context: &Context<'_>, row: &Row) -> f64 {
    let davis = context.believed.train().davis();
    row.interval.mean(|point| davis.resistance_n_per_kg(point.speed_mps))
}

/// The same of all rows.
fn all_believed(context: &Context<'_>, rows: &[Row]) -> Vec<f64> {
    rows.iter().map(|row| believed(context, row)).collect()
}

/// What groups may have more of in their rows, for each group of these levels but the largest of each. `values`: of the
/// rows.
fn all_columns(levels: &[Level], values: &[f64], rows: &[Row], runs: &[Run], least: usize) -> Vec<Vec<f64>> {
    let of_rows = runs_of(rows, runs);
    let of_level = |level: Level| {
        let labels = labels(level, &of_rows);
        let of = groups(labels.iter().map(String::as_str), least);
        let count = |group: &&&str| labels.iter().filter(|label| *label == **group).count();
        let largest = of.iter().max_by_key(count).copied().filter(|_| of.len() > 1);
        let others = of.iter().copied().filter(|group| largest.is_some_and(|largest| largest != *group));
        others.map(|group| column_of(level, group, values, rows, runs)).collect::<Vec<_>>()
    };
    levels.iter().copied().flat_map(of_level).collect()
}

/// What a group may have more of, in its rows alone.
fn column_of(level: Level, group: &str, values: &[f64], rows: &[Row], runs: &[Run]) -> Vec<f64> {
    let is_in = |row: &Row| level.of(&runs[row.interval.run]) == group;
    rows.iter().zip(values).map(|(row, value)| if is_in(row) { *value } else { 0.0 }).collect()
}

/// Columns of the units and drivers that differ: beside them runs are compared with each other. A day that differs may
/// be a windy one.
pub fn columns(found: &[Standout], context: &Context<'_>, rows: &[Row], runs: &[Run]) -> Vec<Vec<f64>> {
    let lasting = found.iter().filter(|one| Level::LASTING.contains(&one.level));
    let values = |more: More| match more {
        More::Resistance => all_believed(context, rows),
        More::Effort => mass(context, rows),
    };
    lasting.map(|one| column_of(one.level, &one.of, &values(one.more), rows, runs)).collect()
}

/// Groups that differ from the others by more than chance, the surest first, and what could not be compared. `noise`:
/// beside columns in which runs differ, so that what units and drivers differ by is no scatter of their runs.
pub fn standouts(
    context: &Context<'_>,
    rows: &[Row],
    noise: impl Fn(Vec<Vec<f64>>) -> Calibrated,
    model: &[Fitted],
    runs: &[Run],
) -> (Vec<Standout>, Vec<NotCompared>) {
    let evidence = &context.config.evidence;
    let of_rows = runs_of(rows, runs);
    let may_differ =
        |level: &Level| groups(labels(*level, &of_rows).iter().map(String::as_str), evidence.least_runs).len() > 1;
    // Of one unit, and days of a run or two each, nothing is to be compared.
    if !Level::ALL.iter().any(may_differ) {
        return Default::default();
    }
    let loads = loads::standouts(context, rows, &noise, model, runs);
    // Only what coasts is compared: another constant of a run that its efforts have, too, would hide what its coasting
    // has.
    let beside = all_columns(&Level::LASTING, &all_believed(context, rows), rows, runs, evidence.least_runs);
    let (rows, calibrated) = coasting(rows, &noise(beside), evidence);
    let (rows, of_rows) = (rows.as_slice(), runs_of(&rows, runs));
    if rows.is_empty() {
        return (loads, Vec::new());
    }
    let ground = Ground::of_terms(context, rows, &calibrated);
    let of_terms = |terms: &mut dyn Iterator<Item = &Fitted>| {
        let columns: Vec<Vec<f64>> = terms.map(|fitted| column(context, rows, fitted)).collect();
        ground.beside(&columns)
    };
    let believed = all_believed(context, rows);
    // Of places the description is compared by others; what is the same all along the line stays in the comparison with
    // it.
    let bases = (of_terms(&mut model.iter()), of_terms(&mut model.iter().filter(|fitted| fitted.term.by_place())));
    let (Some(base), Some(places)) = bases else {
        return (loads, Vec::new());
    };
    let [of_runs, described] = [base, places].map(|base| ground.of_runs(&base, &believed));
    let all = of_runs.iter().zip(&described).zip(of_rows);
    let all = all.map(|((of_run, described), run)| One { of_run: *of_run, described: *described, run });
    let mut all: Vec<One<'_>> = all.filter(|one| one.of_run.information > 0.0).collect();
    without_directions(&mut all);
    let (mut found, not_compared) = compared(&Level::ALL, &all, More::Resistance, context.config);
    found.extend(loads);
    found.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
    (found, not_compared)
}

/// What of these levels differs, and what cannot be compared.
fn compared(levels: &[Level], all: &[One<'_>], more: More, config: &GapConfig) -> (Vec<Standout>, Vec<NotCompared>) {
    let (mut tried, mut not_compared) = (Vec::new(), Vec::new());
    let least = config.certainty.chance / levels.len() as f64;
    for &level in levels {
        let all = labelled(level, all);
        if groups(all.iter().map(|one| one.label.as_str()), config.evidence.least_runs).len() > 1 {
            match Exchange::of(level, &all, least) {
                Ok(exchange) => tried.push((level, all, exchange)),
                Err(why) => not_compared.push(NotCompared { level, why }),
            }
        }
    }
    let of_level = |(level, all, exchange): &(Level, Vec<Labelled<'_>>, Exchange)| {
        of_level(*level, all, exchange, tried.len(), config).into_iter().map(|one| Standout { more, ..one })
    };
    (tried.iter().flat_map(of_level).collect(), not_compared)
}

/// A run with its label at a level.
#[derive(Clone)]
struct Labelled<'a> {
    of_run: OfRun,
    described: OfRun,
    label: String,
    run: &'a Run,
}

/// Takes the mean of each direction out of the comparison.
fn without_directions(all: &mut [One<'_>]) {
    for direction in [Direction::Up, Direction::Down] {
        let those = || all.iter().filter(|one| one.run.direction == direction).map(|one| one.of_run);
        let mean = those().map(|run| run.score).sum::<f64>() / those().map(|run| run.information).sum::<f64>();
        for one in all.iter_mut().filter(|one| one.run.direction == direction) {
            one.of_run.score -= mean * one.of_run.information;
        }
    }
}

/// Runs that have a label.
fn labelled<'a>(level: Level, all: &[One<'a>]) -> Vec<Labelled<'a>> {
    let one = |one: &One<'a>| Labelled {
        of_run: one.of_run,
        described: one.described,
        label: level.of(one.run),
        run: one.run,
    };
    all.iter().map(one).filter(|one| !one.label.is_empty()).collect()
}

/// Labels of enough runs, where the others are enough, too.
fn groups<'a>(labels: impl Iterator<Item = &'a str>, least: usize) -> BTreeSet<&'a str> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    labels.for_each(|label| *counts.entry(label).or_default() += 1);
    let all: usize = counts.values().sum();
    counts.into_iter().filter(|(_, count)| *count >= least && all - count >= least).map(|(label, _)| label).collect()
}

/// `tried`: so many levels were looked at.
fn of_level(
    level: Level,
    all: &[Labelled<'_>],
    exchange: &Exchange,
    tried: usize,
    config: &GapConfig,
) -> Vec<Standout> {
    let groups = groups(all.iter().map(|one| one.label.as_str()), config.evidence.least_runs);
    // As all runs scatter: labels that are exchanged change nothing of it.
    let [excess, growth] = beyond_noise(all.iter().map(|one| one.of_run), None);
    let between = (excess / growth).max(0.0);
    let sizes = |labels: &[&str]| -> Vec<f64> {
        let size = |group: &&str| difference(labels, group, all, between);
        groups.iter().map(size).map(|figure| figure.away_from(0.0)).collect()
    };
    let labels: Vec<&str> = all.iter().map(|one| one.label.as_str()).collect();
    let observed = sizes(&labels);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let largest = |sizes: Vec<f64>| sizes.into_iter().fold(0.0, f64::max);
    let draws: Vec<f64> =
        (0..config.evidence.flips).map(|_| largest(sizes(&exchange.draw(&labels, &mut rng)))).collect();
    let of_group = |(group, size): (&&str, &f64)| {
        let reached = draws.iter().filter(|draw| *draw >= size).count();
        let p_value = (tried as f64 * probability(reached, draws.len())).min(1.0);
        // As runs scatter within the two groups.
        let is_in = |inside: bool| {
            let those = all.iter().filter(move |one| (one.label == **group) == inside);
            beyond_noise(those.map(|one| one.of_run), None)
        };
        let [[a, of_a], [b, of_b]] = [is_in(true), is_in(false)];
        let other = groups.iter().find(|other| *other != group).filter(|_| groups.len() == 2);
        let [own, others] = [Some(group), other].map(|of| {
            let those = || all.iter().filter(move |one| Some(&one.label.as_str()) == of).map(|one| one.described);
            those().map(|run| run.score).sum::<f64>() / those().map(|run| run.information).sum::<f64>()
        });
        Standout {
            more: More::Resistance,
            level,
            of: (*group).to_owned(),
            runs: labels.iter().filter(|label| *label == group).count(),
            share: difference(&labels, group, all, ((a + b) / (of_a + of_b)).max(0.0)),
            described: own,
            other: other.map(|other| ((*other).to_owned(), others)),
            p_value,
        }
    };
    let found = groups.iter().zip(&observed).map(of_group).filter(|one| one.p_value <= config.certainty.chance);
    // Two that are all there is differ from each other: said once, of the one that has more.
    found.filter(|one| groups.len() > 2 || one.share.value > 0.0).collect()
}

/// The mean of a group less that of the others, where runs differ by this variance beside their noise.
fn difference(labels: &[&str], group: &str, all: &[Labelled<'_>], between: f64) -> Figure {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::{Shape, Term};
    use crate::candidates;
    use crate::data::believed::tests::on_a_level_line;
    use crate::data::runs::Recorded;
    use crate::noise::whitening::Noise;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::effects::EffectKind;

    const RUNS: usize = 40;
    const ROWS: usize = 40;

    /// Forty runs on eight days, driven by two in turn, with a scatter between runs of 3 %.
    struct Fleet {
        /// Which unit a run is of.
        unit: fn(usize) -> usize,
        /// How many runs a day has, in turn up and down.
        runs_a_day: usize,
        /// How much more of r(v) a run has.
        more: fn(usize) -> f64,
        /// Scatter between days, a share of r(v).
        day_sd: f64,
        /// How much slower the runs of unit 3 are, m/s, with a wrong r0 in all runs that the model has.
        slower_mps: f64,
    }

    const FLEET: Fleet = Fleet { unit: |run| run % 5, runs_a_day: 5, more: |_| 0.0, day_sd: 0.0, slower_mps: 0.0 };

    impl Fleet {
        fn found(&self, seed: u64) -> Vec<Standout> {
            self.compared(seed).0
        }

        fn compared(&self, seed: u64) -> (Vec<Standout>, Vec<NotCompared>) {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let run = |run: usize| Run {
                name: run.to_string(),
                direction: [Direction::Up, Direction::Down][run % 2],
                day: Some((run / self.runs_a_day) as f64 + 0.3),
                samples: Vec::new(),
                recorded: Recorded {
                    unit: format!("u{}", (self.unit)(run)),
                    driver: ["Ada", "Bo"][run / 2 % 2].to_owned(),
                    ..Recorded::default()
                },
            };
            let runs: Vec<Run> = (0..RUNS).map(run).collect();
            let noise = Noise { acceleration_mps2: 0.003, ..Noise::default() };
            on_a_level_line(RUNS, |context| {
                let davis = context.believed.train().davis();
                let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
                let days: Vec<f64> = (0..RUNS / self.runs_a_day).map(|_| self.day_sd * normal()).collect();
                let wrong_r0 = if self.slower_mps > 0.0 { 2e-3 } else { 0.0 };
                let mut rows = Vec::new();
                for (index, run) in runs.iter().enumerate() {
                    let share = (self.more)(index) + 0.03 * normal() + days[index / self.runs_a_day];
                    let slower_mps = if (self.unit)(index) == 3 { self.slower_mps } else { 0.0 };
                    for i in 0..ROWS {
                        let speed_mps = 40.0 - 0.5 * i as f64 - slower_mps;
                        let mut row = Row::coasting(run.direction, 1000.0 * i as f64, speed_mps);
                        row.interval.run = index;
                        let r = davis.resistance_n_per_kg(speed_mps);
                        row.residual_n_per_kg = 0.003 * normal() + share * r + wrong_r0;
                        rows.push(row);
                    }
                }
                let calibrated = Calibrated::even(noise, rows.len());
                let shape = Shape::Powers([true, false, false]);
                let term = Term { of: candidates::of(EffectKind::DavisError), shape };
                let model = Fitted::certain(term, vec![wrong_r0]);
                standouts(
                    context,
                    &rows,
                    |_| calibrated.clone(),
                    if wrong_r0 > 0.0 { std::slice::from_ref(&model) } else { &[] },
                    &runs,
                )
            })
        }
    }

    #[test]
    fn the_unit_that_drags_is_found_with_its_share() {
        for seed in 0..5 {
            let found = Fleet { more: |run| if run % 5 == 3 { 0.12 } else { 0.0 }, ..FLEET }.found(seed);
            let [one] = &found[..] else {
                panic!("expected one, found {found:?}");
            };
            assert_eq!((one.level, one.of.as_str(), one.runs), (Level::Unit, "u3", 8));
            assert!(one.share.away_from(0.12) < 3.5 && one.share.sd < 0.03, "{one:?}");
            assert!(one.sentence().starts_with("The 8 runs of unit u3 have 1"), "{}", one.sentence());
        }
    }

    #[test]
    fn it_is_found_beside_a_term_of_the_model_where_it_runs_slower_than_the_others() {
        for seed in 0..5 {
            let more: fn(usize) -> f64 = |run| if run % 5 == 3 { 0.12 } else { 0.0 };
            let found = Fleet { more, slower_mps: 10.0, ..FLEET }.found(seed);
            assert_eq!(found.first().map(|one| one.of.as_str()), Some("u3"), "{found:?}");
            assert!((found[0].share.value - 0.12).abs() < 0.05, "{found:?}");
        }
    }

    #[test]
    fn a_windy_day_is_one() {
        let found = Fleet { more: |run| if run / 5 == 4 { 0.15 } else { 0.0 }, ..FLEET }.found(7);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!((found[0].level, found[0].of.as_str()), (Level::Day, "1970-01-05"));
    }

    #[test]
    fn two_drivers_that_differ_are_said_once() {
        let found = Fleet { more: |run| if run / 2 % 2 == 1 { 0.1 } else { 0.0 }, ..FLEET }.found(3);
        let drivers: Vec<&str> =
            found.iter().filter(|one| one.level == Level::Driver).map(|one| one.of.as_str()).collect();
        assert_eq!(drivers, ["Bo"], "{found:?}");
    }

    /// Units 0 and 1 each make a run a day, one up and one down, in turn.
    const IN_TURN: Fleet = Fleet { unit: |run| (run + run / 2) % 2, runs_a_day: 2, ..FLEET };

    #[test]
    fn two_units_that_never_go_the_same_way_on_a_day_are_compared() {
        let more: fn(usize) -> f64 = |run| if (run + run / 2) % 2 == 1 { -0.1 } else { 0.0 };
        for seed in 0..5 {
            let (found, not_compared) = Fleet { more, day_sd: 0.05, ..IN_TURN }.compared(seed);
            assert_eq!(not_compared, []);
            let one = found.iter().find(|one| one.level == Level::Unit).expect("units that differ by a tenth");
            // Of two it is said of the one that has more, though the other is the one that is not as described.
            assert_eq!(one.of, "u0");
            let (other, others) = one.other.as_ref().expect("the other one");
            assert_eq!(other, "u1");
            assert!((one.share.value - 0.1).abs() < 0.04, "{one:?}");
            assert!(one.described.abs() < 0.06 && (others + 0.1).abs() < 0.06, "{one:?}");
            assert!(one.sentence().contains("than those of unit u1"), "{}", one.sentence());
        }
    }

    #[test]
    fn units_that_each_go_in_one_direction_are_not_compared_and_it_is_said() {
        let unit: fn(usize) -> usize = |run| run % 2;
        let (found, not_compared) = Fleet { unit, more: |run| 0.1 * (run % 2) as f64, ..IN_TURN }.compared(0);
        assert!(found.iter().all(|one| one.level != Level::Unit), "{found:?}");
        let [one] = &not_compared[..] else {
            panic!("expected the units, found {not_compared:?}");
        };
        assert_eq!(
            one.sentence(),
            "Whether one unit has more resistance than the others is not known: each unit went in one direction only, so a unit that differs is not distinguished from a direction that does."
        );
    }

    /// In how many of 60 sets a unit or a driver stands out.
    fn false_ones(fleet: &Fleet) -> usize {
        let of_units = |found: Vec<Standout>| found.iter().any(|one| one.level != Level::Day);
        (0..60).filter(|seed| of_units(fleet.found(100 + seed))).count()
    }

    #[test]
    fn where_none_differs_hardly_any_is_found() {
        let sets = (0..60).filter(|seed| !FLEET.found(100 + seed).is_empty()).count();
        println!("{sets} of 60");
        // Binomial, 60 of at most 0.03: more than 6 in one of 300 tries.
        assert!(sets <= 6, "{sets} of 60");
    }

    #[test]
    fn windy_days_make_no_unit_that_differs() {
        // Each day has all units, or one of four, or each of two in a direction of its own.
        let of_one_direction_a_day = Fleet { day_sd: 0.05, ..IN_TURN };
        let units = [|run: usize| run % 5, |run: usize| run / 5 % 4];
        for fleet in units.map(|unit| Fleet { unit, day_sd: 0.05, ..FLEET }).iter().chain([&of_one_direction_a_day]) {
            let sets = false_ones(fleet);
            println!("{sets} of 60");
            assert!(sets <= 6, "{sets} of 60");
        }
    }
}
