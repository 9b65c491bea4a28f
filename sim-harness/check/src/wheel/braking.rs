//! Whether speeds read too little while the train brakes: what one run says, and the rows without them.
//!
//! ```text
//! Δx - ∫ v_r dt = (1/s - 1) ∫ v_r dt + (o/s) Δt + τ Δv_r + q ∫ v_r dt (braking) + noise
//! ```

use crate::agreement::compared::{BRAKES_MPS2, Compared};
use crate::figure::Figure;
use crate::wheel::creep::{FALLS_MPS2, RISES_MPS2};
use rundown_files::sample::Sample;

/// Over so long before and behind a row, s: less is a step of the speed.
const OVER_S: f64 = 2.5;
/// A speed is one of a brake this long before and behind, too, s: there the wheels begin to slide.
const AROUND_S: f64 = 3.0;
/// Their scatter says how sure the share is.
const LEAST_RUNS: usize = 3;
/// Slides of less do not matter. Fitted beside the others, which take up a part of it, they are half as large.
pub(crate) const LEAST_SHARE: f64 = 0.01;
/// So many standard deviations.
const SURE: f64 = 6.0;
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
    pub(crate) fn are_sure(runs: &[Self]) -> bool {
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
