//! The effort of each interval: measured, known to be zero in coasting, or what the model says it takes; and so the rows and the pulls of a set.

use super::agreement::by_place;
use super::calibrate::{Calibrated, Own};
use super::caps::{Pull, Reading, calculated, pulls, sampled_pulls, traction};
use super::coasting::{Driven, Extra, Recognised, coasted};
use super::fit::median;
use super::rows::Row;
use super::runs::{EffortReading, Interval, Readings, Run, intervals, usual_step_s};
use super::terms::{Context, Term};
use core::f64::consts::SQRT_2;

/// Share of moving samples with an effort above which the effort counts as measured.
const MEASURED_SHARE: f64 = 0.7;
/// What a calculated effort has beyond the rounding of the speeds, standard deviation at first, N/kg.
const DISTURBED_N_PER_KG: f64 = 0.005;
/// The range in which the one that was found is believed, N/kg.
const RECOGNISED_N_PER_KG: (f64, f64) = (0.003, 0.03);
/// Logs with less between samples are fast, s.
const FAST_S: f64 = 3.0;

/// What the rounding of speeds 10 s apart leaves in an effort calculated from them, standard deviation, N/kg.
fn rounded_n_per_kg(runs: &[Run], readings: &Readings) -> f64 {
    // Speeds of a fast log are means of several readings.
    let fast = median(runs.iter().map(usual_step_s)).is_some_and(|step_s| step_s < FAST_S);
    let of_reading = readings.speed_quantum_mps / 12.0_f64.sqrt() * if fast { 0.7 } else { 1.0 };
    SQRT_2 * of_reading / 10.0
}

/// The same with all else that disturbs it, as found.
fn calculated_n_per_kg(found: &Calibrated) -> f64 {
    (SQRT_2 * found.noise.reading_mps / 10.0).hypot(found.noise.acceleration_mps2)
}

impl Recognised {
    /// With the noise that was found, if one was.
    pub fn new(runs: &[Run], readings: &Readings, found: Option<&Calibrated>, uncertain: f64) -> Self {
        let at_first = rounded_n_per_kg(runs, readings).hypot(DISTURBED_N_PER_KG);
        let (least, most) = RECOGNISED_N_PER_KG;
        let of = |found| calculated_n_per_kg(found).clamp(least, most);
        Self {
            noise_n_per_kg: found.map_or(at_first, of),
            uncertain,
            own: found.map_or_else(Own::default, |found| found.own),
        }
    }
}

/// Whether the effort counts as measured.
pub fn measured(runs: &[Run]) -> bool {
    let moving = || runs.iter().flat_map(|run| &run.samples).filter(|s| s.speed_mps.is_some_and(|v| v > 1.0));
    let with = moving().filter(|s| s.effort_n_per_kg.is_some()).count();
    // A column of zeros is none.
    let any = moving().any(|s| s.effort_n_per_kg.is_some_and(|effort| effort != 0.0));
    any && with as f64 > MEASURED_SHARE * moving().count() as f64
}

/// The reading under which the residuals are smaller.
pub fn effort_reading(context: &Context<'_>, runs: &[Run], readings: &Readings) -> EffortReading {
    let spread = |effort| {
        let readings = Readings { effort, ..*readings };
        let residuals = runs.iter().enumerate().flat_map(|(i, run)| {
            let line = context.believed.line(run.direction);
            intervals(i, run, line, &readings)
                .into_iter()
                .filter(|interval| interval.effort_change_n_per_kg > 0.03)
                .filter_map(|interval| {
                    let effort = interval.effort_n_per_kg?;
                    let load = super::rows::believed_load(line, &interval);
                    Some((effort - interval.acceleration_mps2() - load).abs())
                })
                .collect::<Vec<_>>()
        });
        median(residuals).unwrap_or(0.0)
    };
    if spread(EffortReading::MeanSinceLast) < 0.7 * spread(EffortReading::Momentary) {
        EffortReading::MeanSinceLast
    } else {
        EffortReading::Momentary
    }
}

/// Extra resistance of a model along intervals, N/kg.
fn extra(context: &Context<'_>, run: &Run, intervals: &[Interval], (model, beta): (&[Term], &[f64])) -> Vec<f64> {
    let rows: Vec<Row> = intervals
        .iter()
        .map(|interval| Row {
            interval: interval.clone(),
            direction: run.direction,
            effort_n_per_kg: interval.effort_n_per_kg.unwrap_or(0.0),
            residual_n_per_kg: 0.0,
        })
        .collect();
    let mut extra = vec![0.0; rows.len()];
    let columns = model.iter().flat_map(|term| term.columns(context, &rows));
    for (column, beta) in columns.zip(beta) {
        for (sum, value) in extra.iter_mut().zip(column) {
            *sum += beta * value;
        }
    }
    extra
}

