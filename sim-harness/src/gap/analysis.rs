//! From recorded runs to the missing effects: the order of the steps, and nothing else.

use super::calibrate::{Calibrated, calibrate};
use super::caps::{FoundLimit, Pull, limits, pulls, sampled_pulls};
use super::coasting::coasted;
use super::dragging::dragging;
use super::fit::{TWO_SIDED, median};
use super::kinematics::{Kinematics, kinematics};
use super::rows::{Believed, Row, SLOWEST_MPS};
use super::runs::{EffortReading, Interval, Readings, Run, intervals, usual_step_s};
use super::select::{ENOUGH, Found, Search, SectionLimits, unnamed};
use super::shape;
use super::terms::{Context, Term};

/// What may be known of a line beyond its gradients.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// Length of the line, m.
    pub length_m: f64,
    /// Curves: (from, to, Röckl's number), m, N/N.
    pub curves: Vec<(f64, f64, f64)>,
    /// Tunnels: (from, to), m.
    pub tunnels: Vec<(f64, f64)>,
    /// Feeding sections: (from, to), m.
    pub feeding: Vec<(f64, f64)>,
    /// Platforms, m.
    pub stops: Vec<f64>,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Findings {
    /// Speed against location.
    pub kinematics: Kinematics,
    /// How the readings are corrected.
    pub readings: Readings,
    /// With an effort column.
    pub measured: bool,
    /// Intervals in which a train moved.
    pub moving: usize,
    /// Rows that counted.
    pub rows: Vec<Row>,
    /// Their noise.
    pub calibrated: Calibrated,
    /// Missing terms of the resistance, with their coefficients.
    pub terms: Vec<Fitted>,
    /// Limits of the traction that are not as believed.
    pub limit: Option<FoundLimit>,
    /// Intervals of steady power from which the limits were judged, run by run.
    pub pulls: Vec<Vec<Pull>>,
    /// Gain of log-likelihood of a wind of its own in each run, over other differences between runs.
    pub wind_gain: f64,
    /// The believed r2, N/(kg (m/s)²).
    pub believed_r2: f64,
    /// g/γ of the believed train, N/kg.
    pub gravity_n_per_kg: f64,
    /// Believed length of the train, m.
    pub length_m: f64,
    /// Mean temperature of the rows, °C.
    pub temperature_c: f64,
    /// Day of the first run, since 1970-01-01.
    pub first_day: f64,
    /// Days from the first to the last run.
    pub period_days: f64,
}

/// Rows below this are no ground for a term.
pub const FEW_ROWS: usize = 120;

/// A term with its coefficients.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The term.
    pub term: Term,
    /// Its coefficients.
    pub beta: Vec<f64>,
    /// Their standard deviations: the larger of noise model and spread between runs, and what sensors may do in all runs alike.
    pub sd: Vec<f64>,
    /// Log-likelihood that would be lost without it.
    pub gain: f64,
    /// Limits of a section.
    pub section: Option<SectionLimits>,
    /// Limits of a shape that is a number.
    pub shape: Option<shape::Limits>,
    /// Others that would do nearly as well in its place, with how much worse they are.
    pub rivals: Vec<(Term, f64)>,
}

/// A law is as good as this share of its coefficient, whatever the noise: means over 10 s, the path between readings.
const LAW: f64 = 0.01;
/// A rival within this of a term cannot be told apart from it.
const NEAR: f64 = 3.0;
/// Share of moving samples with an effort above which the effort counts as measured.
const MEASURED_SHARE: f64 = 0.7;
/// Deviation of the resistance from its description within which coasting is still recognised: wide at first.
const UNCERTAIN: [f64; 3] = [0.3, 0.15, 0.1];
/// Standard deviation of a calculated effort for speeds rounded to 1 km/h, 10 s apart, and its range, N/kg. Logs with less between samples are fast, s.
const ROUNDED_N_PER_KG: f64 = 0.0115;
const FAST_S: f64 = 3.0;
const RECOGNISED_N_PER_KG: (f64, f64) = (0.006, 0.03);

/// How sure a calculated effort is in which coasting is to be recognised.
#[derive(Clone, Copy, Debug)]
struct Recognised {
    noise_n_per_kg: f64,
    uncertain: f64,
}

