//! Speeds that are counted in one unit and written in another one with few digits: whole mph in whole km/h, whole km/h
//! in tenths of a metre per second.
//!
//! In: the rows of a recorder. Out: each speed as the whole number of units that it was written for.
//!
//! ```text
//! counted, mph       29     30     31     32     33
//! the same, km/h  46.67  48.28  49.89  51.50  53.11
//! written, km/h      47     48     50     51     53        never 49, never 52
//! ```
//!
//! The steps of what is written say how fine the numbers are, those of what is counted how fine the speeds are.

use crate::rows::steps::{self, SPEED_STEPS_KMH};
use rundown_files::recording::Recording;
use rundown_files::statistics::sorted;
use std::collections::BTreeMap;

/// Steps in which speeds are written, km/h, the largest first: whole km/h, tenths of m/s, tenths, and so on.
const WRITTEN_KMH: [f64; 6] = [1.0, 0.36, 0.1, 0.036, 0.01, 0.0036];
/// Share of the readings that a unit has to explain; a few may have been put in by hand.
const MOST: f64 = 0.98;
/// By chance all values are among those of a unit with this probability: e to the power of it, with its sign turned.
/// Neighbours are all of them sooner or later, in a recorder that does not skip any.
const LEAST_EVIDENCE: f64 = 12.0;
/// Fewer different readings say nothing.
const LEAST_VALUES: usize = 8;
/// A unit that is a multiple of the written step, but for so many of these, is written as it is.
const EXACT: f64 = 1e-3;

/// How the speeds of a recorder are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Written {
    /// What it counts in, km/h.
    pub(crate) unit_kmh: f64,
    /// The step in which that is written, km/h.
    pub(crate) step_kmh: f64,
    is_cut: bool,
}

impl Written {
    /// What the speeds of these runs were counted in, where that is not what they are written in.
    fn of(recordings: &[&Recording]) -> Option<Self> {
        let rows = recordings.iter().flat_map(|one| &one.rows);
        let moving = rows.filter_map(|row| row.speed_mps).filter(|mps| *mps > 0.0);
        let read_kmh = sorted(moving.map(|mps| 3.6 * mps));
        let step_kmh = WRITTEN_KMH.into_iter().find(|step_kmh| steps::are_multiples(&read_kmh, *step_kmh))?;
        let mut values = read_kmh.clone();
        values.dedup_by(|next, kept| *next - *kept < 0.5 * step_kmh);
        let may_be = |unit_kmh: &f64| {
            let ratio = unit_kmh / step_kmh;
            ratio > 1.0 + EXACT
                && (ratio - ratio.round()).abs() > EXACT
                && values.len() >= LEAST_VALUES
                && values.len() as f64 * ratio.ln() > LEAST_EVIDENCE
        };
        let units = SPEED_STEPS_KMH.into_iter().filter(may_be);
        let candidates = units.flat_map(|unit_kmh| [false, true].map(|is_cut| Self { unit_kmh, step_kmh, is_cut }));
        let explains = |one: &Self| {
            let count = read_kmh.iter().filter(|kmh| one.counted_kmh(**kmh).is_some()).count();
            count as f64 >= MOST * read_kmh.len() as f64
        };
        candidates.into_iter().find(explains)
    }

    /// The multiple of the unit that is written so.
    fn counted_kmh(&self, read_kmh: f64) -> Option<f64> {
        let steps = (read_kmh / self.step_kmh).round();
        let least = (steps * self.step_kmh / self.unit_kmh).round();
        let is_written_so = |count: &f64| {
            let exact = count * self.unit_kmh / self.step_kmh;
            let off = exact - steps;
            if self.is_cut { (-EXACT..1.0).contains(&off) } else { off.abs() <= 0.5 + EXACT }
        };
        [least, least + 1.0].into_iter().find(is_written_so).map(|count| count * self.unit_kmh)
    }

    /// What says so.
    pub(crate) fn evidence(&self) -> String {
        let how = if self.is_cut { "cut off" } else { "rounded" };
        format!("written in steps of {} km/h, {how}", (self.step_kmh * 1e4).round() / 1e4)
    }
}

