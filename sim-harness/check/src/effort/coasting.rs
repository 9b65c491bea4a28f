//! What an effort column has for trains that coast.
//!
//! In: rows of all runs of a unit, put right, and what is described of train and line. Out: the small effort that
//! recurs while trains move, and whether it can be none that acts.
//!
//! Trains that stand show the zero of a column only where nothing but friction holds them; many hold the brake. But a
//! train that coasts has the same effort at any speed, on any slope, in each run, and none that powers, brakes or holds
//! its speed has: means over 20 s of an effort crowd at that value. Noise makes the crowd wider, so it is sought in
//! intervals of growing width. Efforts that hold a speed lie densely as well, but mostly no denser than around them.
//!
//! A notch, a regulator on a level line and a drag of the motors recur as well, and act. What the motion needs,
//! acceleration and gradient and described resistance, is then that effort, and nothing where the zero is off. Of an
//! effort that is small beside the resistance nobody can tell: a description is off by as much.

use crate::Known;
use crate::effort::stretches;
use crate::figure::Figure;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::{mean_of, spread};
use std::collections::BTreeMap;
use std::ops::Range;

/// Means over so long, s.
const STRETCH_S: f64 = 20.0;
/// A slower train may be about to stand, m/s.
const SLOWEST_MPS: f64 = 1.0;
/// Half the width of the interval, N/kg: an effort without noise, up to a noise by which nothing would be learned.
pub(crate) const HALF_WIDTHS_N_PER_KG: [f64; 5] = [2e-4, 4e-4, 8e-4, 1.6e-3, 3.2e-3];
/// A larger effort is none of a coast, N/kg.
const MOST_N_PER_KG: f64 = 0.02;
/// So many stretches, this share of all of moving trains, in so many runs.
const LEAST: usize = 20;
const LEAST_SHARE: f64 = 0.04;
const LEAST_RUNS: usize = 3;
/// Intervals beside it, in half-widths on either side, in which all together this many times fewer stretches are: a
/// density of 12 times as much. In the densest intervals of simulated trains that hold their speed, whose zero is
/// right, it is 1 to 5 times as much.
const BESIDE: f64 = 5.0;
const DENSER: usize = 3;
/// A described resistance is off by less than this share of itself, mostly; a larger effort is known to act or not.
pub(crate) const DOUBTED_SHARE: f64 = 0.4;
/// Where nothing is described, trains that coast lose at least so much of their speed, m/s².
const SLOWS_MPS2: f64 = 0.003;
/// An effort of 0 is that of some coasts, where so many times fewer are there.
const ZEROS: usize = 10;

/// An effort that recurs while trains move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoastingEffort {
    pub(crate) effort: Figure,
    /// Stretches of 20 s.
    pub(crate) count: usize,
    /// That it does not act does not rest on the described resistance.
    pub(crate) is_sure: bool,
    /// What rounding may hide of it, N/kg.
    pub(crate) rounded_n_per_kg: f64,
}

/// A stretch of a moving train.
#[derive(Clone, Copy)]
pub(crate) struct MovingStretch {
    pub(crate) effort_n_per_kg: f64,
    pub(crate) mps2: f64,
    /// What gradient and described resistance take, N/kg.
    pub(crate) taken_n_per_kg: Option<[f64; 2]>,
    pub(crate) run: usize,
}

/// The effort of trains that coast; nothing where none recurs, or what recurs acts. `step`: of the efforts, N/kg.
pub(crate) fn effort_of_coasts(mut all: Vec<MovingStretch>, step: Option<f64>) -> Option<CoastingEffort> {
    sort(&mut all);
    HALF_WIDTHS_N_PER_KG.into_iter().find_map(|half_width| recurring(&all, half_width, step.unwrap_or_default()))?
}

/// The stretches of moving trains, run by run.
pub(crate) fn moving_stretches<'a>(
    recordings: impl Iterator<Item = &'a Recording>,
    known: &Known,
) -> Vec<MovingStretch> {
    let mut all: Vec<MovingStretch> = Vec::new();
    for (run, recording) in recordings.enumerate() {
        let line = known.line(recording.direction);
        let moves = |rows: &&[Sample]| rows.iter().all(|row| row.speed_mps > Some(SLOWEST_MPS));
        let stretch = |rows: &[Sample]| {
            let [first, last] = [rows.first()?, rows.last()?];
            let taken = || {
                let line = line.as_ref()?;
                let taken = rows.iter().map(|row| {
                    let climb = line.gradient_n_per_kg(row.location_m?);
                    Some([climb, line.train.davis().resistance_n_per_kg(row.speed_mps?)])
                });
                let taken: Vec<[f64; 2]> = taken.collect::<Option<_>>()?;
                Some([0, 1].map(|i| mean_of(taken.iter().map(|both| both[i]))))
            };
            Some(MovingStretch {
                effort_n_per_kg: mean_of(rows.iter().filter_map(|row| row.effort_n_per_kg)),
                mps2: (last.speed_mps? - first.speed_mps?) / (last.time_s - first.time_s),
                taken_n_per_kg: taken(),
                run,
            })
        };
        all.extend(stretches(&recording.rows, STRETCH_S).into_iter().filter(moves).filter_map(stretch));
    }
    all
}

