//! Replay: a recorded run through the very `step` of the board.
//!
//! In: an [`Estimator`], the vehicle before the run, a [`Recording`]. Out: a [`ReplayedRun`], and the vehicle after the
//! run.
//!
//! | tick | rows that are steps |
//! |---|---|
//! | [`Tick::EverySample`] | all |
//! | [`Tick::Period`] | the newest row of each period, as the board does with a faster recorder: the first row, then the last row of (0, S], (S, 2S], ... after it |
//!
//! A run with more than half of its ticks invalid does not change the vehicle, and says so.
//!
//! Rows whose time does not increase are dropped and named by [`Dropped`]; nothing else is.

use crate::{recording::Recording, sample::Sample};
use rayon::prelude::*;
use rundown::estimator::{Estimator, RunSummary, StepError};
use rundown::tick::foresight::Trust;
use rundown::{
    coast_ahead::CoastAhead, filter::gaussian::Gaussian, model::direction::Direction, tick::estimate::Estimate,
    tick::measurement::Measurement, tick::memory::Vehicle, tick::regime::Regime,
};
use rundown_wire::Learned;
use std::collections::{BTreeMap, HashMap};
use std::{borrow::Borrow, path::PathBuf};

/// Which rows are steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "said by the table above")]
pub enum Tick {
    #[default]
    EverySample,
    Period {
        /// The period, s, above 0.
        seconds: f64,
    },
}

/// A row that gave no estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "named with their units")]
pub struct Dropped {
    /// Line of the log, counted from 1.
    pub line: u64,
    pub time_s: f64,
    pub reason: StepError,
}

/// What a replay gave.
#[derive(Clone, Debug)]
#[expect(missing_docs, reason = "as in Recording, where not said")]
pub struct ReplayedRun {
    pub name: String,
    pub path: PathBuf,
    pub unit: String,
    pub direction: Direction,
    pub rows: usize,
    /// The accepted measurements.
    pub measurements: Vec<Measurement>,
    /// One estimate for each accepted measurement.
    pub estimates: Vec<Estimate>,
    /// What coasting from each estimate on leads to; none where the track has no targets.
    pub coast_ahead: Vec<CoastAhead>,
    /// The regime of each estimate's sample as it is known one sample later; the last one keeps its causal regime.
    pub regimes: Vec<Regime>,
    /// Rows that gave no estimate.
    pub dropped: Vec<Dropped>,
    /// Features, counters and the train of this run.
    pub summary: RunSummary,
    /// The vehicle as the run began with it.
    pub began_with: Vehicle,
    /// The vehicle's Davis coefficients before the run.
    pub vehicle_before: Gaussian<3>,
    /// The vehicle's Davis coefficients after the run.
    pub vehicle_after: Gaussian<3>,
    /// How far they may be trusted: only where they are learned would the board publish them between runs.
    pub learned: Learned,
    /// The same by how coasts were foreseen, those of earlier runs included.
    pub trust: Trust,
    /// Share of what the vehicle was taught that short hops taught.
    pub hops_share: f64,
    /// Standard deviation of r(v) for that, share.
    pub hops_sd: f64,
    /// What it says went into the vehicle: not where most of it is invalid.
    pub is_used: bool,
    /// Half a step was added to its speeds: the runs before have shown that they are cut off.
    pub speeds_put_right: bool,
    /// What outside the train held the run up, in words.
    pub perturbed: Option<String>,
    pub warnings: Vec<String>,
}

