//! From recorded runs to the missing effects: the order of the steps, and nothing else.

use super::calibrate::{Calibrated, calibrate};
use super::caps::{FoundLimit, Pull, limits};
use super::coasting::Recognised;
use super::dragging::dragging;
use super::efforts::{effort_reading, measured, rows, traction_of};
use super::fit::TWO_SIDED;
use super::fitted::{Fitted, fitted};
use super::kinematics::{Kinematics, kinematics};
use super::rows::{Believed, Row, SLOWEST_MPS};
use super::runs::{Interval, Readings, Run, intervals};
use super::select::{ENOUGH, Search};
use super::separates::Have;
use super::terms::{Context, Term, both_directions};

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
    /// Limits of the traction, the best first.
    pub limits: Vec<FoundLimit>,
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
pub const FEW_ROWS: usize = 80;

/// Deviation of the resistance from its description within which coasting is still recognised: wide at first.
const UNCERTAIN: [f64; 3] = [0.3, 0.15, 0.1];
/// Gain of log-likelihood above which runs have a wind of their own, over other differences between runs.
const WIND_GAIN: f64 = 4.5;
/// Below this gain it may as well be a brake that drags in some of them.
pub const NO_DRAG_GAIN: f64 = 9.0;
/// The wind of a run is not measured without error: the spread is that much less certain than that of as many values.
const WIND_SD: f64 = 1.3;
/// The least standard deviation of the wind that matters, m/s.
pub const LEAST_WIND_MPS: f64 = 0.8;

impl Findings {
    /// Spread of the wind between runs and its standard deviation, m/s, if runs surely differ by more than the wind that there always is.
    pub fn run_wind(&self) -> Option<(f64, f64)> {
        let mut runs: Vec<usize> = self.rows.iter().map(|row| row.interval.run).collect();
        runs.dedup();
        let spread = self.calibrated.own.wind_mps;
        let sd = WIND_SD * spread / (2.0 * runs.len().max(2) as f64).sqrt();
        let sure = self.wind_gain > WIND_GAIN && spread - TWO_SIDED * sd > LEAST_WIND_MPS;
        sure.then_some((spread, sd))
    }

    /// The limit of the traction that is not as believed, if one is worth a name.
    pub fn limit(&self) -> Option<&FoundLimit> {
        self.limits.first().filter(|found| found.value > ENOUGH)
    }

    /// What the data have already that could tell rivals apart.
    pub fn have(&self) -> Have {
        Have { effort: self.measured, both_directions: both_directions(&self.rows) }
    }

    /// What the columns of terms were made from.
    pub fn context<'a>(&self, believed: Believed<'a>, surroundings: &'a Surroundings) -> Context<'a> {
        Context {
            believed,
            curves: &surroundings.curves,
            temperature_c: self.temperature_c,
            first_day: self.first_day,
            period_days: self.period_days,
        }
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
    let temperatures = || runs.iter().flat_map(|run| run.samples.iter().filter_map(|s| s.temperature_c));
    let temperature_c = temperatures().sum::<f64>() / temperatures().count().max(1) as f64;
    let context = Context { believed, curves: &surroundings.curves, temperature_c, first_day, period_days };
    if measured {
        readings.effort = effort_reading(&context, runs, &readings);
        story(&format!("effort column read as {:?}", readings.effort));
    }
    let cut: Vec<Vec<Interval>> =
        runs.iter().enumerate().map(|(i, run)| intervals(i, run, believed.line(run.direction), &readings)).collect();
    let rounds = if measured { 1 } else { UNCERTAIN.len() };
    let mut model: Vec<Term> = Vec::new();
    let mut beta: Vec<f64> = Vec::new();
    let mut last: Option<(Vec<Row>, Calibrated)> = None;
    for uncertain in UNCERTAIN.iter().take(rounds) {
        let known = last.as_ref().filter(|(rows, _)| rows.len() >= FEW_ROWS);
        let recognised = Recognised::new(runs, &readings, known.map(|(_, found)| found), *uncertain);
        let rows = rows(&context, runs, &cut, measured, (&model, &beta), recognised);
        if rows.len() < 30 {
            break;
        }
        let (mut calibrated, _) = calibrate(&context, &rows, measured, true, &model);
        if let Some(drags) = dragging(&context, &rows, &calibrated, &model) {
            let with: Vec<Term> = model.iter().cloned().chain([drags]).collect();
            (calibrated, _) = calibrate(&context, &rows, measured, true, &with);
        }
        let search = Search::new(&context, &rows, &calibrated, measured);
        // So few rows would fit anything; limits can be judged nevertheless.
        model = if rows.len() < FEW_ROWS { Vec::new() } else { search.select() };
        let base = search.base(&model)?;
        beta = expanded(&model, base.beta.as_slice());
        last = Some((rows, calibrated));
    }
    // Without rows forces cannot be judged; wheels and locations can.
    let judged = last.is_some();
    let (rows, calibrated) = last.unwrap_or_default();
    let (terms, wind_gain) = if judged {
        // Beside the same model, which was not known when the noise was found.
        let reached = |wind| calibrate(&context, &rows, measured, wind, &model).1;
        let wind_gain = reached(true) - reached(false);
        let search = Search::new(&context, &rows, &calibrated, measured);
        (fitted(&search, &model), wind_gain)
    } else if kinematics.runs > 0 {
        (Vec::new(), 0.0)
    } else {
        return None;
    };
    let (pulls, traction) = traction_of(&context, runs, &cut, measured, &readings, (&model, &beta), &calibrated);
    Some(Findings {
        kinematics,
        readings,
        measured,
        moving: cut.iter().flatten().filter(|i| i.mean_speed_mps() > SLOWEST_MPS).count(),
        terms,
        limits: limits(&pulls, &traction),
        pulls,
        wind_gain,
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

/// Rows and pulls of other runs, as the findings would have them: for judging on runs that took no part.
pub fn apply(
    believed: Believed<'_>,
    surroundings: &Surroundings,
    findings: &Findings,
    runs: &[Run],
) -> (Vec<Row>, Vec<Vec<Pull>>) {
    let context = findings.context(believed, surroundings);
    let cut: Vec<Vec<Interval>> = runs
        .iter()
        .enumerate()
        .map(|(i, run)| intervals(i, run, believed.line(run.direction), &findings.readings))
        .collect();
    let model: Vec<Term> = findings.terms.iter().map(|fitted| fitted.term.clone()).collect();
    let beta: Vec<f64> = findings
        .terms
        .iter()
        .flat_map(|fitted| match fitted.term {
            Term::Length(_) => vec![1.0],
            _ => fitted.beta.clone(),
        })
        .collect();
    let model = (model.as_slice(), beta.as_slice());
    let recognised =
        Recognised::new(runs, &findings.readings, Some(&findings.calibrated), UNCERTAIN[UNCERTAIN.len() - 1]);
    let rows = rows(&context, runs, &cut, findings.measured, model, recognised);
    let (pulls, _) =
        traction_of(&context, runs, &cut, findings.measured, &findings.readings, model, &findings.calibrated);
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
