//! Which terms are missing: forward selection by penalised gain of log-likelihood, with second thoughts.
//!
//! Each family (one named effect, or a smooth function of one coordinate) offers its best shape beside the current model. Its value is the gain, scaled down
//! where runs differ more than the noise model says, minus what its freedom costs.

use super::calibrate::{Calibrated, knots};
use super::evidence::NOTHING_N_PER_KG;
use super::fit::{Base, Gain, LOSS_AT_LIMIT, TWO_SIDED};
use super::rows::Row;
use super::scan::{Kind, Scan};
use super::shape;
use super::terms::{Context, Coordinate, Side, Term, both_directions, coordinate};
use super::whitening::Whitening;
use nalgebra::DVector;
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

/// A value below this is chance: with some fifteen families a data set without an effect reaches it once in about a hundred.
pub const ENOUGH: f64 = 5.0;
/// A term that brings less than this share of what the model has brought already may be no more than the model's law being a little different: an effect of a twentieth of the size.
const SHADOW: f64 = 0.003;
/// Cost of a free coefficient: half the logarithm of about 67 runs.
const COEFFICIENT: f64 = 2.1;
/// Cost of the freedom to choose a section, or a time constant.
const SECTION: f64 = 5.0;
const SHAPE: f64 = 1.5;
/// What another length must be better by: locations that are off by some metres look like it.
const SHIFT: f64 = 4.0;
/// What an unnamed smooth function must be better by than a named effect.
const UNNAMED: f64 = 4.0;
/// Largest extra resistance over the believed one.
const MOST_SHARE: f64 = 1.5;
/// How well a Davis coefficient is described that is left as it is, as a share of it.
const DESCRIBED: f64 = 0.1;
/// Most values of a coordinate between which steps are tried: each run's, where there are no more.
const STEPS: usize = 100;
/// Half the width of a steep step, of a day or a degree.
pub const STEEP: f64 = 0.02;
/// Knots at even speeds.
const EVEN: usize = 12;
/// Most terms in a model.
const MOST_TERMS: usize = 4;

/// A term with what was found of it.
#[derive(Clone, Debug)]
pub struct Found {
    /// The term, its shape chosen.
    pub term: Term,
    /// What it brings beside the others.
    pub gain: Gain,
    /// `gain` less the cost of its freedom.
    pub value: f64,
}

/// 95 % limits of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionLimits {
    /// Of its edges, m.
    pub edges_m: [(f64, f64); 2],
    /// Of its coefficient.
    pub beta: (f64, f64),
}

/// A family of terms: which shapes there are.
#[derive(Clone, Debug)]
pub enum Family {
    /// Some shapes to try.
    Shapes(Vec<Term>),
    /// A section of the line.
    Section(Box<Scan>),
    /// A length of the train; its coefficient is 1.
    Length,
    /// A steady wind, linearised where it is.
    Wind,
    /// The runs in which a brake drags.
    Dragging,
}

/// All that a search needs.
pub struct Search<'a> {
    context: &'a Context<'a>,
    rows: &'a [Row],
    whitening: Whitening,
    y: DVector<f64>,
    /// Whitened columns of what sensors do; part of every fit.
    sensors: Vec<DVector<f64>>,
    families: Vec<Family>,
    /// Whitened columns of terms that were tried, by their text.
    known: RefCell<HashMap<String, Rc<Vec<DVector<f64>>>>>,
}

impl<'a> Search<'a> {
    /// Prepares the search. `measured`: with an effort column.
    pub fn new(
        context: &'a Context<'a>,
        rows: &'a [Row],
        calibrated: &Calibrated,
        measured: bool,
    ) -> Self {
        let whitening = calibrated.whitening(context, rows);
        // Winds that differ from run to run are more resistance in the mean: (v + w)² is v² + w².
        let by_winds = context.believed.train().davis().r2 * calibrated.own.wind_mps.powi(2);
        let y = rows.iter().map(|row| row.residual_n_per_kg - by_winds);
        let y = whitening.whiten(&y.collect::<Vec<f64>>());
        let families = families(context, rows, &whitening, measured);
        let sensors = sensors(context, rows, &whitening);
        Self {
            context,
            rows,
            whitening,
            y,
            sensors,
            families,
            known: RefCell::default(),
        }
    }

