//! A wheel that changes: within a run, or from one run of a recorder on. Turning takes 1 % off its diameter; a new one,
//! or another diameter that is entered, more.
//!
//! ```text
//! Δx - ∫ v_r dt = (1/s - 1) ∫ v_r dt + d ∫ v_r dt after the change + (o/s) Δt + τ Δv_r + noise
//! ```
//!
//! Within a run the place is the one that explains most, with scale, offset and skew beside it. Between runs it is
//! where the scales before and after are the furthest apart for how surely they are known. Both are said; what comes
//! after is brought to the scale from before, and then the runs are judged as those of one wheel.

use crate::agreement::compared::Compared;
use crate::agreement::rounding;
use crate::agreement::{ALONE, Agreement, BENDS_SD, Pooled, pooled};
use crate::figure::Figure;
use crate::{LEAST_SCALE, SURE};
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, spread};
use std::collections::BTreeMap;

/// Places that are tried in a run.
const PLACES: f64 = 48.0;
/// On either side of a change lies so much of the way ...
const LEAST_SHARE: f64 = 0.1;
/// ... and so much, m.
const LEAST_WAY_M: f64 = 3000.0;
/// A smaller one is not looked at more closely, standard deviations.
const SUSPECT: f64 = 2.5;
/// Beyond doubt within a run: of many places the best one is taken.
const WITHIN_SURE: f64 = 6.0;
/// Runs on either side of a change; one that differs from all others is its own matter.
const LEAST_RUNS: usize = 2;
/// So few of the runs may be nearer to the scale of the other side.
const MOST_ASTRAY: f64 = 0.1;

/// By so much, in squares of standard deviations, a change of the scale must fit better than one of the offset.
const OUTWEIGHS: f64 = 4.0;

/// Where the scale of a run changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    /// Readings after this time are by the new scale, s.
    pub(crate) time_s: f64,
    /// Scale after over scale before.
    pub(crate) ratio: Figure,
    /// What errors of 1 m/s in its held speeds do to that.
    held: f64,
}

/// The change that this run shows; the rounding of its speeds is not in its doubt yet.
pub(crate) fn within(compared: &Compared) -> Option<Change> {
    // A change that is not known of looks like noise that adds up: it is looked for again in the noise that is left
    // without it.
    let (rough, grows) = place(compared).filter(|(_, grows)| grows.away_from(0.0) > SUSPECT)?;
    let calm = compared.without(&scaled(&compared.way_after(rough), grows.value))?;
    let (at, grows) = place(&compared.in_noise_of(&calm)?)?;
    let after = compared.way_after(at);
    let calm = compared.without(&scaled(&after, grows.value))?;
    let (left, _) = calm.beside(&after)?;
    let sd = (left.sd / calm.independent().sqrt()).hypot(by_bends(&calm, &after, left.value));
    let grows = Figure { value: grows.value + left.value, sd };
    // With the change taken off, 1/s is that from before.
    let before = 1.0 + calm.fit.beta[0];
    let ratio = Figure { value: before / (before + grows.value), sd: grows.sd };
    let held = rounding::beside(&calm, &after, at);
    Some(Change { time_s: compared.differences.end_s[at], ratio, held })
}

/// What other bends between rows far apart change it by.
fn by_bends(compared: &Compared, after: &[f64], left: f64) -> f64 {
    let others = compared.with_other_bends().into_iter().flatten().zip(BENDS_SD);
    let changes = others.filter_map(|(other, sd)| Some(ALONE * sd * (other.beside(after)?.0.value - left)));
    changes.fold(0.0, f64::hypot)
}

fn scaled(values: &[f64], by: f64) -> Vec<f64> {
    values.iter().map(|value| by * value).collect()
}

/// Behind which difference a change explains most, and by how much 1/s grows there.
fn place(compared: &Compared) -> Option<(usize, Figure)> {
    let by_speed = &compared.differences.by_speed;
    let way_m: f64 = by_speed.iter().sum();
    let least_m = LEAST_WAY_M.max(LEAST_SHARE * way_m);
    let (mut passed_m, mut next_m) = (0.0, least_m);
    let mut best: Option<(usize, Figure)> = None;
    for (i, metres) in by_speed.iter().enumerate() {
        passed_m += metres;
        if passed_m > way_m - least_m {
            break;
        }
        if passed_m < next_m {
            continue;
        }
        next_m = passed_m + (way_m - 2.0 * least_m) / PLACES;
        let Some((grows, _)) = compared.beside(&compared.way_after(i)) else { continue };
        if best.is_none_or(|(_, most)| grows.away_from(0.0) > most.away_from(0.0)) {
            best = Some((i, grows));
        }
    }
    best
}

