//! Which terms are missing: forward selection by penalised gain of log-likelihood, with second thoughts.
//!
//! Each family (one named effect, or a smooth function of one coordinate) offers its best shape beside the current model. Its value is the gain, scaled down
//! where runs differ more than the noise model says, minus what its freedom costs.

use super::calibrate::Calibrated;
use super::dragging::Told;
use super::families::{Family, families};
use super::fit::{Base, Gain};
use super::named::is_unnamed;
use super::rows::Row;
use super::shape;
use super::terms::{Context, Term};
use super::whitening::Whitening;
use super::worth::{between_runs, choice_cost, cost, is_section, matters};
use nalgebra::DVector;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// A value below this is chance: with some fifteen families a data set without an effect reaches it once in about a hundred.
pub const ENOUGH: f64 = 5.0;
/// A term that brings less than this share of what the model has brought already may be no more than the model's law being a little different: an effect of a twentieth of the size.
const SHADOW: f64 = 0.003;
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

/// All that a search needs.
pub struct Search<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) rows: &'a [Row],
    pub(super) whitening: Whitening,
    y: DVector<f64>,
    /// Whitened columns of what sensors do; part of every fit.
    sensors: Vec<DVector<f64>>,
    pub(super) families: Vec<Family>,
    /// Whitened columns of terms that were tried, by their text.
    known: RefCell<HashMap<String, Rc<Vec<DVector<f64>>>>>,
}

impl<'a> Search<'a> {
    /// Prepares the search. `measured`: with an effort column.
    pub fn new(context: &'a Context<'a>, rows: &'a [Row], calibrated: &Calibrated, measured: bool) -> Self {
        let whitening = calibrated.whitening(context, rows);
        // Winds that differ from run to run are more resistance in the mean: (v + w)² is v² + w².
        let by_winds = context.believed.train().davis().r2 * calibrated.own.wind_mps.powi(2);
        let y = rows.iter().map(|row| row.residual_n_per_kg - by_winds);
        let y = whitening.whiten(&y.collect::<Vec<f64>>());
        let families = families(context, rows, &whitening, measured);
        let sensors = sensors(context, rows, &whitening);
        Self { context, rows, whitening, y, sensors, families, known: RefCell::default() }
    }

    pub(super) fn white(&self, term: &Term) -> Rc<Vec<DVector<f64>>> {
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
        let mut found: Vec<Found> =
            self.families.iter().filter_map(|family| self.best_of(family, &base, model)).collect();
        found.sort_by(|a, b| b.value.total_cmp(&a.value));
        found
    }

    fn best_of(&self, family: &Family, base: &Base, model: &[Term]) -> Option<Found> {
        let terms = match family {
            Family::Shapes(terms) => terms.clone(),
            Family::Section(scan) => {
                vec![scan.refined(base).map(|section| scan.kind().term(section))?]
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
            let same = |other: &Term| core::mem::discriminant(other) == core::mem::discriminant(term);
            // A board takes one table.
            let second = is_unnamed(term) && model.iter().any(is_unnamed);
            !second && (is_section(term) || !model.iter().any(same))
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
            let sure = if few { sure } else { sure.min(gain.without_best - cost) };
            let value = if sure > ENOUGH { value } else { value.min(sure) };
            let sure = || self.is_sure(&term, &gain);
            let agrees = || self.agrees(base, &term, gain.beta.as_slice());
            if value > ENOUGH && !(sure() && agrees()) {
                return None;
            }
            Some(Found { term, gain, value })
        };
        let best = terms.filter_map(found).max_by(|a, b| a.value.total_cmp(&b.value))?;
        if best.value < ENOUGH {
            return Some(best);
        }
        match shape::refined(self, base, best.term.clone()) {
            same if same == best.term => Some(best),
            finer => found(finer).or(Some(best)),
        }
    }

    /// What a term brings beside a model. The coefficient of another length is 1, so its gain is not that of a free fit.
    pub fn gain(&self, base: &Base, term: &Term) -> Option<Gain> {
        let columns: Vec<DVector<f64>> =
            term.columns(self.context, self.rows).iter().map(|column| self.whitening.whiten(column)).collect();
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
            // Another length is a column of its own: its coefficient is 1.
            if value > ENOUGH && !self.agrees(base, &term, &[1.0]) {
                return None;
            }
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
        let mut of_runs = Told::of_runs(self.rows, self.whitening.runs(), &column, &base.residual);
        of_runs.retain(|run| run.information > 0.0);
        let sums = |chosen: &[&Told]| {
            let add = |(a, b): (f64, f64), run: &&Told| (a + run.score, b + run.information);
            chosen.iter().fold((0.0, 0.0), add)
        };
        let mut best: Option<(f64, Vec<usize>)> = None;
        for Told { score, information, .. } in &of_runs {
            let mut drag = score / information;
            if drag <= 0.0 {
                continue;
            }
            let mut chosen: Vec<&Told> = Vec::new();
            for _ in 0..6 {
                chosen = of_runs.iter().filter(|run| run.gain(drag) > 1.0).collect();
                let (g, i) = sums(&chosen);
                if i <= 0.0 {
                    break;
                }
                drag = g / i;
            }
            let (g, i) = sums(&chosen);
            let runs: Vec<usize> = chosen.iter().map(|run| run.run).collect();
            let value = if i > 0.0 { 0.5 * g * g / i } else { 0.0 } - choice_cost(runs.len(), of_runs.len());
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
        let costs: f64 = model.iter().map(|term| cost(term, self.rows) + ENOUGH).sum();
        0.5 * self.y.norm_squared() - base.half_sum() - costs
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
        // A term that comes and goes would do so for ever.
        for _ in 0..2 * MOST_TERMS {
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
                let shadow = if model.iter().any(alike) { SHADOW * brought } else { 0.0 };
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
