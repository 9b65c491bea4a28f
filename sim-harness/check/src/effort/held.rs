//! Efforts that stand still for a while, as the last one that arrived, beside a train that answers to others.
//!
//! In: rows of all runs of a unit, put right. Out: the rows whose effort is an old one.
//!
//! ```text
//! e    .1  .2  .4  .4  .4  .4  .4  .4  .1  .0        repeats; a - e is the same before and after, and another at its end,
//! a    .1  .2  .4  .3  .2  .1  .0  .0  .1  .0        by as much as the effort jumps then
//! ```
//!
//! A lever that stays where it is repeats efforts as well, but the train goes with them. A gradient changes a - e, but
//! the effort does not jump by as much where it ends. Zeros are none of these: every coast repeats them. Where a column
//! hardly ever repeats an effort, because it has noise and digits, those that do for so long in a few runs are old
//! ones, too, unless the train is seen to go with them.

use crate::effort::window;
use rundown_files::sample::Sample;
use rundown_files::statistics::span;
use std::collections::BTreeMap;
use std::ops::Range;

/// Fewer rows, or less time, s, repeat by chance, and cost little.
const LEAST_ROWS: usize = 3;
const LEAST_S: f64 = 8.0;
/// Accelerations before, at the end and after are taken over so long, s, at speeds above this, m/s.
const WINDOW_S: f64 = 10.0;
const LEAST_MPS: f64 = 1.0;
/// A smaller jump may be a gradient's, N/kg.
const LEAST_JUMP_N_PER_KG: f64 = 0.1;
/// What a - e differs by before and after, as a share of the jump, and at the end of the stretch.
const ALIKE: f64 = 0.3;
const AS_MUCH: Range<f64> = 0.6..1.6;
/// A train that starts with all it has repeats the largest effort of its run, one that brakes so the least: within this
/// share.
const AT_LIMIT: f64 = 0.01;
/// A train that holds its speed on an even slope repeats an effort: within this, m/s.
const HELD_MPS: f64 = 0.3;
/// One such stretch may be a gradient.
const LEAST_STRETCHES: usize = 2;
/// A column of this many neighbours that repeats no larger share of them outside of such stretches ...
const LEAST_NEIGHBOURS: f64 = 1000.0;
const MOST_REPEATED: f64 = 0.05;
/// ... has so many, one in so many of the runs, for a reason, where fewer than this are expected by chance.
const STRANGE_STRETCHES: usize = 3;
const FEW_RUNS: usize = 5;
const CHANCE: f64 = 0.01;

/// Efforts that are old ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct HeldEfforts {
    /// By run: rows that repeat an effort.
    pub rows: Vec<Vec<Range<usize>>>,
    /// Stretches in which the train answered to another effort.
    pub shown: usize,
    /// All stretches.
    pub stretches: usize,
    /// Their mean, s.
    pub mean_s: f64,
}

/// What the train says of efforts that repeat: it went with them, it answered to others, or nothing is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Says {
    Same,
    Other,
    Nothing,
}

/// Rows that repeat an effort.
type Repeat = (Says, Range<usize>);

/// Of the runs of a unit. Where some stretches are shown to be old, all are taken to be whose effort is that of no
/// other stretch: the train may have answered to others in them by less than can be seen.
pub(crate) fn of(runs: &[&[Sample]]) -> Option<HeldEfforts> {
    let asked = |rows: &[Sample]| -> Vec<Repeat> {
        repeats(rows).into_iter().map(|rows_of| (says(rows, &rows_of), rows_of)).collect()
    };
    let repeats: Vec<Vec<Repeat>> = runs.iter().map(|rows| asked(rows)).collect();
    let shown = count(&repeats, Says::Other);
    let value = |rows: &[Sample], range: &Range<usize>| rows[range.start].effort_n_per_kg.map_or(0, f64::to_bits);
    let mut times: BTreeMap<u64, usize> = BTreeMap::new();
    for (rows, of_run) in runs.iter().zip(&repeats) {
        of_run.iter().for_each(|(_, range)| *times.entry(value(rows, range)).or_default() += 1);
    }
    let once = |rows: &[Sample], range: &Range<usize>| times[&value(rows, range)] == 1;
    if shown < LEAST_STRETCHES && !are_strange(runs, &repeats, once) {
        return None;
    }
    let mut held = HeldEfforts { shown, ..HeldEfforts::default() };
    for (rows, of_run) in runs.iter().zip(repeats) {
        let old = of_run.into_iter().filter(|(says, range)| *says == Says::Other || once(rows, range));
        let old: Vec<Range<usize>> = old.map(|(_, range)| range).collect();
        held.stretches += old.len();
        held.mean_s += old.iter().map(|range| rows[range.end - 1].time_s - rows[range.start].time_s).sum::<f64>();
        held.rows.push(old);
    }
    held.mean_s /= held.stretches as f64;
    Some(held)
}

