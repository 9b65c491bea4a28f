//! Speeds that trail behind the train in a filter of first order, beside efforts that do not.
//!
//! In: rows of runs of a unit, put right. Out: the time constant of the filter; efforts through the same filter, so
//! that both are of the same moments.
//!
//! ```text
//! dv/dt = (v_true - v)/T          e' = e'_before + (1 - exp(-Δt/T)) (e - e'_before)
//! ```
//!
//! A filter is late by T, and so are locations that are moved by the age of the speed. But it is no delay: a start is
//! spread over some T, and beside an effort that is as sharp as it was a start looks like a resistance, in each run
//! alike. Which of both it is, or a mean over some seconds, the accelerations say: each is tried with the age that
//! suits it best ([`effort::age`](crate::effort::age)).

use crate::effort::age::{Asked, Reading, of_run, pooled};
use crate::figure::Figure;
use crate::speed::smoothed::averaged;
use rundown_files::sample::Sample;
use rundown_files::statistics::median_of;

/// Time constants that are tried, s, evenly spaced.
const STEP_S: f64 = 0.5;
const STEPS: usize = 12;
/// Means that are tried against them, s.
const MEANS_S: [f64; 5] = [3.0, 5.0, 7.0, 9.0, 12.0];
/// Shorter ones look like what steps of the speed do to efforts that leap (whole km/h without a filter: 0.9 to 1.05 s),
/// s.
const SHORTEST_S: f64 = 1.25;
/// Nats by which a filter must explain the accelerations better than a delay and than means, in all runs together ...
const CLEARLY: f64 = 10.0;
/// ... and the share of the runs in which it does.
const MOST_RUNS: f64 = 0.65;
/// Fewer runs do not decide.
const LEAST_RUNS: usize = 3;
/// The shape of a filter hardly shows in windows of some seconds: share of its time constant.
const SHAPE_SD: f64 = 0.1;
/// A row after a longer time, in usual ones, begins again.
const GAP: f64 = 3.5;

/// The time constant of the filter; none where a delay or means explain as much.
pub(crate) fn of(runs: &[Asked<'_>]) -> Option<Figure> {
    let as_read: Vec<Option<f64>> = runs.iter().map(|run| explained(run, run.rows)).collect();
    let with = |run: &Asked<'_>, efforts: Vec<Option<f64>>| -> Vec<Sample> {
        run.rows.iter().zip(efforts).map(|(row, e)| Sample { effort_n_per_kg: e, ..*row }).collect()
    };
    let through = |efforts: &dyn Fn(&Asked<'_>) -> Vec<Option<f64>>| -> Vec<f64> {
        let gain =
            |(run, as_read): (&Asked<'_>, &Option<f64>)| Some(explained(run, &with(run, efforts(run)))? - (*as_read)?);
        runs.iter().zip(&as_read).filter_map(gain).collect()
    };
    let of_filter = |step: usize| through(&|run| filtered(run, STEP_S * step as f64));
    let sum = |gains: &[f64]| gains.iter().sum::<f64>();
    let filters: Vec<Vec<f64>> = (1..=STEPS).map(of_filter).collect();
    let best = (0..STEPS).max_by(|a, b| sum(&filters[*a]).total_cmp(&sum(&filters[*b])))?;
    let gains = &filters[best];
    let means = MEANS_S.map(|long_s| sum(&through(&|run| averaged(run.rows, long_s))));
    let rival = means.into_iter().fold(0.0, f64::max);
    let agree = gains.iter().filter(|gain| **gain > 0.0).count() as f64 > MOST_RUNS * gains.len() as f64;
    if gains.len() < LEAST_RUNS || !agree || sum(gains) < rival + CLEARLY {
        return None;
    }
    // What is left of an age says more of the whole delay than the shape does. Efforts behind the filter are those of
    // the moment, or half a row before it where those that went in were.
    let tried_s = STEP_S * (best + 1) as f64;
    let left = |run: &Asked<'_>| {
        let rows = with(run, filtered(run, tried_s));
        Some((of_run(Asked { rows: &rows, ..*run }, Reading::Momentary)?.age_s, run.step_s))
    };
    let left: Vec<(Figure, f64)> = runs.iter().filter_map(left).collect();
    let quarter_s = 0.25 * median_of(left.iter().map(|(_, step_s)| step_s));
    let (left_s, _) = pooled(left.iter().map(|(age_s, _)| *age_s));
    let value = tried_s - left_s.value - quarter_s;
    let sd = left_s.sd.hypot(quarter_s).hypot(SHAPE_SD * value);
    (value > SHORTEST_S).then_some(Figure { value, sd })
}

/// Log-likelihood of the accelerations with the age that suits best, however the column is read.
fn explained(run: &Asked<'_>, rows: &[Sample]) -> Option<f64> {
    let of = |reading| of_run(Asked { rows, ..*run }, reading).map(|age| age.log_likelihood);
    Some(of(Reading::Mean)?.max(of(Reading::Momentary)?))
}

/// The efforts of a run through a filter of this time constant.
pub(crate) fn filtered(run: &Asked<'_>, constant_s: f64) -> Vec<Option<f64>> {
    let mut before: Option<(f64, f64)> = None;
    let through = |row: &Sample| {
        let effort = row.effort_n_per_kg;
        before = effort.map(|effort| {
            let near = before.filter(|(time_s, _)| row.time_s - time_s < GAP * run.step_s);
            let kept = near.map_or(0.0, |(time_s, _)| (-(row.time_s - time_s) / constant_s).exp());
            (row.time_s, effort + kept * (near.map_or(0.0, |(_, before)| before) - effort))
        });
        before.map(|(_, effort)| effort)
    };
    run.rows.iter().map(through).collect()
}