    fn white(&self, term: &Term) -> Rc<Vec<DVector<f64>>> {
        let key = format!("{term:?}");
        if let Some(known) = self.known.borrow().get(&key) {
            return Rc::clone(known);
        }
        let columns = term.columns(self.context, self.rows);
        let white = Rc::new(columns.iter().map(|c| self.whitening.whiten(c)).collect());
        self.known.borrow_mut().insert(key, Rc::clone(&white));
        white
    }

    /// The fit of a model: its coefficients in the order of the terms, then those of sensors.
    pub fn base(&self, model: &[Term]) -> Option<Base> {
        let y = model
            .iter()
            .filter(|term| matches!(term, Term::Length(_)))
            .fold(self.y.clone(), |y, term| y - &self.white(term)[0]);
        let free: Vec<_> = model
            .iter()
            .filter(|term| !matches!(term, Term::Length(_)))
            .flat_map(|term| self.white(term).to_vec())
            .chain(self.sensors.iter().cloned())
            .collect();
        Base::new(&y, &free, self.whitening.runs())
    }

    /// The best shape of each family beside a model, best first.
    pub fn candidates(&self, model: &[Term]) -> Vec<Found> {
        let Some(base) = self.base(model) else {
            return Vec::new();
        };
        let mut found: Vec<Found> = self
            .families
            .iter()
            .filter_map(|family| self.best_of(family, &base, model))
            .collect();
        found.sort_by(|a, b| b.value.total_cmp(&a.value));
        found
    }

    fn best_of(&self, family: &Family, base: &Base, model: &[Term]) -> Option<Found> {
        let terms = match family {
            Family::Shapes(terms) => terms.clone(),
            Family::Section(scan) => {
                vec![scan.refined(base).map(|s| scan_term(scan, s))?]
            }
            Family::Wind => {
                let mut wind_mps = 0.0;
                for _ in 0..3 {
                    wind_mps = base.gain(&self.white(&Term::Wind(wind_mps)))?.beta[0];
                }
                vec![Term::Wind(wind_mps)]
            }
            Family::Length => return self.best_length(base),
            Family::Dragging => vec![self.dragging(base)?],
        };
        let terms = terms.into_iter().filter(|term| {
            let same =
                |other: &Term| core::mem::discriminant(other) == core::mem::discriminant(term);
            is_section(term)
                || !model.iter().any(same)
                || matches!(term, Term::Smooth(..) | Term::Step(..))
        });
        let found = |term: Term| {
            let gain = base.gain(&self.white(&term))?;
            if !matters(&term, gain.beta.as_slice(), self.context, self.rows) {
                return None;
            }
            let cost = cost(&term, self.rows);
            let (value, sure) = (gain.naive_gain - cost, gain.gain - cost);
            // A gain that rests on a few runs is worth what it is worth run by run.
            let few = matches!(term, Term::DraggingBrake(_));
            let sure = if few {
                sure
            } else {
                sure.min(gain.without_best - cost)
            };
            let value = if sure > ENOUGH {
                value
            } else {
                value.min(sure)
            };
            if value > ENOUGH && !self.is_sure(&term, &gain) {
                return None;
            }
            Some(Found { term, gain, value })
        };
        let best = terms
            .filter_map(found)
            .max_by(|a, b| a.value.total_cmp(&b.value))?;
        if best.value < ENOUGH {
            return Some(best);
        }
        match shape::refined(self, base, best.term.clone()) {
            same if same == best.term => Some(best),
            finer => found(finer).or(Some(best)),
        }
    }

    /// Its sign is sure, whatever differs in all rows alike.
    fn is_sure(&self, term: &Term, gain: &Gain) -> bool {
        // The other coefficient of a temperature is a constant.
        let one = gain.beta.len() == 1 || matches!(term, Term::Temperature);
        let (beta, systematic) = (gain.beta.iter().next(), self.in_all_rows(term));
        let (true, Some(beta), Some(systematic)) = (one, beta, systematic.first()) else {
            return true;
        };
        let sd = gain.naive[(0, 0)].max(gain.robust[(0, 0)]).sqrt();
        beta.abs() > TWO_SIDED * sd.hypot(*systematic)
    }

