//! Wheels that slide in each brake by the same share: no bumps, but a speed that reads too little wherever the train
//! brakes.
//!
//! Unless q ([`crate::wheel::braking`]) is in the model, the others make it up: such a speed looked older by -0.6 s and
//! 2 km/h too low, of a wheel of 1.018. But a wheel that creeps wherever it powers, and is off by as much, looks like
//! q. So slides are named only where no wheel is left.

use crate::agreement::compared::{BRAKES_MPS2, Differences};
use crate::agreement::parts::differences;
use crate::agreement::{Agreement, pooled};
use crate::figure::Figure;
use crate::run::of_speed::{OfSpeed, Taken};
use crate::wheel::braking::{EachBrake, LEAST_SHARE};
use crate::{LEAST_SCALE, clock};
use nalgebra::Vector3;
use rundown_files::recording::Recording;
use rundown_files::statistics::{median, sd_of_median, spread};

/// Wheels that creep wherever they power are off by one per cent and more: a scale that is known less well does not
/// show whether one is left.
const VAGUE: f64 = 0.005;
/// What the ends of brakes, between two rows that are compared, make of the usual share, as a share of it.
const OF_ENDS: f64 = 0.02;

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
    let usual = median(&shares)?;
    if usual < LEAST_SHARE {
        return None;
    }
    // Where a clock loses seconds they are put right first, and the times of brakes are others.
    if clock::lost_seconds::sought(runs, recordings).period_s.is_some() {
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
