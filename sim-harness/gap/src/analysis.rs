//! From recorded runs to the missing effects: the order of the steps, and nothing else.

use crate::candidate::{Shape, Term};
use crate::candidates::dragging_brake;
use crate::config::TractionConfig;
use crate::data::believed::{Conditions, Context};
use crate::data::runs::{EffortReading, Run, without_gain};
use crate::data::{cut, interval::Interval, rows::Row};
use crate::efforts::{Looked, measured};
use crate::findings::Findings;
use crate::noise::calibrate::{Calibrated, calibrate};
use crate::noise::dragging::dragging;
use crate::readings::kinematics::Kinematics;
use crate::search::{fits::Search, fitting::fitted, headwind::headwind};
use crate::traction::{hypotheses::limits, powering::SteadyPower};

/// What rounds of recognising coasting, calibrating and selecting come to.
struct Model {
    terms: Vec<Term>,
    /// All coefficients, those of whole terms included.
    beta: Vec<f64>,
    /// The last rows with their noise; none: too few.
    last: Option<(Vec<Row>, Calibrated)>,
}

/// Analyses runs against the believed model, with efforts that are read so. `None` if there is nothing to analyse: no run has enough of location and speed.
pub fn analyse(given: &Context<'_>, runs: &[Run], effort: EffortReading) -> Option<Findings> {
    let config = given.config;
    let kinematics = Kinematics::of(runs);
    let measured = measured(runs, &config.effort);
    let context = &Context { conditions: Conditions::of(runs), ..*given };
    let cut = cut::all(context, runs, effort);
    let Model { terms, beta, last } = model(context, runs, &cut, effort, measured)?;
    if last.is_none() && kinematics.runs == 0 {
        return None;
    }
    // Without rows forces cannot be evaluated; wheels and locations can.
    let has_rows = last.is_some();
    let (mut rows, calibrated) = last.unwrap_or_default();
    let searched = (has_rows && measured).then(|| Search::new(context, &rows, &calibrated, measured));
    let gain = searched.and_then(|search| search.effort_gain(&terms));
    let (righted, recut);
    let (mut runs, mut cut) = (runs, cut.as_slice());
    if let Some(gain) = gain {
        rows = rows.into_iter().map(|row| row.without_gain(gain.value)).collect();
        righted = without_gain(runs, gain.value);
        recut = cut::all(context, &righted, effort);
        (runs, cut) = (&righted, &recut);
    }
    let (fitted, wind_gain, headwind) = if has_rows {
        // Beside the same model, which was not known when the noise was found.
        let reached = |wind| calibrate(context, &rows, measured, wind, &terms).1;
        let wind_gain = reached(true) - reached(false);
        let search = Search::new(context, &rows, &calibrated, measured);
        (fitted(&search, &terms), wind_gain, headwind(&search, &terms))
    } else {
        (Vec::new(), 0.0, None)
    };
    let looked = Looked { context, runs, cut, effort, measured, model: (&terms, &beta) };
    let (powering, traction) = looked.traction(&calibrated);
    // What is not known of the gain of the effort is no finding of a limit.
    let least_scale = gain.map_or(0.0, |gain| config.nuisance.sure * gain.sd).max(config.traction.least_scale);
    let traction_config = TractionConfig { least_scale, ..config.traction.clone() };
    let moves = |interval: &&Interval| interval.mean_speed_mps() > config.interval.slowest_mps;
    Some(Findings {
        kinematics,
        effort,
        measured,
        moving: cut.iter().flatten().filter(moves).count(),
        terms: fitted,
        limits: limits(&powering, &traction, &traction_config, &context.penalty()),
        gain,
        powering,
        wind_gain,
        headwind,
        rows,
        calibrated,
        conditions: context.conditions,
    })
}

/// With an effort column one round; without, the model shows where trains coast, and coasting the model.
fn model(
    context: &Context<'_>,
    runs: &[Run],
    cut: &[Vec<Interval>],
    effort: EffortReading,
    measured: bool,
) -> Option<Model> {
    let config = context.config;
    let uncertain = &config.coasting.uncertain;
    let rounds = if measured { 1 } else { uncertain.len() };
    let mut found = Model { terms: Vec::new(), beta: Vec::new(), last: None };
    for uncertain in uncertain.iter().take(rounds) {
        let known = found.last.as_ref().filter(|(rows, _)| rows.len() >= config.search.few_rows);
        let looked = Looked { context, runs, cut, effort, measured, model: (&found.terms, &found.beta) };
        let rows = looked.rows(known.map(|(_, found)| found), *uncertain);
        if rows.len() < config.search.least_rows {
            break;
        }
        let (mut calibrated, _) = calibrate(context, &rows, measured, true, &found.terms);
        let drags = |term: &Term| matches!(term.shape, Shape::Runs(_));
        if !found.terms.iter().any(drags)
            && let Some(runs) = dragging(context, &rows, &calibrated, &found.terms)
        {
            let drags = Term { of: &dragging_brake::This, shape: Shape::Runs(runs) };
            let with: Vec<Term> = found.terms.iter().cloned().chain([drags]).collect();
            (calibrated, _) = calibrate(context, &rows, measured, true, &with);
        }
        let search = Search::new(context, &rows, &calibrated, measured);
        // So few rows would fit anything; limits can be evaluated nevertheless.
        found.terms = if rows.len() < config.search.few_rows { Vec::new() } else { search.select() };
        let base = search.base(&found.terms)?;
        found.beta = expanded(&found.terms, base.beta.as_slice());
        drop(search);
        found.last = Some((rows, calibrated));
    }
    Some(found)
}

/// Rows and powering phases of other runs, as the findings would have them: for judging on hold-out runs. `context`: that of the findings.
pub fn apply(context: &Context<'_>, findings: &Findings, runs: &[Run]) -> (Vec<Row>, Vec<Vec<SteadyPower>>) {
    let righted = without_gain(runs, findings.gain.map_or(0.0, |gain| gain.value));
    let runs = &righted;
    let cut = cut::all(context, runs, findings.effort);
    let terms: Vec<Term> = findings.terms.iter().map(|fitted| fitted.term.clone()).collect();
    let of_term = |fitted: &crate::candidate::Fitted| match fitted.term.is_whole() {
        true => vec![1.0],
        false => fitted.beta.clone(),
    };
    let beta: Vec<f64> = findings.terms.iter().flat_map(of_term).collect();
    let Findings { effort, measured, calibrated, .. } = findings;
    let looked = Looked { context, runs, cut: &cut, effort: *effort, measured: *measured, model: (&terms, &beta) };
    let uncertain = context.config.coasting.uncertain.last().copied().unwrap_or(0.0);
    (looked.rows(Some(calibrated), uncertain), looked.traction(calibrated).0)
}

/// Coefficients with those of whole terms put in their places.
fn expanded(model: &[Term], free: &[f64]) -> Vec<f64> {
    let mut free = free.iter();
    let mut beta = Vec::new();
    for term in model {
        if term.is_whole() {
            beta.push(1.0);
        } else {
            beta.extend(free.by_ref().take(term.count()));
        }
    }
    beta
}