/// Replays one run; what it says about the train goes into `vehicle`.
pub fn replay(estimator: &Estimator, vehicle: &mut Vehicle, recording: &Recording, tick: Tick) -> ReplayedRun {
    let before = *vehicle;
    let vehicle_before = vehicle.davis();
    let mut run = estimator.begin_run(vehicle, recording.direction);
    let speeds_put_right = run.puts_right();
    let mut measurements = Vec::new();
    let mut estimates = Vec::new();
    let mut dropped = Vec::new();
    let mut coast_ahead = Vec::new();
    let has_targets = estimator.track().targets() > 0;
    let mut surroundings = recording.surroundings();
    for row in steps(&recording.rows, tick) {
        row.update(&mut surroundings);
        estimator.set_surroundings(&mut run, surroundings);
        match estimator.step(&mut run, &row.measurement()) {
            Ok(estimate) => {
                if has_targets {
                    coast_ahead.push(estimator.coast_ahead(&run, &estimate));
                }
                measurements.push(row.measurement());
                estimates.push(estimate);
            }
            Err(reason) => dropped.push(Dropped { line: row.line, time_s: row.time_s, reason }),
        }
    }
    let summary = estimator.end_run(&mut run, vehicle);
    let mut warnings = recording.warnings.clone();
    let is_used = !run.is_mostly_invalid();
    if !is_used {
        let (path, invalid, all) = (recording.path.display(), run.invalid_ticks(), estimates.len());
        warnings
            .push(format!("{path}: {invalid} of {all} ticks are invalid: the vehicle stays as it was before this run"));
    }
    if estimator.cuts_off(vehicle) && !estimator.cuts_off(&before) {
        warnings
            .push("its locations show that speeds are cut off: half a step is added to those of later runs".to_owned());
    }
    ReplayedRun {
        name: recording.name.clone(),
        path: recording.path.clone(),
        unit: recording.unit.clone(),
        direction: recording.direction,
        rows: recording.rows.len(),
        measurements,
        coast_ahead,
        regimes: confirmed(&estimates),
        estimates,
        dropped,
        summary,
        began_with: before,
        vehicle_before,
        vehicle_after: vehicle.davis(),
        learned: estimator.published(vehicle).1,
        trust: *vehicle.trust(),
        hops_share: vehicle.hops_share(),
        hops_sd: vehicle.hops_sd(),
        is_used,
        speeds_put_right,
        perturbed: recording.perturbed.clone(),
        warnings,
    }
}

fn confirmed(estimates: &[Estimate]) -> Vec<Regime> {
    let later = estimates.iter().skip(1).map(|next| next.confirmed).chain([None]);
    let regimes = estimates.iter().zip(later);
    regimes.map(|(estimate, later)| later.unwrap_or(estimate.regime)).collect()
}

/// Replays runs, each by its own model (an effect may act in some runs only) and each unit's vehicle carried from run
/// to run in order. Units go side by side. `done` is called once a run.
pub fn replay_carried_by<'a>(
    model: &(impl Fn(&Recording) -> &'a Estimator + Sync),
    recordings: &[Recording],
    tick: Tick,
    done: impl Fn() + Sync,
) -> Vec<ReplayedRun> {
    replay_units_by(model, recordings, tick, &mut HashMap::new(), done)
}

/// As [`replay_carried_by`], where `vehicles` has the units that are known already; what the runs say of each goes in
/// there.
pub fn replay_units_by<'a, R: Borrow<Recording> + Sync>(
    model: &(impl Fn(&Recording) -> &'a Estimator + Sync),
    recordings: &[R],
    tick: Tick,
    vehicles: &mut HashMap<String, Vehicle>,
    done: impl Fn() + Sync,
) -> Vec<ReplayedRun> {
    let recording = |index: usize| -> &Recording { recordings[index].borrow() };
    let mut units: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for index in 0..recordings.len() {
        units.entry(&recording(index).unit).or_default().push(index);
    }
    let known = &*vehicles;
    let of_unit = |(unit, indexes): (&str, Vec<usize>)| {
        let new = || model(recording(indexes[0])).new_vehicle();
        let mut vehicle = known.get(unit).cloned().unwrap_or_else(new);
        let one = |index: usize| {
            let run = replay(model(recording(index)), &mut vehicle, recording(index), tick);
            done();
            (index, run)
        };
        let runs: Vec<(usize, ReplayedRun)> = indexes.into_iter().map(one).collect();
        (unit.to_owned(), vehicle, runs)
    };
    // Where `done` unwinds, as for an interrupt, the other units end, too.
    let of_units: Vec<_> = units.into_par_iter().panic_fuse().map(of_unit).collect();
    let mut runs = Vec::with_capacity(recordings.len());
    for (unit, vehicle, of_unit) in of_units {
        vehicles.insert(unit, vehicle);
        runs.extend(of_unit);
    }
    runs.sort_by_key(|(index, _)| *index);
    runs.into_iter().map(|(_, run)| run).collect()
}

