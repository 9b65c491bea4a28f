//! Wheels that slide in each brake by the same share: no bumps, but a speed that reads too little wherever the train
//! brakes.
//!
//! ```text
//! Δx - ∫ v_r dt = (1/s - 1) ∫ v_r dt + (o/s) Δt + τ Δv_r + q ∫ v_r dt (braking) + noise
//! ```
//!
//! Without q the others make it up: such a speed looked older by -0.6 s and 2 km/h too low, of a wheel of 1.018. But a
//! wheel that creeps wherever it powers, and is off by as much, looks like q. So it is named only where no wheel is
//! left.

use crate::agreement::{Agreement, Figure, pooled};
use crate::compared::{BRAKES_MPS2, Compared, Differences};
use crate::creep::{FALLS_MPS2, RISES_MPS2};
use crate::run::{OfSpeed, Taken, differences};
use crate::{LEAST_SCALE, lost_seconds};
use nalgebra::Vector3;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, sd_of_median, spread};

/// Over so long before and behind a row, s: less is a step of the speed.
const OVER_S: f64 = 2.5;
/// A speed is one of a brake this long before and behind, too, s: there the wheels begin to slide.
const AROUND_S: f64 = 3.0;
/// Their scatter says how sure the share is.
const LEAST_RUNS: usize = 3;
/// Slides of less do not matter. Fitted beside the others, which take up a part of it, they are half as large.
const LEAST_SHARE: f64 = 0.01;
/// So many standard deviations.
const SURE: f64 = 6.0;
/// Wheels that creep wherever they power are off by one per cent and more: a scale that is known less well does not show
/// whether one is left.
const VAGUE: f64 = 0.005;
/// What the ends of brakes, between two rows that are compared, make of the usual share, as a share of it.
const OF_ENDS: f64 = 0.02;
/// Nats by which q must explain the locations better than what else goes with the speed's change.
const LEAST_GAIN: f64 = 12.0;

/// What one run says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EachBrake {
    share: Figure,
    nats: f64,
    /// Nats of another scale while the speed rises, of one while it falls, and of what means make of its turns.
    rivals: [f64; 3],
}

impl EachBrake {
    /// None: the run does not say.
    pub(crate) fn of(compared: &Compared) -> Option<Self> {
        let differences = &compared.differences;
        let independent = compared.independent();
        let nats = |metres: &[f64]| compared.beside(metres).map_or(0.0, |(_, nats)| nats * independent);
        let (share, braked) = compared.beside(&differences.way_where(|mps2| mps2 < BRAKES_MPS2))?;
        let raised_m = differences.way_where(|mps2| mps2 > RISES_MPS2);
        let fallen_m = differences.way_where(|mps2| mps2 < FALLS_MPS2);
        let rivals = [nats(&raised_m), nats(&fallen_m), nats(&differences.turns_mps2)];
        let share = Figure { sd: share.sd / independent.sqrt(), ..share };
        Some(Self { share, nats: braked * independent, rivals })
    }

    /// Of one recorder: that they read too little while the train brakes explains the locations, and nothing else does.
    fn are_sure(runs: &[Self]) -> bool {
        if runs.len() < LEAST_RUNS {
            return false;
        }
        let shares: Vec<Figure> = runs.iter().map(|run| run.share).collect();
        let Some(share) = Figure::mean_of(&shares) else { return false };
        let nats: f64 = runs.iter().map(|run| run.nats).sum();
        let [raised, fallen, turns] = [0, 1, 2].map(|which| runs.iter().map(|run| run.rivals[which]).sum::<f64>());
        // Where a speed that falls is mostly that of a brake, both say the same.
        let is_better = nats > raised.max(turns) + LEAST_GAIN && nats > fallen;
        is_better && share.value > 0.5 * LEAST_SHARE && share.away_from(0.0) > SURE
    }
}