    /// What a term brings beside a model. The coefficient of another length is 1, so its gain is not that of a free fit.
    pub fn gain(&self, base: &Base, term: &Term) -> Option<Gain> {
        let columns: Vec<DVector<f64>> = term
            .columns(self.context, self.rows)
            .iter()
            .map(|column| self.whitening.whiten(column))
            .collect();
        let Term::Length(_) = term else {
            return base.gain(&columns);
        };
        let column = base.beside(&columns[0]);
        let mut gain = base.gain(core::slice::from_ref(&column))?;
        let naive = base.residual.dot(&column) - 0.5 * column.norm_squared();
        gain.gain *= naive / gain.naive_gain.max(1e-12);
        gain.naive_gain = naive;
        Some(gain)
    }

    fn best_length(&self, base: &Base) -> Option<Found> {
        let believed_m = self.context.believed.train().length_m();
        let found = |term: Term| {
            let gain = self.gain(base, &term)?;
            let value = gain.gain - cost(&term, self.rows);
            Some(Found { term, gain, value })
        };
        let best = (4..40)
            .filter(|i: &i32| (i - 20).abs() >= 3)
            .filter_map(|i| found(Term::Length(believed_m * f64::from(i) / 20.0)))
            .max_by(|a, b| a.value.total_cmp(&b.value))?;
        if best.value < ENOUGH {
            return Some(best);
        }
        found(shape::refined(self, base, best.term))
    }

    /// The runs in which a constant resistance after the first brake application, the same in all of them, explains most.
    fn dragging(&self, base: &Base) -> Option<Term> {
        let all: Vec<usize> = self.rows.iter().map(|row| row.interval.run).collect();
        let column = &self.white(&Term::DraggingBrake(all))[0];
        let column = base.beside(column);
        let of_runs: Vec<(usize, f64, f64)> = self
            .whitening
            .runs()
            .iter()
            .map(|range| {
                let c = column.rows(range.start, range.len());
                let e = base.residual.rows(range.start, range.len());
                (
                    self.rows[range.start].interval.run,
                    c.dot(&e),
                    c.norm_squared(),
                )
            })
            .filter(|(_, _, information)| *information > 0.0)
            .collect();
        let mut best: Option<(f64, Vec<usize>)> = None;
        for (_, score, information) in &of_runs {
            let mut drag = score / information;
            if drag <= 0.0 {
                continue;
            }
            let mut chosen: Vec<&(usize, f64, f64)> = Vec::new();
            for _ in 0..6 {
                chosen = of_runs
                    .iter()
                    .filter(|(_, g, i)| g * drag - 0.5 * i * drag * drag > 1.0)
                    .collect();
                let (g, i) = chosen
                    .iter()
                    .fold((0.0, 0.0), |(a, b), c| (a + c.1, b + c.2));
                if i <= 0.0 {
                    break;
                }
                drag = g / i;
            }
            let (g, i) = chosen
                .iter()
                .fold((0.0, 0.0), |(a, b), c| (a + c.1, b + c.2));
            let runs: Vec<usize> = chosen.iter().map(|c| c.0).collect();
            let value = if i > 0.0 { 0.5 * g * g / i } else { 0.0 }
                - choice_cost(runs.len(), of_runs.len());
            if !runs.is_empty() && best.as_ref().is_none_or(|b| value > b.0) {
                best = Some((value, runs));
            }
        }
        best.map(|(_, runs)| Term::DraggingBrake(runs))
    }

    /// Penalised log-likelihood of a model.
    pub fn score(&self, model: &[Term]) -> f64 {
        let Some(base) = self.base(model) else {
            return f64::NEG_INFINITY;
        };
        let costs: f64 = model
            .iter()
            .map(|term| cost(term, self.rows) + ENOUGH)
            .sum();
        0.5 * self.y.norm_squared() - base.half_sum() - costs
    }

