//! What an age of the speed, or a mean over some seconds, adds to the way besides, in all runs of a recorder.
//!
//! ```text
//! x - ∫ v_r dt = ... + τ Δv_r + c Δa
//! ```
//!
//! c is τ²/2 of a delay, 0 of a filter of first order, less half a row of it of one that is computed from row to row,
//! -L²/24 of means over L s. On short hops the train powers, brakes and stands for seconds, and c looks like a wheel:
//! beside a filter of 3 s trams got one of 0.994.

use crate::SURE;
use crate::figure::Figure;
use crate::run::of_speed::{OfSpeed, Taken};
use rundown_files::recording::Recording;
use rundown_files::statistics::median;

/// A smaller one does not matter, s².
const LEAST_S2: f64 = 0.1;
/// A smaller age is none, s. Without an age none of it is taken off: what the rounding of a held speed does looks like
/// 2.4 s².
const LEAST_AGE_S: f64 = 0.3;
/// That of means over 5 s without its sign, s²: shorter ones hardly matter, and that of momentary speeds in clean logs
/// is nearer to zero.
const MEANS_S2: f64 = 25.0 / 24.0;
/// The noise is less without it, and it is better known then.
const PASSES: usize = 2;
/// A row's share of what a filter makes that is computed from row to row.
const OF_ROW: f64 = 0.5;

/// Where the speed has an age: compares speed and location of these runs again without it, as far as it is beyond doubt
/// or the age makes it likely; what is not known of it is a doubt of scale and offset. Without an age nothing is taken
/// off, and all of it is a doubt where the speeds look like means. `runs`: places and times between rows.
pub(crate) fn take_off(recordings: &[Recording], runs: &[(usize, f64)], of_speeds: &mut [Option<OfSpeed>]) {
    let compare = |of_speeds: &mut [Option<OfSpeed>], more_s2: f64| {
        for (i, step_s) in runs {
            let Some(of_speed) = &of_speeds[*i] else { continue };
            let before = of_speed.taken.second_order_s2;
            let second_order_s2 = Figure { value: before.value + more_s2, ..before };
            let taken = Taken { second_order_s2, ..of_speed.taken };
            of_speeds[*i] = OfSpeed::of(&recordings[*i].rows, *step_s, taken);
        }
    };
    let doubt = |of_speeds: &mut [Option<OfSpeed>], sd_s2: f64| {
        runs.iter().for_each(|(i, _)| of_speeds[*i] = of_speeds[*i].take().map(|of_speed| of_speed.doubted(sd_s2)));
    };
    let likely_s2 = likely_s2(runs, of_speeds);
    if likely_s2 == 0.0 {
        if let Some(mean) = left(runs, of_speeds).filter(are_means) {
            doubt(of_speeds, mean.value.abs());
        }
        return;
    }
    let mut taken_s2 = 0.0;
    for pass in 0..=PASSES {
        let Some(mean) = left(runs, of_speeds) else { return };
        if pass < PASSES && mean.value.abs() > LEAST_S2 && mean.away_from(0.0) > SURE {
            taken_s2 += mean.value;
            compare(of_speeds, mean.value);
            continue;
        }
        let believed_s2 = likely_s2.max(f64::abs(taken_s2));
        let share = believed_s2.powi(2) / (believed_s2.powi(2) + mean.sd.powi(2));
        if share * mean.value.abs() > LEAST_S2 {
            compare(of_speeds, share * mean.value);
        }
        doubt(of_speeds, mean.sd * share.sqrt());
        return;
    }
}

/// What is left of it in these runs. None: their rows do not show it.
fn left(runs: &[(usize, f64)], of_speeds: &[Option<OfSpeed>]) -> Option<Figure> {
    let left: Vec<Figure> = runs.iter().filter_map(|(i, _)| of_speeds[*i].as_ref()?.second_order_s2).collect();
    Figure::mean_of(&left)
}

/// Speeds that are means over some seconds have it without an age. The rounding of a speed that all runs hold looks
/// like it, so it is not taken off: all of it is a doubt.
fn are_means(left: &Figure) -> bool {
    left.value < -MEANS_S2 && left.away_from(0.0) > SURE
}

/// By the usual age of the speed, standard deviation; 0 where it has none.
fn likely_s2(runs: &[(usize, f64)], of_speeds: &[Option<OfSpeed>]) -> f64 {
    let age_s = |(i, _): &(usize, f64)| Some(of_speeds[*i].as_ref()?.agreement.age_s());
    let usual_s = median(runs.iter().filter_map(age_s)).unwrap_or_default().abs();
    let row_s = median(runs.iter().map(|(_, step_s)| *step_s)).unwrap_or_default();
    if usual_s > LEAST_AGE_S { OF_ROW * row_s * usual_s } else { 0.0 }
}