/// Takes the speeds of brakes off the comparison of these runs of a recorder, if the wheels slide in each of them: by
/// how much they read too little, less than nothing, %. `runs`: places and times between rows.
pub(crate) fn take_off(
    recordings: &[Recording],
    runs: &[(usize, f64)],
    of_speeds: &mut [Option<OfSpeed>],
) -> Option<Figure> {
    let said = |(i, _): &(usize, f64)| of_speeds[*i].as_ref()?.each_brake.clone();
    if !EachBrake::are_sure(&runs.iter().filter_map(said).collect::<Vec<_>>()) {
        return None;
    }
    let taken = Taken { brakes: true, ..Taken::default() };
    let again = runs.iter().map(|(i, step_s)| OfSpeed::of(&recordings[*i].rows, *step_s, taken));
    let again: Vec<Option<OfSpeed>> = again.collect();
    let agreements: Vec<Agreement> = again.iter().flatten().map(|one| one.agreement.clone()).collect();
    let scale = pooled(&agreements)?.scale();
    let is_no_wheel = scale.sd < VAGUE && (scale.value - 1.0).abs() < LEAST_SCALE.max(2.0 * scale.sd);
    if !is_no_wheel {
        return None;
    }
    let of_run = |((i, step_s), again): (&(usize, f64), &Option<OfSpeed>)| {
        share(&differences(&recordings[*i].rows, *step_s), &again.as_ref()?.agreement)
    };
    let shares: Vec<f64> = runs.iter().zip(&again).filter_map(of_run).collect();
    let usual = median(shares.iter().copied())?;
    if usual < LEAST_SHARE {
        return None;
    }
    // Where a clock loses seconds they are put right first, and the times of brakes are others.
    if let (_, Some(_)) = lost_seconds::sought(runs, recordings) {
        return None;
    }
    let sd = sd_of_median(spread(shares.iter().map(|share| share - usual)), shares.len());
    for ((i, _), again) in runs.iter().zip(again) {
        of_speeds[*i] = again;
    }
    let read = 1.0 / (1.0 + usual);
    Some(Figure { value: 100.0 * (read - 1.0), sd: 100.0 * read * read * sd.hypot(OF_ENDS * usual) })
}

/// By which share of the way by speed the locations are ahead while the train brakes, beside what the rest of the run
/// says: the usual one, for brakes begin and end between rows.
fn share(differences: &Differences, rest: &Agreement) -> Option<f64> {
    let left_m = differences.left_m(&Vector3::new(rest.values[0], rest.values[1], rest.age_s()));
    let braked = differences.mps2().into_iter().enumerate().filter(|(_, mps2)| *mps2 < BRAKES_MPS2);
    median(braked.map(|(i, _)| left_m[i] / differences.by_speed[i]))
}

/// The rows without the speeds of brakes.
pub(crate) fn without_brakes(rows: &[Sample]) -> Vec<Sample> {
    let read: Vec<(f64, f64)> = rows.iter().filter_map(|row| Some((row.time_s, row.speed_mps?))).collect();
    let within = |(at_s, _): &(f64, f64)| {
        let from = read.partition_point(|(time_s, _)| *time_s < at_s - OVER_S);
        let to = read.partition_point(|(time_s, _)| *time_s <= at_s + OVER_S) - 1;
        let [(from_s, from_mps), (to_s, to_mps)] = [read[from], read[to]];
        to_mps - from_mps < BRAKES_MPS2 * (to_s - from_s)
    };
    let braked_s: Vec<f64> = read.iter().filter(|one| within(one)).map(|(time_s, _)| *time_s).collect();
    let is_braked = |time_s: f64| {
        let next = braked_s.partition_point(|braked_s| *braked_s < time_s - AROUND_S);
        braked_s.get(next).is_some_and(|braked_s| *braked_s <= time_s + AROUND_S)
    };
    let without = |row: &Sample| Sample { speed_mps: row.speed_mps.filter(|_| !is_braked(row.time_s)), ..*row };
    rows.iter().map(without).collect()
}
