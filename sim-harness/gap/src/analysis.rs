//! From runs put right to the missing effects: intervals, rounds of calibrating and selecting terms, what they leave.

use crate::candidate::{Fitted, Shape, Term};
use crate::candidates::dragging_brake;
use crate::config::TractionConfig;
use crate::data::believed::{Conditions, Context};
use crate::data::runs::{EffortReading, Run, without_gain};
use crate::data::{cut, interval::Interval, rows::Row};
use crate::efforts::{Looked, measured};
use crate::findings::{BetweenRuns, Findings};
use crate::levels::{columns, standouts};
use crate::noise::calibrate::{Calibrated, calibrate, calibrate_beside, flexible};
use crate::noise::dragging::dragging;
use crate::noise::{gradient_errors, habits};
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

/// The intervals of runs and the terms that explain them, before it is known which of these are no more than chance.
pub struct Selected {
    cut: Vec<Vec<Interval>>,
    measured: bool,
    model: Model,
}

impl Selected {
    /// Leaves out terms of the model that are no more than chance.
    pub fn leave_out(&mut self, chance: &[Term]) {
        self.model.terms.retain(|term| !chance.contains(term));
    }
}

/// Selects the terms of runs with efforts that are read so. `None`: they do not fit.
pub fn selected(given: &Context<'_>, runs: &[Run], effort: EffortReading) -> Option<Selected> {
    let measured = measured(runs, &given.config.effort);
    let context = &Context { conditions: Conditions::of(runs), ..*given };
    let cut = cut::all(context, runs, effort);
    let model = model(context, runs, &cut, effort, measured)?;
    Some(Selected { cut, measured, model })
}

/// Analyses runs against the believed model, with the terms that were selected of them. `None` if there is nothing to
/// analyse: no run has enough of location and speed.
pub fn analyse(given: &Context<'_>, runs: &[Run], effort: EffortReading, selected: &Selected) -> Option<Findings> {
    let config = given.config;
    let kinematics = Kinematics::of(runs);
    let context = &Context { conditions: Conditions::of(runs), ..*given };
    let Selected { cut, measured, model: Model { terms, beta, last } } = selected;
    let measured = *measured;
    if last.is_none() && kinematics.runs == 0 {
        return None;
    }
    // Without rows forces cannot be evaluated; wheels and locations can.
    let has_rows = last.is_some();
    let (mut rows, calibrated) = last.clone().unwrap_or_default();
    let searched = (has_rows && measured).then(|| Search::new(context, &rows, &calibrated, measured));
    // What is left out is explained by the others.
    let beta = match &searched {
        Some(search) => expanded(terms, search.base(terms)?.beta.as_slice()),
        None => beta.clone(),
    };
    let gain = searched.as_ref().and_then(|search| search.effort_gain(terms));
    let gain_may_be_mass = searched.zip(gain).is_some_and(|(search, gain)| search.may_be_mass(terms, gain));
    let (righted, recut);
    let (mut runs, mut cut) = (runs, cut.as_slice());
    if let Some(gain) = gain {
        rows = rows.into_iter().map(|row| row.without_gain(gain.value)).collect();
        righted = without_gain(runs, gain.value);
        recut = cut::all(context, &righted, effort);
        (runs, cut) = (&righted, &recut);
    }
    let (fitted, headwind) = if has_rows {
        let search = Search::new(context, &rows, &calibrated, measured);
        (fitted(&search, terms), headwind(&search, terms))
    } else {
        (Vec::new(), None)
    };
    let differing =
        if has_rows { between_runs(context, &rows, measured, &fitted, runs) } else { BetweenRuns::default() };
    let looked = Looked { context, runs, cut, effort, measured, model: (terms, &beta) };
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
        gain_may_be_mass,
        powering,
        differing,
        headwind,
        rows,
        calibrated,
        conditions: context.conditions,
    })
}

/// By what runs differ from each other.
fn between_runs(context: &Context<'_>, rows: &[Row], measured: bool, fitted: &[Fitted], runs: &[Run]) -> BetweenRuns {
    // Beside the same model, which was not known when the noise was found.
    let terms: Vec<Term> = fitted.iter().map(|fitted| fitted.term.clone()).collect();
    // Momentary efforts say little of braking: with the noise of coasting its errors would be winds.
    let wider = if measured { habits::wider(rows, &context.config.evidence) } else { vec![1.0; rows.len()] };
    let beside = |wind: bool, differing: Vec<Vec<f64>>| {
        let known = flexible(context, rows, &terms).into_iter().chain(differing);
        calibrate_beside(context, (rows, wider.clone()), measured, wind, known.collect())
    };
    let (standouts, not_compared) = standouts(context, rows, |differing| beside(true, differing).0, fitted, runs);
    let differing = columns(&standouts, context, rows, runs);
    let ((with, reached), (_, without)) = (beside(true, differing.clone()), beside(false, differing));
    BetweenRuns { wind_mps: with.own.wind_mps, wind_gain: reached - without, standouts, not_compared }
}