/// Few runs repeat efforts for longer than chance would, as rarely as the column repeats one elsewhere.
fn are_strange(runs: &[&[Sample]], repeats: &[Vec<Repeat>], once: impl Fn(&[Sample], &Range<usize>) -> bool) -> bool {
    let [mut neighbours, mut repeated] = [0.0, 0.0];
    for (rows, of_run) in runs.iter().zip(repeats) {
        let is_asked = |i: &usize| !of_run.iter().any(|(_, range)| range.contains(i) && range.contains(&(i + 1)));
        for i in (0..rows.len().saturating_sub(1)).filter(is_asked) {
            if let (Some(a), Some(b)) = (rows[i].effort_n_per_kg, rows[i + 1].effort_n_per_kg)
                && a != 0.0
            {
                neighbours += 1.0;
                repeated += f64::from(a == b);
            }
        }
    }
    let share = repeated.max(1.0) / neighbours;
    let by_chance = |range: &Range<usize>| neighbours * share.powi(range.len() as i32 - 1);
    let strange = |(rows, of_run): (&&[Sample], &Vec<Repeat>)| {
        let is_strange = |range| by_chance(range) < CHANCE && once(rows, range) && !has_reason(rows, range);
        of_run.iter().filter(|(_, range)| is_strange(range)).count()
    };
    let of_runs: Vec<usize> = runs.iter().zip(repeats).map(strange).collect();
    let concerned = of_runs.iter().filter(|count| **count > 0).count();
    neighbours >= LEAST_NEIGHBOURS
        && share <= MOST_REPEATED
        && of_runs.iter().sum::<usize>() >= STRANGE_STRETCHES
        && concerned * FEW_RUNS <= runs.len()
        && count(repeats, Says::Other) > 0
        && count(repeats, Says::Same) <= count(repeats, Says::Other)
}

/// A column without noise repeats such an effort, too: it is at a limit, or holds the speed.
fn has_reason(rows: &[Sample], range: &Range<usize>) -> bool {
    let [mut least, mut most] = [0.0_f64; 2];
    for effort in rows.iter().filter_map(|row| row.effort_n_per_kg) {
        (least, most) = (least.min(effort), most.max(effort));
    }
    let effort = rows[range.start].effort_n_per_kg.unwrap_or_default();
    let near = |limit: f64| (effort - limit).abs() <= AT_LIMIT * limit.abs();
    let held_mps = span(rows[range.clone()].iter().filter_map(|row| row.speed_mps));
    near(most) || near(least) || held_mps < HELD_MPS
}

fn count(repeats: &[Vec<Repeat>], wanted: Says) -> usize {
    repeats.iter().flatten().filter(|(says, _)| *says == wanted).count()
}

/// Rows that have one effort, other than 0, for long.
fn repeats(rows: &[Sample]) -> Vec<Range<usize>> {
    let (mut found, mut begin) = (Vec::new(), 0);
    for stretch in rows.chunk_by(|a, b| a.effort_n_per_kg == b.effort_n_per_kg) {
        let end = begin + stretch.len();
        let is_effort = stretch[0].effort_n_per_kg.is_some_and(|effort| effort != 0.0);
        let long_s = rows[end - 1].time_s - rows[begin].time_s;
        if is_effort && stretch.len() >= LEAST_ROWS && long_s >= LEAST_S {
            found.push(begin..end);
        }
        begin = end;
    }
    found
}

/// What the train answers to at its end.
fn says(rows: &[Sample], range: &Range<usize>) -> Says {
    let apart = || {
        let (first, last) = (range.start, range.end - 1);
        let effort = rows[first].effort_n_per_kg?;
        let before = answered(&rows[..=first], rows[first].time_s - WINDOW_S)?;
        let at_end = answered(&rows[first..=last], rows[last].time_s - WINDOW_S)?;
        let until_s = rows[last].time_s + WINDOW_S;
        let ends = last + rows[last..].iter().take_while(|row| row.time_s <= until_s).count();
        let after = answered(&rows[last..ends], rows[last].time_s)?;
        let jump = after.1 - effort;
        let is_alike = (before.0 - after.0).abs() < ALIKE * jump.abs();
        let apart = (at_end.0 - 0.5 * (before.0 + after.0)) / jump;
        (jump.abs() > LEAST_JUMP_N_PER_KG && is_alike).then_some(apart)
    };
    match apart() {
        Some(apart) if AS_MUCH.contains(&apart) => Says::Other,
        Some(apart) if apart.abs() < ALIKE => Says::Same,
        _ => Says::Nothing,
    }
}

