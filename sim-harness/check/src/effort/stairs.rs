//! Efforts that are written again only once they have changed enough, as event recorders do, and stand still until
//! then.
//!
//! In: rows of a run. Out: the same with efforts that go from one change to the next.
//!
//! ```text
//! e   .40  .40  .40  .38  .38  .38  .36  .36  .36   0    written
//! e   .40  .393 .387 .38  .373 .367 .36  .36  .36   0    put right
//! ```
//!
//! While the train gains speed its effort falls, so what is written is too large by half of a change, in the mean: 0.01
//! N/kg of 0.02 are a third of the resistance, and the measured mode would learn them. Before a change of more than
//! [`MOST_CHANGES`] the driver did something, and until then the effort stood within a change of what is written.
//!
//! Rounded efforts change by one step, a lever by all sizes, and efforts that arrive every few rows stand still for as
//! long each time: of these nothing is put right.

use crate::finding::{Done, Finding, Kind};
use crate::rows::stairs::{Stairs, level};
use crate::rows::times::{next_row_s, usual_step_s};
use rundown_files::sample::Sample;
use std::ops::Range;

/// Of the changes between repeats such a share is near the usual one. Of efforts that are written once they have
/// changed enough 0.53 and more are.
const ALIKE: f64 = 0.45;
const NEAR: Range<f64> = 0.7..1.5;
/// Usual changes that are larger are a driver's, N/kg.
const MOST_N_PER_KG: f64 = 0.05;
/// Efforts with larger ones are left out, N/kg: put right, changes of 0.03 still made r(100 km/h) 5 to 9 % too large in
/// five of ten sets.
const COARSE_N_PER_KG: f64 = 0.025;
/// A change of more usual ones came at once.
const MOST_CHANGES: f64 = 2.0;
/// An effort that was constant and then begins to fall stood still for long before its first change, which took no
/// longer than the one beside it but for this factor.
const SLOWER: f64 = 1.5;

/// Puts efforts between two changes where they were.
pub(crate) fn put_right(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    // A driver's brake has steps as well, and a recorder's are in both.
    let effort = |row: &Sample| row.effort_n_per_kg.map(|effort| effort.max(0.0));
    let stairs = Stairs::of(rows, effort).without_beats();
    let is_band = |value: f64| value <= MOST_N_PER_KG && stairs.share_near(value, NEAR) >= ALIKE;
    let Some(figure) = stairs.usual(level(rows, effort)).filter(|usual| is_band(usual.value)) else { return };
    let (count, line) = (stairs.repeats.len(), rows[stairs.repeats[0]].line);
    let done = if figure.value > COARSE_N_PER_KG { Done::LeftOut } else { Done::PutRight };
    findings.push(Finding { kind: Kind::EffortStairs, figure, unit: "N/kg", count, line, done });
    if done == Done::LeftOut {
        rows.iter_mut().for_each(|row| row.effort_n_per_kg = None);
        return;
    }
    let stairs = stairs_of(rows);
    for (k, stair) in stairs.iter().enumerate() {
        let is_like = |other: &&Stair| other.by * stair.by > 0.0 && other.is_small(figure.value);
        let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|k| stairs.get(k));
        let beside_s = beside.filter(is_like).map(|other| other.long_s).fold(0.0, f64::max);
        if stair.is_small(figure.value) {
            let until_s = if beside_s > 0.0 { stair.long_s.min(SLOWER * beside_s) } else { stair.long_s };
            stair.spread(rows, until_s);
        }
    }
}

/// From the first row of an effort to that of the next one.
struct Stair {
    rows: Range<usize>,
    /// N/kg.
    by: f64,
    long_s: f64,
}

impl Stair {
    fn is_small(&self, usual: f64) -> bool {
        self.by.abs() < MOST_CHANGES * usual
    }

    /// Lays the efforts of the last `long_s` on a straight line.
    fn spread(&self, rows: &mut [Sample], long_s: f64) {
        let end_s = rows[self.rows.end].time_s;
        for row in &mut rows[self.rows.clone()] {
            let share = 1.0 - (end_s - row.time_s) / long_s;
            row.effort_n_per_kg = row.effort_n_per_kg.map(|effort| effort + share.max(0.0) * self.by);
        }
    }
}

