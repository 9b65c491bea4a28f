//! Which labels may be exchanged, so that what runs share for other reasons stays where it is.
//!
//! What the runs of a day share, weather and load, is no matter of who drove them, nor of the unit; and the gradients of a line are described as well as they
//! are, so that a direction has its own error. Labels of units and drivers are exchanged between the runs of a day and direction; where that leaves too few
//! orders of the labels, whole days exchange theirs, those of days with runs in the same directions.

use super::{Labelled, Level};
use crate::chance::probability;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rundown::model::direction::Direction;
use std::collections::BTreeMap;

/// Pools of groups of runs; the groups of a pool exchange their labels as a whole.
pub(super) struct Exchange(Vec<Vec<Group>>);

/// Indices of runs that keep together, in the order of their directions.
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
        let is_up = |i: usize| all[i].run.direction == Direction::Up;
        let day = |i: usize| all[i].run.day.map(|day| day.floor() as i64);
        let days_are_known = (0..all.len()).all(|i| day(i).is_some());
        let crossed = Self::of_runs(all.len(), |i| (is_up(i), day(i).filter(|_| level != Level::Day)));
        let ways = if level != Level::Day && days_are_known {
            let whole = Self::of_days(&labels, is_up, day);
            // Where each day has one label, nothing is exchanged within it.
            vec![crossed, whole]
        } else {
            vec![Self::of_runs(all.len(), is_up)]
        };
        let enough = |way: &Self| probability(0, way.orders(&labels) as usize) <= least;
        ways.into_iter().find(enough).ok_or_else(|| {
            let of = level.name();
            let mut directions: BTreeMap<&str, [bool; 2]> = BTreeMap::new();
            labels.iter().enumerate().for_each(|(i, label)| {
                directions.entry(label).or_default()[usize::from(is_up(i))] = true;
            });
            if directions.values().all(|both| *both != [true, true]) {
                format!("each {of} went in one direction only, so a {of} that differs is not distinguished from a direction that does")
            } else {
                format!("too few runs of different {of}s share a day and a direction, or go on days with runs in the same directions")
            }
        })
    }

    /// Runs of a block, each for itself.
    fn of_runs<K: Ord>(count: usize, block: impl Fn(usize) -> K) -> Self {
        let mut blocks: BTreeMap<K, Vec<Group>> = BTreeMap::new();
        (0..count).for_each(|i| blocks.entry(block(i)).or_default().push(vec![i]));
        Self(blocks.into_values().collect())
    }

    /// Days with the same number of runs in each direction; of days with one label each, those with runs in the same directions.
    fn of_days(labels: &[&str], is_up: impl Fn(usize) -> bool, day: impl Fn(usize) -> Option<i64>) -> Self {
        let mut days: BTreeMap<Option<i64>, Group> = BTreeMap::new();
        (0..labels.len()).for_each(|i| days.entry(day(i)).or_default().push(i));
        let most = if days.values().all(|runs| pattern(runs, labels).len() == 1) { 1 } else { usize::MAX };
        let mut alike: BTreeMap<[usize; 2], Vec<Group>> = BTreeMap::new();
        for mut runs in days.into_values() {
            runs.sort_by_key(|i| is_up(*i));
            let up = runs.iter().filter(|i| is_up(**i)).count();
            alike.entry([up.min(most), (runs.len() - up).min(most)]).or_default().push(runs);
        }
        Self(alike.into_values().collect())
    }

    /// How many orders of the labels there are, at most a million.
    fn orders(&self, labels: &[&str]) -> f64 {
        let factorial = |count: usize| (1..=count).map(|i| (i as f64).ln()).sum::<f64>();
        let of_pool = |pool: &Vec<Group>| {
            let mut counts: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
            pool.iter().for_each(|group| *counts.entry(pattern(group, labels)).or_default() += 1);
            factorial(pool.len()) - counts.into_values().map(factorial).sum::<f64>()
        };
        self.0.iter().map(of_pool).sum::<f64>().exp().min(1e6)
    }

    /// The labels in another order.
    pub(super) fn draw<'a>(&self, labels: &[&'a str], rng: &mut ChaCha8Rng) -> Vec<&'a str> {
        let mut drawn = labels.to_vec();
        for pool in &self.0 {
            let mut patterns: Vec<Vec<&str>> = pool.iter().map(|group| pattern(group, labels)).collect();
            patterns.shuffle(rng);
            for (group, pattern) in pool.iter().zip(&patterns) {
                group.iter().zip(pattern.iter().cycle()).for_each(|(i, label)| drawn[*i] = label);
            }
        }
        drawn
    }
}