/// Acceleration less effort, and the effort, of the rows since then; none where these are too few, lack something, or
/// the train is slow.
fn answered(rows: &[Sample], since_s: f64) -> Option<(f64, f64)> {
    let begin = rows.iter().rposition(|row| row.time_s < since_s).map_or(0, |i| i + 1);
    let rows = rows.get(begin..).filter(|rows| rows.len() > 1)?;
    let complete = rows.iter().all(|row| row.effort_n_per_kg.is_some() && row.speed_mps.is_some_and(|v| v > LEAST_MPS));
    let is_long = rows[rows.len() - 1].time_s - rows[0].time_s >= 0.8 * WINDOW_S;
    let (acceleration, effort) = window(rows).filter(|_| complete && is_long)?;
    Some((acceleration - effort, effort))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// A train that powers, coasts and powers again on slopes. `reads` makes the column of the efforts, second by
    /// second.
    fn run(seed: u64, noise: f64, reads: impl Fn(&[f64]) -> Vec<f64>) -> Vec<Sample> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let lever = rng.random_range(0.25..0.45);
        let (mut mps, mut slope, mut speeds, mut efforts) = (25.0_f64, 0.0, Vec::new(), Vec::new());
        for second in 0..900 {
            if second % 50 == 0 {
                slope = rng.random_range(-0.05..0.05);
            }
            let effort = match second % 180 {
                0..40 => lever,
                40..110 => 0.0,
                110..150 => 0.8 * lever,
                _ => 0.1 - 2.4 * lever,
            };
            mps += effort - 0.02 - 0.003 * (mps - 25.0) - slope;
            speeds.push(mps + rng.random_range(-0.02..0.02));
            let read = effort + if noise > 0.0 { rng.random_range(-noise..noise) } else { 0.0 };
            efforts.push(if effort == 0.0 { 0.0 } else { read });
        }
        let column = reads(&efforts);
        let rows = speeds.iter().zip(column).enumerate().map(|(second, (mps, effort))| Sample {
            time_s: second as f64,
            speed_mps: Some(*mps),
            effort_n_per_kg: Some(effort),
            ..Sample::default()
        });
        rows.collect()
    }

    /// From each of these seconds on the effort stands still for 30 s.
    fn frozen(efforts: &[f64], at: &[usize]) -> Vec<f64> {
        let mut column = efforts.to_vec();
        at.iter().for_each(|at| column[*at..at + 30].fill(efforts[*at]));
        column
    }

    fn found(runs: &[Vec<Sample>]) -> Option<HeldEfforts> {
        of(&runs.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    #[test]
    fn efforts_that_stand_still_are_found_and_only_those() {
        for seed in 0..20 {
            let runs: Vec<Vec<Sample>> =
                (0..6)
                    .map(|i| {
                        run(10 * seed + i, 0.01, |efforts| {
                            if i == 2 { frozen(efforts, &[25, 200, 310]) } else { efforts.to_vec() }
                        })
                    })
                    .collect();
            let held = found(&runs).unwrap();
            assert!(held.shown >= 2 && held.stretches <= 3, "{held:?}");
            assert!(held.rows.iter().enumerate().all(|(run, rows)| rows.is_empty() || run == 2));
            assert!((25.0..31.0).contains(&held.mean_s), "{held:?}");
            let at: Vec<usize> = held.rows[2].iter().map(|range| range.start).collect();
            assert!(at.iter().all(|at| [25, 200, 310].contains(at)), "{at:?}");
        }
    }

    #[test]
    fn a_column_that_never_repeats_an_effort_stands_still_where_it_does_unless_the_train_goes_with_it() {
        let of_runs = |at: &[usize]| -> Vec<Vec<Sample>> {
            let reads = |i: u64, efforts: &[f64]| frozen(efforts, if i == 2 { at } else { &[] });
            (0..6).map(|i| run(i, 0.01, |efforts| reads(i, efforts))).collect()
        };
        // Of the first nothing is seen, in the second the train lets go, in the third it does what it did.
        let held = found(&of_runs(&[2, 205, 365])).unwrap();
        assert_eq!((held.shown, held.stretches), (1, 3), "{held:?}");
        assert_eq!(found(&of_runs(&[185, 365, 545])), None);
    }

    /// Rows 10 s apart without noise: a start at the largest effort, which the load gives each run its own, then held
    /// speeds, each on a slope of its own.
    #[test]
    fn starts_at_the_largest_effort_and_speeds_held_on_even_slopes_are_none() {
        let run = |i: u32| -> Vec<Sample> {
            let mut mps = 0.0;
            let row = |k: u32| {
                let (t, slope) = (10.0 * f64::from(k), 0.001 * f64::from((7 * i + k / 30) % 40) + 1e-4 * f64::from(i));
                // Few runs have a start or a slope that is long enough for four rows.
                let wanted = match k % 60 {
                    0..4 if i.is_multiple_of(7) && k < 60 => 0.47 + 0.001 * f64::from(i),
                    0..4 => 0.46 - 0.001 * f64::from(k % 60) - 1e-5 * f64::from(k),
                    30..34 if i == 1 && k < 60 => slope + 0.02,
                    _ => slope + 0.02 + 0.05 * (0.7 * f64::from(k) + f64::from(i)).sin(),
                };
                mps = f64::max(mps + 10.0 * (wanted - slope - 0.02), 0.0);
                Sample { time_s: t, speed_mps: Some(mps), effort_n_per_kg: Some(wanted), ..Sample::default() }
            };
            (0..240).map(row).collect()
        };
        assert_eq!(found(&(0..20).map(run).collect::<Vec<_>>()), None);
    }

    #[test]
    fn a_lever_that_stays_repeats_efforts_and_is_none() {
        for seed in 0..20 {
            let runs: Vec<Vec<Sample>> = (0..6).map(|i| run(10 * seed + i, 0.0, <[f64]>::to_vec)).collect();
            assert_eq!(found(&runs), None, "{seed}");
        }
    }
}