/// All changes of efforts other than 0, without gaps.
fn stairs_of(rows: &[Sample]) -> Vec<Stair> {
    let longest_s = next_row_s(usual_step_s(rows));
    let (mut found, mut begin) = (Vec::new(), 0);
    for (i, pair) in (1..).zip(rows.windows(2)) {
        let is_next = pair[1].time_s - pair[0].time_s <= longest_s;
        let by = match [&pair[0], &pair[1]].map(|row| row.effort_n_per_kg) {
            // A coast ends at once.
            [Some(before), Some(now)] if is_next && before != 0.0 => now - before,
            _ => {
                begin = i;
                continue;
            }
        };
        if by != 0.0 {
            found.push(Stair { rows: begin..i, by, long_s: pair[1].time_s - rows[begin].time_s });
            begin = i;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Efforts of a train that powers with less and less, coasts, and powers again, as `shown` has them.
    fn shown(mut shown: impl FnMut(usize, f64) -> f64) -> Vec<Sample> {
        let sample = |i: usize| Sample {
            time_s: i as f64,
            effort_n_per_kg: Some(shown(i, effort(i))),
            line: i as u64 + 2,
            ..Sample::default()
        };
        (0..900).map(sample).collect()
    }

    fn effort(i: usize) -> f64 {
        match i % 180 {
            // Constant, then falling, each time with another load.
            phase @ 0..120 => (0.45 - 0.013 * (i / 180) as f64) / (1.0 + phase.saturating_sub(30) as f64 / 40.0),
            120..160 => 0.0,
            _ => -0.3,
        }
    }

    /// Or after 20 s.
    fn written_again_after(change: f64) -> Vec<Sample> {
        let (mut last, mut long_s) = (0.0_f64, 0);
        shown(|_, effort| {
            long_s += 1;
            if (effort - last).abs() >= change || long_s == 20 {
                (last, long_s) = (effort, 0);
            }
            last
        })
    }

    fn off(rows: &[Sample]) -> (f64, f64) {
        let off = |(i, row): (usize, &Sample)| row.effort_n_per_kg.unwrap() - effort(i);
        let all: Vec<f64> = rows.iter().enumerate().map(off).collect();
        (all.iter().sum::<f64>() / all.len() as f64, all.iter().fold(0.0, |most, off| off.abs().max(most)))
    }

    #[test]
    fn efforts_that_are_written_again_once_they_have_changed_enough_are_put_where_they_were() {
        for change in [0.015, 0.02] {
            let (mut rows, mut findings) = (written_again_after(change), Vec::new());
            assert!(off(&rows).0 > 0.1 * change, "too large in the mean before");
            put_right(&mut rows, &mut findings);
            assert_eq!(findings.len(), 1);
            assert_eq!((findings[0].kind, findings[0].done), (Kind::EffortStairs, Done::PutRight));
            assert!((change..1.3 * change).contains(&findings[0].figure.value), "{findings:?}");
            let (mean, most) = off(&rows);
            assert!(mean.abs() < 0.05 * change && most < 1.3 * change, "{mean} {most}");
        }
    }

    #[test]
    fn they_are_left_out_where_the_changes_are_too_large() {
        let (mut rows, mut findings) = (written_again_after(0.03), Vec::new());
        put_right(&mut rows, &mut findings);
        assert_eq!(findings.iter().map(|found| found.done).collect::<Vec<_>>(), [Done::LeftOut]);
        assert!(rows.iter().all(|row| row.effort_n_per_kg.is_none()));
    }

    #[test]
    fn rounded_efforts_levers_and_those_that_arrive_every_fifth_row_stay() {
        let rounded = shown(|_, effort| (50.0 * effort).round() / 50.0);
        let notches = shown(|i, _| [0.31, 0.07, 0.22, -0.1, 0.4, 0.12][i / 7 % 6] + 0.003 * (i / 42) as f64);
        let mut last = 0.0;
        let late = shown(|i, effort| {
            if i % 5 == 0 {
                last = effort + 0.05 * (i as f64).sin();
            }
            last
        });
        // By a little or by much, after a short time or a long one, as the hand goes.
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut hand = 0.2;
        let moves = shown(|_, _| {
            if rng.random_bool(0.3) {
                hand = 0.2 + 0.1 * rng.random_range(-1.0..1.0_f64).powi(3);
            }
            hand
        });
        // A smooth traction beside the steps of a brake lever.
        let mut lever = 3;
        let brake = shown(|_, effort| {
            if rng.random_bool(0.3) {
                lever = if rng.random_bool(0.5) { lever % 6 + 1 } else { (lever + 4) % 6 + 1 };
            }
            if effort > 0.25 { effort } else { -0.04 * f64::from(lever) }
        });
        let all = [("rounded", rounded), ("lever", notches), ("late", late), ("hand", moves), ("brake", brake)];
        for (name, mut rows) in all {
            let (before, mut findings) = (rows.clone(), Vec::new());
            put_right(&mut rows, &mut findings);
            assert_eq!((findings.len(), rows == before), (0, true), "{name}: {findings:?}");
        }
    }
}
