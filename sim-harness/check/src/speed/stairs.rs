//! Speeds that stand still from row to row and then change at once: a recorder that writes a speed only where it has
//! changed enough, or every few rows.
//!
//! In: rows of a run. Out: the same without the repeats, each of which may be off by as much as the next change.
//!
//! ```text
//! v  62.1  62.1  62.1  63.2  63.2  64.3  64.3  64.3  65.4        by tenths, and every change is 1.1
//! ```
//!
//! A speed that is rounded stands still, too, and then changes by one step; one that is held by a controller, and then
//! goes on changing. So the changes between repeats are asked: where most of them are of several steps, the train
//! passed the steps between, and the rows did not show it. The first row of each stair is a reading; the others are
//! left out.

use crate::finding::{Done, Finding, Kind};
use crate::rows::stairs::{Stairs, level};
use rundown_files::sample::Sample;

/// Usual changes of less are noise, km/h.
const LEAST_KMH: f64 = 0.4;

/// Leaves out the speeds that repeat the one before, where they are stairs.
pub(crate) fn leave_out(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let speed_kmh = |row: &Sample| Some(3.6 * row.speed_mps?);
    let stairs = Stairs::of(rows, speed_kmh);
    let Some(figure) = stairs.usual(level(rows, speed_kmh)).filter(|usual| usual.value >= LEAST_KMH) else {
        return;
    };
    let Stairs { repeats, .. } = stairs;
    let (count, line) = (repeats.len(), rows[repeats[0]].line);
    findings.push(Finding { kind: Kind::Stairs, figure, unit: "km/h", count, line, done: Done::LeftOut });
    repeats.into_iter().for_each(|row| rows[row].speed_mps = None);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Speeds of a train that goes up and down between 40 and 110 km/h, by up to 1.6 km/h a second, as `shown` has
    /// them.
    fn shown(mut shown: impl FnMut(usize, f64) -> f64) -> Vec<Sample> {
        let kmh = |i: usize| 75.0 + 35.0 * (i as f64 / 22.0).sin();
        let sample = |i: usize| Sample {
            time_s: i as f64,
            speed_mps: Some(shown(i, kmh(i)) / 3.6),
            line: i as u64 + 2,
            ..Sample::default()
        };
        (0..900).map(sample).collect()
    }

    fn left_out(mut rows: Vec<Sample>) -> (Vec<Finding>, Vec<Sample>) {
        let mut findings = Vec::new();
        leave_out(&mut rows, &mut findings);
        (findings, rows)
    }

    fn to(step_kmh: f64, kmh: f64) -> f64 {
        (kmh / step_kmh).round() * step_kmh
    }

    /// Shows a speed again once it has changed by so much.
    fn dead_band(band_kmh: f64, step_kmh: f64) -> Vec<Sample> {
        let mut last = 0.0_f64;
        shown(|_, kmh| {
            if (kmh - last).abs() >= band_kmh {
                last = kmh;
            }
            to(step_kmh, last)
        })
    }

    #[test]
    fn repeats_of_a_speed_that_is_shown_once_it_has_changed_enough_are_left_out() {
        for (band_kmh, step_kmh) in [(1.0, 0.1), (2.0, 1.0), (2.0, 0.1)] {
            let recorded = dead_band(band_kmh, step_kmh);
            let repeats = recorded.windows(2).filter(|pair| pair[1].speed_mps == pair[0].speed_mps).count();
            let (findings, rows) = left_out(recorded);
            assert_eq!(findings.len(), 1, "{band_kmh}");
            let found = &findings[0];
            assert_eq!((found.kind, found.done, found.count), (Kind::Stairs, Done::LeftOut, repeats));
            assert!((band_kmh - 0.01..band_kmh + 1.6).contains(&found.figure.value), "{found:?}");
            assert_eq!(rows.iter().filter(|row| row.speed_mps.is_none()).count(), repeats);
        }
    }

    #[test]
    fn so_are_those_of_a_speed_that_arrives_every_fourth_row() {
        let mut last = 0.0;
        let (findings, rows) = left_out(shown(|i, kmh| {
            if i % 4 == 0 {
                last = to(0.1, kmh);
            }
            last
        }));
        assert_eq!(findings.len(), 1);
        let kept = rows.iter().filter(|row| row.speed_mps.is_some()).map(|row| row.time_s as usize % 4);
        assert!(kept.eq(std::iter::repeat_n(0, 225)));
    }

    #[test]
    fn rounded_speeds_and_those_that_a_controller_holds_stay() {
        // Also with a wheel, and off by half a step.
        for (step_kmh, scale, offset_kmh) in
            [(0.1, 1.0, 0.0), (1.0, 1.0, 0.0), (2.0, 1.0, 1.0), (1.0, 1.013, 0.0), (1.0, 1.0, 0.5)]
        {
            assert_eq!(left_out(shown(|_, kmh| scale * to(step_kmh, kmh) + offset_kmh)).0, []);
        }
        // Held at 50, at 85 and at 100 km/h, between which it changes at once by 1 km/h a second.
        let held = [50.0, 85.0, 100.0, 85.0];
        let mut kmh = 50.0_f64;
        let controlled = shown(|i, _| {
            kmh += (held[i / 30 % 4] - kmh).clamp(-1.0, 1.0);
            to(0.1, kmh)
        });
        assert_eq!(left_out(controlled).0, []);
    }
}