impl Compared {
    /// Distance by speed behind a difference, m; before it none.
    fn way_after(&self, at: usize) -> Vec<f64> {
        let by_speed = self.differences.by_speed.iter().enumerate();
        by_speed.map(|(i, metres)| if i > at { *metres } else { 0.0 }).collect()
    }
}

impl Change {
    /// Where it is beyond doubt, with what the rounding of held speeds does on either side of it. `rounding_mps`: of a
    /// reading, standard deviation.
    pub(crate) fn sure(mut self, rounding_mps: f64) -> Option<Self> {
        self.ratio.sd = self.ratio.sd.hypot(self.held * rounding_mps);
        let is_sure = (self.ratio.value - 1.0).abs() > LEAST_SCALE && self.ratio.away_from(1.0) > WITHIN_SURE;
        is_sure.then_some(self)
    }

    /// Location where it lies, m, and line.
    pub(crate) fn place(&self, rows: &[Sample]) -> (Option<f64>, u64) {
        let at = rows.partition_point(|row| row.time_s <= self.time_s);
        (rows[..at].iter().rev().find_map(|row| row.location_m), rows.get(at).map_or(0, |row| row.line))
    }
}

/// Where the scale changes from run to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Between {
    /// The first run after it.
    pub(crate) from: usize,
    /// Scale of the runs before and after.
    pub(crate) sides: [Figure; 2],
}

impl Between {
    /// Scale after over scale before.
    pub(crate) fn ratio(&self) -> Figure {
        let [before, after] = self.sides;
        Figure { value: after.value / before.value, sd: before.sd.hypot(after.sd) }
    }
}

/// The scale of a run, and by how much the rounding of each held speed makes it differ, by the reading.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OfRun {
    pub(crate) scale: Figure,
    pub(crate) held: Vec<(u64, f64)>,
}

impl OfRun {
    /// With the offset of the recorder, m/s. None: the run does not say.
    pub(crate) fn at(agreement: &Agreement, offset_mps: f64) -> Option<Self> {
        let one = pooled(std::slice::from_ref(agreement))?.beside_others();
        let beside = one.covariance[(0, 1)] / one.covariance[(1, 1)];
        let held = agreement.held.iter().map(|(speed, effect)| (*speed, effect[0] - beside * effect[1])).collect();
        Some(Self { scale: one.scale_at(offset_mps), held })
    }
}

/// Scales of runs in the order in which they were made: from which on they are others; none where they scatter around
/// one. `may_change`: before which run.
pub(crate) fn between(runs: &[OfRun], may_change: impl Fn(usize) -> bool) -> Option<Between> {
    let places = (LEAST_RUNS..(runs.len() + 1).saturating_sub(LEAST_RUNS)).filter(|from| may_change(*from));
    let apart = |found: &Between| found.ratio().away_from(1.0);
    let split = |from: usize| Between { from, sides: sides(runs, from) };
    let best = places.map(split).max_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    let [before, after] = best.sides.map(|side| side.value);
    let is_astray = |(i, OfRun { scale, .. }): (usize, &OfRun)| {
        let (own, other) = if i < best.from { (before, after) } else { (after, before) };
        scale.sd < 0.25 * (after - before).abs() && (scale.value - own).abs() > (scale.value - other).abs()
    };
    let astray = runs.iter().enumerate().filter(|one| is_astray(*one)).count();
    let fewer = best.from.min(runs.len() - best.from) as f64;
    let is_sure = (best.ratio().value - 1.0).abs() > LEAST_SCALE && apart(&best) > SURE;
    (is_sure && astray as f64 <= MOST_ASTRAY * fewer).then_some(best)
}

/// What changed is the scale, not the offset: each alone leaves what the other one had to explain. On phones the offset
/// changes with how the speed is smoothed.
pub(crate) fn is_wheel(before: &Pooled, after: &Pooled) -> bool {
    let [by_scale, by_offset] = [0, 1].map(|which| grown(before, after, which)).map(|grown| grown.away_from(0.0));
    by_scale * by_scale - by_offset * by_offset > OUTWEIGHS
}

/// The offset after, km/h, where it is another one beyond doubt.
pub(crate) fn other_offset_kmh(before: &Pooled, after: &Pooled) -> Option<Figure> {
    (grown(before, after, 1).away_from(0.0) > SURE).then(|| after.offset_kmh())
}