impl Recognised {
    /// With the noise that was found, if one was.
    fn new(runs: &[Run], found: Option<&Calibrated>, uncertain: f64) -> Self {
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

/// Gain of log-likelihood above which runs have a wind of their own, over other differences between runs.
const WIND_GAIN: f64 = 9.0;
/// The least standard deviation of the wind that matters, m/s.
pub const LEAST_WIND_MPS: f64 = 0.8;

impl Findings {
    /// Runs differ in their wind.
    pub fn run_wind(&self) -> bool {
        self.wind_gain > WIND_GAIN && self.calibrated.own.wind_mps > LEAST_WIND_MPS
    }
}

/// Analyses runs against the believed model. `None` if there is nothing to analyse: no run has enough of location and speed.
pub fn analyse(
    believed: Believed<'_>,
    surroundings: &Surroundings,
    runs: &[Run],
    mut story: impl FnMut(&str),
) -> Option<Findings> {
    let kinematics = kinematics(runs);
    let mut readings = kinematics.readings();
    let measured = measured(runs);
    let days = || runs.iter().filter_map(|run| run.day);
    let first_day = days().fold(f64::INFINITY, f64::min).min(1e6);
    let period_days = (days().fold(0.0, f64::max) - first_day).max(0.0);
    let temperatures = || {
        runs.iter()
            .flat_map(|run| run.samples.iter().filter_map(|s| s.temperature_c))
    };
    let temperature_c = temperatures().sum::<f64>() / temperatures().count().max(1) as f64;
    let context = Context {
        believed,
        curves: &surroundings.curves,
        temperature_c,
        first_day,
        period_days,
    };
    if measured {
        readings.effort = effort_reading(&context, runs, &readings);
        story(&format!("effort column read as {:?}", readings.effort));
    }
    let cut: Vec<Vec<Interval>> = runs
        .iter()
        .enumerate()
        .map(|(i, run)| intervals(i, run, believed.line(run.direction), &readings))
        .collect();
    let rounds = if measured { 1 } else { UNCERTAIN.len() };
    let mut model: Vec<Term> = Vec::new();
    let mut beta: Vec<f64> = Vec::new();
    let mut last: Option<(Vec<Row>, Calibrated, f64)> = None;
    for uncertain in UNCERTAIN.iter().take(rounds) {
        let known = last.as_ref().filter(|(rows, ..)| rows.len() >= FEW_ROWS);
        let recognised = Recognised::new(runs, known.map(|(_, found, _)| found), *uncertain);
        let rows = rows(&context, runs, &cut, measured, (&model, &beta), recognised);
        if rows.len() < 30 {
            break;
        }
        let (mut calibrated, mut likelihood) = calibrate(&context, &rows, measured, true, &model);
        if let Some(drags) = dragging(&context, &rows, &calibrated, &model) {
            let with: Vec<Term> = model.iter().cloned().chain([drags]).collect();
            (calibrated, likelihood) = calibrate(&context, &rows, measured, true, &with);
        }
        let search = Search::new(&context, &rows, &calibrated, measured);
        // So few rows would fit anything; limits can be judged nevertheless.
        model = if rows.len() < FEW_ROWS {
            Vec::new()
        } else {
            search.select()
        };
        let base = search.base(&model)?;
        beta = expanded(&model, base.beta.as_slice());
        last = Some((rows, calibrated, likelihood));
    }
    // Without rows forces cannot be judged; wheels and locations can.
    let judged = last.is_some();
    let (rows, calibrated, likelihood) = last.unwrap_or_default();
    let (terms, without_wind) = if judged {
        let (_, without_wind) = calibrate(&context, &rows, measured, false, &model);
        let search = Search::new(&context, &rows, &calibrated, measured);
        (fitted(&search, &model), without_wind)
    } else if kinematics.runs > 0 {
        (Vec::new(), likelihood)
    } else {
        return None;
    };
    let of_runs = pulls_of(
        &context,
        runs,
        &cut,
        measured,
        &readings,
        (&model, &beta),
        &calibrated,
    );
    let limit = limits(&of_runs)
        .into_iter()
        .next()
        .filter(|l| l.value > ENOUGH);
    Some(Findings {
        kinematics,
        readings,
        measured,
        moving: cut
            .iter()
            .flatten()
            .filter(|i| i.mean_speed_mps() > SLOWEST_MPS)
            .count(),
        terms,
        limit,
        pulls: of_runs,
        wind_gain: likelihood - without_wind,
        believed_r2: believed.train().davis().r2,
        gravity_n_per_kg: believed.train().gravity_n_per_kg(),
        length_m: believed.train().length_m(),
        rows,
        calibrated,
        temperature_c,
        first_day,
        period_days,
    })
}

fn pulls_of(
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
            if measured && (readings.effort == EffortReading::Momentary || usual_step_s(run) < 3.0)
            {
                return sampled_pulls(&context.believed, index, run, readings);
            }
            let effort = efforts(context, run, intervals, measured, model);
            pulls(&context.believed, run.direction, intervals, &effort, sd)
        })
        .collect()
}