    /// What a difference of [`NOTHING_N_PER_KG`] in all rows alike would make of each coefficient of a term where it acts.
    fn in_all_rows(&self, term: &Term) -> Vec<f64> {
        let columns = term.columns(self.context, self.rows);
        let size = |column: Vec<f64>| {
            let acting = || column.iter().filter(|value| **value != 0.0);
            let square = acting().map(|value| value * value).sum::<f64>();
            (square / acting().count().max(1) as f64).sqrt()
        };
        let of = |size: f64| {
            if size > 0.0 {
                NOTHING_N_PER_KG / size
            } else {
                0.0
            }
        };
        columns.into_iter().map(size).map(of).collect()
    }

    /// Standard deviations of a term's coefficients that no spread of rows or runs shows: a difference in all rows alike, and Davis coefficients that were taken as
    /// described.
    pub fn systematic(&self, model: &[Term], index: usize) -> Vec<f64> {
        let mut sd = self.in_all_rows(&model[index]);
        let Term::Davis(wrong) = model[index] else {
            return sd;
        };
        let free = |term: &&Term| !matches!(term, Term::Length(_));
        let before: usize = model[..index].iter().filter(free).map(Term::count).sum();
        let columns: Vec<_> = model
            .iter()
            .filter(free)
            .flat_map(|term| self.white(term).to_vec())
            .collect();
        let davis = self.context.believed.train().davis();
        for (k, described) in [davis.r0, davis.r1, davis.r2]
            .into_iter()
            .enumerate()
            .filter(|(k, _)| !wrong[*k])
        {
            let mut alone = [false; 3];
            alone[k] = true;
            let left_out = self.white(&Term::Davis(alone));
            if let Some(base) = Base::new(&left_out[0], &columns, self.whitening.runs()) {
                for (sd, beta) in sd.iter_mut().zip(base.beta.iter().skip(before)) {
                    *sd = sd.hypot(DESCRIBED * described * beta);
                }
            }
        }
        sd
    }

    /// 95 % limits of a section: how far its edges may move, one by one and both together, before the log-likelihood has lost what is allowed, and where its
    /// coefficient goes meanwhile. `half`: how far the limits of the coefficient are from it where the edges stay.
    pub fn section(&self, others: &[Term], term: &Term, half: f64) -> Option<SectionLimits> {
        let (section, kind) = match term {
            Term::Tunnel(section) => (*section, Kind::Tunnel),
            Term::Gradient(section) => (*section, Kind::Gradient),
            Term::Bump(section) => (*section, Kind::Bump),
            _ => return None,
        };
        let base = self.base(others)?;
        let gain = |section: [f64; 2]| self.gain(&base, &kind.term(section));
        let best = gain(section)?;
        let mut limits = SectionLimits {
            edges_m: section.map(|at| (at, at)),
            beta: (best.beta[0], best.beta[0]),
        };
        let mut include = |section: [f64; 2], beta: f64, lost: f64| {
            let half = half * (1.0 - lost / LOSS_AT_LIMIT).max(0.0).sqrt();
            limits.beta = (
                limits.beta.0.min(beta - half),
                limits.beta.1.max(beta + half),
            );
            for (limits, at) in limits.edges_m.iter_mut().zip(section) {
                *limits = (limits.0.min(at), limits.1.max(at));
            }
        };
        include(section, best.beta[0], 0.0);
        for (edge, by) in [(0, -40.0), (0, 40.0), (1, -40.0), (1, 40.0)] {
            let mut moved = section;
            for _ in 0..60 {
                moved[edge] += by;
                let lost = |gain: &Gain| (best.gain - gain.gain).max(0.0);
                let found = gain(moved).filter(|gain| lost(gain) < LOSS_AT_LIMIT);
                let Some(found) = found.filter(|_| moved[1] - moved[0] >= 50.0) else {
                    // The limit is no nearer than this.
                    include(moved, best.beta[0], LOSS_AT_LIMIT);
                    break;
                };
                include(moved, found.beta[0], lost(&found));
            }
        }
        let scans = self.families.iter().filter_map(|family| match family {
            Family::Section(scan) if scan.kind() == kind => Some(scan),
            _ => None,
        });
        // Where runs differ more than the noise model says, so much more may be lost.
        let wider = (best.naive_gain / best.gain.max(1e-9)).max(1.0);
        for scan in scans {
            for (section, beta, lost) in scan.within(&base, best.naive_gain, wider * LOSS_AT_LIMIT)
            {
                include(section, beta, lost / wider);
            }
        }
        Some(limits)
    }

