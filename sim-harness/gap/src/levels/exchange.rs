//! Which labels may be exchanged, so that what runs share for other reasons stays where it is.
//!
//! What the runs of a day share, weather and load, is no matter of who drove them, nor of the unit. So whole days
//! exchange their labels of units and drivers, those of days with as many runs, and then the runs of a day theirs:
//! where no unit differs both leave runs as likely as they were. The mean of each direction has been taken out, for the
//! gradients of a line are described as well as they are.

use super::{Labelled, Level};
use crate::chance::probability;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rundown::model::direction::Direction;
use std::collections::{BTreeMap, BTreeSet};

/// Ways to exchange, one after the other: pools of groups of runs; the groups of a pool exchange their labels as a
/// whole.
pub(super) struct Exchange(Vec<Pools>);

type Pools = Vec<Vec<Group>>;

/// Indices of runs that keep together.
type Group = Vec<usize>;

/// Labels of a group: one where all have the same, so that groups of unlike size exchange it.
fn pattern<'a>(group: &Group, labels: &[&'a str]) -> Vec<&'a str> {
    let mut of_group: Vec<&str> = group.iter().map(|i| labels[*i]).collect();
    if of_group.iter().all(|label| *label == of_group[0]) {
        of_group.truncate(1);
    }
    of_group
}

impl Exchange {
    /// With enough orders of the labels that a probability may come to `least`, else why there are too few.
    pub(super) fn of(level: Level, all: &[Labelled<'_>], least: f64) -> Result<Self, String> {
        let labels: Vec<&str> = all.iter().map(|one| one.label.as_str()).collect();
        let of = level.name();
        if level != Level::Day && is_of_one_direction(all) {
            return Err(format!(
                "each {of} went in one direction only, so a {of} that differs is not distinguished from a direction that does"
            ));
        }
        let day = |i: usize| all[i].run.day.map(|day| day.floor() as i64).filter(|_| level != Level::Day);
        let mut ways = vec![of_runs(all.len(), day)];
        if (0..all.len()).all(|i| day(i).is_some()) {
            // Where days have few runs, hardly anything is exchanged within them.
            ways.insert(0, of_days(&labels, day));
        }
        if ways.iter().any(|way| probability(0, orders(way, &labels) as usize) <= least) {
            return Ok(Self(ways));
        }
        Err(format!("too few runs of different {of}s share a day, or go on days with as many runs"))
    }

    /// The labels in another order.
    pub(super) fn draw<'a>(&self, labels: &[&'a str], rng: &mut ChaCha8Rng) -> Vec<&'a str> {
        let mut drawn = labels.to_vec();
        for pool in self.0.iter().flatten() {
            let mut patterns: Vec<Vec<&str>> = pool.iter().map(|group| pattern(group, &drawn)).collect();
            patterns.shuffle(rng);
            for (group, pattern) in pool.iter().zip(&patterns) {
                group.iter().zip(pattern.iter().cycle()).for_each(|(i, label)| drawn[*i] = label);
            }
        }
        drawn
    }
}

/// Whether each label has runs in one direction, and not all in the same.
fn is_of_one_direction(all: &[Labelled<'_>]) -> bool {
    let mut directions: BTreeMap<&str, BTreeSet<bool>> = BTreeMap::new();
    for one in all {
        directions.entry(&one.label).or_default().insert(one.run.direction == Direction::Up);
    }
    directions.values().all(|of| of.len() == 1) && directions.values().flatten().collect::<BTreeSet<_>>().len() == 2
}

/// Runs of a block, each for itself.
fn of_runs<K: Ord>(count: usize, block: impl Fn(usize) -> K) -> Pools {
    let mut blocks: BTreeMap<K, Vec<Group>> = BTreeMap::new();
    (0..count).for_each(|i| blocks.entry(block(i)).or_default().push(vec![i]));
    blocks.into_values().collect()
}

/// Days with as many runs; days with one label each, all of them.
fn of_days(labels: &[&str], day: impl Fn(usize) -> Option<i64>) -> Pools {
    let mut days: BTreeMap<Option<i64>, Group> = BTreeMap::new();
    (0..labels.len()).for_each(|i| days.entry(day(i)).or_default().push(i));
    let most = if days.values().all(|runs| pattern(runs, labels).len() == 1) { 1 } else { usize::MAX };
    let mut alike: BTreeMap<usize, Vec<Group>> = BTreeMap::new();
    days.into_values().for_each(|runs| alike.entry(runs.len().min(most)).or_default().push(runs));
    alike.into_values().collect()
}

/// How many orders of the labels there are, at most a million.
fn orders(way: &Pools, labels: &[&str]) -> f64 {
    let factorial = |count: usize| (1..=count).map(|i| (i as f64).ln()).sum::<f64>();
    let of_pool = |pool: &Vec<Group>| {
        let mut counts: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
        pool.iter().for_each(|group| *counts.entry(pattern(group, labels)).or_default() += 1);
        factorial(pool.len()) - counts.into_values().map(factorial).sum::<f64>()
    };
    way.iter().map(of_pool).sum::<f64>().exp().min(1e6)
}