/// By how much one of 1/s - 1 and o/s grows, whatever the other one does.
fn grown(before: &Pooled, after: &Pooled, which: usize) -> Figure {
    let variance = before.covariance[(which, which)] + after.covariance[(which, which)];
    Figure { value: after.values[which] - before.values[which], sd: variance.sqrt() }
}

/// Mean scales of both sides, each run weighed by its doubt and by how much runs of one side differ.
fn sides(runs: &[OfRun], from: usize) -> [Figure; 2] {
    let parts = [&runs[..from], &runs[from..]];
    let off = parts.iter().flat_map(|part| {
        let middle = mean(part, 0.0).value;
        part.iter().map(move |run| run.scale.value - middle)
    });
    let known = median(runs.iter().map(|run| run.scale.sd.powi(2))).unwrap_or(0.0);
    let own = (spread(off).powi(2) - known).max(0.0);
    parts.map(|part| mean(part, own))
}

/// Mean scale of runs that differ by `own`, a variance. A speed that is held in all of them has the same rounding in
/// all of them.
fn mean(part: &[OfRun], own: f64) -> Figure {
    let weight = |run: &OfRun| (run.scale.sd.powi(2) + own).recip();
    let all: f64 = part.iter().map(weight).sum();
    let value = part.iter().map(|run| weight(run) * run.scale.value).sum::<f64>() / all;
    let mut levels: BTreeMap<u64, f64> = BTreeMap::new();
    let mut alone = 0.0;
    for run in part {
        for (level, effect) in &run.held {
            let effect = weight(run) / all * effect;
            *levels.entry(*level).or_default() += effect;
            alone += effect * effect;
        }
    }
    let shared = levels.values().map(|effect| effect * effect).sum::<f64>() - alone;
    Figure { value, sd: (all.recip() + shared.max(0.0)).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(values: &[f64]) -> Vec<OfRun> {
        let noise = [0.2, -0.4, 0.1, 0.5, -0.3, -0.1];
        let figure = |(i, value): (usize, &f64)| Figure { value: value + 1e-3 * noise[i % 6], sd: 5e-4 };
        values.iter().enumerate().map(figure).map(|scale| OfRun { scale, held: Vec::new() }).collect()
    }

    #[test]
    fn a_change_from_one_run_on_is_found_and_a_single_other_run_is_none() {
        let turned = runs(&[vec![1.0; 7], vec![0.99; 5]].concat());
        let found = between(&turned, |_| true).unwrap();
        assert!(found.from == 7 && (found.ratio().value - 0.99).abs() < 1e-3, "{found:?}");
        assert_eq!(between(&turned, |_| false), None);
        let mut one = runs(&[1.0; 12]);
        one[10].scale.value = 1.02;
        assert_eq!((between(&runs(&[1.0; 12]), |_| true), between(&one, |_| true)), (None, None));
    }

    /// A phone that smooths otherwise since: 1.8 km/h less at any speed, and at the usual offset a scale of 0.975.
    #[test]
    fn an_offset_that_changes_is_no_wheel() {
        let side = |scale: f64, offset_mps: f64| Pooled {
            values: nalgebra::Vector2::new(scale.recip() - 1.0, offset_mps),
            covariance: nalgebra::Matrix2::new(9e-6, 2.2e-4, 2.2e-4, 6e-3),
            by_bends: nalgebra::Matrix2::zeros(),
            runs: 8,
        };
        let usual = side(1.0, 0.05);
        let changed = side(1.005, 0.5);
        assert!(!is_wheel(&usual, &changed) && !is_wheel(&usual, &side(0.99, 0.5)));
        assert!((other_offset_kmh(&usual, &changed).unwrap().value - 1.8).abs() < 0.02);
        assert!(is_wheel(&usual, &side(0.98, 0.1)) && other_offset_kmh(&usual, &side(0.98, 0.1)).is_none());
    }

    /// 80.4 km/h read 80 in the runs before, and 79.6 after.
    #[test]
    fn what_the_rounding_of_one_held_speed_makes_of_all_runs_is_no_change() {
        let mut held = runs(&[vec![0.996; 12], vec![1.004; 12]].concat());
        assert!(between(&held, |_| true).is_some());
        for run in &mut held {
            (run.scale.sd, run.held) = (3.6e-3, vec![(80, 3.6e-3)]);
        }
        assert_eq!(between(&held, |_| true), None);
    }
}