/// Replays runs side by side, each by its own model with the vehicle as its manufacturer describes it. `done` is called
/// once a run.
pub fn replay_apart_by<'a, R: Borrow<Recording> + Sync>(
    model: &(impl Fn(&Recording) -> &'a Estimator + Sync),
    recordings: &[R],
    tick: Tick,
    done: impl Fn() + Sync,
) -> Vec<ReplayedRun> {
    let one = |recording: &R| {
        let estimator = model(recording.borrow());
        let run = replay(estimator, &mut estimator.new_vehicle(), recording.borrow(), tick);
        done();
        run
    };
    // As above.
    recordings.par_iter().panic_fuse().map(one).collect()
}

/// The rows that are handed to the estimator.
///
/// A period ends with its last row whose time is the largest so far; rows that go back in time are handed on after it,
/// so that the estimator counts them.
fn steps(rows: &[Sample], tick: Tick) -> Vec<&Sample> {
    let Tick::Period { seconds } = tick else {
        return rows.iter().collect();
    };
    let Some(first) = rows.first() else {
        return Vec::new();
    };
    // A row on the edge belongs to the period it ends, whatever the last bit of its time says.
    let period = |row: &Sample| ((row.time_s - first.time_s) / seconds - 1e-6).ceil();
    let mut steps = Vec::new();
    let mut newest = first;
    // Rows behind the newest one follow it, so that it is they which the estimator drops.
    let mut behind = Vec::new();
    for row in &rows[1..] {
        if row.time_s <= newest.time_s {
            behind.push(row);
            continue;
        }
        if period(row) > period(newest) {
            steps.push(newest);
            steps.append(&mut behind);
        }
        newest = row;
    }
    steps.push(newest);
    steps.append(&mut behind);
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(times_s: &[f64]) -> Vec<Sample> {
        let row =
            |(index, time_s): (usize, &f64)| Sample { line: index as u64 + 2, time_s: *time_s, ..Sample::default() };
        times_s.iter().enumerate().map(row).collect()
    }

    fn times_s(rows: &[Sample], tick: Tick) -> Vec<f64> {
        steps(rows, tick).iter().map(|row| row.time_s).collect()
    }

    const TEN: Tick = Tick::Period { seconds: 10.0 };

    #[test]
    fn without_a_period_every_row_is_a_step() {
        let rows = rows(&[0.0, 1.0, 1.0, 0.5, 2.0]);
        assert_eq!(times_s(&rows, Tick::EverySample), [0.0, 1.0, 1.0, 0.5, 2.0]);
    }

    #[test]
    fn a_period_ends_with_its_newest_row() {
        let each_second: Vec<f64> = (0..=35).map(f64::from).collect();
        assert_eq!(times_s(&rows(&each_second), TEN), [0.0, 10.0, 20.0, 30.0, 35.0]);
        assert_eq!(times_s(&rows(&[100.0, 104.0, 109.0, 111.0, 135.0]), TEN), [100.0, 109.0, 111.0, 135.0]);
        let tenths: Vec<f64> = (0..=301).map(|index| f64::from(index) * 0.1).collect();
        let found: Vec<f64> = times_s(&rows(&tenths), TEN).iter().map(|t| (t * 10.0).round() / 10.0).collect();
        assert_eq!(found, [0.0, 10.0, 20.0, 30.0, 30.1]);
        assert_eq!(times_s(&rows(&[0.0, 5.0, 3.0, 12.0]), TEN), [0.0, 5.0, 3.0, 12.0]);
        assert!(times_s(&[], TEN).is_empty());
        assert_eq!(times_s(&rows(&[3.0]), TEN), [3.0]);
    }
}