/// A model without what acts by place.
fn beyond_places((model, beta): (&[Term], &[f64])) -> (Vec<Term>, Vec<f64>) {
    let mut betas = beta.iter().copied();
    let mut kept = (Vec::new(), Vec::new());
    for term in model {
        let of_term = betas.by_ref().take(term.count());
        if by_place(term) {
            of_term.for_each(drop);
        } else {
            kept.0.push(term.clone());
            kept.1.extend(of_term);
        }
    }
    kept
}

/// The rows of a set: from every moving interval where the effort is measured, else from coasting.
pub fn rows(
    context: &Context<'_>,
    runs: &[Run],
    cut: &[Vec<Interval>],
    measured: bool,
    model: (&[Term], &[f64]),
    recognised: Recognised,
) -> Vec<Row> {
    let zero: Vec<Vec<bool>> = if measured {
        Vec::new()
    } else {
        let (terms, betas) = beyond_places(model);
        let driven = |(run, intervals): (&Run, &Vec<Interval>)| {
            let extra = Extra {
                all: extra(context, run, intervals, model),
                beyond_places: extra(context, run, intervals, (&terms, &betas)),
            };
            let line = context.believed.line(run.direction);
            Driven::new(line, intervals, &extra, recognised)
        };
        coasted(&runs.iter().zip(cut).map(driven).collect::<Vec<_>>())
    };
    let effort = |run: usize, i: usize| {
        if measured { cut[run][i].effort_n_per_kg } else { zero[run][i].then_some(0.0) }
    };
    let of_run = |(index, run): (usize, &Run)| {
        let line = context.believed.line(run.direction);
        let intervals = cut[index].iter().enumerate();
        intervals.filter_map(|(i, interval)| Row::new(line, interval, Some(effort(index, i)?))).collect::<Vec<_>>()
    };
    runs.iter().enumerate().flat_map(of_run).collect()
}

/// The effort of each interval: measured, or what the model says it takes.
fn efforts(
    context: &Context<'_>,
    run: &Run,
    intervals: &[Interval],
    measured: bool,
    model: (&[Term], &[f64]),
) -> Vec<Option<f64>> {
    let line = context.believed.line(run.direction);
    // What a table was found from ends somewhere; beyond it is a guess, and no ground for judging the traction.
    let within = |interval: &Interval| model.0.iter().all(|term| term.covers(interval));
    let extra = extra(context, run, intervals, model);
    intervals
        .iter()
        .zip(extra)
        .map(|(interval, extra)| {
            if measured {
                interval.effort_n_per_kg.filter(|_| interval.effort_change_n_per_kg < 0.05)
            } else {
                let load = super::rows::believed_load(line, interval) + extra;
                within(interval).then(|| interval.acceleration_mps2() + load)
            }
        })
        .collect()
}

/// Steady pulls of each run, and all that it gives where the power limits.
pub fn traction_of(
    context: &Context<'_>,
    runs: &[Run],
    cut: &[Vec<Interval>],
    measured: bool,
    readings: &Readings,
    model: (&[Term], &[f64]),
    calibrated: &Calibrated,
) -> (Vec<Vec<Pull>>, Vec<Vec<Reading>>) {
    let believed = &context.believed;
    let sd = if measured {
        0.0
    } else {
        // The noise was found where coasting was recognised, and there it is at its smallest.
        calculated_n_per_kg(calibrated).max(rounded_n_per_kg(runs, readings))
    };
    let of_run = |(index, (intervals, run)): (usize, (&Vec<Interval>, &Run))| {
        let effort = || efforts(context, run, intervals, measured, model);
        if !measured {
            let effort = effort();
            let given = calculated(believed.train(), intervals, &effort, sd);
            return (pulls(believed, run.direction, intervals, &effort, sd), given);
        }
        let sampled = readings.effort == EffortReading::Momentary || usual_step_s(run) < FAST_S;
        let pulls = if sampled {
            sampled_pulls(believed, index, run, readings)
        } else {
            pulls(believed, run.direction, intervals, &effort(), sd)
        };
        (pulls, traction(believed, run, readings))
    };
    cut.iter().zip(runs).enumerate().map(of_run).unzip()
}