/// The rows of coasting of runs without an effort column.
pub fn coasts(context: &Context<'_>, runs: &[Run]) -> Option<Vec<Row>> {
    let effort = EffortReading::default();
    let cut = cut::all(context, runs, effort);
    model(context, runs, &cut, effort, false)?.last.map(|(rows, _)| rows)
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
        calibrated.gradients = gradient_errors::errors(context, &rows, &calibrated);
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

/// Rows and powering phases of other runs, as the findings would have them: for judging on hold-out runs. `context`:
/// that of the findings.
pub fn apply(context: &Context<'_>, findings: &Findings, runs: &[Run]) -> (Vec<Row>, Vec<Vec<SteadyPower>>) {
    let righted = without_gain(runs, findings.gain.map_or(0.0, |gain| gain.value));
    let runs = &righted;
    let cut = cut::all(context, runs, findings.effort);
    let terms: Vec<Term> = findings.terms.iter().map(|fitted| fitted.term.clone()).collect();
    let of_term = |fitted: &Fitted| match fitted.term.is_whole() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::GapConfig;
    use crate::data::believed::tests::on_a_level_line;
    use crate::data::runs::Recorded;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::direction::Direction;

    const RUNS: usize = 32;

    /// Of 32 runs of four units on eight days, up and down, that coast from 40 to 15 m/s: unit 3 has a share more
    /// resistance, and each run a wind of its own, m/s.
    fn differing(more: f64, wind_sd_mps: f64, seed: u64) -> BetweenRuns {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let run = |run: usize| Run {
            name: run.to_string(),
            direction: [Direction::Up, Direction::Down][(run / 4 + run) % 2],
            day: Some((run / 4) as f64 + 0.4),
            samples: Vec::new(),
            recorded: Recorded { unit: format!("u{}", run % 4), ..Recorded::default() },
        };
        let runs: Vec<Run> = (0..RUNS).map(run).collect();
        on_a_level_line(RUNS, |context| {
            let davis = context.believed.train().davis();
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let mut rows = Vec::new();
            for (index, run) in runs.iter().enumerate() {
                let wind_mps = wind_sd_mps * normal();
                for i in 0..50 {
                    let speed_mps = 40.0 - 0.5 * f64::from(i);
                    let mut row = Row::coasting(run.direction, 1_000.0 * f64::from(i), speed_mps);
                    row.interval.run = index;
                    row.interval.day = run.day;
                    let of_unit = if index % 4 == 3 { more * davis.resistance_n_per_kg(speed_mps) } else { 0.0 };
                    let of_wind = davis.r2 * ((speed_mps + wind_mps).powi(2) - speed_mps * speed_mps);
                    row.residual_n_per_kg = 0.002 * normal() + of_unit + of_wind;
                    rows.push(row);
                }
            }
            between_runs(context, &rows, true, &[], &runs)
        })
    }

    #[test]
    fn a_unit_that_has_more_resistance_is_no_wind_of_its_runs() {
        for seed in 0..3 {
            let found = differing(0.15, 0.0, seed);
            let units: Vec<&str> = found.standouts.iter().map(|one| one.of.as_str()).collect();
            assert_eq!(units, ["u3"]);
            assert!((found.standouts[0].share.value - 0.15).abs() < 0.03, "{found:?}");
            assert!(found.wind_gain < GapConfig::default().between_runs.wind_gain, "{found:?}");
        }
    }

    #[test]
    fn what_braking_scatters_is_no_wind() {
        let with_gain = |own_sd: f64, braking_sd: f64, seed: u64| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let runs = vec![Run::default(); RUNS];
            on_a_level_line(RUNS, |context| {
                let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
                let mut rows = Vec::new();
                for run in 0..RUNS {
                    let own = own_sd * normal();
                    for i in 0..40 {
                        let braking = i >= 30;
                        let mut row = Row::coasting(Direction::Up, 1_000.0 * f64::from(i), 40.0 - 0.5 * f64::from(i));
                        row.interval.run = run;
                        row.interval.day = Some(run as f64);
                        row.effort_n_per_kg = if braking { -0.3 } else { 0.0 };
                        row.interval.effort_n_per_kg = Some(row.effort_n_per_kg);
                        row.residual_n_per_kg = if braking { own + braking_sd * normal() } else { 0.002 * normal() };
                        rows.push(row);
                    }
                }
                between_runs(context, &rows, true, &[], &runs).wind_gain
            })
        };
        for seed in 0..3 {
            let gain = with_gain(0.01, 0.01, seed);
            assert!(gain < GapConfig::default().between_runs.wind_gain, "{seed}: {gain}");
        }
    }

    #[test]
    fn winds_stay_what_they_are_beside_units() {
        for seed in 0..3 {
            let found = differing(0.0, 4.0, seed);
            assert!(found.wind_gain > GapConfig::default().between_runs.wind_gain, "{found:?}");
            assert!((found.wind_mps / 4.0 - 1.0).abs() < 0.4, "{found:?}");
        }
    }
}