    /// The model.
    pub fn select(&self) -> Vec<Term> {
        let first = self.candidates(&[]);
        let mut best: (f64, Vec<Term>) = (0.0, Vec::new());
        for start in first.iter().filter(|f| f.value > ENOUGH).take(3) {
            let mut model = vec![start.term.clone()];
            self.grow(&mut model);
            let score = self.score(&model);
            if score > best.0 + 1e-6 {
                best = (score, model);
            }
        }
        best.1
    }

    fn grow(&self, model: &mut Vec<Term>) {
        let left = |model: &[Term]| self.base(model).map(|base| base.half_sum());
        let Some(at_first) = left(&[]) else {
            return;
        };
        loop {
            self.reconsider(model);
            if model.len() >= MOST_TERMS {
                return;
            }
            let Some(now) = left(model) else {
                return;
            };
            let brought = at_first - now;
            let next = self.candidates(model).into_iter().find(|found| {
                // What differs from run to run is no shadow of what acts along the way, and the other way round.
                let alike = |term: &Term| between_runs(term) == between_runs(&found.term);
                let shadow = if model.iter().any(alike) {
                    SHADOW * brought
                } else {
                    0.0
                };
                found.value > ENOUGH.max(shadow)
            });
            match next {
                Some(next) => model.push(next.term),
                None => return,
            }
        }
    }

    /// Takes each term out in turn: what would now be best in its place, if anything?
    fn reconsider(&self, model: &mut Vec<Term>) {
        for _ in 0..3 {
            let mut changed = false;
            let mut index = 0;
            while index < model.len() {
                let mut others = model.clone();
                others.remove(index);
                let score = self.score(model);
                match self.candidates(&others).into_iter().next() {
                    Some(found) if found.value > ENOUGH => {
                        let mut with = others.clone();
                        with.insert(index, found.term);
                        if with != *model && self.score(&with) > score + 0.5 {
                            *model = with;
                            changed = true;
                        }
                        index += 1;
                    }
                    _ => {
                        *model = others;
                        changed = true;
                    }
                }
            }
            if !changed {
                return;
            }
        }
    }
}

/// Whitened columns of what sensors do, as far as these rows can show it.
pub fn sensors(context: &Context<'_>, rows: &[Row], whitening: &Whitening) -> Vec<DVector<f64>> {
    let columns = [Term::Delay, Term::Late].map(|term| term.columns(context, rows).remove(0));
    let shown = columns.iter().filter(|c| c.iter().any(|v| *v != 0.0));
    shown.map(|column| whitening.whiten(column)).collect()
}

/// The same all through a run, another in each.
fn between_runs(term: &Term) -> bool {
    matches!(
        term,
        Term::Season
            | Term::Temperature
            | Term::DraggingBrake(_)
            | Term::Step(..)
            | Term::Smooth(Coordinate::Day | Coordinate::Temperature, _)
    )
}

fn is_section(term: &Term) -> bool {
    matches!(term, Term::Tunnel(_) | Term::Gradient(_) | Term::Bump(_))
}

fn scan_term(scan: &Scan, section: [f64; 2]) -> Term {
    scan.kind().term(section)
}

