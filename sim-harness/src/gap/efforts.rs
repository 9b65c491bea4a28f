//! The effort of each interval: measured, known to be zero in coasting, or what the model says it takes; and so the rows and the pulls of a set.

use super::calibrate::Calibrated;
use super::caps::{Pull, pulls, sampled_pulls};
use super::coasting::coasted;
use super::fit::median;
use super::rows::Row;
use super::runs::{EffortReading, Interval, Readings, Run, intervals, usual_step_s};
use super::terms::{Context, Term};

/// Share of moving samples with an effort above which the effort counts as measured.
const MEASURED_SHARE: f64 = 0.7;
/// Standard deviation of a calculated effort for speeds rounded to 1 km/h, 10 s apart, N/kg.
const ROUNDED_N_PER_KG: f64 = 0.0115;
/// The range in which the one that was found is believed, N/kg.
const RECOGNISED_N_PER_KG: (f64, f64) = (0.006, 0.03);
/// Logs with less between samples are fast, s.
const FAST_S: f64 = 3.0;

/// How sure a calculated effort is in which coasting is to be recognised.
#[derive(Clone, Copy, Debug)]
pub struct Recognised {
    noise_n_per_kg: f64,
    uncertain: f64,
}

impl Recognised {
    /// With the noise that was found, if one was.
    pub fn new(runs: &[Run], found: Option<&Calibrated>, uncertain: f64) -> Self {
        // Speeds of a fast log are means of several readings.
        let fast = median(runs.iter().map(usual_step_s)).is_some_and(|step_s| step_s < FAST_S);
        let at_first = if fast { 0.7 } else { 1.0 } * ROUNDED_N_PER_KG;
        let of_readings = |found: &Calibrated| {
            let acceleration = 1.44 * found.noise.reading_mps / 10.0;
            let (least, most) = RECOGNISED_N_PER_KG;
            acceleration
                .hypot(found.noise.acceleration_mps2)
                .clamp(least, most)
        };
        Self {
            noise_n_per_kg: found.map_or(at_first, of_readings),
            uncertain,
        }
    }
}

/// Whether the effort counts as measured.
pub fn measured(runs: &[Run]) -> bool {
    let moving = || {
        runs.iter()
            .flat_map(|run| &run.samples)
            .filter(|s| s.speed_mps.is_some_and(|v| v > 1.0))
    };
    let with = moving().filter(|s| s.effort_n_per_kg.is_some()).count();
    with as f64 > MEASURED_SHARE * moving().count() as f64 && with > 0
}

/// The reading under which the residuals are smaller.
pub fn effort_reading(context: &Context<'_>, runs: &[Run], readings: &Readings) -> EffortReading {
    let spread = |effort| {
        let readings = Readings {
            effort,
            ..*readings
        };
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
fn extra(
    context: &Context<'_>,
    run: &Run,
    intervals: &[Interval],
    (model, beta): (&[Term], &[f64]),
) -> Vec<f64> {
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

/// The rows of a set: from every moving interval where the effort is measured, else from coasting.
pub fn rows(
    context: &Context<'_>,
    runs: &[Run],
    cut: &[Vec<Interval>],
    measured: bool,
    model: (&[Term], &[f64]),
    recognised: Recognised,
) -> Vec<Row> {
    let mut rows = Vec::new();
    for (run, intervals) in runs.iter().zip(cut) {
        let line = context.believed.line(run.direction);
        if measured {
            rows.extend(
                intervals
                    .iter()
                    .filter_map(|i| Row::new(line, i, i.effort_n_per_kg)),
            );
        } else {
            let extra = extra(context, run, intervals, model);
            let coasts = coasted(
                &context.believed,
                run.direction,
                intervals,
                &extra,
                recognised.noise_n_per_kg,
                recognised.uncertain,
            );
            rows.extend(
                intervals
                    .iter()
                    .zip(coasts)
                    .filter(|(_, coasts)| *coasts)
                    .filter_map(|(i, _)| Row::new(line, i, Some(0.0))),
            );
        }
    }
    rows
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
                interval
                    .effort_n_per_kg
                    .filter(|_| interval.effort_change_n_per_kg < 0.05)
            } else {
                let load = super::rows::believed_load(line, interval) + extra;
                within(interval).then(|| interval.acceleration_mps2() + load)
            }
        })
        .collect()
}

/// The pulls of each run.
pub fn pulls_of(
    context: &Context<'_>,
    runs: &[Run],
    cut: &[Vec<Interval>],
    measured: bool,
    readings: &Readings,
    model: (&[Term], &[f64]),
    calibrated: &Calibrated,
) -> Vec<Vec<Pull>> {
    let sd = if measured {
        0.0
    } else {
        1.5 * calibrated.noise.reading_mps / 10.0
    };
    cut.iter()
        .zip(runs)
        .enumerate()
        .map(|(index, (intervals, run))| {
            if measured
                && (readings.effort == EffortReading::Momentary || usual_step_s(run) < FAST_S)
            {
                return sampled_pulls(&context.believed, index, run, readings);
            }
            let effort = efforts(context, run, intervals, measured, model);
            pulls(&context.believed, run.direction, intervals, &effort, sd)
        })
        .collect()
}