/// Gives each speed the value that was counted. Out: how they were written, by unit.
pub(crate) fn put_right(recordings: &mut [Recording]) -> BTreeMap<String, Written> {
    let mut units: BTreeMap<&str, Vec<&Recording>> = BTreeMap::new();
    for recording in recordings.iter().filter(|recording| !recording.speed_is_computed()) {
        units.entry(&recording.unit).or_default().push(recording);
    }
    let found = |(unit, of_unit): (&str, Vec<&Recording>)| Some((unit.to_owned(), Written::of(&of_unit)?));
    let found: BTreeMap<String, Written> = units.into_iter().filter_map(found).collect();
    for recording in recordings.iter_mut().filter(|recording| !recording.speed_is_computed()) {
        let Some(written) = found.get(&recording.unit) else { continue };
        for speed_mps in recording.rows.iter_mut().filter_map(|row| row.speed_mps.as_mut()) {
            *speed_mps = written.counted_kmh(3.6 * *speed_mps).map_or(*speed_mps, |kmh| kmh / 3.6);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown_files::sample::Sample;

    const MPH: f64 = 1.609_344;

    /// A run to 80 km/h and back that is counted in a unit and written in steps, rounded or cut off.
    fn run(unit_kmh: f64, round: fn(f64) -> f64, step_kmh: f64, write: fn(f64) -> f64) -> Recording {
        let row = |second: u32| {
            let kmh = 80.0 - (f64::from(second) / 5.0 - 80.0).abs();
            let counted = round(kmh / unit_kmh) * unit_kmh;
            let written = write(counted / step_kmh) * step_kmh;
            Sample { time_s: f64::from(second), speed_mps: Some(written / 3.6), ..Sample::default() }
        };
        Recording { rows: (0..800).map(row).collect(), ..Recording::default() }
    }

    fn found(recording: Recording) -> Option<Written> {
        put_right(&mut [recording]).remove("")
    }

    #[test]
    fn units_that_are_written_in_steps_of_others_are_found_and_put_right() {
        let written = [
            (MPH, 1.0),
            (1.852, 1.0),
            (1.8, 1.0),
            (3.6, 1.0),
            (1.0, 0.36),
            (1.0, 0.036),
            (MPH, 0.1),
            (MPH, 0.01),
            (MPH, 0.36),
            (0.5, 0.36),
        ];
        for (unit_kmh, step_kmh) in written {
            for (round, write) in
                [(f64::round as fn(f64) -> f64, f64::round as fn(f64) -> f64), (f64::floor, f64::floor)]
            {
                let mut runs = [run(unit_kmh, round, step_kmh, write)];
                let found = put_right(&mut runs).remove("");
                let found = found.unwrap_or_else(|| panic!("{unit_kmh} in {step_kmh}: not found"));
                assert_eq!((found.unit_kmh, found.step_kmh), (unit_kmh, step_kmh));
                let exact = run(unit_kmh, round, 1e-9, f64::round);
                for (put, exact) in runs[0].rows.iter().zip(exact.rows) {
                    let [put, exact] = [put, &exact].map(|row| 3.6 * row.speed_mps.unwrap());
                    assert!((put - exact).abs() < 1e-6, "{unit_kmh} in {step_kmh}: {put} of {exact}");
                }
            }
        }
    }

    #[test]
    fn what_is_written_as_it_is_counted_stays() {
        for (unit_kmh, step_kmh) in
            [(1.0, 1.0), (5.0, 1.0), (2.0, 1.0), (0.5, 0.1), (0.1, 0.1), (MPH, 1e-6), (1.0, 1e-6), (0.0137, 0.01)]
        {
            assert_eq!(found(run(unit_kmh, f64::round, step_kmh, f64::round)), None, "{unit_kmh} in {step_kmh}");
        }
        let few = Recording {
            rows: run(MPH, f64::round, 1.0, f64::round).rows.drain(..50).collect(),
            ..Recording::default()
        };
        assert_eq!(found(few), None, "six values");
    }

    #[test]
    fn a_recorder_that_skips_no_value_counts_in_what_it_writes() {
        // One run in fifty was of another kind.
        let mut mixed = run(MPH, f64::round, 1.0, f64::round);
        mixed.rows.extend(run(1.0, f64::round, 1.0, f64::round).rows);
        assert_eq!(found(mixed), None);
    }
}