/// Whether a term is large enough to matter to a train: what is smaller is left to the Davis coefficients' uncertainty and to sensors.
fn matters(term: &Term, beta: &[f64], context: &Context<'_>, rows: &[Row]) -> bool {
    /// A resistance below this is no finding, N/kg: 1 % of a train's at 100 km/h.
    const LEAST_N_PER_KG: f64 = 3e-4;
    /// A table without a name takes the faults of all that is named with it, so it must be more.
    const LEAST_UNNAMED_N_PER_KG: f64 = 6e-4;
    /// The same in a section of the line: 0.2 permille.
    const LEAST_IN_SECTION_N_PER_KG: f64 = 2e-3;
    /// A brake that drags by less is no finding: winds and loads of single runs do that.
    const LEAST_DRAG_N_PER_KG: f64 = 1.5e-3;
    /// What stiff bearings add at most, N/kg. More is a law of something else, carried back to the departure.
    const MOST_WARM_UP_N_PER_KG: f64 = 0.03;
    // In rising order.
    let sizes = || {
        let columns = term.columns(context, rows);
        let extra = |i: usize| columns.iter().zip(beta).map(|(c, b)| c[i] * b).sum::<f64>();
        let mut sizes: Vec<f64> = (0..rows.len()).map(|i| extra(i).abs()).collect();
        sizes.sort_by(f64::total_cmp);
        sizes
    };
    let most = || sizes().last().copied().unwrap_or(0.0);
    // What acts always must be seen in more than the few slowest or fastest rows.
    let often = || sizes().get(rows.len() * 4 / 5).copied().unwrap_or(0.0);
    // More than the train's whole resistance is no finding either: too few rows for so many coefficients.
    let davis = context.believed.train().davis();
    let absurd = || {
        let columns = term.columns(context, rows);
        rows.iter().enumerate().any(|(i, row)| {
            let extra: f64 = columns.iter().zip(beta).map(|(c, b)| c[i] * b).sum();
            extra.abs()
                > MOST_SHARE * davis.resistance_n_per_kg(row.interval.mean_speed_mps()) + 0.01
        })
    };
    if !matches!(
        term,
        Term::Tunnel(_) | Term::Gradient(_) | Term::Bump(_) | Term::Mass | Term::BrakeFade(_)
    ) && absurd()
    {
        return false;
    }
    match term {
        Term::Mass => beta[0].abs() > 0.008,
        Term::BrakeFade(_) => beta[0] > 0.04,
        Term::Length(_) => true,
        Term::Tunnel(_) => beta[0] > 0.0 && most() > LEAST_IN_SECTION_N_PER_KG,
        Term::Gradient(_) | Term::Bump(_) => most() > LEAST_IN_SECTION_N_PER_KG,
        Term::Curve => beta[0] > 0.0 && most() > LEAST_N_PER_KG,
        Term::DraggingBrake(_) => beta[0] > LEAST_DRAG_N_PER_KG,
        // The largest value belongs to the first rows alone.
        Term::WarmUp(_) => {
            (0.0..MOST_WARM_UP_N_PER_KG).contains(&beta[0]) && most() > 2.0 * LEAST_N_PER_KG
        }
        Term::Davis(_) | Term::Cube | Term::Wind(_) => often() > LEAST_N_PER_KG,
        Term::Smooth(..) | Term::Step(..) => most() > LEAST_UNNAMED_N_PER_KG,
        _ => most() > LEAST_N_PER_KG,
    }
}

/// What a section must be better by only because it has no name: it fits as well as one with a name that is better by no more.
pub fn unnamed(term: &Term) -> f64 {
    match term {
        Term::Bump(_) => UNNAMED,
        _ => 0.0,
    }
}

/// Cost of a term's freedom.
pub fn cost(term: &Term, rows: &[Row]) -> f64 {
    match term {
        Term::Davis(wrong) => wrong.iter().filter(|w| **w).count() as f64 * COEFFICIENT,
        Term::Tunnel(_) | Term::Gradient(_) => COEFFICIENT + SECTION,
        Term::Bump(_) => COEFFICIENT + SECTION + unnamed(term),
        // One law instead of three coefficients: a little dearer than one of them.
        Term::Cube => COEFFICIENT + 1.0,
        Term::Delay | Term::Late => 0.0,
        Term::Curve | Term::Wind(_) | Term::Mass | Term::Season => COEFFICIENT,
        Term::Length(_) => COEFFICIENT + SHAPE + SHIFT,
        Term::Temperature => 2.0 * COEFFICIENT,
        Term::WarmUp(_) | Term::BrakeFade(_) => COEFFICIENT + SHAPE,
        Term::DraggingBrake(runs) => {
            COEFFICIENT + choice_cost(runs.len(), rows.last().map_or(1, |r| r.interval.run + 1))
        }
        Term::Step(..) => COEFFICIENT + SECTION + UNNAMED,
        Term::Smooth(_, knots) => knots.len() as f64 * COEFFICIENT + UNNAMED,
    }
}