/// By their efforts.
pub(crate) fn sort(stretches: &mut [MovingStretch]) {
    stretches.sort_by(|a, b| a.effort_n_per_kg.total_cmp(&b.effort_n_per_kg));
}

/// Of sorted stretches those with an effort between these, N/kg.
pub(crate) fn within(sorted: &[MovingStretch], low: f64, high: f64) -> Range<usize> {
    let begin = sorted.partition_point(|one| one.effort_n_per_kg < low);
    begin..sorted.partition_point(|one| one.effort_n_per_kg <= high)
}

/// The densest of the intervals of small efforts among sorted stretches.
pub(crate) fn densest(sorted: &[MovingStretch], half_width: f64) -> Option<Range<usize>> {
    let from = sorted.iter().map(|one| one.effort_n_per_kg).filter(|effort| effort.abs() < MOST_N_PER_KG);
    from.map(|low| within(sorted, low, low + 2.0 * half_width)).max_by_key(ExactSizeIterator::len)
}

/// The densest of the intervals of small efforts, where it is far denser than what is beside it, unless it acts. `all`:
/// sorted by their efforts.
fn recurring(all: &[MovingStretch], half_width: f64, step: f64) -> Option<Option<CoastingEffort>> {
    let inside = &all[densest(all, half_width)?];
    let count = inside.len();
    // Of rounded efforts the median would be one of few values.
    let value = mean_of(inside.iter().map(|one| one.effort_n_per_kg));
    let mut of_runs: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    inside.iter().for_each(|one| of_runs.entry(one.run).or_default().push(one.effort_n_per_kg));
    let is_enough = count >= LEAST && count as f64 >= LEAST_SHARE * all.len() as f64 && of_runs.len() >= LEAST_RUNS;
    let centre = 0.5 * (inside[0].effort_n_per_kg + inside[count - 1].effort_n_per_kg);
    let beside = within(all, centre - BESIDE * half_width, centre + BESIDE * half_width).len() - count;
    let zeros = within(all, -half_width, half_width).len();
    let has_zeros = centre.abs() > 2.0 * half_width && ZEROS * zeros > count;
    if !is_enough || count < DENSER * beside || has_zeros || value.abs() >= MOST_N_PER_KG {
        return None;
    }
    let scatter = spread(inside.iter().map(|one| one.effort_n_per_kg - value)) / (count as f64).sqrt();
    let run_means = of_runs.values().map(|efforts| mean_of(efforts) - value);
    let between = spread(run_means) / (of_runs.len() as f64).sqrt();
    let effort = Figure { value, sd: scatter.max(between) };
    // A constant is off by up to half of a step in all rows.
    let rounded_n_per_kg = 0.5 * step;
    let taken: Option<Vec<[f64; 2]>> = inside.iter().map(|one| one.taken_n_per_kg).collect();
    let slows = mean_of(inside.iter().map(|one| one.mps2));
    let Some(taken) = taken else {
        return Some((slows < -SLOWS_MPS2).then_some(CoastingEffort {
            effort,
            count,
            is_sure: false,
            rounded_n_per_kg,
        }));
    };
    let [climb, resistance] = [0, 1].map(|i| mean_of(taken.iter().map(|both| both[i])));
    let needed = slows + climb + resistance;
    let acts = (needed - value).abs() < needed.abs();
    let is_sure = value.abs() >= DOUBTED_SHARE * resistance;
    Some((!(is_sure && acts)).then_some(CoastingEffort { effort, count, is_sure, rounded_n_per_kg }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stretches with this effort and acceleration beside a described resistance of 0.02 N/kg, among some that power.
    fn found(effort_n_per_kg: f64, mps2: f64) -> Option<CoastingEffort> {
        let one = |i: usize| {
            let powers = if i.is_multiple_of(2) { Some(0.05 + 0.001 * i as f64) } else { None };
            MovingStretch {
                effort_n_per_kg: powers.unwrap_or(effort_n_per_kg),
                mps2: powers.map_or(mps2, |effort| effort - 0.02),
                taken_n_per_kg: Some([0.0, 0.02]),
                run: i % 5,
            }
        };
        let mut all: Vec<MovingStretch> = (0..200).map(one).collect();
        sort(&mut all);
        recurring(&all, HALF_WIDTHS_N_PER_KG[0], 0.0).flatten()
    }

    #[test]
    fn an_effort_that_the_motion_needs_is_no_zero() {
        // A notch that holds the speed, or nearly; and a coast of a column whose zero is off.
        assert!(found(0.015, 0.0).is_none() && found(0.015, -0.005).is_none());
        let coasts = found(0.015, -0.02).unwrap();
        assert!(coasts.is_sure && (coasts.effort.value - 0.015).abs() < 1e-12, "{coasts:?}");
    }

    #[test]
    fn a_small_effort_may_be_either() {
        for mps2 in [-0.016, -0.02] {
            assert!(!found(0.004, mps2).unwrap().is_sure);
        }
    }
}