/// Rows and pulls of other runs, as the findings would have them: for judging on runs that took no part.
pub fn apply(
    believed: Believed<'_>,
    surroundings: &Surroundings,
    findings: &Findings,
    runs: &[Run],
) -> (Vec<Row>, Vec<Vec<Pull>>) {
    let context = Context {
        believed,
        curves: &surroundings.curves,
        temperature_c: findings.temperature_c,
        first_day: findings.first_day,
        period_days: findings.period_days,
    };
    let cut: Vec<Vec<Interval>> = runs
        .iter()
        .enumerate()
        .map(|(i, run)| intervals(i, run, believed.line(run.direction), &findings.readings))
        .collect();
    let model: Vec<Term> = findings
        .terms
        .iter()
        .map(|fitted| fitted.term.clone())
        .collect();
    let beta: Vec<f64> = findings
        .terms
        .iter()
        .flat_map(|fitted| match fitted.term {
            Term::Length(_) => vec![1.0],
            _ => fitted.beta.clone(),
        })
        .collect();
    let model = (model.as_slice(), beta.as_slice());
    let recognised = Recognised::new(
        runs,
        Some(&findings.calibrated),
        UNCERTAIN[UNCERTAIN.len() - 1],
    );
    let rows = rows(&context, runs, &cut, findings.measured, model, recognised);
    let pulls = pulls_of(
        &context,
        runs,
        &cut,
        findings.measured,
        &findings.readings,
        model,
        &findings.calibrated,
    );
    (rows, pulls)
}

/// Coefficients with the fixed one of [`Term::Length`] put in its place.
fn expanded(model: &[Term], free: &[f64]) -> Vec<f64> {
    let mut free = free.iter();
    let mut beta = Vec::new();
    for term in model {
        match term {
            Term::Length(_) => beta.push(1.0),
            other => beta.extend(free.by_ref().take(other.count())),
        }
    }
    beta
}

fn measured(runs: &[Run]) -> bool {
    let moving = || {
        runs.iter()
            .flat_map(|run| &run.samples)
            .filter(|s| s.speed_mps.is_some_and(|v| v > 1.0))
    };
    let with = moving().filter(|s| s.effort_n_per_kg.is_some()).count();
    with as f64 > MEASURED_SHARE * moving().count() as f64 && with > 0
}

/// The reading under which the residuals are smaller.
fn effort_reading(context: &Context<'_>, runs: &[Run], readings: &Readings) -> EffortReading {
    let spread = |effort| {
        let readings = Readings {
            effort,
            ..*readings
        };
        let mut residuals: Vec<f64> = runs
            .iter()
            .enumerate()
            .flat_map(|(i, run)| {
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
            })
            .collect();
        residuals.sort_by(f64::total_cmp);
        residuals.get(residuals.len() / 2).copied().unwrap_or(0.0)
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

fn rows(
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

/// Each term of the model with its coefficients, what it brings beside the others, and who would do as well.
fn fitted(search: &Search<'_>, model: &[Term]) -> Vec<Fitted> {
    let Some(base) = search.base(model) else {
        return Vec::new();
    };
    let score = search.score(model);
    let (naive, robust) = (base.naive(), base.robust());
    let mut place = 0;
    let mut fitted = Vec::new();
    for (index, term) in model.iter().enumerate() {
        let count = if matches!(term, Term::Length(_)) {
            0
        } else {
            term.count()
        };
        let range = place..place + count;
        place += count;
        let mut others = model.to_vec();
        others.remove(index);
        let (same, rivals): (Vec<Found>, Vec<Found>) =
            search.candidates(&others).into_iter().partition(|found| {
                core::mem::discriminant(&found.term) == core::mem::discriminant(term)
            });
        let gain = same.first().map_or(0.0, |found| found.gain.gain);
        let rivals = rivals
            .into_iter()
            .filter_map(|found| {
                let mut with = others.clone();
                with.insert(index, found.term.clone());
                let worse = score - search.score(&with) - unnamed(&found.term);
                (worse < NEAR).then_some((found.term, worse))
            })
            .collect();
        let sd: Vec<f64> = range
            .clone()
            .zip(search.systematic(model, index))
            .map(|(i, systematic)| naive[(i, i)].max(robust[(i, i)]).sqrt().hypot(systematic))
            .zip(range.clone())
            .map(|(sd, i)| sd.hypot(LAW * base.beta[i]))
            .collect();
        let half = TWO_SIDED * sd.first().copied().unwrap_or(0.0);
        let beside = search.base(&others);
        let shape = beside.and_then(|beside| shape::limits(&beside, search, term, half));
        let section = search.section(&others, term, half);
        fitted.push(Fitted {
            term: term.clone(),
            beta: range.map(|i| base.beta[i]).collect(),
            sd,
            shape,
            gain,
            section,
            rivals,
        });
    }
    fitted
}