/// Log of the number of ways to choose `chosen` of `all` runs, about.
fn choice_cost(chosen: usize, all: usize) -> f64 {
    let p = (chosen as f64 / all as f64).clamp(1e-9, 1.0 - 1e-9);
    -(all as f64) * (p * p.ln() + (1.0 - p) * (1.0 - p).ln()) + 0.5 * (all as f64).ln()
}

fn families(
    context: &Context<'_>,
    rows: &[Row],
    whitening: &Whitening,
    measured: bool,
) -> Vec<Family> {
    let kmh = |v: f64| v / 3.6;
    let mut families = vec![
        // r1 alone is what a one-way wind looks like, and no way in which a description goes wrong.
        Family::Shapes(
            [
                [true, false, false],
                [false, false, true],
                [true, false, true],
                [true, true, true],
            ]
            .map(Term::Davis)
            .to_vec(),
        ),
        Family::Shapes(vec![Term::Cube]),
        Family::Wind,
        Family::Shapes(
            [60.0, 120.0, 200.0, 300.0, 450.0, 700.0, 1000.0]
                .map(Term::WarmUp)
                .to_vec(),
        ),
        Family::Length,
        Family::Dragging,
    ];
    for kind in [Kind::Tunnel, Kind::Gradient] {
        families.push(Family::Section(Box::new(Scan::new(
            kind, context, rows, whitening,
        ))));
    }
    if both_directions(rows) {
        families.push(Family::Section(Box::new(Scan::new(
            Kind::Bump,
            context,
            rows,
            whitening,
        ))));
    }
    if !context.curves.is_empty() {
        families.push(Family::Shapes(vec![Term::Curve]));
    }
    // In coasting it is a wrong r2, and so a rival of that.
    families.push(Family::Shapes(vec![Term::Mass]));
    if measured {
        families.push(Family::Shapes(
            [20.0, 40.0, 60.0, 80.0, 100.0]
                .map(|v| Term::BrakeFade(kmh(v)))
                .to_vec(),
        ));
    }
    let mut coordinates = vec![
        (Coordinate::Speed, 7),
        (Coordinate::Speed, 14),
        (Coordinate::Time, 7),
        (Coordinate::Time, 24),
    ];
    if rows.iter().any(|row| row.interval.temperature_c.is_some()) {
        families.push(Family::Shapes(vec![Term::Temperature]));
        coordinates.push((Coordinate::Temperature, 5));
    }
    if context.period_days > 0.0 {
        families.push(Family::Shapes(vec![Term::Season]));
        coordinates.push((Coordinate::Day, 5));
    }
    let along = |which| {
        let at = move |row: &Row| coordinate(which, row, row.interval.middle());
        rows.iter().filter_map(at)
    };
    // Days and temperatures are those of runs, so a step lies between two of them.
    for which in [Coordinate::Day, Coordinate::Temperature] {
        let of_run = |range: &Range<usize>| {
            coordinate(
                which,
                &rows[range.start],
                rows[range.start].interval.middle(),
            )
        };
        let between = knots(whitening.runs().iter().filter_map(of_run), STEPS);
        let steps = between.windows(2).flat_map(|pair| {
            let at = 0.5 * (pair[0] + pair[1]);
            [Side::Below, Side::Above].map(|side| Term::Step(which, [at - STEEP, at + STEEP], side))
        });
        let steps: Vec<Term> = steps.collect();
        if !steps.is_empty() {
            families.push(Family::Shapes(steps));
        }
    }
    let mut smooth = |which, knots| families.push(Family::Shapes(vec![Term::Smooth(which, knots)]));
    for (which, count) in coordinates {
        smooth(which, knots(along(which), count));
    }
    // Speeds that are only passed through have few rows, and no knot among those that are equally filled.
    let (low, high) =
        along(Coordinate::Speed).fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    if low < high {
        let even = |i: usize| low + (high - low) * i as f64 / (EVEN - 1) as f64;
        smooth(Coordinate::Speed, (0..EVEN).map(even).collect());
    }
    families
}
